//! One shadow map for each of many points of the light.

pub mod adaptive;
pub mod uniform;
