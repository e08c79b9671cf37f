//! One shadow map from the light's centre; the light is a point.

pub mod hard;
pub mod pcf;
