//! Maps seen from the light: depths, layers, pyramids, moments and tables.

pub mod depth_layers;
pub mod depth_map;
pub mod depth_pyramid;
pub mod light_depth;
pub mod light_maps;
pub mod moments;
pub mod patch_pyramid;
pub mod summed_area;
