//! The techniques: one folder each, and one line each in the list.

use crate::technique::{TechniqueInfo, entry};

pub mod adaptive_sampling;
pub mod backprojection;
pub mod hard;
pub mod packet;
pub mod pcf;
pub mod pcss;
pub mod ssm;
pub mod uniform_sampling;

/// Every technique, in the order of papers. The command line, the report, the tests and the docs are made from it.
pub const TECHNIQUES: &[TechniqueInfo] = &[
    entry::<hard::Hard>(),
    entry::<pcf::Pcf>(),
    entry::<pcss::Pcss>(),
    entry::<ssm::Ssm>(),
    entry::<backprojection::Backprojection>(),
    entry::<packet::Packet>(),
    entry::<uniform_sampling::UniformSampling>(),
    entry::<adaptive_sampling::AdaptiveSampling>(),
];
