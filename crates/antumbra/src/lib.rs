//! Soft and anti-aliased shadows of area lights, as `wgpu` passes.
//!
//! A host hands over its device, its casters, the depth and normals of its image and a rectangular light; a technique
//! from the [list](techniques::TECHNIQUES) fills a texture with the visible fraction of the light at each pixel: 1 lit,
//! 0 umbra. Nothing here opens files or windows.
//!
//! ```no_run
//! use antumbra::input::casters::MeshBuffers;
//! use antumbra::techniques::pcss::{Pcss, PcssSettings};
//! use antumbra::{
//!     Casters, Error, Frame, FrameDescriptor, Gpu, RectLight, ShadowFrustum, Shadows, TechniqueFactory, View, wgpu,
//! };
//!
//! # struct Host { device: wgpu::Device, queue: wgpu::Queue, depth: wgpu::TextureView, normals: wgpu::TextureView,
//! #     visibility: wgpu::TextureView, view: View, light: RectLight }
//! # fn run(host: Host, meshes: &[MeshBuffers], mut encoder: wgpu::CommandEncoder) -> Result<(), Error> {
//! // Once: device, vertex and index buffers, depth, normals and an R32Float texture are the host's own.
//! let gpu = Gpu::from_host(host.device, host.queue);
//! let casters = std::sync::Arc::new(Casters::from_buffers(&gpu, meshes)?);
//! let mut frame = Frame::new(&gpu, &FrameDescriptor {
//!     view: host.view,
//!     light: host.light,
//!     casters: &casters,
//!     depth: &host.depth,
//!     normals: &host.normals,
//!     visibility: &host.visibility,
//! })?;
//! let mut shadows = Shadows::new(Pcss::make(&gpu, PcssSettings { map: 1024, ..Default::default() })?);
//!
//! // Each frame, between the depth prepass and the shading that reads the visibility.
//! frame.update(host.view, host.light, ShadowFrustum::around(&host.light, &casters.bounds()));
//! shadows.record(&gpu, &mut encoder, &frame)?;
//! # Ok(()) }
//! ```
//!
//! `examples/bring_your_own_renderer.rs` is a whole host of that kind, and a test compares its image with the
//! ray-traced truth. Programs without a renderer draw a whole [`antumbra_scene::Scene`] with [`scene::SceneRenderer`].
//!
//! # Where to look
//!
//! - Input and output: [`FrameDescriptor`], [`input::casters::MeshBuffers`], [`ShadowFrustum`].
//! - Techniques and their settings: [`techniques::TECHNIQUES`], [`Spec`].
//! - Time, memory and debug views: [`Timer`], [`Shadows`].
//! - Writing a technique: [`TechniqueFactory`], [`gpu::recorder::Recorder`], the [`passes`] that several techniques share,
//!   and `CONTRIBUTING.md`.
//!
//! The modules are in the order in which they use each other: [`error`], [`gpu`], [`input`], [`technique`], shared
//! shaders, [`passes`], [`techniques`], [`shadows`], [`scene`].
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
