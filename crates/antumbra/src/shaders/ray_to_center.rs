//! `shaders/ray_to_center.wesl`: is the light's centre hidden from a point by a triangle?

use crate::testing::{Random, evaluate};
use glam::Vec3;

const KERNEL: &str = "
    import package::shaders::ray_to_center::hides_center;
    fn point(at: u32) -> vec3<f32> { return vec3(input[at], input[at + 1u], input[at + 2u]); }
    fn evaluate(at: u32, to: u32) {
        let hides = hides_center(point(at), input[at + 12u], point(at + 3u), point(at + 6u), point(at + 9u));
        output[to] = select(0.0, 1.0, hides);
    }";

/// A point, a triangle, and by how much positions may be off.
#[derive(Clone, Copy, Debug)]
struct Case {
    point: Vec3,
    corners: [Vec3; 3],
    error: f32,
}

fn on_gpu(cases: &[Case]) -> Vec<bool> {
    let words = |c: &Case| {
        let [x, y, z] = c.corners;
        [c.point, x, y, z].iter().flat_map(|v| v.to_array()).chain([c.error]).collect::<Vec<f32>>()
    };
    let input: Vec<f32> = cases.iter().flat_map(words).collect();
    evaluate(KERNEL, &input, 13, 1).iter().map(|o| o[0] == 1.0).collect()
}

/// The same in double precision by another road: the plane first, then the three sides. `None` where it is too close to
/// tell in single precision.
fn exact(c: &Case) -> Option<bool> {
    let p = c.point.as_dvec3();
    let v = c.corners.map(|v| v.as_dvec3());
    let normal = (v[1] - v[0]).cross(v[2] - v[0]);
    let area = normal.length();
    let along = normal.dot(p);
    if area < 1e-9 || along.abs() < 1e-4 * area * p.length() {
        return None;
    }
    let s = normal.dot(v[0]) / along;
    let distance = (normal.dot(p - v[0]) / area).abs();
    let error = f64::from(c.error);
    let slant = (v[1] - v[0]).length() * (v[2] - v[0]).length() / area;
    let rounding = 2.4e-7 * (v[0].length() + (p - v[0]).length() * slant);
    if (distance - error).abs() < 0.5 * error + 2.0 * rounding || s.abs() < 1e-4 || (s - 1.0).abs() < 1e-4 {
        return None;
    }
    let hit = p * s;
    let reach = v.iter().fold(p.length(), |m, v| m.max(v.length()));
    let mut inside = true;
    for i in 0..3 {
        let (a, b) = (v[i], v[(i + 1) % 3]);
        let aside = (b - a).cross(hit - a).dot(normal) / (area * (b - a).length());
        // The ray is met at an angle: its displacement along the plane by rounding.
        if aside.abs() < 3e-5 * reach * area * p.length() / along.abs() {
            return None;
        }
        inside &= aside > 0.0;
    }
    Some(inside && s > 0.0 && s < 1.0 && distance > error)
}

#[test]
fn random_triangles_hide_the_center_as_in_double_precision() {
    let mut random = Random(11);
    let cases: Vec<Case> = (0..40_000)
        .map(|i| {
            let far = random.decades(-1.0, 1.5);
            let point = Vec3::new(random.within(-1.0, 1.0), random.within(-1.0, 1.0), random.within(0.2, 1.0)) * far;
            // Around a place on the ray, before the light, behind it, beyond the point, or anywhere.
            let s = random.within(-0.7, 1.7);
            let size = far * random.decades(-2.0, 0.3);
            let middle = if i % 5 == 0 { random.direction() * far } else { point * s };
            let corners = [(); 3].map(|()| middle + random.direction() * size * random.unit());
            Case { point, corners, error: far * 1e-5 }
        })
        .collect();
    let (mut told, mut hidden) = (0, 0);
    for (got, case) in on_gpu(&cases).iter().zip(&cases) {
        let Some(expected) = exact(case) else { continue };
        assert_eq!(*got, expected, "{case:?}");
        told += 1;
        hidden += usize::from(expected);
    }
    assert!(told > 30_000 && hidden > 1500, "{told} of them can be told, {hidden} hide the centre");
}

/// A ray that does not slip between the triangles of a fan, whatever edge or corner it passes.
#[test]
fn a_fan_around_the_ray_has_no_crack() {
    let mut random = Random(12);
    let mut cases = Vec::new();
    for _ in 0..3000 {
        let point = Vec3::new(random.within(-3.0, 3.0), random.within(-3.0, 3.0), random.within(3.0, 9.0));
        // The middle of the fan lies on the ray but for rounding, so that the ray passes its edges and its corner.
        let middle = point * random.within(0.2, 0.8);
        let turn = random.within(0.0, 6.0);
        let rim = |k: usize| {
            let angle = turn + k as f32 * std::f32::consts::TAU / 5.0;
            middle + Vec3::new(angle.cos(), angle.sin(), 0.3 * (2.0 * angle).sin()) * 0.5
        };
        cases.extend((0..5).map(|k| Case { point, corners: [middle, rim(k), rim((k + 1) % 5)], error: 1e-5 }));
    }
    let got = on_gpu(&cases);
    for (fan, case) in got.chunks(5).zip(cases.chunks(5)) {
        assert!(fan.iter().any(|hides| *hides), "the ray slips through {:?}", case[0]);
    }
}

#[test]
fn special_places_are_decided_as_they_should_be() {
    let v = Vec3::new;
    let below = v(0.0, 0.0, 10.0);
    let case = |point, corners| Case { point, corners, error: 1e-4 };
    let all = [
        (
            "through the light's plane, around the ray",
            true,
            case(below, [v(-4.0, -1.0, -2.0), v(4.0, -1.0, 4.0), v(0.0, 3.0, 4.0)]),
        ),
        (
            "through the light's plane, met behind the light",
            false,
            case(below, [v(-4.0, -1.0, -4.0), v(4.0, -1.0, 2.0), v(0.0, 3.0, -4.0)]),
        ),
        (
            "through the light's plane, aside of the ray",
            false,
            case(below, [v(1.0, -1.0, -2.0), v(4.0, -1.0, 4.0), v(3.0, 3.0, 4.0)]),
        ),
        ("behind the light", false, case(below, [v(-1.0, -1.0, -1.0), v(1.0, -1.0, -1.0), v(0.0, 1.0, -1.0)])),
        ("before the light", true, case(below, [v(-1.0, -1.0, 1.0), v(1.0, -1.0, 1.0), v(0.0, 1.0, 1.0)])),
        ("the same, wound the other way", true, case(below, [v(1.0, -1.0, 1.0), v(-1.0, -1.0, 1.0), v(0.0, 1.0, 1.0)])),
        ("beyond the point", false, case(below, [v(-1.0, -1.0, 11.0), v(1.0, -1.0, 11.0), v(0.0, 1.0, 11.0)])),
        (
            "the surface that the point lies on",
            false,
            case(below, [v(-1.0, -1.0, 10.0), v(1.0, -1.0, 10.0), v(0.0, 1.0, 10.0)]),
        ),
        (
            "that surface, off by less than rounding",
            false,
            case(below, [v(-1.0, -1.0, 9.99995), v(1.0, -1.0, 9.99995), v(0.0, 1.0, 9.99995)]),
        ),
        ("a surface just above it", true, case(below, [v(-1.0, -1.0, 9.999), v(1.0, -1.0, 9.999), v(0.0, 1.0, 9.999)])),
        (
            "through the facet, standing on it beside the point",
            false,
            case(below, [v(0.5, -1.0, 11.0), v(0.5, 1.0, 11.0), v(0.5, 0.0, 5.0)]),
        ),
        (
            "through the facet, leaning over the point",
            true,
            case(below, [v(0.5, -1.0, 11.0), v(0.5, 1.0, 11.0), v(-2.0, 0.0, 2.0)]),
        ),
        ("seen edge-on from the light", false, case(below, [v(0.0, -1.0, 3.0), v(0.0, 1.0, 3.0), v(0.0, 0.0, 6.0)])),
        (
            "a facet at grazing angle, itself",
            false,
            case(v(30.0, 0.0, 0.3), [v(29.0, -1.0, 0.3), v(29.0, 1.0, 0.3), v(31.0, 0.0, 0.3)]),
        ),
        (
            "a facet at grazing angle, a low wall before it",
            true,
            case(v(30.0, 0.0, 0.3), [v(20.0, -1.0, 0.3), v(20.0, 1.0, 0.3), v(20.0, 0.0, 0.1)]),
        ),
        ("corners in one point", false, case(below, [v(0.0, 0.0, 5.0); 3])),
    ];
    let got = on_gpu(&all.map(|(_, _, case)| case));
    for ((what, expected, case), got) in all.iter().zip(got) {
        assert_eq!(got, *expected, "{what}: {case:?}");
    }
}
