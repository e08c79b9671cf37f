//! Depth layers: the first is the depth map, the others are what rays find behind it.

mod common;

use antumbra::Error;
use antumbra::gpu::readback::{read_layers, read_texture};
use antumbra::gpu::recorder::Recorder;
use antumbra::gpu::resources::Resources;
use antumbra::gpu::texture::Texture;
use antumbra::passes::maps::depth_layers::DepthLayers;
use antumbra::passes::maps::depth_map::DepthMap;
use antumbra::scene::SceneRenderer;
use antumbra_reference::{Ray, Tracer};
use antumbra_scene::{Mesh, Scene};
use common::{builtin, camera, cuboid, drawn, gpu, light, quad};
use glam::{DVec2, DVec3, Vec3};
use pollster::block_on;

const SIZE: u32 = 160;

fn depths(texture: &wgpu::Texture) -> Vec<f32> {
    bytemuck::pod_collect_to_vec(&block_on(read_texture(gpu(), texture)).expect("reads"))
}

/// The layers in a texture: their nearer surfaces and their thickness.
fn columns(texture: &Texture) -> Vec<Vec<[f32; 2]>> {
    let [count, width] = [texture.texture.depth_or_array_layers(), texture.texture.width()];
    let bytes = block_on(read_layers(gpu(), &texture.texture)).expect("reads");
    let all: Vec<[f32; 2]> = bytemuck::pod_collect_to_vec(&bytes);
    assert_eq!(all.len(), (count * width * width) as usize);
    all.chunks_exact((width * width) as usize).map(<[[f32; 2]]>::to_vec).collect()
}

/// The nearer surfaces of layers that are no thicker than that.
fn of_texture(texture: &Texture) -> Vec<Vec<f32>> {
    let surface = |[near, thickness]: &[f32; 2]| {
        assert_eq!(*thickness, 0.0, "a layer of a single surface");
        *near
    };
    columns(texture).iter().map(|layer| layer.iter().map(surface).collect()).collect()
}

/// The layers of a scene, nearest first.
fn layers(renderer: &SceneRenderer, size: u32, count: u32) -> Vec<Vec<f32>> {
    let maps = drawn_layers(renderer, size, count);
    of_texture(&maps.texture)
}

fn drawn_layers(renderer: &SceneRenderer, size: u32, count: u32) -> DepthLayers {
    draw(&mut Resources::default(), renderer, [size, count], 0.0).expect("draws")
}

/// Draws so many maps of so many texels per side with the resources of earlier frames.
fn draw(
    resources: &mut Resources,
    renderer: &SceneRenderer,
    [size, count]: [u32; 2],
    apart: f32,
) -> Result<DepthLayers, Error> {
    let mut maps = None;
    common::submit(|encoder| {
        let mut recorder = Recorder::new(gpu(), encoder, resources);
        let frame = renderer.frame.bind(&mut recorder)?;
        maps = Some(DepthLayers::of_light(&mut recorder, &frame, size, count, apart)?);
        Ok(())
    })?;
    Ok(maps.expect("recorded"))
}

/// What of a picture differs in its bits.
fn differing(a: &[f32], b: &[f32]) -> usize {
    a.iter().zip(b).filter(|(a, b)| a.to_bits() != b.to_bits()).count()
}

fn filled(layer: &[f32]) -> usize {
    layer.iter().filter(|q| **q > 0.0).count()
}

/// Meshes that all cast, under a light that looks down at them.
fn casting(meshes: Vec<Mesh>) -> Scene {
    let view = camera([2.0, 3.0, 4.0], [0.0; 3], 50.0);
    let mut scene = common::scene(meshes, view, light([0.3, 4.0, 0.2], [0.0; 3], 0.5));
    scene.instances[0].receiver_only = false;
    scene.light.shadow_fov_deg = Some(40.0);
    scene
}

#[test]
fn the_first_layer_is_the_depth_map_and_depths_descend() {
    // The plant has leaves that are cut out of a texture.
    for spec in ["layers", "fence:slats=9", "bumpy", "plant:leaves=8"] {
        let renderer = drawn(&builtin(spec), [16, 16]);
        let (mut map, mut resources) = (None, Resources::default());
        common::submit(|encoder| {
            let mut recorder = Recorder::new(gpu(), encoder, &mut resources);
            let frame = renderer.frame.bind(&mut recorder)?;
            map = Some(DepthMap::of_light(&mut recorder, &frame, SIZE)?);
            Ok(())
        })
        .expect("draws");
        let map = depths(&map.expect("recorded").texture.texture);
        assert!(filled(&map) > 1000, "{spec}: the map is empty");
        for count in [1, 4] {
            let maps = drawn_layers(&renderer, SIZE, count);
            let wrong = differing(&depths(&maps.nearest.texture.texture), &map);
            assert_eq!(wrong, 0, "{spec}: {wrong} texels of the map drawn by the way are not those of the map");
            let layers = of_texture(&maps.texture);
            let wrong = differing(&layers[0], &map);
            assert_eq!(wrong, 0, "{spec}: {wrong} texels of the first of {count} layers are not those of the map");
            for (i, pair) in layers.windows(2).enumerate() {
                let (near, far) = (&pair[0], &pair[1]);
                let rising = near.iter().zip(far).find(|(near, far)| near <= far && **far > 0.0);
                assert_eq!(rising, None, "{spec}: layer {} is not behind layer {i}", i + 1);
                println!("{spec}: {} texels in layer {i}, {} in the next", filled(near), filled(far));
            }
        }
    }
}

#[test]
fn behind_a_single_surface_there_is_nothing() {
    // Oblique planes, large and small, and a ball's worth of triangles of which only the upper half is there.
    let mut slope = quad([0.0; 3], [9.0; 2]);
    for p in &mut slope.positions {
        p.y = 0.37 * p.x - 0.61 * p.z - 1.0;
    }
    let mut sheet = Mesh::default();
    let side = 97;
    for i in 0..side * side {
        let (x, z) = ((i % side) as f32 / 12.0 - 4.0, (i / side) as f32 / 12.0 - 4.0);
        sheet.positions.push(Vec3::new(x, 0.2 * (2.1 * x + 0.7 * z).sin() - 0.4 * z.cos(), z));
        if i % side + 1 < side && i / side + 1 < side {
            sheet.indices.extend([i, i + side, i + 1, i + 1, i + side, i + side + 1]);
        }
    }
    for (name, mesh) in [("slope", slope), ("sheet", sheet)] {
        for size in [SIZE, 255] {
            let layers = layers(&drawn(&casting(vec![mesh.clone()]), [16, 16]), size, 2);
            assert_eq!(filled(&layers[0]), (size * size) as usize, "{name}: it fills the map");
            let behind = filled(&layers[1]);
            assert_eq!(behind, 0, "{name}: {behind} texels of {size} x {size} have a second surface");
        }
    }
}

/// The inverse distances of a ray's first hits, nearest first, along the light's normal.
fn hits(tracer: &Tracer, origin: Vec3, direction: Vec3, count: usize) -> Vec<f64> {
    let (mut t_min, mut found) = (0.0, Vec::new());
    while let Some(hit) = tracer.nearest(&Ray { t_min, ..Ray::new(origin, direction) }).filter(|_| found.len() < count)
    {
        found.push(1.0 / hit.t);
        t_min = hit.t as f32 * (1.0 + 1e-6);
    }
    found
}

/// The part of the texels of each layer that are not what rays through their middles meet.
fn wrong_texels(scene: &Scene, size: u32, count: u32) -> Vec<f64> {
    let renderer = drawn(scene, [16, 16]);
    let (layers, frustum) = (layers(&renderer, size, count), renderer.frame.frustum);
    // What only receives is not drawn into maps, and rays would hit it.
    let mut casting = scene.clone();
    casting.instances.retain(|i| !i.receiver_only);
    let tracer = Tracer::new(&casting);
    let (right, up, forward) = scene.light.basis();
    let mut wrong = vec![0.0; count as usize];
    for i in 0..size * size {
        let at = DVec2::new(f64::from(i % size) + 0.5, f64::from(i / size) + 0.5) / f64::from(size) * 2.0 - 1.0;
        let at = (at * frustum.tan_half.as_dvec2()).as_vec2();
        let hits = hits(&tracer, scene.light.center, forward + right * at.x + up * at.y, count as usize);
        for (k, layer) in layers.iter().enumerate() {
            let q = f64::from(layer[i as usize]) / f64::from(frustum.near);
            let expected = hits.get(k).copied().unwrap_or(0.0);
            wrong[k] += f64::from((q - expected).abs() > 1e-4 * expected.max(1e-6));
        }
    }
    wrong.iter().map(|w| w / f64::from(size * size)).collect()
}

#[test]
fn the_layers_are_what_rays_meet() {
    for spec in ["layers", "fence:slats=9", "plant:leaves=8"] {
        let wrong = wrong_texels(&builtin(spec), SIZE, 3);
        println!("{spec}: {wrong:.4?}");
        // Silhouettes that pass within a rounding of a texel's middle; each moves what lies behind it.
        assert!(wrong.iter().all(|w| *w < 0.01), "{spec}: parts {wrong:.4?} of the texels differ from rays");
    }
}

/// A quad turned about its middle.
fn turned(center: DVec3, half: f64, normal: DVec3) -> Mesh {
    let right = normal.any_orthonormal_vector();
    let up = normal.cross(right);
    let at = |x: f64, y: f64| (center + (right * x + up * y) * half).as_vec3();
    let positions = vec![at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)];
    Mesh { positions, indices: vec![0, 1, 2, 0, 2, 3], ..Mesh::default() }
}

#[test]
fn random_quads_come_in_the_order_of_their_depths() {
    // Numbers in [-1, 1) by a linear congruence.
    let mut state = 7u32;
    let mut random = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / f64::from(1 << 23) - 1.0
    };
    for round in 0..4 {
        let meshes: Vec<Mesh> = (0..7)
            .map(|_| {
                let center = DVec3::new(random() * 0.5, random() * 1.3, random() * 0.5);
                turned(center, 0.9 + 0.5 * random(), DVec3::new(random() * 0.7, 1.0, random() * 0.7).normalize())
            })
            .collect();
        let wrong = wrong_texels(&casting(meshes), SIZE, 4);
        println!("round {round}: {wrong:.4?}");
        assert!(wrong.iter().all(|w| *w < 0.003), "round {round}: parts {wrong:.4?} of the texels differ from rays");
    }
}

#[test]
fn a_stack_gives_its_depths_and_coinciding_surfaces_count_once() {
    // Heights below the light at 4 m that looks straight down, in the wrong order, one of them twice.
    let heights = [0.5, 2.0, -1.0, 2.0, 1.25];
    let mut scene = casting(heights.iter().map(|y| quad([0.0, *y, 0.0], [9.0; 2])).collect());
    scene.light = light([0.0, 4.0, 0.0], [0.0; 3], 0.5);
    scene.light.shadow_fov_deg = Some(40.0);
    let renderer = drawn(&scene, [16, 16]);
    let layers = layers(&renderer, 128, 5);
    for (layer, z) in layers.iter().zip([2.0, 2.75, 3.5, 5.0, f32::INFINITY]) {
        let expected = renderer.frame.frustum.near / z;
        let largest = layer.iter().map(|q| (q - expected).abs()).fold(0.0, f32::max);
        assert!(largest <= 1e-6 * expected, "{z} m: off by up to {largest} from {expected}");
    }
}

/// The nearer and the farther end of a layer, as distances from the light; none where there is nothing.
type Ends = Option<(f32, f32)>;

/// The layers of large sheets at some heights below a light at 4 m that looks straight down; the same in all texels.
fn layers_of_sheets(heights: &[f32], count: u32, gap: f32) -> Vec<Ends> {
    let mut scene = casting(heights.iter().map(|y| quad([0.0, *y, 0.0], [9.0; 2])).collect());
    scene.light = light([0.0, 4.0, 0.0], [0.0; 3], 0.5);
    scene.light.shadow_fov_deg = Some(40.0);
    let renderer = drawn(&scene, [16, 16]);
    // So many texels as the light moves something by, over `gap` of inverse distance.
    let frustum = renderer.frame.frustum;
    let apart = gap * 0.25 / (2.0 * frustum.tan_half.x / SIZE as f32);
    let mut resources = Resources::default();
    draw(&mut resources, &renderer, [SIZE, count], apart).expect("draws");
    // Twice: nothing is left of the first time.
    let maps = draw(&mut resources, &renderer, [SIZE, count], apart).expect("draws");
    let of_layer = |layer: &Vec<[f32; 2]>| {
        let first = layer[0];
        let same = |t: &[f32; 2]| (t[0] - first[0]).abs() + (t[1] - first[1]).abs() < 1e-6 * first[0].max(1e-9);
        assert!(layer.iter().all(same), "sheets fill the map");
        (first[0] > 0.0).then(|| (frustum.near / first[0], frustum.near / (first[0] - first[1])))
    };
    columns(&maps.texture).iter().map(of_layer).collect()
}

#[test]
fn surfaces_that_the_light_hardly_tells_apart_are_a_layer_with_a_thickness() {
    // At 1, 1.1, 2, 2.2, and 4 m from the light: 1, 0.91, 0.5, 0.45 and 0.25 as inverse distance.
    let heights = [1.8, 3.0, 2.0, 0.0, 2.9];
    let expect = |count, gap, expected: &[Ends]| {
        let found = layers_of_sheets(&heights, count, gap);
        let off = |(a, b): (&Ends, &Ends)| match (a, b) {
            (Some(a), Some(b)) => (a.0 - b.0).abs().max((a.1 - b.1).abs()),
            (a, b) => f32::from(u8::from(a != b)) * 9.0,
        };
        let worst = found.iter().zip(expected).map(off).fold(0.0, f32::max);
        assert!(found.len() == expected.len() && worst < 1e-4, "gap {gap}: {found:?}, expected {expected:?}");
    };
    // Two pairs and the ground.
    expect(4, 0.1, &[Some((1.0, 1.1)), Some((2.0, 2.2)), Some((4.0, 4.0)), None]);
    // Closer ones only.
    expect(4, 0.06, &[Some((1.0, 1.0)), Some((1.1, 1.1)), Some((2.0, 2.2)), Some((4.0, 4.0))]);
    // All but the ground are one.
    expect(2, 0.6, &[Some((1.0, 2.2)), Some((4.0, 4.0))]);
    // The last layer takes what is behind it, but not the ground.
    expect(2, 0.06, &[Some((1.0, 1.0)), Some((1.1, 2.2))]);
    expect(1, 0.1, &[Some((1.0, 2.2))]);
    // One surface behind the last layer is the ground, as far as that is known.
    expect(2, 0.1, &[Some((1.0, 1.1)), Some((2.0, 2.2))]);
}

#[test]
fn a_last_layer_reaches_down_to_all_that_is_collected() {
    // More than are collected for one layer, five: the farthest of those may be the ground.
    let heights = [3.0, 2.5, 2.0, 1.5, 1.0, 0.5, 0.0];
    let found = layers_of_sheets(&heights, 1, 1e-3);
    assert!(
        matches!(found[..], [Some((top, low))] if (top - 1.0).abs() < 1e-4 && (low - 2.5).abs() < 1e-4),
        "{found:?}"
    );
}

#[test]
fn both_sides_of_a_box_are_layers() {
    let layers = layers(&drawn(&casting(vec![cuboid([-0.5, 0.0, -0.5], [0.5, 1.0, 0.5])]), [16, 16]), SIZE, 3);
    let counts: Vec<usize> = layers.iter().map(|l| filled(l)).collect();
    assert!(counts[0] > 1000 && counts[1] == counts[0], "in front and behind: {counts:?}");
    assert_eq!(counts[2], 0, "a box has two sides: {counts:?}");
}

#[test]
fn nothing_is_left_of_the_frame_before() {
    let [low, high] = [0.5, 1.5].map(|y| {
        let quads = vec![quad([0.1, y, 0.0], [0.6; 2]), quad([-0.1, y + 0.2, 0.3], [0.5; 2])];
        drawn(&casting(quads), [16, 16])
    });
    let mut resources = Resources::default();
    let first = draw(&mut resources, &high, [SIZE, 2], 0.0).expect("draws").texture;
    let again = draw(&mut resources, &low, [SIZE, 2], 0.0).expect("draws").texture;
    assert_eq!(again.texture, first.texture, "the maps are drawn into again");
    for (i, (fresh, used)) in layers(&low, SIZE, 2).iter().zip(of_texture(&again)).enumerate() {
        let wrong = differing(&used, fresh);
        assert!(filled(fresh) > 500 && wrong == 0, "layer {i}: {wrong} texels differ from maps that are drawn first");
    }
}

#[test]
fn maps_are_kept_while_size_and_number_are_the_same() {
    let renderer = drawn(&builtin("fence:slats=9"), [16, 16]);
    let mut resources = Resources::default();
    let mut texture = |size, count| {
        let maps = draw(&mut resources, &renderer, [size, count], 0.0)?;
        let passes = ["depth layers", "merging layers"];
        let memory = resources.memory();
        let found: u64 = memory.iter().filter(|m| passes.contains(&m.pass)).map(|m| m.bytes).sum();
        let maps_alone = u64::from(size * size * (3 * count + 1) * 4);
        assert!((maps_alone..maps_alone + 2048).contains(&found), "{size} texels, {count} layers: {memory:?}");
        Ok(maps.texture.texture.clone())
    };
    let first = texture(64, 2).expect("draws");
    assert_eq!(texture(64, 2).expect("draws"), first);
    let mut last = first;
    for (size, count) in [(128, 2), (128, 3)] {
        let next = texture(size, count).expect("draws");
        assert_ne!(next, last, "{size} texels, {count} layers");
        last = next;
    }
    assert!(matches!(texture(1 << 20, 2), Err(Error::Size { .. })), "a map that no device holds");
    let (largest, binding) =
        (gpu().capabilities.max_texture_size, gpu().device.limits().max_storage_buffer_binding_size);
    if 16 * u64::from(largest).pow(2) > binding {
        match texture(largest, 4) {
            Err(Error::Size { what: "depth layers", max, .. }) => assert!(max >= 1024 && max < largest, "{max}"),
            other => panic!("4 maps of {largest} texels per side: {other:?}"),
        }
    }
}
