//! The techniques: one folder each, and one line each in the list.

use crate::technique::{TechniqueInfo, entry};

pub mod adaptive_sampling;
pub mod alias_free;
pub mod alias_free_soft;
pub mod backprojection;
pub mod csm;
pub mod cssm;
pub mod esm;
pub mod evsm;
pub mod fvsm;
pub mod hard;
pub mod msm;
pub mod packet;
pub mod pcf;
pub mod pcss;
pub mod prefiltered;
pub mod pvssm;
pub mod savsm;
pub mod smooth_pcss;
pub mod ssm;
pub mod subpixel;
pub mod summed;
pub mod uniform_sampling;
pub mod vsm;
pub mod vssm;

/// Every technique, in the order of papers. The command line, the report, the tests and the docs are made from it.
pub const TECHNIQUES: &[TechniqueInfo] = &[
    entry::<hard::Hard>(),
    entry::<pcf::Pcf>(),
    entry::<pcss::Pcss>(),
    entry::<smooth_pcss::SmoothPcss>(),
    entry::<ssm::Ssm>(),
    entry::<vsm::Vsm>(),
    entry::<evsm::Evsm>(),
    entry::<msm::Msm>(),
    entry::<esm::Esm>(),
    entry::<csm::Csm>(),
    entry::<savsm::Savsm>(),
    entry::<vssm::Vssm>(),
    entry::<cssm::Cssm>(),
    entry::<backprojection::Backprojection>(),
    entry::<packet::Packet>(),
    entry::<pvssm::Pvssm>(),
    entry::<fvsm::Fvsm>(),
    entry::<subpixel::Subpixel>(),
    entry::<uniform_sampling::UniformSampling>(),
    entry::<adaptive_sampling::AdaptiveSampling>(),
    entry::<alias_free::AliasFree>(),
    entry::<alias_free_soft::AliasFreeSoft>(),
];
