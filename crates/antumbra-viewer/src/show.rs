//! The displayed quantity: shaded image, visibility, or error.

use antumbra::Gpu;
use antumbra::gpu::texture::{Texture, TextureDescription};
use antumbra_metrics::{HEAT_SCALE, color_bar};

/// Displayed quantity.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Show {
    /// Shaded.
    #[default]
    Image,
    /// The visible fraction of the light as grey.
    Visibility,
    /// The difference from the truth in colours.
    Error,
}

/// Steps of the colour bar.
const COLORS: u32 = 256;

/// Draws visibilities and errors.
pub struct Shown {
    grey: wgpu::ComputePipeline,
    error: wgpu::ComputePipeline,
    colors: Texture,
}

impl Shown {
    /// Compiles both.
    pub fn new(gpu: &Gpu) -> Shown {
        let module = gpu.device.create_shader_module(wgpu::include_wgsl!("show.wgsl"));
        let pipeline = |is_error: f64| {
            gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some("show"),
                layout: Some(&layout(gpu)),
                module: &module,
                entry_point: Some("show"),
                compilation_options: wgpu::PipelineCompilationOptions {
                    constants: &[("is_error", is_error), ("scale", HEAT_SCALE)],
                    ..Default::default()
                },
                cache: None,
            })
        };
        let colors = TextureDescription::new([COLORS, 1], wgpu::TextureFormat::Rgba8Unorm, "heat colours");
        let colors = Texture::new(gpu, "heat colours", colors.usage(wgpu::TextureUsages::COPY_DST));
        let bar = color_bar(COLORS, 1).data;
        let rgba: Vec<u8> = bar.chunks_exact(3).flat_map(|c| [c[0], c[1], c[2], 255]).collect();
        let rows = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * COLORS), rows_per_image: None };
        gpu.queue.write_texture(colors.texture.as_image_copy(), &rgba, rows, colors.texture.size());
        Shown { grey: pipeline(0.0), error: pipeline(1.0), colors }
    }

    /// Writes `shown`, an `Rgba8Unorm` storage texture of the visibility's size.
    pub fn record(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        show: Show,
        visibility: &Texture,
        truth: &Texture,
        shown: &Texture,
    ) {
        let pipeline = if show == Show::Error { &self.error } else { &self.grey };
        let entries: Vec<_> = [visibility, truth, &self.colors, shown]
            .into_iter()
            .zip(0u32..)
            .map(|(t, binding)| wgpu::BindGroupEntry { binding, resource: wgpu::BindingResource::TextureView(&t.view) })
            .collect();
        let layout = &pipeline.get_bind_group_layout(0);
        let group = wgpu::BindGroupDescriptor { label: Some("show"), layout, entries: &entries };
        let group = gpu.device.create_bind_group(&group);
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &group, &[]);
        let size = shown.texture.size();
        pass.dispatch_workgroups(size.width.div_ceil(8), size.height.div_ceil(8), 1);
    }
}

/// Explicit layout: an automatic one would omit the truth where an override removes the branch.
fn layout(gpu: &Gpu) -> wgpu::PipelineLayout {
    let read = wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Float { filterable: false },
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    };
    let write = wgpu::BindingType::StorageTexture {
        access: wgpu::StorageTextureAccess::WriteOnly,
        format: wgpu::TextureFormat::Rgba8Unorm,
        view_dimension: wgpu::TextureViewDimension::D2,
    };
    let entry = |(ty, binding)| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty,
        count: None,
    };
    let entries: Vec<_> = [read, read, read, write].into_iter().zip(0u32..).map(entry).collect();
    let descriptor = wgpu::BindGroupLayoutDescriptor { label: Some("show"), entries: &entries };
    let group = gpu.device.create_bind_group_layout(&descriptor);
    gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("show"),
        bind_group_layouts: &[Some(&group)],
        immediate_size: 0,
    })
}
