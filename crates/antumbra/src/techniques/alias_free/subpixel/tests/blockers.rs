//! The shadow of a triangle on a facet against rays in double precision, and against the paper's own way.

use super::*;

/// A plane in image space.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    pub position: DVec3,
    pub normal: DVec3,
    pub eye: DVec3,
    /// Change of the ray at the plane's distance by one pixel to the right, and by one down.
    pub across: DVec3,
    pub down: DVec3,
}

impl Seen {
    /// The point of the plane at a position in the pixel; none past its horizon.
    pub fn place(&self, s: DVec2) -> Option<DVec3> {
        let direction = self.position - self.eye + s.x * self.across + s.y * self.down;
        let t = self.normal.dot(self.position - self.eye) / self.normal.dot(direction);
        (t > 0.0).then(|| self.eye + t * direction)
    }

    pub fn numbers(&self) -> [DVec3; 5] {
        [self.position, self.normal, self.eye, self.across, self.down]
    }
}

pub(super) const KERNEL: &str = "
    import package::techniques::alias_free::subpixel::facet::{plane_seen, before_horizon, before_light};
    import package::techniques::alias_free::subpixel::shadow_of_triangle::{blocker_of, shadow_of_triangle};
    fn masks(at: u32) -> array<Samples, 2> {
        let f = plane_seen(vector(at), vector(at + 3u), vector(at + 9u), vector(at + 12u), vector(at + 6u), 1.0e-5, 1.0e-6);
        let shadow = shadow_of_triangle(f, blocker_of(vector(at + 15u), vector(at + 18u), vector(at + 21u)));
        return array(shadow.hidden, shadow.invalid);
    }";

pub(super) fn shadows(pattern: &Pattern, cases: &[(Seen, [DVec3; 3])]) -> Vec<[Samples; 2]> {
    let numbers = |(seen, t): &(Seen, [DVec3; 3])| {
        let vectors = seen.numbers().into_iter().chain(*t);
        vectors.flat_map(|v| v.as_vec3().to_array()).collect::<Vec<f32>>()
    };
    let input: Vec<f32> = cases.iter().flat_map(numbers).collect();
    masks_on_gpu(pattern, KERNEL, &input, 24)
}

/// Of a point before the light: whether the triangle hides it, and by how much less or more than an edge, as an angle
/// seen from the light, and in metres to the triangle's plane.
fn hidden(p: DVec3, [a, b, c]: [DVec3; 3]) -> (bool, f64) {
    let n = (b - a).cross(c - a);
    let turn = n.dot(a).signum();
    let side = |u: DVec3, v: DVec3| turn * u.cross(v).normalize().dot(p) / p.length();
    let beyond = turn * n.normalize().dot(p - a) / p.length();
    let all = [side(a, b), side(b, c), side(c, a), beyond];
    (all.iter().all(|v| *v >= 0.0), all.iter().fold(f64::INFINITY, |m, v| m.min(v.abs())))
}

/// A plane before the light, seen by a pixel a few centimetres wide.
pub(super) fn random_seen(random: &mut Random) -> Seen {
    let position = random.point(DVec3::new(-3.0, -3.0, 2.0), DVec3::new(3.0, 3.0, 9.0));
    let eye = random.point(DVec3::splat(-6.0), DVec3::new(6.0, 6.0, 3.0));
    let to_eye = (eye - position).normalize();
    loop {
        let normal = random.point(DVec3::NEG_ONE, DVec3::ONE).normalize();
        // Turned to the eye and to the light.
        if normal.dot(to_eye) > 0.05 && normal.dot(-position.normalize()) > 0.05 {
            let across = to_eye.cross(DVec3::new(0.3, 0.9, 0.2)).normalize();
            let width = random.within(0.005, 0.1);
            return Seen { position, normal, eye, across: across * width, down: across.cross(to_eye) * width };
        }
    }
}

#[test]
fn the_shadow_of_a_triangle_is_what_rays_find_but_for_the_nearest_line() {
    let pattern = Pattern::arranged(Arrangement::Rotated, 32);
    let mut random = Random(11);
    let cases: Vec<_> = (0..6000)
        .map(|i| {
            let seen = random_seen(&mut random);
            // A third of the triangles reach through the light's plane or lie behind it, a third through the facet's.
            let at =
                seen.position * random.within(if i % 3 == 0 { -0.5 } else { 0.3 }, if i % 3 == 1 { 1.1 } else { 0.9 });
            let reach = if i % 3 == 0 { 6.0 } else { random.within(0.02, 1.0) };
            let corner = |random: &mut Random| {
                let p = at + random.point(DVec3::splat(-reach), DVec3::splat(reach));
                p.as_vec3().as_dvec3()
            };
            (seen, [corner(&mut random), corner(&mut random), corner(&mut random)])
        })
        .collect();
    let (mut looked, mut off, mut hits) = (0, 0, 0);
    for ((seen, t), [mask, invalid]) in cases.iter().zip(shadows(&pattern, &cases)) {
        assert_eq!(invalid & 1, 0, "the middle is always valid: {seen:?}, {t:?}");
        // Angle that a pixel spans, seen from the light.
        let pixel =
            seen.across.length().max(seen.down.length()) / seen.normal.dot((seen.eye - seen.position).normalize());
        for (i, s) in pattern.samples().iter().enumerate() {
            let Some(p) = seen.place(*s).filter(|p| p.z > 0.01) else { continue };
            let (is_hidden, by) = hidden(p, *t);
            looked += 1;
            hits += u32::from(is_hidden);
            if is_hidden != (mask >> i & 1 != 0) {
                // No farther than a few steps of the table from a line.
                let allowed = 0.03 * pixel / p.length() + 2e-5;
                assert!(by <= allowed, "sample {i} is off by {by} over {allowed}: {seen:?}, {t:?}");
                off += 1;
            }
        }
    }
    println!("{off} of {looked} samples beside a line, {hits} hidden");
    assert!(off * 200 < looked && hits > looked / 50, "{off} of {looked} samples, {hits} hidden");
}

/// Figure 6: the half-plane H0 of an edge in the triangle's plane, projected by two points of its boundary, on the side
/// of a point of H0.
fn by_figure_six(seen: &Seen, [a, b, c]: [DVec3; 3], p: DVec3) -> Option<bool> {
    let height = |v: DVec3| seen.normal.dot(v - seen.position);
    let project = |v: DVec3| {
        let t = height(DVec3::ZERO) / (height(DVec3::ZERO) - height(v));
        v * t
    };
    let (a1, b1) = (project(a), project(b));
    // Case: between the centre and the facet, or beyond the facet, the projection is in H1; above the centre's own
    // plane parallel to the facet it is not.
    let above_light = height(c) > height(DVec3::ZERO);
    let side = |v: DVec3| seen.normal.dot((b1 - a1).cross(v - a1));
    let boundary_is_above = [a, b].iter().any(|v| height(*v) > height(DVec3::ZERO));
    // The paper projects any two points of the boundary; corners serve where both lie below the light.
    if boundary_is_above {
        return None;
    }
    let same = side(project(c)).signum() == side(p).signum();
    Some(same != above_light)
}

#[test]
fn the_sign_of_a_plane_through_the_light_is_the_case_distinction_of_figure_6() {
    let mut random = Random(29);
    let mut seen_above = 0;
    for _ in 0..20000 {
        let seen = random_seen(&mut random);
        let t = [(); 3].map(|()| random.point(DVec3::splat(-6.0), DVec3::splat(9.0)));
        let p = seen.place(DVec2::new(random.within(-0.5, 0.5), random.within(-0.5, 0.5))).expect("faces the eye");
        let [a, b, c] = t;
        let Some(theirs) = by_figure_six(&seen, t, p) else { continue };
        let turn = (b - a).cross(c - a).dot(a).signum();
        let ours = turn * a.cross(b).dot(p) >= 0.0;
        assert_eq!(ours, theirs, "{seen:?}, {t:?}, {p}");
        seen_above += u32::from(seen.normal.dot(c) > 0.0);
    }
    assert!(seen_above > 500, "only {seen_above} points above the light were met");
}
