//! The techniques: one folder each, and one line each in the list.

use crate::technique::{TechniqueInfo, entry};

pub mod alias_free;
// TODO(convert) pub mod backprojection;
// TODO(convert) pub mod light_sampling;
// TODO(convert) pub mod moments;
pub mod pcss;
// TODO(convert) pub mod pvssm;
pub mod shadow_map;
pub mod spec;
// TODO(convert) pub mod ssm;

/// Every technique, in the order of papers. The command line, the report, the tests and the docs are made from it.
pub const TECHNIQUES: &[TechniqueInfo] = &[
    entry::<shadow_map::hard::Hard>(),
    entry::<shadow_map::pcf::Pcf>(),
    entry::<pcss::Pcss>(),
    entry::<pcss::SmoothPcss>(),
    // TODO(convert) entry::<ssm::Ssm>(),
    // TODO(convert) entry::<moments::vsm::Vsm>(),
    // TODO(convert) entry::<moments::evsm::Evsm>(),
    // TODO(convert) entry::<moments::msm::Msm>(),
    // TODO(convert) entry::<moments::esm::Esm>(),
    // TODO(convert) entry::<moments::csm::Csm>(),
    // TODO(convert) entry::<moments::savsm::Savsm>(),
    // TODO(convert) entry::<moments::vssm::Vssm>(),
    // TODO(convert) entry::<moments::cssm::Cssm>(),
    // TODO(convert) entry::<backprojection::Backprojection>(),
    // TODO(convert) entry::<backprojection::packet::Packet>(),
    // TODO(convert) entry::<pvssm::Pvssm>(),
    // TODO(convert) entry::<pvssm::fvsm::Fvsm>(),
    entry::<alias_free::subpixel::Subpixel>(),
    // TODO(convert) entry::<light_sampling::uniform::UniformSampling>(),
    // TODO(convert) entry::<light_sampling::adaptive::AdaptiveSampling>(),
    entry::<alias_free::hard::AliasFree>(),
    // TODO(convert) entry::<alias_free::soft::AliasFreeSoft>(),
];
