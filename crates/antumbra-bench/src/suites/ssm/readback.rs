//! The paper's program, for comparison only: the occluder map is read back, the CPU loops over its texels and makes the
//! penumbra rectangles, and the GPU blends them [Atty 2006, section 4.1].

use super::stage::Stage;
use super::truth::floats;
use crate::Error;
use antumbra::gpu::recorder::color_target;
use antumbra::gpu::texture::{Texture, TextureDescription};
use antumbra::techniques::ssm::{Ssm, SsmMaps};
use antumbra::{Frame, Gpu, Shadows};
use pollster::block_on;
use std::time::Instant;
use wgpu::util::DeviceExt;

/// Milliseconds of each step.
pub struct Steps {
    /// Reading the occluder map back.
    pub read: f64,
    /// Looping over its texels.
    pub looped: f64,
    /// Uploading and blending the rectangles.
    pub blended: f64,
}

impl Steps {
    /// All of them.
    pub fn total(&self) -> f64 {
        self.read + self.looped + self.blended
    }
}

/// One frame of one pass, after the maps have been rendered.
pub fn frame(stage: &Stage, map: u32) -> Result<Steps, Error> {
    let gpu = stage.loaded.gpu;
    let mut ssm = stage.create(&format!("ssm:map={map},passes=1"))?;
    draw_maps(stage, &mut ssm)?;
    let maps = ssm.technique().maps().expect("a frame was drawn");
    let pipeline = Rectangles::new(gpu, &stage.loaded.renderer.frame, maps, map);
    let started = Instant::now();
    let depths: Vec<f32> = floats(&block_on(gpu.read_texture(&maps.occluders))?);
    let read = milliseconds(started);
    let started = Instant::now();
    let instances = rectangles(&depths, map, &stage.loaded.renderer.frame);
    let looped = milliseconds(started);
    let started = Instant::now();
    pipeline.draw(gpu, &instances);
    gpu.wait()?;
    let blended = milliseconds(started);
    Ok(Steps { read, looped, blended })
}

fn milliseconds(since: Instant) -> f64 {
    since.elapsed().as_secs_f64() * 1000.0
}

fn draw_maps(stage: &Stage, ssm: &mut Shadows<Ssm>) -> Result<(), Error> {
    let gpu = stage.loaded.gpu;
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let renderer = &stage.loaded.renderer;
    renderer.record_geometry(gpu, &mut encoder, None)?;
    ssm.record(gpu, &mut encoder, &renderer.frame)?;
    gpu.queue.submit([encoder.finish()]);
    Ok(gpu.wait()?)
}

/// Half the light over a texel.
fn widening(frame: &Frame, size: u32) -> [f32; 2] {
    (frame.light.size * 0.5 / (2.0 * frame.frustum.tan_half / size as f32)).into()
}

/// Seven numbers per texel with an occluder: the rectangle's corners, the patch's corner and its inverse distance.
fn rectangles(depths: &[f32], size: u32, frame: &Frame) -> Vec<f32> {
    let widening = widening(frame, size);
    let receiver_q = 1.0 / frame.frustum.receivers[1];
    let mut instances = Vec::new();
    for (i, depth) in depths.iter().enumerate() {
        let above = depth / frame.frustum.near - receiver_q;
        if *depth > 0.0 && above > 0.0 {
            let (x, y) = ((i as u32 % size) as f32, (i as u32 / size) as f32);
            let reach = widening.map(|w| w * above);
            instances.extend([x - reach[0], y - reach[1], x + 1.0 + reach[0], y + 1.0 + reach[1]]);
            instances.extend([x, y, above + receiver_q]);
        }
    }
    instances
}

struct Rectangles {
    pipeline: wgpu::RenderPipeline,
    group: wgpu::BindGroup,
    target: Texture,
}

impl Rectangles {
    fn new(gpu: &Gpu, frame: &Frame, maps: &SsmMaps, size: u32) -> Rectangles {
        let device = &gpu.device;
        let module = device.create_shader_module(wgpu::include_wgsl!("readback.wgsl"));
        let format = wgpu::TextureFormat::R32Float;
        let one = wgpu::BlendFactor::One;
        let sum = wgpu::BlendComponent { src_factor: one, dst_factor: one, operation: wgpu::BlendOperation::Add };
        let target = wgpu::ColorTargetState {
            format,
            blend: Some(wgpu::BlendState { color: sum, alpha: sum }),
            write_mask: wgpu::ColorWrites::ALL,
        };
        let attributes = wgpu::vertex_attr_array![0 => Float32x4, 1 => Float32x3];
        let layout = wgpu::VertexBufferLayout {
            array_stride: 28,
            step_mode: wgpu::VertexStepMode::Instance,
            attributes: &attributes,
        };
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("rectangles of the CPU"),
            layout: None,
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("vertex"),
                compilation_options: Default::default(),
                buffers: &[Some(layout)],
            },
            primitive: Default::default(),
            depth_stencil: None,
            multisample: Default::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("fragment"),
                compilation_options: Default::default(),
                targets: &[Some(target)],
            }),
            multiview_mask: None,
            cache: None,
        });
        let [wx, wy] = widening(frame, size);
        let shape = [wx, wy, frame.frustum.near, size as f32].map(f32::to_le_bytes).concat();
        let shape = device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: None,
            contents: &shape,
            usage: wgpu::BufferUsages::UNIFORM,
        });
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: shape.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::TextureView(&maps.receivers.view) },
            ],
        });
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC;
        let description = TextureDescription::new([size; 2], format, "hidden fraction of the light").usage(usage);
        Rectangles { pipeline, group, target: Texture::new(gpu, "soft shadow map", description) }
    }

    fn draw(&self, gpu: &Gpu, instances: &[f32]) {
        let bytes: Vec<u8> = instances.iter().flat_map(|v| v.to_le_bytes()).collect();
        let buffer = gpu.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some("rectangles"),
            contents: if bytes.is_empty() { &[0; 28] } else { &bytes },
            usage: wgpu::BufferUsages::VERTEX,
        });
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("rectangles of the CPU"),
            color_attachments: &[color_target(&self.target.view, wgpu::Color::TRANSPARENT)],
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.group, &[]);
        pass.set_vertex_buffer(0, buffer.slice(..));
        pass.draw(0..6, 0..(instances.len() / 7) as u32);
        drop(pass);
        gpu.queue.submit([encoder.finish()]);
    }
}
