//! A small renderer with a device, vertex layout, 16-bit indices, instances, depth prepass and normals of its own. It
//! lends its buffers to Antumbra and shades with the visibility. The calls of Antumbra stand between the two marked
//! lines.
//!
//!     cargo run --example bring_your_own_renderer -- backprojection shadow.ppm

use antumbra::input::casters::{Indices, MeshBuffers, Role, Transforms};
use antumbra::{Aabb, Casters, Frame, FrameDescriptor, Gpu, RectLight, ShadowFrustum, Shadows, View};
use glam::{Mat4, Quat, Vec2, Vec3};
use std::{error::Error, sync::Arc};
use wgpu::util::DeviceExt;

/// Pixels per side.
pub const SIZE: u32 = 192;

/// Position and normal, interleaved.
pub type Vertex = [f32; 6];

/// The unit cube around the origin: 24 vertices and 36 16-bit indices.
pub fn cube() -> (Vec<Vertex>, Vec<u16>) {
    let (mut vertices, mut indices) = (Vec::new(), Vec::new());
    for (axis, sign) in (0..3).flat_map(|a| [(a, -1.0f32), (a, 1.0)]) {
        let (n, u) = (Vec3::AXES[axis] * sign, Vec3::AXES[(axis + 1) % 3]);
        let v = n.cross(u);
        let base = vertices.len() as u16;
        for (s, t) in [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)] {
            let p = n * 0.5 + u * s + v * t;
            vertices.push([p.x, p.y, p.z, n.x, n.y, n.z]);
        }
        indices.extend([0, 1, 2, 0, 2, 3].map(|i| base + i));
    }
    (vertices, indices)
}

/// The first is the ground; the others stand and float above it.
pub fn instances() -> Vec<Mat4> {
    let place = |scale: Vec3, turn: f32, at: Vec3| {
        Mat4::from_scale_rotation_translation(scale, Quat::from_rotation_y(turn), at)
    };
    vec![
        place(Vec3::new(12.0, 0.2, 12.0), 0.0, Vec3::new(0.0, -0.1, 0.0)),
        place(Vec3::new(0.8, 1.6, 0.8), 0.4, Vec3::new(-0.9, 0.8, 0.0)),
        place(Vec3::splat(0.6), 0.9, Vec3::new(0.7, 0.3, 0.6)),
        place(Vec3::new(1.2, 0.15, 0.5), -0.3, Vec3::new(0.5, 1.3, -0.4)),
    ]
}

/// Where it is seen from.
pub fn camera() -> antumbra::Camera {
    antumbra::Camera {
        eye: Vec3::new(2.6, 2.4, 3.4),
        target: Vec3::new(0.0, 0.5, 0.0),
        up: Vec3::Y,
        fov_y_deg: 45.0,
        near: 0.1,
        far: 50.0,
    }
}

/// World to view, and view to clip space with reversed depth.
pub fn view() -> View {
    View::of_camera(&camera(), [SIZE, SIZE])
}

/// A lamp of 60 x 60 cm.
pub fn light() -> RectLight {
    RectLight {
        center: Vec3::new(2.0, 4.5, 1.0),
        target: Vec3::new(0.0, 0.3, 0.0),
        up: Vec3::NEG_Z,
        size: Vec2::splat(0.6),
        shadow_fov_deg: None,
    }
}

/// The host's part of a frame.
struct Host {
    device: wgpu::Device,
    queue: wgpu::Queue,
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
    transforms: wgpu::Buffer,
    camera: wgpu::Buffer,
    depth: wgpu::TextureView,
    normals: wgpu::TextureView,
    visibility: wgpu::Texture,
    picture: wgpu::Texture,
}

/// Draws the scene with a technique; returns the visibility and the RGBA picture.
pub async fn render(technique: &str) -> Result<(Vec<f32>, Vec<u8>), Box<dyn Error>> {
    let host = Host::new().await?;
    let mut encoder = host.device.create_command_encoder(&Default::default());
    host.prepass(&mut encoder);

    // ---- Antumbra: once ----
    let gpu = Gpu::from_host(host.device.clone(), host.queue.clone());
    let bounds = instances().iter().skip(1).fold(Aabb::EMPTY, |b, m| b.union(&cube_bounds(m)));
    let mesh = MeshBuffers {
        vertices: &host.vertices,
        position_offset: 0,
        vertex_stride: size_of::<Vertex>() as u64,
        indices: Some(Indices { buffer: &host.indices, format: wgpu::IndexFormat::Uint16, offset: 0 }),
        triangle_count: 12,
        transforms: Transforms { buffer: &host.transforms, offset: 0, stride: 64, count: instances().len() as u32 },
        bounds,
        role: Role::Caster,
        mask: None,
    };
    let casters = Arc::new(Casters::from_buffers(&gpu, &[mesh])?);
    let mut frame = Frame::new(
        &gpu,
        &FrameDescriptor {
            view: view(),
            light: light(),
            casters: &casters,
            depth: &host.depth,
            normals: &host.normals,
            visibility: &host.visibility.create_view(&Default::default()),
        },
    )?;
    // Typed settings where the technique is known: `Shadows::new(Pcss::make(&gpu, PcssSettings::default())?)`.
    let mut shadows = Shadows::from_spec(&gpu, &technique.parse()?)?;
    // ---- each frame ----
    frame.update(view(), light(), ShadowFrustum::around(&light(), &bounds));
    shadows.record(&gpu, &mut encoder, &frame)?;
    // ---- that was all ----

    host.shade(&mut encoder);
    host.queue.submit([encoder.finish()]);
    let visibility = antumbra::gpu::readback::read_texture(&gpu, &host.visibility).await?;
    let picture = antumbra::gpu::readback::read_texture(&gpu, &host.picture).await?;
    Ok((visibility.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect(), picture))
}

/// World-space box of a cube with its shadow on the ground: what the shadow map has to hold.
fn cube_bounds(world_from_cube: &Mat4) -> Aabb {
    let corners = Aabb { min: Vec3::splat(-0.5), max: Vec3::splat(0.5) }.corners();
    let corners = corners.map(|c| world_from_cube.transform_point3(c));
    let light = light().center;
    let fallen = corners.map(|c| light + (c - light) * 1.15 * (light.y / (light.y - c.y)));
    Aabb::of_points(corners.into_iter().chain(fallen))
}

impl Host {
    async fn new() -> Result<Host, Box<dyn Error>> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
        let adapter = instance.request_adapter(&Default::default()).await?;
        let (device, queue) = adapter
            .request_device(&wgpu::DeviceDescriptor { required_limits: adapter.limits(), ..Default::default() })
            .await?;
        let buffer = |contents: &[u8], usage| {
            device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: Some("host"), contents, usage })
        };
        let (vertices, indices) = cube();
        let storage = wgpu::BufferUsages::STORAGE;
        let to_light = (light().center - light().target).normalize().extend(0.0);
        let mut camera: Vec<f32> = view().clip_from_world().to_cols_array().to_vec();
        camera.extend(view().eye().extend(1.0).to_array());
        camera.extend(to_light.to_array());
        let texture = |format, usage| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some("host"),
                size: wgpu::Extent3d { width: SIZE, height: SIZE, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: usage | wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_SRC,
                view_formats: &[],
            })
        };
        let (target, written) = (wgpu::TextureUsages::RENDER_ATTACHMENT, wgpu::TextureUsages::STORAGE_BINDING);
        Ok(Host {
            vertices: buffer(bytemuck::cast_slice(&vertices), wgpu::BufferUsages::VERTEX | storage),
            indices: buffer(bytemuck::cast_slice(&indices), wgpu::BufferUsages::INDEX | storage),
            transforms: buffer(bytemuck::cast_slice(&instances()), wgpu::BufferUsages::VERTEX | storage),
            camera: buffer(bytemuck::cast_slice(&camera), wgpu::BufferUsages::UNIFORM),
            depth: texture(wgpu::TextureFormat::Depth32Float, target).create_view(&Default::default()),
            normals: texture(wgpu::TextureFormat::Rgba16Float, target).create_view(&Default::default()),
            visibility: texture(wgpu::TextureFormat::R32Float, written),
            picture: texture(wgpu::TextureFormat::Rgba8UnormSrgb, target),
            device,
            queue,
        })
    }

    fn pipeline(&self, stage: [&str; 2], format: wgpu::TextureFormat, prepass: bool) -> wgpu::RenderPipeline {
        let module = self.device.create_shader_module(wgpu::include_wgsl!("bring_your_own_renderer.wgsl"));
        let per_vertex = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3];
        let per_instance = wgpu::vertex_attr_array![2 => Float32x4, 3 => Float32x4, 4 => Float32x4, 5 => Float32x4];
        let layout = |array_stride, step_mode, attributes| {
            Some(wgpu::VertexBufferLayout { array_stride, step_mode, attributes })
        };
        let buffers = [
            layout(24, wgpu::VertexStepMode::Vertex, &per_vertex[..]),
            layout(64, wgpu::VertexStepMode::Instance, &per_instance[..]),
        ];
        self.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("host"),
            layout: None,
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some(stage[0]),
                compilation_options: Default::default(),
                buffers: if prepass { &buffers } else { &[] },
            },
            primitive: Default::default(),
            depth_stencil: prepass.then(|| wgpu::DepthStencilState {
                format: wgpu::TextureFormat::Depth32Float,
                depth_write_enabled: Some(true),
                depth_compare: Some(wgpu::CompareFunction::Greater),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: Default::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some(stage[1]),
                compilation_options: Default::default(),
                targets: &[Some(format.into())],
            }),
            multiview_mask: None,
            cache: None,
        })
    }

    fn bind(&self, pipeline: &wgpu::RenderPipeline, views: &[&wgpu::TextureView]) -> wgpu::BindGroup {
        let mut entries = vec![wgpu::BindGroupEntry { binding: 0, resource: self.camera.as_entire_binding() }];
        for (i, view) in views.iter().enumerate() {
            let resource = wgpu::BindingResource::TextureView(view);
            entries.push(wgpu::BindGroupEntry { binding: i as u32 + 1, resource });
        }
        let layout = &pipeline.get_bind_group_layout(0);
        self.device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
    }

    fn prepass(&self, encoder: &mut wgpu::CommandEncoder) {
        let stage = ["prepass_vertex", "prepass_fragment"];
        let pipeline = self.pipeline(stage, wgpu::TextureFormat::Rgba16Float, true);
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[antumbra::gpu::recorder::color_target(&self.normals, wgpu::Color::TRANSPARENT)],
            depth_stencil_attachment: antumbra::gpu::recorder::depth_target(&self.depth, Some(0.0)),
            ..Default::default()
        });
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &self.bind(&pipeline, &[]), &[]);
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.set_vertex_buffer(1, self.transforms.slice(..));
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint16);
        pass.draw_indexed(0..36, 0, 0..instances().len() as u32);
    }

    fn shade(&self, encoder: &mut wgpu::CommandEncoder) {
        let pipeline = self.pipeline(["shade_vertex", "shade_fragment"], self.picture.format(), false);
        let group = self.bind(&pipeline, &[&self.visibility.create_view(&Default::default()), &self.normals]);
        let target = self.picture.create_view(&Default::default());
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[antumbra::gpu::recorder::color_target(&target, wgpu::Color::BLACK)],
            ..Default::default()
        });
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..3, 0..1);
    }
}

#[allow(dead_code, reason = "the test includes this file as a module")]
fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let technique = arguments.next().unwrap_or("backprojection".to_owned());
    let path = arguments.next().unwrap_or("shadow.ppm".to_owned());
    let (_, picture) = pollster::block_on(render(&technique))?;
    let rgb = picture.chunks_exact(4).flat_map(|p| &p[..3]).copied();
    std::fs::write(
        &path,
        format!("P6\n{SIZE} {SIZE}\n255\n").into_bytes().into_iter().chain(rgb).collect::<Vec<u8>>(),
    )?;
    println!("{technique}: {path}");
    Ok(())
}
