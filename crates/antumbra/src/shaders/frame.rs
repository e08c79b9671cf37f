//! `shaders/frame.wesl`: the receiver at a pixel, and its plane in the map.

use crate::bindings;
use crate::gpu::resources::buffer_of;
use crate::scene::SceneRenderer;
use crate::testing::{Worst, at_pixels, gpu};
use antumbra_scene::{Scene, builtin};
use glam::{DVec2, DVec3, DVec4, Vec2};

const SIZE: [u32; 2] = [64, 48];

/// Writes the receiver of every pixel: depth and normal of the geometry buffer, then the receiver, then at three
/// tangents how far points of inverse distance 0 and 2 q lie above its plane, and the bias of texels without width.
const KERNEL: &str = "
    import package::shaders::frame::{frame, geometry_depth, geometry_normal, receiver_at, above_plane, plane_bias};
    var<storage, read> tangents: array<vec2<f32>>;
    var<storage, read_write> output: array<f32>;
    fn put(to: u32, v: vec3<f32>) {
        output[to] = v.x; output[to + 1u] = v.y; output[to + 2u] = v.z;
    }
    @compute @workgroup_size(8, 8)
    fn receivers(@builtin(global_invocation_id) pixel: vec3<u32>) {
        if any(pixel.xy >= frame.size) { return; }
        let depth = textureLoad(geometry_depth, pixel.xy, 0);
        let r = receiver_at(pixel.xy, depth);
        let at = (pixel.y * frame.size.x + pixel.x) * 24u;
        output[at] = depth;
        put(at + 1u, textureLoad(geometry_normal, pixel.xy, 0).xyz);
        put(at + 4u, r.position);
        put(at + 7u, vec3(r.tangent, r.q));
        put(at + 10u, vec3(r.cosine, r.position_error, r.height));
        for (var k = 0u; k < 3u; k++) {
            let t = r.tangent + tangents[k];
            let bias = plane_bias(r, vec2(0.0), length(tangents[k]));
            put(at + 13u + 3u * k, vec3(above_plane(r, t, 0.0), above_plane(r, t, 2.0 * r.q), bias));
        }
    }";

/// Offsets from the receiver at which its plane is asked for.
const TANGENTS: [Vec2; 3] = [Vec2::ZERO, Vec2::new(0.05, -0.02), Vec2::new(-0.3, 0.4)];

fn on_gpu(renderer: &SceneRenderer) -> Vec<Vec<f32>> {
    let usage = wgpu::BufferUsages::STORAGE;
    let tangents = buffer_of(gpu(), "tangents", bytemuck::cast_slice(&TANGENTS), usage);
    let bytes = u64::from(SIZE[0] * SIZE[1]) * 96;
    let words = at_pixels(renderer, KERNEL, "receivers", bindings! { tangents: &tangents }, bytes);
    words.chunks_exact(24).map(<[f32]>::to_vec).collect()
}

/// A receiver in light space, in double precision, from the depth and the normal of the geometry buffer.
struct Twin {
    position: DVec3,
    normal: DVec3,
}

impl Twin {
    fn new(scene: &Scene, renderer: &SceneRenderer, pixel: [u32; 2], words: &[f32]) -> Twin {
        let size = DVec2::new(f64::from(SIZE[0]), f64::from(SIZE[1]));
        let at = DVec2::new(f64::from(pixel[0]) + 0.5, f64::from(pixel[1]) + 0.5) / size;
        let clip = DVec4::new(2.0 * at.x - 1.0, 1.0 - 2.0 * at.y, f64::from(words[0]), 1.0);
        let view = &renderer.frame.view;
        let h = (view.clip_from_view.as_dmat4() * view.view_from_world.as_dmat4()).inverse() * clip;
        let world = h.truncate() / h.w;
        let (right, up, forward) = scene.light.basis();
        let basis = [right, up, forward].map(|v| v.as_dvec3());
        let into = |v: DVec3| DVec3::from(basis.map(|b| b.dot(v)));
        let normal = DVec3::new(words[1].into(), words[2].into(), words[3].into()).normalize();
        Twin { position: into(world - scene.light.center.as_dvec3()), normal: into(normal) }
    }

    /// Distance of a point of the map from the receiver's plane along the normal, metres.
    fn above(&self, tangent: DVec2, q: f64) -> f64 {
        self.normal.dot(tangent.extend(1.0) / q - self.position)
    }

    /// Inverse distance at which the ray from the light's centre through a tangent meets the receiver's plane.
    fn plane_q(&self, tangent: DVec2) -> f64 {
        self.normal.dot(tangent.extend(1.0)) / self.normal.dot(self.position)
    }

    fn tangent(&self) -> DVec2 {
        self.position.truncate() / self.position.z
    }

    fn cosine(&self) -> f64 {
        -self.normal.dot(self.position.normalize())
    }
}

/// Scenes near the origin, and one that is far from it.
fn scenes() -> Vec<Scene> {
    let mut list =
        ["fence", "bumpy", "spheres:segments=32", "layers"].map(|s| builtin::build(s).expect("known")).to_vec();
    let mut far = list[0].clone();
    let shift = glam::Vec3::new(3000.0, 20.0, -5000.0);
    far.instances.iter_mut().for_each(|i| i.world_from_object.translation += glam::Vec3A::from(shift));
    for p in [&mut far.camera.eye, &mut far.camera.target, &mut far.light.center, &mut far.light.target] {
        *p += shift;
    }
    far.name = "fence far away".into();
    list.push(far);
    list
}

/// Calls with every pixel of a scene that faces the light.
fn for_each_receiver(scene: &Scene, mut call: impl FnMut([u32; 2], &Twin, &[f32])) {
    let renderer = SceneRenderer::new(gpu(), scene, SIZE).expect("uploads");
    let mut count = 0;
    for (i, words) in on_gpu(&renderer).iter().enumerate() {
        let pixel = [i as u32 % SIZE[0], i as u32 / SIZE[0]];
        let twin = Twin::new(scene, &renderer, pixel, words);
        if words[0] > 0.0 && twin.position.z > 0.0 && twin.cosine() > 0.01 {
            count += 1;
            call(pixel, &twin, words);
        }
    }
    assert!(count > 500, "{}: only {count} pixels face the light", scene.name);
}

#[test]
fn a_receivers_place_is_as_wrong_as_it_says_at_most() {
    for scene in scenes() {
        let mut worst = Worst::default();
        for_each_receiver(&scene, |pixel, twin, words| {
            let got = DVec3::new(words[4].into(), words[5].into(), words[6].into());
            let allowed = f64::from(words[11]);
            let off = (got - twin.position).length() / allowed;
            worst.see(off, || format!("{pixel:?}: {got} instead of {}, {allowed} allowed", twin.position));
        });
        println!("{}: {worst:?}", scene.name);
        assert!(worst.error <= 1.0, "{}: times what it says: {worst:?}", scene.name);
    }
}

#[test]
fn height_above_the_plane_is_the_distance_along_the_normal_times_the_inverse_distance() {
    for scene in scenes() {
        let mut worst = Worst::default();
        for_each_receiver(&scene, |pixel, twin, words| {
            let q = 2.0 / twin.position.z;
            for (k, offset) in TANGENTS.iter().enumerate() {
                let exact = q * twin.above(twin.tangent() + offset.as_dvec2(), q);
                let got = f64::from(words[14 + 3 * k]);
                // Tangent and inverse distance are off by the stated error.
                let allowed = f64::from(words[11]) * q + 2e-7 * (1.0 + twin.position.length() * q);
                worst.see((got - exact).abs() / allowed, || format!("{pixel:?} at {offset}: {got} instead of {exact}"));
            }
        });
        println!("{}: {worst:?}", scene.name);
        assert!(worst.error <= 1.0, "{}: times what is allowed: {worst:?}", scene.name);
    }
}

/// Largest computed height of points exactly on a receiver's plane, relative to the bias.
fn worst_of_bias(scene: &Scene, turn: impl Fn(DVec3) -> DVec3) -> Worst {
    let mut worst = Worst::default();
    for_each_receiver(scene, |pixel, twin, words| {
        let turned = Twin { normal: turn(twin.normal).normalize(), ..*twin };
        for (k, offset) in TANGENTS.iter().enumerate() {
            let q = turned.plane_q(turned.tangent() + offset.as_dvec2());
            if q <= 0.0 {
                continue;
            }
            // Stored depths are rounded to single precision; heights are affine in it.
            let [at_0, at_2q, bias] = [0, 1, 2].map(|i| f64::from(words[13 + 3 * k + i]));
            let above = at_0 + (at_2q - at_0) * f64::from(q as f32) / (2.0 * f64::from(words[9]));
            worst.see(above / bias, || format!("{pixel:?} at {offset}: {above} above its own plane, bias {bias}"));
        }
    });
    worst
}

#[test]
fn the_bias_covers_the_rounding_of_a_plane_even_where_texels_have_no_width() {
    for scene in scenes() {
        let worst = worst_of_bias(&scene, |n| n);
        println!("{}: {worst:?}", scene.name);
        assert!(worst.error < 1.0, "{}: times the bias: {worst:?}", scene.name);
    }
}

#[test]
fn a_plane_of_another_slope_is_caught() {
    let worst = worst_of_bias(&scenes()[0], |n| n + DVec3::new(1e-4, -1e-4, 0.0));
    assert!(worst.error > 1.0, "a tenth of a milliradian went through: {worst:?}");
}
