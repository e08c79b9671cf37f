//! Draws debug views: maps and lists of a technique as images.

use crate::readback::Readback;
use antumbra::Gpu;
use antumbra::gpu::debug_view::{DebugContent, DebugLayout, DebugView};
use antumbra::gpu::texture::{Texture, TextureDescription};

/// Pixels per side of what is shown.
const SIDE: u32 = 512;

/// The displayed part of a texture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Part {
    /// Array layer.
    pub layer: u32,
    /// Mip level.
    pub level: u32,
    /// 0 to 3.
    pub channel: u32,
}

/// Numbers of layers, mip levels and channels of a debug view.
pub fn parts(content: &DebugContent) -> [u32; 3] {
    match content {
        DebugContent::Texture(texture) => {
            let channels = u32::from(texture.format().components());
            [texture.depth_or_array_layers(), texture.mip_level_count(), channels]
        }
        DebugContent::Buffer(_, DebugLayout::Numbers { channels, .. }) => [1, 1, *channels],
        _ => [1; 3],
    }
}

/// Its size in texels or elements.
pub fn size(content: &DebugContent) -> [u32; 2] {
    match content {
        DebugContent::Texture(texture) => [texture.width(), texture.height()],
        DebugContent::Buffer(_, DebugLayout::Numbers { size, .. } | DebugLayout::Pixels { size }) => *size,
        DebugContent::Buffer(_, DebugLayout::Mask { side } | DebugLayout::ListLengths { side }) => [*side; 2],
        DebugContent::LightPoints(_) => [1; 2],
    }
}

/// True if it can be shown: depth or float texels with one sample.
pub fn is_shown(view: &DebugView) -> bool {
    let DebugContent::Texture(t) = &view.content else { return true };
    let kind = t.format().sample_type(None, None);
    let readable = matches!(kind, Some(wgpu::TextureSampleType::Float { .. } | wgpu::TextureSampleType::Depth));
    readable && t.sample_count() == 1 && t.usage().contains(wgpu::TextureUsages::TEXTURE_BINDING)
}

/// Draws debug views.
pub struct Inspector {
    /// The result, `Rgba8Unorm`.
    pub shown: Texture,
    /// Smallest and largest non-zero value of the last texture.
    pub range: Option<[f32; 2]>,
    measure: wgpu::ComputePipeline,
    show_values: wgpu::ComputePipeline,
    clear: wgpu::ComputePipeline,
    show_list: wgpu::ComputePipeline,
    forget: wgpu::ComputePipeline,
    gather_rows: wgpu::ComputePipeline,
    gather_listed: wgpu::ComputePipeline,
    gather_mask: wgpu::ComputePipeline,
    gather_lengths: wgpu::ComputePipeline,
    /// `R32Float`: numbers of a buffer at the pixels that they belong to.
    gathered: Option<Texture>,
    look: wgpu::Buffer,
    measured: wgpu::Buffer,
    readback: Option<Readback>,
}

impl Inspector {
    /// Compiles its pipelines.
    pub fn new(gpu: &Gpu) -> Inspector {
        let module = gpu.device.create_shader_module(wgpu::include_wgsl!("inspector.wgsl"));
        let pipeline = |entry: &'static str, layout: Option<&wgpu::PipelineLayout>| {
            gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(entry),
                layout,
                module: &module,
                entry_point: Some(entry),
                compilation_options: Default::default(),
                cache: None,
            })
        };
        let shown = TextureDescription::new([SIDE; 2], wgpu::TextureFormat::Rgba8Unorm, "sRGB colour");
        let layout = values_layout(gpu);
        let buffer = |label, size, usage| {
            let mapped_at_creation = false;
            gpu.device.create_buffer(&wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation })
        };
        Inspector {
            shown: Texture::new(gpu, "debug view", shown),
            range: None,
            measure: pipeline("measure", Some(&layout)),
            show_values: pipeline("show_values", Some(&layout)),
            clear: pipeline("clear", None),
            show_list: pipeline("show_list", None),
            forget: pipeline("forget", None),
            gather_rows: pipeline("gather_rows", None),
            gather_listed: pipeline("gather_listed", None),
            gather_mask: pipeline("gather_mask", None),
            gather_lengths: pipeline("gather_lengths", None),
            gathered: None,
            look: buffer("look", 32, wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST),
            measured: buffer("range", 8, wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC),
            readback: None,
        }
    }

    /// Draws a part of a texture, or a list.
    pub fn draw(&mut self, gpu: &Gpu, view: &DebugView, part: Part) {
        match &view.content {
            DebugContent::Texture(texture) => self.draw_texture(gpu, texture, part),
            DebugContent::Buffer(buffer, layout) => match layout {
                DebugLayout::Pixels { size } => self.draw_list(gpu, buffer, *size),
                DebugLayout::Numbers { .. } => self.draw_numbers(gpu, buffer, layout, part),
                DebugLayout::Mask { side } => self.draw_most(gpu, buffer, *side, false),
                DebugLayout::ListLengths { side } => self.draw_most(gpu, buffer, *side, true),
            },
            DebugContent::LightPoints(_) => self.range = None,
        }
    }

    /// Takes the measured range once it has arrived.
    pub fn poll(&mut self) {
        if let Some(values) = self.readback.as_ref().and_then(Readback::poll_numbers) {
            let range = <[f32; 2]>::try_from(values).ok();
            (self.range, self.readback) = (range.filter(|[low, high]| low <= high), None);
        }
    }

    fn draw_numbers(&mut self, gpu: &Gpu, numbers: &wgpu::Buffer, layout: &DebugLayout, part: Part) {
        let DebugLayout::Numbers { stride, size, list, .. } = layout else { return };
        let (texture, view) = gathered(&mut self.gathered, gpu, *size);
        let look = [part.layer, part.level, part.channel, size[0], size[1], *stride];
        gpu.queue.write_buffer(&self.look, 0, bytemuck::cast_slice(&look));
        let into = || entry(6, wgpu::BindingResource::TextureView(&view));
        let mut from = vec![entry(0, self.look.as_entire_binding()), entry(5, numbers.as_entire_binding()), into()];
        from.extend(list.as_ref().map(|list| entry(4, list.as_entire_binding())));
        let gather = if list.is_some() { &self.gather_listed } else { &self.gather_rows };
        let empty = [size[0].div_ceil(8), size[1].div_ceil(8)];
        self.run(gpu, &[(&self.forget, empty), (gather, threads(*size))], &[&[into()], &from]);
        self.draw_texture(gpu, &texture, Part::default());
    }

    /// Reduces a large map to the largest number per displayed pixel, so that lines of single texels remain.
    fn draw_most(&mut self, gpu: &Gpu, numbers: &wgpu::Buffer, side: u32, are_lists: bool) {
        let size = [side.clamp(1, SIDE); 2];
        let (texture, view) = gathered(&mut self.gathered, gpu, size);
        gpu.queue.write_buffer(&self.look, 0, bytemuck::cast_slice(&[0, 0, 0, size[0], size[1], side]));
        let gather = if are_lists { &self.gather_lengths } else { &self.gather_mask };
        let into = entry(6, wgpu::BindingResource::TextureView(&view));
        let from = [entry(0, self.look.as_entire_binding()), entry(4, numbers.as_entire_binding()), into];
        self.run(gpu, &[(gather, [size[0].div_ceil(8); 2])], &[&from]);
        self.draw_texture(gpu, &texture, Part::default());
    }

    fn draw_texture(&mut self, gpu: &Gpu, texture: &wgpu::Texture, part: Part) {
        gpu.queue.write_buffer(&self.look, 0, bytemuck::cast_slice(&[part.layer, part.level, part.channel, 0, 0]));
        let dimension = Some(wgpu::TextureViewDimension::D2Array);
        let view = texture.create_view(&wgpu::TextureViewDescriptor { dimension, ..Default::default() });
        let entries = [
            entry(0, self.look.as_entire_binding()),
            entry(1, self.measured.as_entire_binding()),
            entry(2, wgpu::BindingResource::TextureView(&view)),
            entry(3, wgpu::BindingResource::TextureView(&self.shown.view)),
        ];
        self.run(gpu, &[(&self.measure, [1, 1]), (&self.show_values, [SIDE / 8; 2])], &[&entries, &entries]);
        if self.readback.is_none() {
            self.readback = Some(Readback::of_buffer(gpu, &self.measured, 2));
        }
    }

    fn draw_list(&mut self, gpu: &Gpu, list: &wgpu::Buffer, size: [u32; 2]) {
        gpu.queue.write_buffer(&self.look, 0, bytemuck::cast_slice(&[0, 0, 0, size[0], size[1]]));
        self.range = None;
        let shown = || wgpu::BindingResource::TextureView(&self.shown.view);
        let listed = [entry(0, self.look.as_entire_binding()), entry(3, shown()), entry(4, list.as_entire_binding())];
        let steps = [(&self.clear, [SIDE / 8; 2]), (&self.show_list, threads(size))];
        self.run(gpu, &steps, &[&[entry(3, shown())], &listed]);
    }

    fn run(&self, gpu: &Gpu, steps: &[(&wgpu::ComputePipeline, [u32; 2])], groups: &[&[wgpu::BindGroupEntry]]) {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        for ((pipeline, [x, y]), entries) in steps.iter().zip(groups) {
            let layout = &pipeline.get_bind_group_layout(0);
            let group = wgpu::BindGroupDescriptor { label: Some("debug view"), layout, entries };
            let group = gpu.device.create_bind_group(&group);
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, &group, &[]);
            pass.dispatch_workgroups(*x, *y, 1);
        }
        gpu.queue.submit([encoder.finish()]);
    }
}

/// Scatters numbers of a list to their pixels.
fn gathered(slot: &mut Option<Texture>, gpu: &Gpu, size: [u32; 2]) -> (wgpu::Texture, wgpu::TextureView) {
    if slot.as_ref().is_none_or(|t| [t.texture.width(), t.texture.height()] != size) {
        let description = TextureDescription::new(size, wgpu::TextureFormat::R32Float, "numbers of a buffer");
        *slot = Some(Texture::new(gpu, "gathered numbers", description));
    }
    let made = slot.as_ref().expect("just made");
    (made.texture.clone(), made.view.clone())
}

/// Workgroups of 64 threads, one thread per element.
fn threads(size: [u32; 2]) -> [u32; 2] {
    let groups = (size[0] * size[1]).div_ceil(64).max(1);
    let rows = groups.div_ceil(4096);
    [groups.div_ceil(rows), rows]
}

fn entry(binding: u32, resource: wgpu::BindingResource) -> wgpu::BindGroupEntry {
    wgpu::BindGroupEntry { binding, resource }
}

/// Explicit layout: depth textures are read as unfilterable floats, and both steps share the bindings.
fn values_layout(gpu: &Gpu) -> wgpu::PipelineLayout {
    let buffer = |ty| wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None };
    let kinds = [
        buffer(wgpu::BufferBindingType::Uniform),
        buffer(wgpu::BufferBindingType::Storage { read_only: false }),
        wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: false },
            view_dimension: wgpu::TextureViewDimension::D2Array,
            multisampled: false,
        },
        wgpu::BindingType::StorageTexture {
            access: wgpu::StorageTextureAccess::WriteOnly,
            format: wgpu::TextureFormat::Rgba8Unorm,
            view_dimension: wgpu::TextureViewDimension::D2,
        },
    ];
    let entry = |(ty, binding)| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty,
        count: None,
    };
    let entries: Vec<_> = kinds.into_iter().zip(0u32..).map(entry).collect();
    let descriptor = wgpu::BindGroupLayoutDescriptor { label: Some("debug view"), entries: &entries };
    let group = gpu.device.create_bind_group_layout(&descriptor);
    gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("debug view"),
        bind_group_layouts: &[Some(&group)],
        immediate_size: 0,
    })
}
