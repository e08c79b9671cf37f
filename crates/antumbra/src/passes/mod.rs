//! What several techniques share.

pub mod adjacency;
pub mod classify;
pub mod cluster_bounds;
pub mod compact;
pub mod culling;
pub mod depth_layers;
pub mod depth_map;
pub mod depth_pyramid;
pub mod geometry_buffer;
pub mod growth;
pub mod light_depth;
pub mod light_maps;
pub mod light_triangles;
pub mod moments;
pub mod patch_pyramid;
pub mod penumbra_widths;
pub mod picture;
pub mod scan;
pub mod silhouette;
pub mod sort;
pub mod sparse;
pub mod summed_area;
pub mod texel_lists;
pub mod triangle_pairs;
