//! `shaders/horizon.wesl`: the part of the light above the receiver's plane.

use crate::testing::{Random, Worst, evaluate};
use glam::{DVec2, DVec3, Vec2, Vec3};
use proptest::prelude::*;

/// The shader's formula in double precision: a difference of four squares.
fn light_above_horizon(normal: DVec3, position: DVec3, half: DVec2) -> f64 {
    let ramp2 = |x: f64| x.max(0.0).powi(2);
    let height = normal.dot(position);
    let reach = normal.truncate().abs() * half;
    let a = reach.max_element();
    let b = reach.min_element().max(1e-2 * a);
    if a + b <= height.abs() {
        return if height < 0.0 { 1.0 } else { 0.0 };
    }
    let below = ramp2(height + a + b) - ramp2(height + a - b) - ramp2(height - a + b) + ramp2(height - a - b);
    (1.0 - below / (8.0 * a * b)).clamp(0.0, 1.0)
}

/// Error bound of the formula: the narrower of the two directions counts as a hundredth of the other.
const CLAMPED: f64 = 1.0 / 800.0;

/// The same by clipping: the area of the rectangle above the plane [Sutherland, Hodgman 1974].
fn clipped_area(normal: DVec3, position: DVec3, half: DVec2) -> f64 {
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| DVec2::new(x, y) * half);
    let side = |p: DVec2| normal.dot(p.extend(0.0) - position);
    let mut kept = Vec::new();
    for i in 0..4 {
        let (a, b) = (corners[i], corners[(i + 1) % 4]);
        let (da, db) = (side(a), side(b));
        if da >= 0.0 {
            kept.push(a);
        }
        if (da >= 0.0) != (db >= 0.0) {
            kept.push(a.lerp(b, da / (da - db)));
        }
    }
    let doubled: f64 = (0..kept.len()).map(|i| kept[i].perp_dot(kept[(i + 1) % kept.len()])).sum();
    doubled.abs() / (8.0 * half.x * half.y)
}

/// Receivers near the light's plane and far from it, lights from a millimetre to ten metres, planes of all slopes;
/// every fourth passes through the light, every eighth is perpendicular to one of its edges.
fn inputs(count: usize) -> Vec<(Vec3, Vec3, Vec2)> {
    let mut random = Random(7);
    (0..count)
        .map(|i| {
            let half = Vec2::new(random.decades(-3.0, 1.0), random.decades(-3.0, 1.0));
            let mut normal = random.direction();
            if i % 8 == 1 {
                normal = Vec3::new(0.0, normal.y, normal.z).normalize_or(Vec3::Z);
            }
            let mut position = random.direction() * random.decades(-1.0, 2.0);
            if i % 4 == 0 {
                let inside = Vec2::new(random.within(-1.0, 1.0), random.within(-1.0, 1.0)) * half;
                let aside = random.direction() * random.decades(-1.0, 1.0);
                position = inside.extend(0.0) + aside - normal * normal.dot(aside);
            }
            (normal, position, half)
        })
        .collect()
}

const KERNEL: &str = "
    import package::shaders::horizon::light_above_horizon;
    fn evaluate(at: u32, to: u32) {
        let normal = vec3(input[at], input[at + 1u], input[at + 2u]);
        let position = vec3(input[at + 3u], input[at + 4u], input[at + 5u]);
        output[to] = light_above_horizon(normal, position, vec2(input[at + 6u], input[at + 7u]));
    }";

/// The largest difference between the GPU and a twin. The rounding error of the plane's height, relative to the light's
/// extent across the plane, is subtracted.
fn worst_on_gpu(twin: impl Fn(DVec3, DVec3, DVec2) -> f64) -> Worst {
    let inputs = inputs(8192);
    let words = |(n, p, h): &(Vec3, Vec3, Vec2)| [n.x, n.y, n.z, p.x, p.y, p.z, h.x, h.y];
    let got = evaluate(KERNEL, &inputs.iter().flat_map(words).collect::<Vec<f32>>(), 8, 1);
    let mut worst = Worst::default();
    let mut partial = 0;
    for (got, (n, p, h)) in got.iter().zip(&inputs) {
        let exact = twin(n.as_dvec3(), p.as_dvec3(), h.as_dvec2());
        partial += usize::from(exact > 0.01 && exact < 0.99);
        let extent = (n.truncate().abs() * *h).max_element().max(1e-9);
        let rounding = f64::from(4.0 * f32::EPSILON * p.abs().max_element() / extent);
        let error = (f64::from(got[0]) - exact).abs() - rounding;
        worst.see(error, || format!("normal {n}, position {p}, half {h}: {} instead of {exact}", got[0]));
    }
    assert!(partial > 500, "only {partial} planes cut the light");
    worst
}

#[test]
fn the_gpu_agrees_with_its_twin() {
    let worst = worst_on_gpu(light_above_horizon);
    println!("{worst:?}");
    assert!(worst.error < 2e-4, "{worst:?}");
}

#[test]
fn the_gpu_agrees_with_clipping() {
    let worst = worst_on_gpu(clipped_area);
    println!("{worst:?}");
    assert!(worst.error < 1.01 * CLAMPED, "{worst:?}");
}

#[test]
fn a_light_of_another_size_is_caught() {
    let worst = worst_on_gpu(|n, p, h| light_above_horizon(n, p, h * 1.1));
    assert!(worst.error > 0.01, "a tenth more of light went through: {worst:?}");
}

#[test]
fn ends_are_exact() {
    let half = DVec2::new(0.4, 0.3);
    for (normal, position, expected, allowed) in [
        // Under the light and facing it, turned away from it, and edge-on through its middle and through its rims.
        (DVec3::NEG_Z, DVec3::Z, 1.0, 0.0),
        (DVec3::Z, DVec3::Z, 0.0, 0.0),
        (DVec3::X, DVec3::Z, 0.5, 1e-9),
        (DVec3::X, DVec3::new(0.4, 0.0, 1.0), 0.0, CLAMPED),
        (DVec3::X, DVec3::new(-0.4, 0.0, 1.0), 1.0, CLAMPED),
    ] {
        let (twin, clipped) = (light_above_horizon(normal, position, half), clipped_area(normal, position, half));
        assert!((twin - expected).abs() <= allowed, "{normal} {position}: {twin}");
        assert!((clipped - expected).abs() <= 1e-9, "{normal} {position}: {clipped}");
    }
    // A point light is above or below.
    assert_eq!(light_above_horizon(DVec3::NEG_Z, DVec3::Z, DVec2::ZERO), 1.0);
    assert_eq!(light_above_horizon(DVec3::Z, DVec3::Z, DVec2::ZERO), 0.0);
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(4096) })]

    #[test]
    fn the_formula_is_the_clipped_area(
        turn in 0.0f64..std::f64::consts::TAU, z in -1.0f64..1.0, height in -1.2f64..1.2,
        half in prop::array::uniform2(-3.0f64..1.0),
    ) {
        let r = (1.0 - z * z).sqrt();
        let normal = DVec3::new(r * turn.cos(), r * turn.sin(), z);
        let half = DVec2::from(half.map(|h| 10f64.powf(h)));
        let reach = normal.truncate().abs().dot(half);
        let position = normal * (height * reach);
        let (twin, clipped) = (light_above_horizon(normal, position, half), clipped_area(normal, position, half));
        prop_assert!((twin - clipped).abs() < 1.01 * CLAMPED, "{twin} against {clipped}");
        // Where neither direction is a hundredth of the other the two are one.
        let sides = normal.truncate().abs() * half;
        if sides.min_element() > 1e-2 * sides.max_element() {
            prop_assert!((twin - clipped).abs() < 1e-9, "{twin} against {clipped}");
        }
    }

    #[test]
    fn a_plane_that_sinks_shows_more_of_the_light(
        turn in 0.0f64..std::f64::consts::TAU, z in -1.0f64..1.0, height in -1.5f64..1.5, step in 0.0f64..0.5,
    ) {
        let r = (1.0 - z * z).sqrt();
        let normal = DVec3::new(r * turn.cos(), r * turn.sin(), z);
        let at = |h: f64| light_above_horizon(normal, normal * h, DVec2::new(0.7, 0.4));
        prop_assert!(at(height) >= at(height + step) - 1e-12);
    }
}
