//! Scenes for shadow work: meshes, a camera, a rectangular light, built-in scenes, importers.
//!
//! World space is right-handed, +Y up, in metres. Nothing here touches a GPU, and with
//! `default-features = false` nothing here touches a file either.
#![deny(missing_docs)]

mod axes;
mod bounds;
pub mod builtin;
mod camera;
mod error;
#[cfg(feature = "import")]
mod framing;
#[cfg(feature = "import")]
pub mod import;
mod light;
mod load;
mod mesh;
mod read_file;
mod scene;
#[cfg(feature = "scene-file")]
pub mod scene_file;

pub use bounds::Aabb;
pub use camera::Camera;
pub use error::{Place, SceneError};
pub use light::RectLight;
pub use load::{load, load_from, load_placed};
pub use mesh::{Material, Mesh, Texture, Wrap};
pub use read_file::{ReadFile, read_from_disk};
pub use scene::{Instance, Scene};
