//! `antumbra study`: questions that a paper has put to people, put to an image metric.

pub mod disk;
pub mod fit;
pub mod rho;
