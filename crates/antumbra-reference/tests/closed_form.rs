//! A rectangle over a plane under a parallel rectangular light: seen from a point of the plane, the occluder's
//! projection to the light's plane is a rectangle too, and the hidden area the overlap of two rectangles.

mod common;

use antumbra_reference::{Reference, Settings};
use antumbra_scene::Scene;
use common::{camera, light_above, quad, scene, traced};
use glam::{DVec3, Vec2, Vec3};

/// The plane y = 0 under a rectangle, under a light whose edges run along x and z.
struct Case {
    occluder: Vec3,
    half: Vec2,
    light_height: f32,
    light: Vec2,
}

impl Case {
    fn scene(&self) -> Scene {
        let meshes = vec![quad(Vec3::ZERO, Vec2::splat(20.0)), quad(self.occluder, self.half)];
        let look = camera(Vec3::new(0.0, 0.9, 2.2), Vec3::ZERO);
        scene(meshes, look, light_above(self.light_height, self.light))
    }

    /// Visible fraction from a point of the plane.
    fn at(&self, p: DVec3) -> f64 {
        let (h, o) = (f64::from(self.light_height), self.occluder.as_dvec3());
        let grow = h / o.y;
        let overlap = |p: f64, center: f64, half: f32, size: f32| {
            let (half, size) = (f64::from(half), f64::from(size));
            let (lo, hi) = (p + (center - half - p) * grow, p + (center + half - p) * grow);
            if size == 0.0 {
                return if lo < 0.0 && hi > 0.0 { 1.0 } else { 0.0 };
            }
            (hi.min(size / 2.0) - lo.max(-size / 2.0)).max(0.0) / size
        };
        1.0 - overlap(p.x, o.x, self.half.x, self.light.x) * overlap(p.z, o.z, self.half.y, self.light.y)
    }

    /// Mean over the 4 × 4 sub-pixels of each pixel, or none where one of them sees the occluder or the sky.
    fn exact(&self, width: u32, height: u32) -> Vec<Option<f64>> {
        let c = self.scene().camera;
        let (right, up, forward) = c.basis();
        let (right, up, forward, eye) = (right.as_dvec3(), up.as_dvec3(), forward.as_dvec3(), c.eye.as_dvec3());
        let tan = (f64::from(c.fov_y_deg) / 2.0).to_radians().tan();
        let point = |x: f64, y: f64| -> Option<f64> {
            let (u, v) = (x / f64::from(width) * 2.0 - 1.0, 1.0 - y / f64::from(height) * 2.0);
            let aspect = f64::from(width) / f64::from(height);
            let d = forward + right * (u * tan * aspect) + up * (v * tan);
            let t = (f64::from(self.occluder.y) - eye.y) / d.y;
            let q = (eye + d * t - self.occluder.as_dvec3()).abs();
            let blocked = t > 0.0 && q.x <= f64::from(self.half.x) && q.z <= f64::from(self.half.y);
            (d.y < 0.0 && !blocked).then(|| self.at(eye - d * (eye.y / d.y)))
        };
        let pixel = |i: u32| {
            let (x, y) = (i % width, i / width);
            let sub = |k: u32| (f64::from(k) + 0.5) / 4.0;
            let values: Option<Vec<f64>> =
                (0..16).map(|k| point(f64::from(x) + sub(k % 4), f64::from(y) + sub(k / 4))).collect();
            values.map(|v| v.iter().sum::<f64>() / 16.0)
        };
        (0..width * height).map(pixel).collect()
    }
}

/// What separates a picture from the exact one on valid pixels.
#[derive(Debug, Default)]
struct Difference {
    pixels: usize,
    penumbra: usize,
    max: f64,
    rms: f64,
    bias: f64,
    /// Fractions of the penumbra's pixels within two and three of their own standard errors.
    within: [f64; 2],
    /// Root mean square of the estimates over the penumbra.
    estimate: f64,
}

fn compare(case: &Case, settings: &Settings) -> Difference {
    let r: Reference = traced(&case.scene(), settings);
    let exact = case.exact(settings.width, settings.height);
    let mut d = Difference::default();
    for (i, exact) in exact.iter().enumerate() {
        let (Some(exact), true) = (exact, r.valid[i]) else { continue };
        let e = f64::from(r.visibility[i]) - exact;
        let sigma = f64::from(r.error[i]);
        d.pixels += 1;
        d.max = d.max.max(e.abs());
        if *exact > 1e-9 && *exact < 1.0 - 1e-9 {
            d.penumbra += 1;
            d.rms += e * e;
            d.bias += e;
            d.estimate += sigma * sigma;
            for (k, within) in d.within.iter_mut().enumerate() {
                *within += f64::from(u8::from(e.abs() <= (k + 2) as f64 * sigma));
            }
        } else {
            assert!(e.abs() < 1e-6, "outside of the penumbra nothing is random: {e} at pixel {i}");
        }
    }
    let n = d.penumbra.max(1) as f64;
    d.within = d.within.map(|w| w / n);
    d.bias /= n;
    (d.rms, d.estimate) = ((d.rms / n).sqrt(), (d.estimate / n).sqrt());
    d
}

const SQUARE: Case =
    Case { occluder: Vec3::new(0.0, 1.0, 0.0), half: Vec2::splat(0.5), light_height: 3.0, light: Vec2::splat(0.8) };

#[test]
fn square_over_plane_within_two_thousandths() {
    let settings = Settings { light_samples: 4096, ..Settings::of_size(128, 128) };
    let d = compare(&SQUARE, &settings);
    println!("{d:#?}");
    assert!(d.penumbra > 2000, "{d:?}");
    assert!(d.max < 0.002, "{d:?}");
    assert!(d.rms < 0.0005 && d.bias.abs() < 0.0001, "{d:?}");
}

#[test]
fn the_error_estimate_covers_the_error_and_is_not_idle() {
    for light_samples in [64, 256, 1024] {
        let d = compare(&SQUARE, &Settings { light_samples, ..Settings::of_size(96, 96) });
        println!("{light_samples} samples: {d:#?}");
        assert!(d.within[0] > 0.95 && d.within[1] > 0.98, "{light_samples} samples: {d:?}");
        assert!(d.estimate < 5.0 * d.rms, "{light_samples} samples: {d:?}");
    }
}

#[test]
fn other_sizes_offsets_and_sample_counts() {
    let cases = [
        Case {
            occluder: Vec3::new(0.4, 0.5, -0.3),
            half: Vec2::new(0.7, 0.2),
            light_height: 2.0,
            light: Vec2::new(1.5, 0.3),
        },
        Case {
            occluder: Vec3::new(-0.2, 1.2, 0.1),
            half: Vec2::new(0.1, 0.4),
            light_height: 5.0,
            light: Vec2::new(0.2, 2.5),
        },
        Case { occluder: Vec3::new(0.0, 0.001, 0.0), half: Vec2::splat(0.5), light_height: 4.0, light: Vec2::ONE },
    ];
    for case in &cases {
        for light_samples in [1024, 1000] {
            let d = compare(case, &Settings { light_samples, ..Settings::of_size(64, 64) });
            println!("{light_samples} {d:#?}");
            assert!(d.pixels > 1500 && d.max < 0.02 && d.bias.abs() < 0.001, "{d:?}");
        }
    }
}

#[test]
fn a_line_light_is_a_rectangle_without_height() {
    for light in [Vec2::new(0.8, 0.0), Vec2::new(0.0, 0.8)] {
        let d = compare(&Case { light, ..SQUARE }, &Settings::of_size(64, 64));
        println!("{d:#?}");
        // Each sub-pixel has 64 points on the line, and errs by up to one of them.
        assert!(d.penumbra > 200 && d.max < 0.006, "{d:?}");
    }
}

#[test]
fn a_point_light_casts_hard_shadows() {
    let case = Case { light: Vec2::ZERO, ..SQUARE };
    let settings = Settings::of_size(64, 64);
    let d = compare(&case, &settings);
    assert!(d.pixels > 1500 && d.max < 1e-6, "{d:?}");
    let rays = traced(&case.scene(), &settings).rays;
    assert!(rays <= 64 * 64 * 16, "one shadow ray for each primary ray is enough: {rays}");
}
