//! Shader functions that carry a formula, each beside its twin in double precision, compared over random inputs.

mod footprint;
mod frame;
mod horizon;
mod layers;
mod patches;
mod ray_to_center;
mod smooth_kernel;
