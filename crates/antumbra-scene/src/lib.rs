//! Scenes for shadow work: meshes, a camera, a rectangular light, built-in scenes, importers.
//!
//! World space is right-handed, +Y up, in metres. Nothing here touches a GPU, and with
//! `default-features = false` nothing here touches a file either.
#![deny(missing_docs)]

mod bounds;
pub mod builtin;
mod camera;
mod error;
mod light;
mod mesh;
mod scene;

pub use bounds::Aabb;
pub use camera::Camera;
pub use error::SceneError;
pub use light::RectLight;
pub use mesh::{Material, Mesh, Texture, Wrap};
pub use scene::{Instance, Scene};
