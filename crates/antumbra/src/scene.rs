//! A small renderer of a whole [`Scene`] for programs that have none: geometry buffer, shadows, shaded image.

use crate::error::Error;
use crate::gpu::device::Gpu;
use crate::gpu::recorder::Recorder;
use crate::gpu::resources::{Resources, buffer_of};
use crate::gpu::texture::{Texture, TextureDescription};
use crate::gpu::timer::Timer;
use crate::input::casters::{BatchLayout, Casters, CastersBuilder, Role, clusters_of};
use crate::input::classification::Classification;
use crate::input::frame::{Frame, FrameDescriptor, View};
use crate::input::frustum::ShadowFrustum;
use crate::passes::pixels::geometry_buffer::GeometryBuffer;
use crate::passes::pixels::shading;
use antumbra_scene::{Aabb, Instance, Material, Mesh, Scene, Wrap};
use glam::{Mat4, Vec3};
use std::sync::{Arc, Mutex};

/// A scene on the GPU with everything that an image of it needs.
pub struct SceneRenderer {
    /// The surfaces that the image shows.
    pub geometry: GeometryBuffer,
    /// The input of techniques.
    pub frame: Frame,
    /// `R32Float`, filled by a technique.
    pub visibility: Texture,
    resources: Mutex<Resources>,
}

impl SceneRenderer {
    /// Uploads a scene and makes the textures of an image of `size` pixels.
    pub fn new(gpu: &Gpu, scene: &Scene, size: [u32; 2]) -> Result<SceneRenderer, Error> {
        let geometry = GeometryBuffer::new(gpu, size)?;
        let visibility = visibility(gpu, size);
        let view = View::of_camera(&scene.camera, size);
        let descriptor = FrameDescriptor {
            view,
            light: scene.light,
            casters: &Arc::new(upload(gpu, scene)?),
            depth: &geometry.depth.view,
            normals: &geometry.normal.view,
            visibility: &visibility.view,
        };
        let mut frame = Frame::new(gpu, &descriptor)?;
        frame.update(view, scene.light, ShadowFrustum::fit(scene, &view));
        Ok(SceneRenderer { geometry, frame, visibility, resources: Mutex::default() })
    }

    /// Records the geometry buffer: the part of a host.
    pub fn record_geometry(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        timer: Option<&Timer>,
    ) -> Result<(), Error> {
        let mut resources = self.resources.lock().expect("recording does not panic");
        let mut recorder = Recorder::new(gpu, encoder, &mut resources).timed(timer);
        self.geometry.record(&mut recorder, &self.frame.casters, &self.frame.view)
    }

    /// Shades with the visibility texture and returns 8-bit sRGB RGBA, row 0 on top.
    pub async fn image(&self, gpu: &Gpu) -> Result<Vec<u8>, Error> {
        let image = shading::image_texture(gpu, self.frame.size);
        gpu.submit(|recorder| {
            let frame = self.frame.bind(recorder)?;
            shading::shade(recorder, &frame, &self.geometry, &image)
        })?;
        gpu.read_texture(&image).await
    }

    /// The visibility of each pixel, row 0 on top.
    pub async fn read_visibility(&self, gpu: &Gpu) -> Result<Vec<f32>, Error> {
        Ok(bytemuck::pod_collect_to_vec(&gpu.read_texture(&self.visibility).await?))
    }

    /// Replaces the visibility, so that an image can be made with the truth.
    pub fn write_visibility(&self, gpu: &Gpu, values: &[f32]) {
        let t = &self.visibility.texture;
        let layout =
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(t.width() * 4), rows_per_image: None };
        gpu.queue.write_texture(t.as_image_copy(), bytemuck::cast_slice(values), layout, t.size());
    }
}

/// A texture that techniques fill.
pub fn visibility(gpu: &Gpu, size: [u32; 2]) -> Texture {
    let help = "visible fraction of the light: 1 lit, 0 umbra";
    let uses = wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::COPY_SRC | wgpu::TextureUsages::COPY_DST;
    Texture::new(gpu, "visibility", TextureDescription::new(size, wgpu::TextureFormat::R32Float, help).usage(uses))
}

/// Puts a scene's triangles on the GPU: all plain meshes in one batch, one batch more for each texture.
pub fn upload(gpu: &Gpu, scene: &Scene) -> Result<Casters, Error> {
    Ok(Placed::upload(gpu, scene)?.casters)
}

/// A scene prepared for the GPU: roles of its instances, triangles in the order of their clusters.
pub struct Arranged {
    roles: Vec<Role>,
    /// For each mesh its triangles in the order of their clusters.
    triangles: Vec<Vec<[u32; 3]>>,
    /// World-space box around all occluders.
    occluder_bounds: Aabb,
}

impl Arranged {
    /// Prepares a scene: about half a microsecond per triangle.
    pub fn of(scene: &Scene) -> Arranged {
        let mut arrangement = Arrangement::new(scene);
        arrangement.by_ref().for_each(drop);
        arrangement.finish()
    }
}

/// [`Arranged::of`] piece by piece, for programs with one thread: an iterator whose every step takes some milliseconds,
/// or as long as it takes to sort the largest mesh.
pub struct Arrangement<'a> {
    scene: &'a Scene,
    classification: Classification<'a>,
    triangles: Vec<Vec<[u32; 3]>>,
}

impl<'a> Arrangement<'a> {
    /// Begins to prepare.
    pub fn new(scene: &'a Scene) -> Arrangement<'a> {
        Arrangement { scene, classification: Classification::new(scene), triangles: Vec::new() }
    }

    /// The prepared scene, once the iterator has ended.
    pub fn finish(self) -> Arranged {
        let roles = self.classification.finish();
        let casters = self.scene.instances.iter().zip(&roles).filter(|(_, role)| **role == Role::Caster);
        let occluder_bounds = casters.fold(Aabb::EMPTY, |bounds, (instance, _)| {
            let mesh = &self.scene.meshes[instance.mesh];
            let corner = |&i: &u32| instance.world_from_object.transform_point3(mesh.positions[i as usize]);
            bounds.union(&Aabb::of_points(mesh.indices.iter().map(corner)))
        });
        Arranged { roles, triangles: self.triangles, occluder_bounds }
    }
}

impl Iterator for Arrangement<'_> {
    type Item = ();

    fn next(&mut self) -> Option<()> {
        self.classification.next().or_else(|| {
            let mesh = self.scene.meshes.get(self.triangles.len())?;
            self.triangles.push(clustered(mesh));
            Some(())
        })
    }
}

/// A scene's triangles on the GPU whose instances can be moved afterwards.
pub struct Placed {
    /// The shadow casters.
    pub casters: Casters,
    /// What each instance is; decided once, where it stood at first.
    pub roles: Vec<Role>,
    /// For each batch its instances, in the order of its transforms.
    order: Vec<Vec<usize>>,
    /// Object-space box around each mesh.
    boxes: Vec<Aabb>,
}

impl Placed {
    /// Uploads a scene: all plain meshes in one batch, one batch more for each texture.
    pub fn upload(gpu: &Gpu, scene: &Scene) -> Result<Placed, Error> {
        Placed::upload_arranged(gpu, scene, Arranged::of(scene))
    }

    /// Uploads a scene that has been arranged.
    pub fn upload_arranged(gpu: &Gpu, scene: &Scene, arranged: Arranged) -> Result<Placed, Error> {
        let mut builder = CastersBuilder::new(gpu);
        let mut order = Vec::new();
        let mut groups: Vec<(Option<usize>, Vec<usize>)> = Vec::new();
        for (index, mesh) in scene.meshes.iter().enumerate() {
            let key = scene.materials[mesh.material].texture.as_ref().map(|_| mesh.material);
            match groups.iter_mut().find(|(k, _)| *k == key) {
                Some((_, meshes)) => meshes.push(index),
                None => groups.push((key, vec![index])),
            }
        }
        for (material, meshes) in &groups {
            for chunk in split(gpu, scene, meshes) {
                let material = material.map(|m| &scene.materials[m]);
                order.extend(push_batch(gpu, &mut builder, scene, &arranged, material, chunk));
            }
        }
        builder.bounds = scene.bounds();
        builder.occluder_bounds = arranged.occluder_bounds;
        let boxes = scene.meshes.iter().map(Mesh::bounds).collect();
        Ok(Placed { casters: builder.finish()?, roles: arranged.roles, order, boxes })
    }

    /// Moves every instance: `instances` are the uploaded scene's with other `world_from_object`. The new places count
    /// for all work submitted after this call, also for that of earlier clones of the casters; only the bounds, boxes
    /// around the boxes of meshes, are new in the result alone.
    pub fn moved(&self, gpu: &Gpu, instances: &[Instance]) -> Casters {
        let mut casters = self.casters.clone();
        for (batch, order) in casters.batches.iter().zip(&self.order) {
            let matrix = |&i: &usize| Mat4::from(instances[i].world_from_object);
            let matrices: Vec<Mat4> = order.iter().map(matrix).collect();
            gpu.queue.write_buffer(&batch.transforms, 0, bytemuck::cast_slice(&matrices));
        }
        let around = |only: fn(&Role) -> bool| {
            let chosen = instances.iter().zip(&self.roles).filter(|(_, role)| only(role));
            chosen
                .fold(Aabb::EMPTY, |bounds, (i, _)| bounds.union(&self.boxes[i.mesh].transformed(&i.world_from_object)))
        };
        casters.bounds = around(|_| true);
        casters.occluder_bounds = around(|role| *role == Role::Caster);
        casters
    }
}

/// Cuts a list of meshes where their vertices or indices would outgrow a storage binding.
fn split<'a>(gpu: &Gpu, scene: &Scene, meshes: &'a [usize]) -> Vec<&'a [usize]> {
    let limit = gpu.device.limits().max_storage_buffer_binding_size as usize;
    let (mut chunks, mut start, mut vertices, mut indices) = (Vec::new(), 0, 0, 0);
    for (at, &m) in meshes.iter().enumerate() {
        let mesh = &scene.meshes[m];
        let grown = (vertices + mesh.positions.len() * 20, indices + mesh.indices.len() * 4);
        if at > start && grown.0.max(grown.1) > limit {
            chunks.push(&meshes[start..at]);
            (start, vertices, indices) = (at, mesh.positions.len() * 20, mesh.indices.len() * 4);
        } else {
            (vertices, indices) = grown;
        }
    }
    chunks.push(&meshes[start..]);
    chunks
}

/// Adds a batch of these meshes and returns its instances in the order of their transforms; none where there are none.
fn push_batch(
    gpu: &Gpu,
    builder: &mut CastersBuilder,
    scene: &Scene,
    Arranged { roles, triangles, .. }: &Arranged,
    textured: Option<&Material>,
    meshes: &[usize],
) -> Option<Vec<usize>> {
    let (mut words, mut indices, mut order, mut clusters) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let mut ranges = Vec::new();
    let stride = if textured.is_some() { 5 } else { 3 };
    for &m in meshes {
        let mesh = &scene.meshes[m];
        let base = (words.len() / stride) as u32;
        let first = (indices.len() / 3) as u32;
        push_vertices(&mut words, mesh, textured.is_some());
        indices.extend(triangles[m].iter().flatten().map(|i| i + base));
        ranges.push(first..(indices.len() / 3) as u32);
        let color = srgb(scene.materials[mesh.material].base_color.truncate());
        for role in [Role::Caster, Role::Ground, Role::Receiver] {
            let placed = (0..roles.len()).filter(|&i| scene.instances[i].mesh == m && roles[i] == role);
            let from = order.len() as u32;
            order.extend(placed);
            let range = from..order.len() as u32;
            clusters.extend(clusters_of(first, mesh.triangle_count() as u32, range, role, color));
        }
    }
    if clusters.is_empty() {
        return None;
    }
    let transforms: Vec<Mat4> = order.iter().map(|&i| Mat4::from(scene.instances[i].world_from_object)).collect();
    let layout = BatchLayout {
        vertex_offset: 0,
        vertex_stride: stride as u32,
        uv_offset: 3,
        index_kind: 2,
        index_offset: 0,
        transform_offset: 0,
        transform_stride: 16,
        first_cluster: 0,
        cluster_count: 0,
        number: 0,
        alpha_cutoff: textured.and_then(|m| m.alpha_cutoff).unwrap_or(0.0),
        alpha: textured.map_or(1.0, |m| m.base_color.w),
        textured: u32::from(textured.is_some()),
    };
    let storage = wgpu::BufferUsages::STORAGE;
    let texture = textured.and_then(|m| m.texture.as_ref()).map(|t| upload_texture(gpu, t));
    builder.push(
        layout,
        [
            buffer_of(gpu, "vertices", bytemuck::cast_slice(&words), storage),
            buffer_of(gpu, "indices", bytemuck::cast_slice(&indices), storage),
            buffer_of(gpu, "transforms", bytemuck::cast_slice(&transforms), storage | wgpu::BufferUsages::COPY_DST),
        ],
        texture.as_ref().map(|(view, sampler)| (view, sampler)),
        clusters.into_iter(),
        ranges,
    );
    Some(order)
}

fn push_vertices(words: &mut Vec<f32>, mesh: &Mesh, with_uv: bool) {
    for (i, p) in mesh.positions.iter().enumerate() {
        words.extend(p.to_array());
        if with_uv {
            words.extend(mesh.uvs.get(i).copied().unwrap_or_default().to_array());
        }
    }
}

/// A mesh's triangles along a space-filling curve, so that every run of them is a compact cluster.
fn clustered(mesh: &Mesh) -> Vec<[u32; 3]> {
    let bounds = mesh.bounds();
    let scale = Vec3::splat(1023.0) / bounds.size().max(Vec3::splat(1e-20));
    let spread = |v: f32| (0..10).fold(0u32, |bits, i| bits | ((v as u32 >> i & 1) << (3 * i)));
    let keyed = |t: &[u32]| {
        let center = t.iter().map(|&i| mesh.positions[i as usize]).sum::<Vec3>() / 3.0;
        let cell = (center - bounds.min) * scale;
        (spread(cell.x) | spread(cell.y) << 1 | spread(cell.z) << 2, [t[0], t[1], t[2]])
    };
    let mut list: Vec<(u32, [u32; 3])> = mesh.indices.chunks_exact(3).map(keyed).collect();
    list.sort_by_key(|(key, _)| *key);
    list.into_iter().map(|(_, t)| t).collect()
}

fn srgb(linear: Vec3) -> [u8; 4] {
    let encode = |c: f32| {
        let c = c.clamp(0.0, 1.0);
        let s = if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 };
        (s * 255.0 + 0.5) as u8
    };
    [encode(linear.x), encode(linear.y), encode(linear.z), 255]
}

/// A texture with all its mip levels, filtered on the CPU, and its sampler.
fn upload_texture(gpu: &Gpu, source: &antumbra_scene::Texture) -> (wgpu::TextureView, wgpu::Sampler) {
    let mips = 32 - source.width.max(source.height).leading_zeros();
    let format = wgpu::TextureFormat::Rgba8UnormSrgb;
    let description = TextureDescription::new([source.width, source.height], format, "base colour");
    let texture = Texture::new(gpu, "base colour", description.mips(mips).usage(wgpu::TextureUsages::COPY_DST));
    let (mut level, mut width, mut height) = (source.rgba.clone(), source.width, source.height);
    for mip in 0..mips {
        gpu.queue.write_texture(
            wgpu::TexelCopyTextureInfo { mip_level: mip, ..texture.texture.as_image_copy() },
            &level,
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(width * 4), rows_per_image: None },
            wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        );
        (level, width, height) = halved(&level, width, height);
    }
    let address = |wrap| match wrap {
        Wrap::Repeat => wgpu::AddressMode::Repeat,
        Wrap::Mirror => wgpu::AddressMode::MirrorRepeat,
        Wrap::Clamp => wgpu::AddressMode::ClampToEdge,
    };
    let filter = if source.nearest { wgpu::FilterMode::Nearest } else { wgpu::FilterMode::Linear };
    let sampler = gpu.device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("base colour"),
        address_mode_u: address(source.wrap[0]),
        address_mode_v: address(source.wrap[1]),
        mag_filter: filter,
        min_filter: filter,
        mipmap_filter: wgpu::MipmapFilterMode::Linear,
        ..Default::default()
    });
    (texture.view.clone(), sampler)
}

/// The next mip level: each texel the mean of up to four.
fn halved(rgba: &[u8], width: u32, height: u32) -> (Vec<u8>, u32, u32) {
    let (w, h) = ((width / 2).max(1), (height / 2).max(1));
    let at =
        |x: u32, y: u32, c: u32| u32::from(rgba[((y.min(height - 1) * width + x.min(width - 1)) * 4 + c) as usize]);
    let mut out = Vec::with_capacity((w * h * 4) as usize);
    for y in 0..h {
        for x in 0..w {
            for c in 0..4 {
                let sum = at(2 * x, 2 * y, c)
                    + at(2 * x + 1, 2 * y, c)
                    + at(2 * x, 2 * y + 1, c)
                    + at(2 * x + 1, 2 * y + 1, c);
                out.push(((sum + 2) / 4) as u8);
            }
        }
    }
    (out, w, h)
}
