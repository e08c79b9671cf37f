//! Silhouette edges and the texels that they pass.

use super::*;
use crate::gpu::readback::read_buffer;
use crate::input::frame::Frame;
use crate::passes::maps::depth_map::DepthMap;
use crate::passes::triangles::silhouette::{Marking, SilhouetteMask};
use crate::scene::SceneRenderer;
use crate::testing::submit;
use antumbra_scene::{Camera, Instance, Material, Mesh, RectLight, Scene};
use glam::{Affine3A, Vec2};
use pollster::block_on;

/// A light 5 metres over the ground that looks straight down, and meshes below it.
fn scene(meshes: Vec<Mesh>) -> Scene {
    let instances = (0..meshes.len())
        .map(|mesh| Instance { mesh, world_from_object: Affine3A::IDENTITY, receiver_only: false })
        .collect();
    let light = RectLight {
        center: Vec3::new(0.13, 5.0, -0.07),
        target: Vec3::new(0.13, 0.0, -0.07),
        up: Vec3::NEG_Z,
        size: Vec2::ZERO,
        shadow_fov_deg: Some(60.0),
    };
    let camera = Camera {
        eye: Vec3::new(0.0, 3.0, 6.0),
        target: Vec3::ZERO,
        up: Vec3::Y,
        fov_y_deg: 45.0,
        near: 0.1,
        far: 50.0,
    };
    Scene { name: "test".into(), meshes, materials: vec![Material::default()], instances, camera, light, size: None }
}

fn mesh(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Mesh {
    Mesh {
        positions: positions.iter().map(|p| Vec3::from(*p)).collect(),
        indices: triangles.concat(),
        ..Mesh::default()
    }
}

/// A closed box with the light not straight above any of its sides' planes.
fn cuboid() -> Mesh {
    let positions: Vec<[f32; 3]> =
        (0..8).map(|i| [(i & 1) as f32 - 0.5, (i >> 1 & 1) as f32 + 0.2, (i >> 2 & 1) as f32 - 0.5]).collect();
    let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles: Vec<[u32; 3]> = faces.iter().flat_map(|f| [[f[0], f[1], f[2]], [f[0], f[2], f[3]]]).collect();
    mesh(&positions, &triangles)
}

/// Every triangle with vertices of its own, every other one listed the other way round.
fn torn(mesh: &Mesh) -> Mesh {
    let positions = mesh.indices.iter().map(|&i| mesh.positions[i as usize]).collect();
    let indices = (0..mesh.indices.len() as u32 / 3)
        .flat_map(|t| if t % 2 == 0 { [3 * t, 3 * t + 1, 3 * t + 2] } else { [3 * t, 3 * t + 2, 3 * t + 1] })
        .collect();
    Mesh { positions, indices, ..Mesh::default() }
}

struct Marked {
    edges: u64,
    texels: Vec<u32>,
    counts: Vec<u32>,
    size: u32,
}

fn marked(scene: &Scene, size: u32, hide: bool) -> (Marked, Frame) {
    let gpu = gpu();
    let renderer = SceneRenderer::new(gpu, scene, [16, 16]).expect("uploads");
    let mut mask = None;
    submit(|recorder| {
        let frame = renderer.frame.bind(recorder)?;
        let map = DepthMap::of_light(recorder, &frame, size)?;
        mask = Some(SilhouetteMask::record(recorder, &frame, &map, Marking { hide, count: true })?);
        Ok(())
    });
    let mask = mask.expect("recorded");
    let [edges, _] = block_on(mask.stats(gpu)).expect("reads");
    let texels = bytemuck::pod_collect_to_vec(&block_on(read_buffer(gpu, &mask.texels)).expect("reads"));
    let counts = bytemuck::pod_collect_to_vec(&block_on(gpu.read_texture(&mask.counts)).expect("reads"));
    (Marked { edges, texels, counts, size }, renderer.frame)
}

impl Marked {
    fn is_set(&self, x: u32, y: u32) -> bool {
        self.texels[(y * self.size.div_ceil(32) + x / 32) as usize] >> (x % 32) & 1 != 0
    }

    fn number(&self) -> u32 {
        self.texels.iter().map(|w| w.count_ones()).sum()
    }
}

#[test]
fn a_box_has_the_silhouette_of_its_top_whatever_its_vertices() {
    // Seen from above, off the middle but over the top: only the top's four edges.
    for (name, mesh) in [("closed", cuboid()), ("torn", torn(&cuboid()))] {
        let (found, _) = marked(&scene(vec![mesh]), 128, true);
        assert_eq!(found.edges, 4, "{name}");
    }
}

#[test]
fn open_edges_and_edges_of_many_triangles_count_where_the_shadow_ends_there() {
    // A square has four edges, and none along its diagonal.
    let square = mesh(&[[-1., 1., -1.], [1., 1., -1.], [1., 1., 1.], [-1., 1., 1.]], &[[0, 1, 2], [0, 2, 3]]);
    assert_eq!(marked(&scene(vec![square]), 64, true).0.edges, 4);
    // Pages of a book along z at x = 0: two folded to the same side end at their spine, with a third on the other side
    // the spine is within the shadow.
    let page = |x: f32, y: f32| [[x, y, -1.0], [x, y, 1.0]];
    let book = |ends: &[[[f32; 3]; 2]]| {
        let mut positions = vec![[0.0, 1.0, -1.0], [0.0, 1.0, 1.0]];
        let mut triangles = Vec::new();
        for end in ends {
            let k = positions.len() as u32;
            positions.extend(end);
            triangles.extend([[0, 1, k], [1, k + 1, k]]);
        }
        mesh(&positions, &triangles)
    };
    let edges = |ends: &[[[f32; 3]; 2]]| marked(&scene(vec![book(ends)]), 64, false).0.edges;
    assert_eq!(edges(&[page(1.0, 1.0)]), 4);
    assert_eq!(edges(&[page(1.0, 1.0), page(-1.0, 1.0)]), 6);
    assert_eq!(edges(&[page(1.0, 1.0), page(1.0, 0.5)]), 7);
    assert_eq!(edges(&[page(1.0, 1.0), page(1.0, 0.5), page(1.0, 1.5)]), 10);
    assert_eq!(edges(&[page(1.0, 1.0), page(1.0, 0.5), page(-1.0, 1.5)]), 9);
    assert_eq!(edges(&[page(1.0, 1.0), page(1.0, 0.5), page(-1.0, 1.5), page(-1.0, 1.0)]), 12);
    // Two meshes at the same place share no edges, and a triangle without area is no neighbour.
    let half = |t: [u32; 3]| mesh(&[[-1., 1., -1.], [1., 1., -1.], [1., 1., 1.], [-1., 1., 1.]], &[t]);
    assert_eq!(marked(&scene(vec![half([0, 1, 2]), half([0, 2, 3])]), 64, false).0.edges, 6);
    let thin = mesh(&[[-1., 1., -1.], [1., 1., -1.], [1., 1., 1.]], &[[0, 1, 2], [0, 0, 1]]);
    assert_eq!(marked(&scene(vec![thin]), 64, false).0.edges, 3);
}

#[test]
fn no_texel_that_a_silhouette_passes_is_missed_and_few_others_are_marked() {
    let mut random = Random(7);
    let triangle = |random: &mut Random| {
        let at = random.point(DVec3::new(-1.5, 0.2, -1.5), DVec3::new(1.5, 3.0, 1.5));
        [(); 3].map(|()| (at + random.point(DVec3::splat(-0.8), DVec3::splat(0.8))).as_vec3().to_array())
    };
    for size in [64, 100] {
        let triangles: Vec<[[f32; 3]; 3]> = (0..12).map(|_| triangle(&mut random)).collect();
        let mesh = mesh(&triangles.concat(), &(0..12).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect::<Vec<_>>());
        let (found, frame) = marked(&scene(vec![mesh]), size, false);
        assert_eq!(found.edges, 36);
        let clip = frame.map_clip_from_world();
        let mut passed = std::collections::HashSet::new();
        for t in &triangles {
            for k in 0..3 {
                let (a, b) = (Vec3::from(t[k]), Vec3::from(t[(k + 1) % 3]));
                for i in 0..=20000 {
                    let p = clip * a.lerp(b, i as f32 / 20000.0).extend(1.0);
                    let at = (Vec2::new(p.x, -p.y) / p.w * 0.5 + 0.5) * size as f32;
                    if at.min_element() >= 0.0 && at.max_element() < size as f32 {
                        passed.insert((at.x as u32, at.y as u32));
                    }
                }
            }
        }
        let missed = passed.iter().filter(|(x, y)| !found.is_set(*x, *y)).count();
        let number = found.number();
        println!("{size}: {} texels passed, {number} marked", passed.len());
        assert_eq!(missed, 0, "of {}", passed.len());
        assert!(number <= passed.len() as u32 * 11 / 10, "{number} marked for {}", passed.len());
        // The table counts them.
        for y in 0..size {
            for x in 0..size {
                let before = (0..=y).map(|j| (0..=x).filter(|i| found.is_set(*i, j)).count() as u32).sum::<u32>();
                if (x + 3 * y) % 17 == 0 {
                    assert_eq!(found.counts[(y * size + x) as usize], before, "{size}: {x} {y}");
                }
            }
        }
    }
}

#[test]
fn silhouettes_that_lie_deep_in_shadow_are_left_out() {
    let lid = mesh(&[[-2., 3., -2.], [2., 3., -2.], [2., 3., 2.], [-2., 3., 2.]], &[[0, 1, 2], [0, 2, 3]]);
    let alone = marked(&scene(vec![lid.clone()]), 128, true).0.number();
    let both = |hide| marked(&scene(vec![lid.clone(), cuboid()]), 128, hide).0.number();
    let (shown, hidden) = (both(false), both(true));
    assert!(
        shown > alone + 40 && hidden == alone,
        "the lid {alone}, with the box {shown}, less what is hidden {hidden}"
    );
}
