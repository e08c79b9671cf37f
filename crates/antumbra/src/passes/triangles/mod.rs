//! Passes over the casters' triangles: culling, shared edges, silhouettes, light-space triangles and their texels.

pub mod adjacency;
pub mod culling;
pub mod light_triangles;
pub mod silhouette;
pub mod triangle_pairs;
