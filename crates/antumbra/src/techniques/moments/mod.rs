//! Shadow maps that can be filtered: moments and other statistics of depth.
//!
//! `vsm`, `evsm`, `msm`, `esm` and `csm` are hard shadows, looked up through [`prefiltered`]; `savsm`, `vssm` and
//! `cssm` are soft, read from summed-area tables through [`summed`].

pub mod csm;
pub mod cssm;
pub mod esm;
pub mod evsm;
pub mod msm;
pub mod prefiltered;
pub mod savsm;
pub mod summed;
pub mod vsm;
pub mod vssm;
