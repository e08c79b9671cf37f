//! User studies of papers, repeated with an image metric in place of people.

mod disk;
mod fit;
pub mod rho;
