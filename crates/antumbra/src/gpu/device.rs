//! The device that everything runs on: choice, capabilities, and the pipelines that are compiled once.

use super::limits::Needs;
use super::pipeline::{ComputePipeline, PipelineCache, RenderPipeline, RenderTarget};
use super::recorder::Recorder;
use super::resources::Resources;
use super::shader::ShaderKey;
use super::texture::Texture;
use crate::error::Error;
use std::sync::Arc;

/// A `wgpu` device with its capabilities and pipelines. Cheap to clone.
#[derive(Clone)]
pub struct Gpu {
    /// The device; the host's own, or one from [`Gpu::new`].
    pub device: wgpu::Device,
    /// Its queue.
    pub queue: wgpu::Queue,
    /// Name, kind and driver.
    pub info: wgpu::AdapterInfo,
    /// Capabilities beyond core WebGPU.
    pub capabilities: Capabilities,
    pipelines: Arc<PipelineCache>,
}

/// Capabilities of an adapter beyond core WebGPU; the missing ones have fallbacks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Capabilities {
    /// GPU times per pass. Without it passes have no milliseconds.
    pub timestamps: bool,
    /// Linear filtering of 32-bit float textures. Without it techniques interpolate in the shader.
    pub float32_filtering: bool,
    /// Samplers with anisotropy whose footprint is right. Without it techniques filter in the shader.
    pub anisotropic_filtering: bool,
    /// Blending into 32-bit float targets. Without it techniques accumulate in compute.
    pub float32_blending: bool,
    /// Rasterisation of every touched pixel. Without it triangles are enlarged in the vertex shader.
    pub conservative_rasterization: bool,
    /// Clipping by planes of the shader's choice. Without it fragments are discarded.
    pub clip_distances: bool,
    /// Wave operations in compute. Without them workgroup memory is used.
    pub subgroups: bool,
    /// Texture formats of 16-bit fixed point. Without it they are refused.
    pub norm16: bool,
    /// Storing to formats that WebGPU only samples, such as `rg16float`. Without it they are refused.
    pub adapter_formats: bool,
    /// Layers of a texture array that one render pass can draw. 1: a pass a layer.
    pub layers_per_pass: u32,
    /// Largest side of a 2D texture, in texels.
    pub max_texture_size: u32,
}

impl Capabilities {
    fn of(features: wgpu::Features, limits: &wgpu::Limits, info: &wgpu::AdapterInfo) -> Self {
        let layered = features.contains(wgpu::Features::MULTIVIEW) && !info.driver.contains("llvmpipe");
        Capabilities {
            timestamps: features.contains(wgpu::Features::TIMESTAMP_QUERY),
            float32_filtering: features.contains(wgpu::Features::FLOAT32_FILTERABLE),
            // llvmpipe (seen in Mesa 22.3) filters over far more than the footprint, and slowly.
            anisotropic_filtering: !info.driver.contains("llvmpipe"),
            float32_blending: features.contains(wgpu::Features::FLOAT32_BLENDABLE),
            conservative_rasterization: features.contains(wgpu::Features::CONSERVATIVE_RASTERIZATION),
            clip_distances: features.contains(wgpu::Features::CLIP_DISTANCES),
            subgroups: features.contains(wgpu::Features::SUBGROUP),
            norm16: features.contains(wgpu::Features::TEXTURE_FORMAT_16BIT_NORM),
            adapter_formats: features.contains(wgpu::Features::TEXTURE_ADAPTER_SPECIFIC_FORMAT_FEATURES),
            // llvmpipe (seen in Mesa 22.3) has the layers, but a triangle that covers a whole tile of its rasteriser is
            // drawn into one of them only.
            layers_per_pass: if layered { limits.max_multiview_view_count.clamp(1, 32) } else { 1 },
            max_texture_size: limits.max_texture_dimension_2d,
        }
    }
}

/// Which adapter to take.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum AdapterChoice {
    /// Discrete before integrated before software.
    #[default]
    Best,
    /// The place in [`adapters`].
    Index(usize),
    /// The first whose name contains this text, whatever the case.
    Name(String),
}

impl std::str::FromStr for AdapterChoice {
    type Err = std::convert::Infallible;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Ok(text.parse().map_or_else(|_| AdapterChoice::Name(text.to_owned()), AdapterChoice::Index))
    }
}

impl AdapterChoice {
    /// The one that is chosen among these, which are in the order of [`adapters`].
    fn among(&self, mut list: Vec<wgpu::Adapter>) -> Result<wgpu::Adapter, Error> {
        let names: Vec<String> = list.iter().map(|a| a.get_info().name).collect();
        let index = match self {
            AdapterChoice::Best => 0,
            AdapterChoice::Index(i) => *i,
            AdapterChoice::Name(n) => names
                .iter()
                .position(|name| name.to_lowercase().contains(&n.to_lowercase()))
                .ok_or_else(|| Error::UnknownAdapter { asked: n.clone(), known: names.clone() })?,
        };
        if list.is_empty() {
            return Err(Error::NoAdapter);
        }
        if index >= list.len() {
            return Err(Error::UnknownAdapter { asked: index.to_string(), known: names });
        }
        Ok(list.swap_remove(index))
    }

    /// The one that is chosen among the adapters of a host's own instance, for hosts that have a window: `suits`
    /// accepts adapters that can draw to it.
    pub fn of(&self, list: &[wgpu::Adapter], suits: impl Fn(&wgpu::Adapter) -> bool) -> Result<wgpu::Adapter, Error> {
        let mut list: Vec<_> = list.iter().filter(|a| is_usable(a) && suits(a)).cloned().collect();
        list.sort_by_key(|a| rank(&a.get_info()));
        self.among(list)
    }
}

/// The device descriptor for hosts that open the device themselves.
pub fn device_descriptor(adapter: &wgpu::Adapter) -> wgpu::DeviceDescriptor<'static> {
    wgpu::DeviceDescriptor {
        label: Some("antumbra"),
        required_features: adapter.features() & WANTED,
        required_limits: adapter.limits(),
        ..Default::default()
    }
}

/// The optional features that are asked for where the adapter has them.
const WANTED: wgpu::Features = wgpu::Features::TIMESTAMP_QUERY
    .union(wgpu::Features::FLOAT32_FILTERABLE)
    .union(wgpu::Features::FLOAT32_BLENDABLE)
    .union(wgpu::Features::CONSERVATIVE_RASTERIZATION)
    .union(wgpu::Features::CLIP_DISTANCES)
    .union(wgpu::Features::SUBGROUP)
    .union(wgpu::Features::TEXTURE_FORMAT_16BIT_NORM)
    .union(wgpu::Features::TEXTURE_ADAPTER_SPECIFIC_FORMAT_FEATURES)
    .union(wgpu::Features::MULTIVIEW);

/// All adapters that can run Antumbra, best first: the order that [`AdapterChoice::Index`] counts in. OpenGL is asked
/// only where no other API has an adapter, so that no device is listed twice. `WGPU_BACKEND` narrows the choice.
pub async fn adapters() -> Vec<wgpu::Adapter> {
    for backends in [wgpu::Backends::PRIMARY, wgpu::Backends::SECONDARY] {
        let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle_from_env();
        descriptor.backends &= backends;
        let mut list = wgpu::Instance::new(descriptor).enumerate_adapters(backends).await;
        list.retain(is_usable);
        list.sort_by_key(|a| rank(&a.get_info()));
        if !list.is_empty() {
            return list;
        }
    }
    Vec::new()
}

/// True if the adapter has compute shaders and renders to the geometry buffer's formats.
fn is_usable(adapter: &wgpu::Adapter) -> bool {
    let renders = |format| {
        let usages = adapter.get_texture_format_features(format).allowed_usages;
        usages.contains(wgpu::TextureUsages::RENDER_ATTACHMENT)
    };
    let needed = wgpu::DownlevelFlags::COMPUTE_SHADERS | wgpu::DownlevelFlags::INDIRECT_EXECUTION;
    let flags = adapter.get_downlevel_capabilities().flags;
    flags.contains(needed) && renders(wgpu::TextureFormat::Rgba32Float)
}

/// Smaller is better.
fn rank(info: &wgpu::AdapterInfo) -> u32 {
    match info.device_type {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    }
}

impl Gpu {
    /// Opens an adapter of this machine.
    pub async fn new(choice: &AdapterChoice) -> Result<Gpu, Error> {
        let adapter = choice.among(adapters().await)?;
        let (device, queue) = adapter
            .request_device(&device_descriptor(&adapter))
            .await
            .map_err(|e| Error::Device { adapter: adapter.get_info().name, message: e.to_string() })?;
        Ok(Gpu::from_host(device, queue))
    }

    /// Takes the host's device. Features that it was not made with are replaced by their fallbacks.
    pub fn from_host(device: wgpu::Device, queue: wgpu::Queue) -> Gpu {
        let info = device.adapter_info();
        let capabilities = Capabilities::of(device.features(), &device.limits(), &info);
        Gpu { info, capabilities, pipelines: Arc::default(), device, queue }
    }

    /// True if the adapter computes on the CPU: its absolute times say nothing about a GPU.
    pub fn is_software(&self) -> bool {
        self.info.device_type == wgpu::DeviceType::Cpu
    }

    /// A compute pipeline, compiled at the first call.
    pub fn compute_pipeline(&self, key: &ShaderKey, entry: &'static str) -> Result<Arc<ComputePipeline>, Error> {
        self.pipelines.compute(&self.device, key, entry)
    }

    /// A render pipeline, compiled at the first call. Entry points are `vertex` and `fragment`.
    pub fn render_pipeline(&self, key: &ShaderKey, target: &RenderTarget) -> Result<Arc<RenderPipeline>, Error> {
        self.pipelines.render(&self.device, key, target)
    }

    /// The largest limited resources that any shader has needed so far.
    pub fn needs(&self) -> Needs {
        self.pipelines.needs()
    }

    /// Records and submits work that is done once, with resources of its own.
    pub fn submit(&self, record: impl FnOnce(&mut Recorder) -> Result<(), Error>) -> Result<(), Error> {
        let mut encoder = self.device.create_command_encoder(&Default::default());
        record(&mut Recorder::new(self, &mut encoder, &mut Resources::default()))?;
        self.queue.submit([encoder.finish()]);
        Ok(())
    }

    /// Waits until all submitted work is done.
    pub fn wait(&self) -> Result<(), Error> {
        self.device.poll(wgpu::PollType::wait_indefinitely()).map(|_| ()).map_err(|e| Error::Lost(e.to_string()))
    }

    /// Runs `work` with GPU errors caught and returned instead of raised in a callback.
    pub async fn checked<T>(&self, work: impl FnOnce() -> Result<T, Error>) -> Result<T, Error> {
        let memory = self.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let validation = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let result = work();
        // Both are popped before either is waited for: where all work shares a thread, another call may push its own
        // then.
        let (invalid, exhausted) = (validation.pop(), memory.pop());
        if let Some(e) = exhausted.await {
            return Err(Error::OutOfMemory(e.to_string()));
        }
        if let Some(e) = invalid.await {
            return Err(Error::Validation(e.to_string()));
        }
        result
    }

    /// Refuses an image or map size beyond the device's limit.
    pub fn check_size(&self, what: &'static str, width: u32, height: u32) -> Result<(), Error> {
        let max = self.capabilities.max_texture_size;
        if width == 0 || height == 0 || width > max || height > max {
            return Err(Error::Size { what, width, height, max });
        }
        Ok(())
    }

    /// Copies the first mip level of a texture to the CPU, rows tightly packed.
    pub async fn read_texture(&self, texture: &Texture) -> Result<Vec<u8>, Error> {
        super::readback::read_texture(self, &texture.texture).await
    }
}
