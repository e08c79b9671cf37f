//! Casters: the host's buffers in any layout, what is refused, moved vertices, culling and holes.

#[path = "casters/host.rs"]
mod host;

mod common;

use antumbra::gpu::recorder::Recorder;
use antumbra::gpu::resources::Resources;
use antumbra::input::casters::{Indices, Mask, MeshBuffers};
use antumbra::passes::maps::depth_map::DepthMap;
use antumbra::{Aabb, Casters, Error};
use antumbra_reference::{Ray, Tracer};
use antumbra_scene::{Instance, Material, Scene, Texture, Wrap};
use common::{builtin, camera, compared, drawn, gpu, ground, light, quad, shadowed, technique, truth};
use glam::{Affine3A, Mat4, Vec2, Vec3};
use host::{Host, Layout};
use pollster::block_on;
use std::sync::Arc;

const SIZE: [u32; 2] = [96, 96];

/// A wedge without symmetry that stands thrice, turned, stretched and mirrored, over the ground.
fn wedges() -> Scene {
    let mut wedge = common::cuboid([-0.3, 0.0, -0.2], [0.4, 0.5, 0.2]);
    wedge.positions[2].y = 0.9;
    wedge.positions[7].x = 0.1;
    let view = camera([1.6, 1.9, 2.6], [0.0, 0.2, 0.0], 45.0);
    let mut scene = common::scene(vec![ground(8.0), wedge], view, light([1.5, 4.0, -1.0], [0.0; 3], 0.6));
    let mirrored = Mat4::from_translation(Vec3::new(0.9, 0.3, 0.1)) * Mat4::from_scale(Vec3::new(-1.0, 0.7, 1.0));
    for m in [Mat4::from_translation(Vec3::new(-1.0, 0.0, -0.6)) * Mat4::from_rotation_y(0.7), mirrored] {
        scene.instances.push(Instance { mesh: 1, world_from_object: Affine3A::from_mat4(m), receiver_only: false });
    }
    scene
}

/// Visibility of a scene whose casters lie in a host's buffers.
fn borrowed(scene: &Scene, layout: Layout) -> Vec<f32> {
    let hosts: Vec<Host> = (0..scene.meshes.len()).map(|m| Host::new(scene, m, layout)).collect();
    let meshes: Vec<MeshBuffers> = hosts.iter().map(Host::mesh).collect();
    let casters = Casters::from_buffers(gpu(), &meshes).unwrap_or_else(|e| panic!("{layout:?}: {e}"));
    assert_eq!(casters.triangle_count(), scene.triangle_count() as u64, "{layout:?}");
    assert_eq!(casters.bounds(), scene.bounds(), "{layout:?}");
    with_casters(scene, casters)
}

/// Geometry buffer and visibility drawn from these casters alone.
fn with_casters(scene: &Scene, casters: Casters) -> Vec<f32> {
    let mut renderer = drawn(scene, SIZE);
    renderer.frame.casters = Arc::new(casters);
    common::submit(|encoder| renderer.record_geometry(gpu(), encoder, None)).expect("draws");
    shadowed(&renderer, &mut technique("pcss:map=256")).expect("draws")
}

fn uploaded(scene: &Scene) -> Vec<f32> {
    shadowed(&drawn(scene, SIZE), &mut technique("pcss:map=256")).expect("draws")
}

/// Largest difference of two pictures, and how many pixels differ by over a thousandth.
fn difference(a: &[f32], b: &[f32]) -> (f32, usize) {
    let differences = || a.iter().zip(b).map(|(a, b)| (a - b).abs());
    (differences().fold(0.0, f32::max), differences().filter(|d| *d > 1e-3).count())
}

#[test]
fn buffers_of_every_layout_give_what_an_upload_gives() {
    let scene = wedges();
    let uploaded = uploaded(&scene);
    assert!(uploaded.iter().filter(|v| **v < 0.5).count() > 200, "the scene has a shadow");
    let plain = Layout::PLAIN;
    for layout in [
        plain,
        Layout { indices: None, ..plain },
        Layout { indices: Some(wgpu::IndexFormat::Uint16), ..plain },
        Layout { indices: Some(wgpu::IndexFormat::Uint16), first_index: 3, ..plain },
        Layout { indices: Some(wgpu::IndexFormat::Uint16), first_index: 4, ..plain },
        Layout { first_index: 5, ..plain },
        Layout { vertex_stride: 32, position_offset: 8, ..plain },
        Layout { vertex_stride: 20, position_offset: 260, ..plain },
        Layout { transform_stride: 80, transform_offset: 12, ..plain },
        Layout {
            indices: None,
            first_index: 0,
            vertex_stride: 24,
            position_offset: 4,
            transform_stride: 128,
            transform_offset: 256,
        },
    ] {
        let (largest, differing) = difference(&borrowed(&scene, layout), &uploaded);
        assert!(largest < 1e-4, "{layout:?}: differs by up to {largest} in {differing} pixels");
    }
}

#[test]
fn a_transform_that_is_not_mirrored_is_caught() {
    let mut wrong = wedges();
    wrong.instances[3].world_from_object.matrix3.x_axis *= -1.0;
    let (largest, differing) = difference(&uploaded(&wrong), &uploaded(&wedges()));
    assert!(largest > 0.5 && differing > 50, "a mirrored instance is not told from its mirror: {largest}, {differing}");
}

/// What is wrong with a mesh after `spoil`.
fn refusal(spoil: impl for<'a> FnOnce(&mut MeshBuffers<'a>, &'a wgpu::Buffer)) -> String {
    let host = Host::new(&wedges(), 1, Layout::PLAIN);
    let useless = host::buffer(&[0; 4096], wgpu::BufferUsages::COPY_DST);
    let mut mesh = host.mesh();
    spoil(&mut mesh, &useless);
    match Casters::from_buffers(gpu(), &[host.mesh(), mesh]) {
        Err(Error::Casters { mesh: 1, message }) => message,
        Err(e) => panic!("another error: {e}"),
        Ok(_) => panic!("it was taken"),
    }
}

/// Asserts that a spoilt mesh is refused with words that say why.
macro_rules! refused {
    ($words:literal, |$mesh:ident, $useless:ident| $spoil:expr) => {
        let message = refusal(|$mesh, $useless| {
            let _ = $useless;
            $spoil;
        });
        assert!(message.contains($words), "`{}` is not said by: {message}", $words);
    };
}

#[test]
fn what_cannot_be_borrowed_is_refused_with_the_reason() {
    refused!("no triangles or no instances", |m, _u| m.triangle_count = 0);
    refused!("no triangles or no instances", |m, _u| m.transforms.count = 0);
    refused!("vertex buffer was made without BufferUsages::STORAGE", |m, u| m.vertices = u);
    refused!("transform buffer was made without BufferUsages::STORAGE", |m, u| m.transforms.buffer = u);
    refused!("index buffer was made without BufferUsages::STORAGE", |m, u| {
        m.indices = Some(Indices { buffer: u, format: wgpu::IndexFormat::Uint32, offset: 0 })
    });
    refused!("position offset of 2 bytes", |m, _u| m.position_offset = 2);
    refused!("vertex stride of 14 bytes", |m, _u| m.vertex_stride = 14);
    refused!("shorter than a position", |m, _u| m.vertex_stride = 8);
    refused!("transform offset of 1 bytes", |m, _u| m.transforms.offset = 1);
    refused!("transform stride of 66 bytes", |m, _u| m.transforms.stride = 66);
    refused!("transform buffer has 192 bytes where the layout needs 256", |m, _u| m.transforms.count = 4);
    refused!("shorter than a matrix", |m, _u| m.transforms.stride = 32);
    refused!("vertex buffer has 96 bytes", |m, _u| m.indices = None);
    refused!("index buffer has 144 bytes", |m, _u| m.triangle_count = 13);
    refused!("index offset of 2 bytes", |m, _u| { m.indices = m.indices.map(|i| Indices { offset: 2, ..i }) });
}

#[test]
fn a_mask_that_makes_no_sense_is_refused() {
    let scene = leaf(Some(0.5));
    let (leaf, (texture, sampler)) =
        (Host::new(&scene, 1, Layout::PLAIN), host::texture(scene.materials[1].texture.as_ref().expect("it has one")));
    for (uv_offset, cutoff, words) in [
        (6, 0.5, "texture coordinates of 6 bytes"),
        (12, 0.0, "cutoff of 0"),
        (12, 1.5, "cutoff of 1.5"),
        (12, f32::NAN, "cutoff of NaN"),
    ] {
        let mask = Mask { texture: &texture, sampler: &sampler, uv_offset, cutoff };
        let refused = Casters::from_buffers(gpu(), &[MeshBuffers { mask: Some(mask), ..leaf.mesh() }]);
        let message = refused.err().expect("it was taken").to_string();
        assert!(message.contains(words), "`{words}` is not said by: {message}");
    }
}

#[test]
fn no_mesh_at_all_is_lit() {
    let casters = Casters::from_buffers(gpu(), &[]).expect("nothing is wrong with nothing");
    assert_eq!((casters.triangle_count(), casters.cluster_count()), (0, 0));
    assert!(with_casters(&wedges(), casters).iter().all(|v| *v == 1.0), "nothing is in the picture");
}

#[test]
fn refit_finds_moved_vertices_and_without_it_they_are_culled() {
    let mut scene = wedges();
    scene.light.shadow_fov_deg = Some(50.0);
    let mut far = scene.clone();
    far.meshes[1].positions.iter_mut().for_each(|p| p.x += 300.0);
    let [ground, near, moving] =
        [(&scene, 0), (&scene, 1), (&far, 1)].map(|(scene, mesh)| Host::new(scene, mesh, Layout::PLAIN));
    let casters = Casters::from_buffers(gpu(), &[ground.mesh(), moving.mesh()]).expect("borrows");
    // The host moves the far mesh to where the near one is.
    let mut encoder = gpu().device.create_command_encoder(&Default::default());
    encoder.copy_buffer_to_buffer(&near.vertices, 0, &moving.vertices, 0, near.vertices.size());
    gpu().queue.submit([encoder.finish()]);
    let mut renderer = drawn(&scene, SIZE);
    let expected = shadowed(&renderer, &mut technique("hard:map=256")).expect("draws");
    renderer.frame.casters = Arc::new(casters);
    let stale = shadowed(&renderer, &mut technique("hard:map=256")).expect("draws");
    assert!(stale.iter().sum::<f32>() > expected.iter().sum::<f32>() + 100.0, "boxes that are out of date must cull");
    renderer.frame.casters.refit(gpu()).expect("measures");
    let fitted = shadowed(&renderer, &mut technique("hard:map=256")).expect("draws");
    assert_eq!(difference(&fitted, &expected), (0.0, 0));
}

// ---- culling ----

/// The opening in degrees at which about a tenth of the triangles' middles lie in the light's frustum, and that part.
fn tenth(scene: &Scene) -> (f32, f64) {
    let mut tangents = Vec::new();
    for instance in &scene.instances {
        let mesh = &scene.meshes[instance.mesh];
        for t in mesh.indices.chunks_exact(3) {
            let middle = t.iter().map(|i| mesh.positions[*i as usize]).sum::<Vec3>() / 3.0;
            let l = scene.light.light_from_world(instance.world_from_object.transform_point3(middle));
            tangents.push(if l.z > 0.0 { l.x.abs().max(l.y.abs()) / l.z } else { f32::INFINITY });
        }
    }
    tangents.sort_by(f32::total_cmp);
    let tan = tangents[tangents.len() / 10];
    let part = tangents.iter().filter(|t| **t <= tan).count() as f64 / tangents.len() as f64;
    (2.0 * tan.atan().to_degrees(), part)
}

/// The part of the map's texels whose depth is not that of a ray from the light through the texel's middle.
fn wrong_texels(map: &[f32], size: u32, scene: &Scene, tan: f32, near: f32) -> f64 {
    let tracer = Tracer::new(scene);
    let (right, up, forward) = scene.light.basis();
    let wrong = (0..size * size).filter(|i| {
        let at = Vec2::new((i % size) as f32 + 0.5, (i / size) as f32 + 0.5) / size as f32 * 2.0 - 1.0;
        let direction = forward + (right * at.x + up * at.y) * tan;
        let q = tracer.nearest(&Ray::new(scene.light.center, direction)).map_or(0.0, |h| 1.0 / h.t as f32);
        (map[*i as usize] / near - q).abs() > 1e-3 * q.max(1e-6)
    });
    wrong.count() as f64 / f64::from(size * size)
}

#[test]
fn culling_draws_what_the_frustum_holds_and_drops_nothing_of_it() {
    let mut scene = builtin("pipes:triangles=300000");
    // What only receives is not drawn into maps, and rays would hit it.
    scene.instances.retain(|i| !i.receiver_only);
    let (degrees, part) = tenth(&scene);
    scene.light.shadow_fov_deg = Some(degrees);
    let renderer = drawn(&scene, [16, 16]);
    let frame = &renderer.frame;
    let size = 256;
    let (mut map, mut resources) = (None, Resources::default());
    common::submit(|encoder| {
        let mut recorder = Recorder::new(gpu(), encoder, &mut resources);
        let frame = frame.bind(&mut recorder)?;
        map = Some(DepthMap::of_light(&mut recorder, &frame, size)?);
        Ok(())
    })
    .expect("draws");
    let map = map.expect("recorded");
    let all = frame.casters.triangle_count();
    let drawn = block_on(map.culling.triangles_drawn(gpu())).expect("reads") as f64 / all as f64;
    assert!(drawn >= part && drawn < 0.25, "{drawn:.3} of {all} triangles drawn where the frustum holds {part:.3}");
    let depths: Vec<f32> = bytemuck::pod_collect_to_vec(&block_on(gpu().read_texture(&map.texture)).expect("reads"));
    let wrong = |scene: &Scene| wrong_texels(&depths, size, scene, frame.frustum.tan_half.x, frame.frustum.near);
    let kept = wrong(&scene);
    println!("{drawn:.3} of {all} triangles drawn, {part:.3} in the frustum, {kept:.4} of the texels differ from rays");
    // Silhouettes that pass within a rounding of a texel's middle.
    assert!(kept < 0.01, "{kept:.4} of the texels differ from rays");
    // The sibling: a cluster in fifty gone must be caught.
    let mut holed = scene.clone();
    for mesh in &mut holed.meshes {
        let clusters: Vec<&[u32]> = mesh.indices.chunks(384).collect();
        mesh.indices =
            clusters.iter().enumerate().filter(|(i, _)| i % 50 != 7).flat_map(|(_, c)| *c).copied().collect();
    }
    let lost = wrong(&holed);
    assert!(lost > 0.01, "clusters that are gone change only {lost:.4} of the texels");
}

// ---- holes ----

/// A leaf over the ground whose texture is transparent but for a diagonal half.
fn leaf(cutoff: Option<f32>) -> Scene {
    let view = camera([0.9, 0.75, 1.4], [0.0, 0.0, 0.0], 50.0);
    let mut scene =
        common::scene(vec![ground(8.0), quad([0.0, 0.8, 0.0], [0.5; 2])], view, light([0.3, 3.0, 0.0], [0.0; 3], 0.3));
    let texel = |i: u32| [90, 160, 60, if i % 32 > i / 32 { 255 } else { 0 }];
    let texture = Texture {
        width: 32,
        height: 32,
        rgba: (0..32 * 32).flat_map(texel).collect(),
        wrap: [Wrap::Clamp; 2],
        nearest: true,
    };
    scene.meshes[1].uvs = vec![Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
    scene.meshes[1].material = 1;
    scene.materials.push(Material { texture: Some(Arc::new(texture)), alpha_cutoff: cutoff, ..Material::default() });
    scene
}

#[test]
fn a_masked_leaf_casts_the_shadow_of_its_solid_part() {
    let scene = leaf(Some(0.5));
    let truth = truth(&scene, SIZE, 256);
    let masked = compared(&uploaded(&scene), &truth);
    assert!(masked.counts.shadowed > 500, "{:?}", masked.counts);
    assert!(masked.average_error < 0.03 && masked.p99 < 0.25, "{masked:?}");
    let solid = compared(&uploaded(&leaf(None)), &truth);
    assert!(solid.p99 > 0.5, "a leaf without its hole went through: {solid:?}");
}

#[test]
fn a_borrowed_mask_cuts_what_an_uploaded_one_cuts() {
    let scene = leaf(Some(0.5));
    let layout = Layout { vertex_stride: 20, ..Layout::PLAIN };
    let (ground, leaf) = (Host::new(&scene, 0, layout), Host::new(&scene, 1, layout));
    let (texture, sampler) = host::texture(scene.materials[1].texture.as_ref().expect("it has one"));
    let mask = Mask { texture: &texture, sampler: &sampler, uv_offset: 12, cutoff: 0.5 };
    let cut = MeshBuffers { mask: Some(mask), ..leaf.mesh() };
    let visibility =
        |mesh| with_casters(&scene, Casters::from_buffers(gpu(), &[ground.mesh(), mesh]).expect("borrows"));
    let (largest, differing) = difference(&visibility(cut), &uploaded(&scene));
    assert!(largest < 1e-4, "differs by up to {largest} in {differing} pixels");
    let (_, differing) = difference(&visibility(leaf.mesh()), &uploaded(&scene));
    assert!(differing > 200, "without the mask only {differing} pixels differ");
}

#[test]
fn bounds_of_casters_are_the_union() {
    let hosts = [0, 1].map(|m| Host::new(&wedges(), m, Layout::PLAIN));
    let casters = Casters::from_buffers(gpu(), &hosts.each_ref().map(Host::mesh)).expect("borrows");
    let union = hosts.iter().fold(Aabb::EMPTY, |b, h| b.union(&h.bounds));
    assert_eq!(casters.bounds(), union);
    assert_eq!(casters.cluster_count(), 4, "one cluster for the ground and for each of three wedges");
}
