//! Soft and anti-aliased shadows of area lights, as `wgpu` passes.
//!
//! A host hands over its device, its casters, depth and normals of its picture and a rectangular light; a technique
//! from the [list](techniques::TECHNIQUES) fills a texture with the visible fraction of the light at each pixel: 1 lit,
//! 0 umbra. Nothing here opens files or windows.
//!
//! ```no_run
//! use antumbra::{Casters, Error, Frame, GeometryInput, Gpu, Recorder, RectLight, ShadowFrustum, Spec, View};
//! # use antumbra::casters::BorrowedMesh;
//! # fn host(device: wgpu::Device, queue: wgpu::Queue, mut encoder: wgpu::CommandEncoder, meshes: &[BorrowedMesh],
//! #     geometry: GeometryInput, visibility: wgpu::TextureView, view: View, light: RectLight) -> Result<(), Error> {
//! // Once, with what the renderer has anyway: device, vertex and index buffers, depth, normals, an R32Float texture.
//! let gpu = Gpu::from_host(device, queue);
//! let casters = std::sync::Arc::new(Casters::borrow(&gpu, meshes)?);
//! let bounds = casters.bounds();
//! let mut frame = Frame::new(&gpu, casters, geometry, visibility, view, light)?;
//! let mut shadow = "pcss:map=1024".parse::<Spec>()?.make(&gpu)?;
//!
//! // Each frame, between the depth prepass and the shading that reads the visibility.
//! frame.update(&gpu, view, light, ShadowFrustum::around(&light, &bounds));
//! shadow.record(&frame, &mut Recorder::new(&gpu, &mut encoder))?;
//! # Ok(()) }
//! ```
//!
//! `examples/bring_your_own_renderer.rs` is a whole host of that kind, and a test compares its picture with the
//! ray-traced truth. Programs without a renderer of their own draw a whole [`antumbra_scene::Scene`] with
//! [`scene::SceneRenderer`].
//!
//! # Where to look
//!
//! - What goes in and what comes out: [`Frame`], [`GeometryInput`], [`casters::BorrowedMesh`], [`ShadowFrustum`].
//! - Which techniques there are and what can be set: [`techniques::TECHNIQUES`], [`Spec`].
//! - Time and memory: [`Timer`], [`Technique::memory`].
//! - Writing a technique: [`technique::Describe`], the [`passes`] that several techniques share, and `CONTRIBUTING.md`.
#![deny(missing_docs)]

pub mod casters;
mod cells;
mod error;
pub mod fit;
pub mod frame;
pub mod gpu;
pub mod passes;
pub mod pipeline;
pub mod recorder;
pub mod resource;
pub mod roles;
pub mod scene;
pub mod settings;
pub mod shader;
pub mod technique;
pub mod techniques;
#[cfg(test)]
mod testing;

pub use antumbra_scene::{Aabb, Camera, RectLight};
pub use casters::Casters;
pub use error::Error;
pub use fit::ShadowFrustum;
pub use frame::{Frame, GeometryInput, View};
pub use gpu::{AdapterChoice, Gpu};
pub use recorder::{Recorder, Timer};
pub use technique::{Spec, Technique, TechniqueInfo};
