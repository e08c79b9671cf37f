//! The input of a frame: view, light, casters, receivers, and the frustum that is fitted to them.

pub mod casters;
pub mod classification;
pub(crate) mod cluster_bounds;
pub mod frame;
pub mod frustum;
pub(crate) mod light_grid;
pub(crate) mod map_view;
