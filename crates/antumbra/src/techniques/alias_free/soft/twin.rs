//! `shaders/light_lattice.wesl`: which points of the light a triangle hides.

use crate::techniques::alias_free::soft::lattice::Lattice;
use crate::testing::{Random, evaluate};
use glam::{DMat2, DVec2, DVec3, Vec2, Vec3};

/// Number of tested rows.
const ROWS: usize = 32;

const KERNEL: &str = "
    import package::shaders::light_lattice::{Projection, hidden_by, hidden_points};
    fn point(at: u32) -> vec3<f32> { return vec3(input[at], input[at + 1u], input[at + 2u]); }
    fn evaluate(at: u32, to: u32) {
        let p = point(at);
        // Metres to lattice: two columns, then the light's centre, then the number of rows.
        let scale = mat2x2(input[at + 13u], input[at + 14u], input[at + 15u], input[at + 16u]);
        let center = vec2(input[at + 17u], input[at + 18u]);
        let s = Projection(p, input[at + 12u], scale * p.z, center + scale * p.xy, center, input[at + 19u]);
        let h = hidden_by(s, point(at + 3u), point(at + 6u), point(at + 9u));
        for (var row = 0u; row < 32u; row++) {
            var points = 0u;
            if row >= h.first && row < h.end {
                let four = hidden_points(h, row & ~3u);
                points = four[row & 3u];
            }
            // In halves, which are whole numbers of a float.
            output[to + 2u * row] = f32(points & 0xffffu);
            output[to + 2u * row + 1u] = f32(points >> 16u);
        }
    }";

#[derive(Clone, Copy, Debug)]
struct Case {
    point: Vec3,
    corners: [Vec3; 3],
    error: f32,
    light: Vec2,
}

/// Points of a light around the origin.
struct Points {
    basis: DMat2,
    origin: DVec2,
    rows: Vec<u32>,
}

impl Points {
    fn new(count: u32) -> Points {
        let lattice = Lattice::new(count);
        let placed = lattice.placed(DVec2::splat(0.5 / f64::from(count)));
        Points { basis: lattice.basis, origin: placed.origin, rows: placed.rows }
    }

    fn words(&self, c: &Case) -> Vec<f32> {
        let inverse = self.basis.inverse();
        let size = c.light.as_dvec2();
        let (x, y) = (inverse.x_axis / size.x, inverse.y_axis / size.y);
        let center = inverse * (DVec2::splat(0.5) - self.origin);
        let [a, b, d] = c.corners;
        let points = [c.point, a, b, d].into_iter().flat_map(|v| v.to_array());
        let more = [x.x, x.y, y.x, y.y, center.x, center.y].map(|v| v as f32);
        points.chain([c.error]).chain(more).chain([self.rows.len() as f32]).collect()
    }

    /// A word a row, of the points that there are.
    fn on_gpu(&self, cases: &[Case]) -> Vec<Vec<u32>> {
        let input: Vec<f32> = cases.iter().flat_map(|c| self.words(c)).collect();
        let all = evaluate(KERNEL, &input, 20, 2 * ROWS);
        let word = |halves: &[f32], row: usize| halves[0] as u32 | (halves[1] as u32) << 16 & self.rows_mask(row);
        all.iter()
            .map(|o| o.chunks(2).enumerate().map(|(row, h)| word(h, row) & self.rows_mask(row)).collect())
            .collect()
    }

    fn rows_mask(&self, row: usize) -> u32 {
        self.rows.get(row).copied().unwrap_or(0)
    }

    /// Metres on the light.
    fn place(&self, c: &Case, row: usize, bit: u32) -> DVec3 {
        let p = self.origin + self.basis * DVec2::new(f64::from(bit), row as f64);
        ((p - 0.5) * c.light.as_dvec2()).extend(0.0)
    }

    fn each(&self) -> impl Iterator<Item = (usize, u32)> {
        let rows = self.rows.iter().enumerate();
        rows.flat_map(|(row, word)| (0..32).filter(move |bit| word >> bit & 1 != 0).map(move |bit| (row, bit)))
    }
}

/// Is a point of the light hidden? In double precision; `None` where it is too close to tell.
fn exact(c: &Case, light_point: DVec3) -> Option<bool> {
    let p = c.point.as_dvec3();
    let v = c.corners.map(|v| v.as_dvec3());
    let normal = (v[1] - v[0]).cross(v[2] - v[0]);
    let area = normal.length();
    let d = light_point - p;
    let along = normal.dot(d);
    let distance = (normal.dot(p - v[0]) / area).abs();
    let error = f64::from(c.error);
    let slant = (v[1] - v[0]).length() * (v[2] - v[0]).length() / area;
    let rounding = 2.4e-7 * (v[0].length() + (p - v[0]).length() * slant);
    if area < 1e-9 || (distance - error).abs() < 0.5 * error + 2.0 * rounding || along.abs() < 1e-3 * area * d.length()
    {
        return None;
    }
    let s = normal.dot(v[0] - p) / along;
    let hit = p + d * s;
    let reach = v.iter().fold(p.length(), |m, v| m.max(v.length()));
    let mut inside = true;
    for i in 0..3 {
        let (a, b) = (v[i], v[(i + 1) % 3]);
        let edge = (b - a).length();
        let aside = (b - a).cross(hit - a).dot(normal) / (area * edge);
        // Lines through corners are rounded to their directions; a short edge turns by more.
        if aside.abs() < 1e-6 * reach * (1.0 + reach / edge) * area * d.length() / along.abs() {
            return None;
        }
        inside &= aside > 0.0;
    }
    if s.abs() < 1e-3 || (s - 1.0).abs() < 1e-3 {
        return None;
    }
    Some(inside && s > 0.0 && s < 1.0 && distance > error)
}

#[test]
fn random_triangles_hide_the_points_that_they_hide_in_double_precision() {
    let points = Points::new(64);
    let mut random = Random(21);
    let cases: Vec<Case> = (0..4000)
        .map(|i| {
            let far = random.decades(-0.5, 1.0);
            let point = Vec3::new(random.within(-1.0, 1.0), random.within(-1.0, 1.0), random.within(0.3, 1.0)) * far;
            let light = Vec2::new(random.within(0.1, 0.6), random.within(0.1, 0.6)) * far;
            let on_light = (Vec2::new(random.unit(), random.unit()) - 0.5) * light;
            // Before the light, behind it, across its plane, beyond the point.
            let middle = point + (on_light.extend(0.0) - point) * random.within(-0.3, 1.3);
            let size = far * random.decades(-1.3, 0.3);
            let corners = [(); 3].map(|()| middle + random.direction() * size * random.unit());
            let corners = if i % 7 == 0 { [corners[0], corners[2], corners[1]] } else { corners };
            Case { point, corners, error: 1e-5 * far, light }
        })
        .collect();
    let (mut told, mut hidden) = (0u32, 0u32);
    for (words, case) in points.on_gpu(&cases).iter().zip(&cases) {
        for (row, bit) in points.each() {
            let Some(expected) = exact(case, points.place(case, row, bit)) else { continue };
            let got = words[row] >> bit & 1 != 0;
            assert_eq!(got, expected, "point {bit} of row {row}: {case:?}");
            told += 1;
            hidden += u32::from(expected);
        }
    }
    assert!(told > 200_000 && hidden > 20_000, "{told} can be told, {hidden} are hidden");
}

/// Two triangles that share an edge part the points between them: none is left out, none is counted twice.
#[test]
fn neighbours_part_the_points_between_them() {
    let points = Points::new(256);
    let mut random = Random(22);
    let mut cases = Vec::new();
    for i in 0..500 {
        let point = Vec3::new(random.within(-2.0, 2.0), random.within(-2.0, 2.0), random.within(4.0, 9.0));
        let light = Vec2::new(random.within(0.5, 2.0), random.within(0.5, 2.0));
        let z = random.within(0.3, 0.8) * point.z;
        let at = |x: f32, y: f32| Vec3::new(x, y, z);
        let shared = at(random.within(-0.4, 0.4) + 0.5 * point.x, random.within(-0.4, 0.4) + 0.5 * point.y);
        // The edge that they share passes over the light; every third is parallel to a row or to an axis.
        let end = shared + if i % 3 == 0 { Vec3::X } else { random.direction() * Vec3::new(1.0, 1.0, 0.0) } * 20.0;
        let start = shared * 2.0 - end;
        let aside = Vec3::new(start.y - end.y, end.x - start.x, 0.0);
        let of = |corners| Case { point, corners, error: 1e-5, light };
        cases.push([of([start, end, shared + aside]), of([end, start, shared - aside])]);
    }
    let words = points.on_gpu(&cases.concat());
    let mut parted = 0;
    for (pair, case) in words.chunks(2).zip(&cases) {
        for (row, (one, other)) in pair[0].iter().zip(&pair[1]).enumerate() {
            assert_eq!(one & other, 0, "row {row} is hidden twice: {case:?}");
        }
        let count = |words: &[u32]| words.iter().map(|w| w.count_ones()).sum::<u32>();
        parted += u32::from(count(&pair[0]) > 0 && count(&pair[1]) > 0);
    }
    assert!(parted > 100, "only {parted} pairs of triangles share the light");
}

#[test]
fn special_places_hide_the_points_that_they_should() {
    let points = Points::new(32);
    let v = Vec3::new;
    let below = v(0.0, 0.0, 10.0);
    let case = |corners| Case { point: below, corners, error: 1e-4, light: Vec2::splat(2.0) };
    let big = |z: f32| [v(-50.0, -50.0, z), v(50.0, -50.0, z), v(0.0, 90.0, z)];
    let nothing = |_: DVec3| false;
    let everything = |_: DVec3| true;
    type Expected = fn(DVec3) -> bool;
    let all: [(&str, Case, Expected); 9] = [
        ("over all of the light", case(big(5.0)), everything),
        ("behind the light", case(big(-1.0)), nothing),
        ("beyond the receiver", case(big(11.0)), nothing),
        ("the receiver's own surface", case(big(10.0)), nothing),
        ("seen edge-on", case([v(0.0, -9.0, 3.0), v(0.0, 9.0, 3.0), v(0.0, 0.0, 6.0)]), nothing),
        // A wall that begins behind the light's plane, meets it at x = 0.5, and leans away below it.
        ("through the light's plane", case([v(0.49, -90.0, -0.01), v(0.49, 90.0, -0.01), v(1.5, 0.0, 1.0)]), |p| {
            p.x > 0.5
        }),
        // A half-plane whose edge x = 0.25 lies half-way: it hides x > 0.5 on the light.
        ("half of the light", case([v(0.25, -90.0, 5.0), v(0.25, 90.0, 5.0), v(90.0, 0.0, 5.0)]), |p| p.x > 0.5),
        // It begins below the receiver's plane on its left and leans over it to x = 0.25 half-way to the light.
        ("through the facet", case([v(-1.0, -90.0, 12.0), v(-1.0, 90.0, 12.0), v(0.25, 0.0, 5.0)]), |p| p.x < 0.49),
        ("corners in a point", case([v(0.0, 0.0, 5.0); 3]), nothing),
    ];
    let got = points.on_gpu(&all.map(|(_, case, _)| case));
    for ((what, case, expected), words) in all.iter().zip(got) {
        for (row, bit) in points.each() {
            let place = points.place(case, row, bit);
            assert_eq!(words[row] >> bit & 1 != 0, expected(place), "{what}: the light's point {place}");
        }
    }
}
