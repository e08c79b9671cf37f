//! `shaders/footprint.wesl`: how the tangent changes from pixel to pixel on a receiver's plane.

use crate::input::frame::light_from_world;
use crate::scene::SceneRenderer;
use crate::testing::{Worst, at_pixels, gpu};
use antumbra_scene::builtin;
use glam::{DVec2, DVec3, DVec4};

const SIZE: [u32; 2] = [64, 48];

const KERNEL: &str = "
    import package::shaders::frame::{frame, geometry_depth, receiver_at};
    import package::shaders::footprint::footprint_of;
    var<storage, read_write> output: array<vec4<f32>>;
    @compute @workgroup_size(8, 8)
    fn footprints(@builtin(global_invocation_id) pixel: vec3<u32>) {
        if any(pixel.xy >= frame.size) { return; }
        let depth = textureLoad(geometry_depth, pixel.xy, 0);
        let r = receiver_at(pixel.xy, depth);
        let f = footprint_of(r, pixel.xy, depth);
        let at = 3u * (pixel.y * frame.size.x + pixel.x);
        output[at] = vec4(r.normal, r.height);
        output[at + 1u] = vec4(f.across, f.down);
        output[at + 2u] = vec4(depth, r.position);
    }";

#[test]
fn a_footprint_is_the_derivative_on_the_receivers_own_plane() {
    let gpu = gpu();
    for name in ["fence", "grid:side=16", "spheres:segments=32"] {
        let scene = builtin::build(name).expect("known");
        let renderer = SceneRenderer::new(gpu, &scene, SIZE).expect("uploads");
        let words = at_pixels(&renderer, KERNEL, "footprints", &[], u64::from(SIZE[0] * SIZE[1]) * 48);

        let view = &renderer.frame.view;
        let world_from_clip = (view.clip_from_view.as_dmat4() * view.view_from_world.as_dmat4()).inverse();
        let light_from_clip = light_from_world(&scene.light) * world_from_clip;
        // Tangent of the intersection of a plane and the ray through an image position.
        let tangent = |at: DVec2, normal: DVec3, height: f64| {
            let place = at / DVec2::new(f64::from(SIZE[0]), f64::from(SIZE[1]));
            let on_ray = |depth: f64| {
                let h = light_from_clip * DVec4::new(2.0 * place.x - 1.0, 1.0 - 2.0 * place.y, depth, 1.0);
                h.truncate() / h.w
            };
            let (a, b) = (on_ray(1.0), on_ray(0.5));
            let p = a + (b - a) * ((height - normal.dot(a)) / normal.dot(b - a));
            p.truncate() / p.z
        };
        let (mut worst, mut count) = (Worst::default(), 0);
        for (i, w) in words.chunks_exact(12).take((SIZE[0] * SIZE[1]) as usize).enumerate() {
            let normal = DVec3::new(w[0].into(), w[1].into(), w[2].into());
            if w[8] == 0.0 || w[11] <= 0.0 {
                continue;
            }
            let at = DVec2::new((i as u32 % SIZE[0]) as f64 + 0.5, (i as u32 / SIZE[0]) as f64 + 0.5);
            let step = 1e-3;
            let by = |d: DVec2| {
                (tangent(at + d * step, normal, w[3].into()) - tangent(at - d * step, normal, w[3].into()))
                    / (2.0 * step)
            };
            for (exact, got) in [(by(DVec2::X), [w[4], w[5]]), (by(DVec2::Y), [w[6], w[7]])] {
                let off = (DVec2::from(got.map(f64::from)) - exact).length() / exact.length().max(1e-9);
                worst.see(off, || format!("pixel {at}: {got:?} instead of {exact}"));
            }
            count += 1;
        }
        println!("{name}: {count} pixels, {worst:?}");
        assert!(count > 500 && worst.error < 0.01, "{name}: {count} pixels, {worst:?}");
    }
}
