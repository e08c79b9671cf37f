//! Soft and anti-aliased shadows of area lights, as `wgpu` passes.
//!
//! A host hands over its device, its casters, depth and normals of its picture and a rectangular light; a technique
//! from the [list](techniques::TECHNIQUES) fills a texture with the visible fraction of the light at each pixel: 1 lit,
//! 0 umbra. Nothing here opens files or windows.
//!
//! ```no_run
//! use antumbra::{Casters, Error, Frame, GeometryInput, Gpu, Recorder, RectLight, ShadowFrustum, Spec, View};
//! # use antumbra::input::casters::BorrowedMesh;
//! # fn host(device: wgpu::Device, queue: wgpu::Queue, mut encoder: wgpu::CommandEncoder, meshes: &[BorrowedMesh],
//! #     geometry: GeometryInput, visibility: wgpu::TextureView, view: View, light: RectLight) -> Result<(), Error> {
//! // Once, with what the renderer has anyway: device, vertex and index buffers, depth, normals, an R32Float texture.
//! let gpu = Gpu::from_host(device, queue);
//! let casters = std::sync::Arc::new(Casters::from_buffers(&gpu, meshes)?);
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
//! - Writing a technique: [`technique::TechniqueFactory`], the [`passes`] that several techniques share, and `CONTRIBUTING.md`.
#![deny(missing_docs)]

pub mod error;
pub mod gpu;
pub mod input;
pub mod passes;
pub mod scene;
#[cfg(test)]
mod shaders;
pub mod shadows;
pub mod technique;
pub mod techniques;
#[cfg(test)]
mod testing;

pub use antumbra_scene::{Aabb, Camera, RectLight};
pub use error::Error;
pub use gpu::device::{AdapterChoice, Gpu};
pub use gpu::timer::Timer;
pub use input::casters::Casters;
pub use input::frame::{Frame, FrameDescriptor, View};
pub use input::frustum::ShadowFrustum;
pub use shadows::Shadows;
pub use technique::{Technique, TechniqueFactory, TechniqueInfo};
pub use techniques::spec::Spec;
pub use wgpu;
