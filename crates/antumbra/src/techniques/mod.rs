//! The techniques: one folder each, and one line each in the list.

use crate::technique::{TechniqueInfo, entry};

pub mod alias_free;
pub mod backprojection;
pub mod light_sampling;
pub mod moments;
pub mod pcss;
pub mod pvssm;
pub mod shadow_map;
pub mod spec;
pub mod ssm;

/// Every technique, in the order of lists and reports. The command line, the report, the tests and the docs are made
/// from it.
pub const TECHNIQUES: &[TechniqueInfo] = &[
    entry::<shadow_map::hard::Hard>(),
    entry::<shadow_map::pcf::Pcf>(),
    entry::<pcss::Pcss>(),
    entry::<pcss::SmoothPcss>(),
    entry::<ssm::Ssm>(),
    entry::<moments::vsm::Vsm>(),
    entry::<moments::evsm::Evsm>(),
    entry::<moments::msm::Msm>(),
    entry::<moments::esm::Esm>(),
    entry::<moments::csm::Csm>(),
    entry::<moments::savsm::Savsm>(),
    entry::<moments::vssm::Vssm>(),
    entry::<moments::cssm::Cssm>(),
    entry::<backprojection::Backprojection>(),
    entry::<backprojection::packet::Packet>(),
    entry::<pvssm::Pvssm>(),
    entry::<pvssm::Fvsm>(),
    entry::<alias_free::subpixel::Subpixel>(),
    entry::<light_sampling::uniform::UniformSampling>(),
    entry::<light_sampling::adaptive::AdaptiveSampling>(),
    entry::<alias_free::hard::AliasFree>(),
    entry::<alias_free::soft::AliasFreeSoft>(),
];
