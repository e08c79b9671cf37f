//! Soft and anti-aliased shadows of area lights, as `wgpu` passes.
//!
//! A host hands over its device, its casters, depth and normals of its picture and a rectangular light; a technique
//! from the [list](techniques::TECHNIQUES) fills a texture with the visible fraction of the light at each pixel.
//! Nothing here opens files or windows.
#![deny(missing_docs)]

pub mod casters;
mod error;
pub mod fit;
pub mod frame;
pub mod gpu;
pub mod passes;
pub mod pipeline;
pub mod recorder;
pub mod resource;
pub mod scene;
pub mod settings;
pub mod shader;
pub mod technique;
pub mod techniques;

pub use antumbra_scene::{Aabb, Camera, RectLight};
pub use casters::Casters;
pub use error::Error;
pub use fit::ShadowFrustum;
pub use frame::{Frame, GeometryInput, View};
pub use gpu::{AdapterChoice, Gpu};
pub use recorder::{Recorder, Timer};
pub use technique::{Spec, Technique, TechniqueInfo};
