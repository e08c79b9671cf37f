//! No ray slips through a closed surface, whatever the coordinates, and the tree finds what a plain loop finds.

mod common;

use antumbra_reference::{Hit, Ray, Tracer};
use antumbra_scene::Mesh;
use common::{Random, camera, icosphere, light_above, mesh, scene};
use glam::{DVec3, Quat, Vec2, Vec3};

fn tracer(m: Mesh) -> Tracer {
    Tracer::new(&scene(vec![m], camera(Vec3::Z, Vec3::ZERO), light_above(1.0, Vec2::ONE)))
}

fn cube() -> Mesh {
    let corner = |i: u32| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32) * 2.0 - 1.0;
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    mesh((0..8).map(corner).collect(), faces.iter().flat_map(|&[a, b, c, d]| [a, b, c, a, c, d]).collect())
}

/// A torus around the y axis, radii 1 and 0.4.
fn torus() -> Mesh {
    let (n, m) = (48u32, 24u32);
    let turn = |i: u32, n: u32| std::f32::consts::TAU * i as f32 / n as f32;
    let point = |i: u32| {
        let (a, b) = (turn(i / m, n), turn(i % m, m));
        let r = 1.0 + 0.4 * b.cos();
        Vec3::new(r * a.cos(), 0.4 * b.sin(), r * a.sin())
    };
    let at = |i: u32, j: u32| (i % n) * m + j % m;
    let cells = (0..n).flat_map(|i| (0..m).map(move |j| (i, j)));
    let indices = cells.flat_map(|(i, j)| {
        let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
        [a, b, c, a, c, d]
    });
    mesh((0..n * m).map(point).collect(), indices.collect())
}

/// Turned, stretched by powers of ten, and moved: (name, mesh, a point inside).
fn closed_meshes() -> Vec<(String, Mesh, Vec3)> {
    let shapes =
        [("sphere", icosphere(3, Vec3::ZERO), Vec3::ZERO), ("cube", cube(), Vec3::ZERO), ("torus", torus(), Vec3::X)];
    let mut all = Vec::new();
    for (name, m, inside) in shapes {
        for (size, shift) in [(1e-3, 0.0), (1e-3, 10.0), (1.0, 0.0), (1.0, 1e3), (1e2, 1.0), (1e5, 0.0), (1e5, 1e5)] {
            let turn = Quat::from_euler(glam::EulerRot::XYZ, 0.3 * size, 0.7, 0.1);
            let place = |p: Vec3| turn * p * size + Vec3::new(0.6, -0.8, 0.3) * shift;
            let placed = Mesh { positions: m.positions.iter().map(|p| place(*p)).collect(), ..m.clone() };
            all.push((format!("{name} of {size} m at {shift} m"), placed, place(inside)));
        }
    }
    all
}

/// A point of a random triangle: a vertex, a point on an edge, or inside, as near as single precision gets.
fn aim(m: &Mesh, random: &mut Random) -> Vec3 {
    let k = (random.unit() * m.triangle_count() as f32) as usize * 3;
    let [a, b, c] = [0, 1, 2].map(|i| m.positions[m.indices[k + i] as usize]);
    match (random.unit() * 4.0) as u32 {
        0 => a,
        1 => (a + b) / 2.0,
        2 => a.lerp(b, random.unit()),
        _ => a.lerp(b, random.unit()).lerp(c, random.unit()),
    }
}

#[test]
fn no_ray_leaves_a_closed_mesh() {
    let mut random = Random::new(1);
    for (name, m, inside) in closed_meshes() {
        let t = tracer(m.clone());
        for _ in 0..10_000 {
            let target = aim(&m, &mut random);
            let d = target - inside;
            assert!(t.nearest(&Ray::new(inside, d)).is_some(), "{name}: from {inside} along {d} to {target}");
            let beyond = inside + d * 8.0;
            assert!(t.occluded(inside, beyond), "{name}: from {inside} to {beyond} by {target}");
        }
    }
}

#[test]
fn no_ray_enters_a_closed_mesh_unseen() {
    let mut random = Random::new(2);
    for (name, m, inside) in closed_meshes() {
        let t = tracer(m.clone());
        for _ in 0..5_000 {
            let target = aim(&m, &mut random);
            let outside = inside + (target - inside) * 8.0 + (target - inside).any_orthogonal_vector() * random.unit();
            assert!(t.occluded(outside, inside), "{name}: from {outside} to {inside} by {target}");
        }
    }
}

/// Axis-parallel rays run exactly in the faces of boxes and along edges, where zeros of directions meet zeros of
/// distances.
#[test]
fn axis_parallel_rays_meet_a_grid_at_its_vertices() {
    let n = 16u32;
    let point = |i: u32| Vec3::new((i % (n + 1)) as f32, 0.0, (i / (n + 1)) as f32);
    let cells = (0..n).flat_map(|i| (0..n).map(move |j| i * (n + 1) + j));
    let indices = cells.flat_map(|k| [k, k + 1, k + n + 2, k, k + n + 2, k + n + 1]).collect();
    let positions: Vec<Vec3> = (0..(n + 1) * (n + 1)).map(point).collect();
    let t = tracer(mesh(positions.clone(), indices));
    for p in positions {
        for d in [Vec3::NEG_Y, Vec3::new(0.0, -1.0, -0.0), Vec3::new(-0.0, -1.0, 0.0), Vec3::new(-0.0, -1.0, -0.0)] {
            let hit = t.nearest(&Ray::new(p + Vec3::Y, d));
            assert!(hit.is_some_and(|h| h.t == 1.0), "at {p} along {d}: {hit:?}");
            assert!(t.occluded(p + Vec3::Y, p - Vec3::Y), "at {p}");
        }
    }
}

#[test]
fn a_ray_that_leaves_a_convex_surface_never_meets_it_again() {
    let mut random = Random::new(3);
    for (name, m, inside) in closed_meshes().into_iter().filter(|(name, ..)| !name.starts_with("torus")) {
        let t = tracer(m.clone());
        for _ in 0..3_000 {
            let start = inside + (aim(&m, &mut random) - inside) * 3.0 + random.cube() * m.bounds().size().x * 0.1;
            let hit = t.nearest(&Ray::new(start, inside - start)).unwrap();
            let out = random.cube().normalize();
            let out = if out.dot(hit.normal.as_vec3()) < 0.0 { -out } else { out };
            let origin = t.off_surface(&hit);
            let direction = out * m.bounds().size().max_element();
            let again = t.nearest(&Ray::new(origin, direction));
            assert_eq!(again, None, "{name}: from {origin} along {direction}, left {hit:?}");
        }
    }
}

/// Nearest hit by testing every triangle in double precision, and whether it was a close call.
fn plain_nearest(m: &Mesh, ray: &Ray) -> (Option<f64>, bool) {
    let (o, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    let (mut best, mut close) = (None::<f64>, false);
    for corner in m.indices.chunks(3) {
        let [a, b, c] = [0, 1, 2].map(|k| m.positions[corner[k] as usize].as_dvec3() - o);
        let edges = [b.cross(c).dot(d), c.cross(a).dot(d), a.cross(b).dot(d)];
        let scale = edges.iter().fold(0.0f64, |s, e| s.max(e.abs()));
        let n: DVec3 = (b - a).cross(c - a);
        let t = n.dot(a) / n.dot(d);
        let inside = edges.iter().all(|e| *e > 0.0) || edges.iter().all(|e| *e < 0.0);
        close |= edges.iter().any(|e| e.abs() < 1e-4 * scale) || n.dot(d).abs() < 1e-4 * n.length() * d.length();
        if inside && t > f64::from(ray.t_min) && t < f64::from(ray.t_max) && best.is_none_or(|b| t < b) {
            best = Some(t);
        }
    }
    (best, close)
}

#[test]
fn the_tree_finds_what_a_plain_loop_finds() {
    let mut random = Random::new(4);
    let mut compared = 0;
    for count in [1u32, 2, 3, 7, 50, 200] {
        for _ in 0..4 {
            let center: Vec<Vec3> = (0..count).map(|_| random.cube() * 5.0).collect();
            let positions = (0..3 * count).map(|i| center[i as usize / 3] + random.cube()).collect();
            let m = mesh(positions, (0..3 * count).collect());
            let t = tracer(m.clone());
            for _ in 0..400 {
                let ray = Ray {
                    t_min: 0.5 * random.unit(),
                    t_max: 3.0,
                    ..Ray::new(random.cube() * 6.0, random.cube() * 4.0)
                };
                let (want, close) = plain_nearest(&m, &ray);
                if close && want.is_none() {
                    continue;
                }
                let got: Option<Hit> = t.nearest(&ray);
                if close {
                    continue;
                }
                compared += 1;
                assert_eq!(got.map(|h| h.t).is_some(), want.is_some(), "{ray:?}: {got:?}, plain {want:?}");
                if let (Some(h), Some(t)) = (got, want) {
                    assert!((h.t - t).abs() < 1e-5, "{ray:?}: {h:?}, plain {t}");
                }
                let whole = Ray { t_min: 0.0, t_max: 1.0, ..ray };
                let shadow = t.occluded(ray.origin, ray.origin + ray.direction);
                assert_eq!(shadow, plain_nearest(&m, &whole).0.is_some(), "{ray:?}");
            }
        }
    }
    assert!(compared > 5000, "{compared}");
}

#[test]
fn degenerate_triangles_are_never_hit() {
    let p = |x: f32| Vec3::new(x, 0.0, 0.0);
    let nan = Vec3::splat(f32::NAN);
    let m = mesh(vec![p(-1.0), p(0.0), p(1.0), nan], vec![0, 1, 2, 0, 0, 0, 0, 1, 3]);
    let t = tracer(m);
    assert_eq!(t.triangle_count(), 0);
    assert_eq!(t.nearest(&Ray::new(Vec3::Y, Vec3::NEG_Y)), None);
    assert!(!t.occluded(Vec3::Y, Vec3::NEG_Y));
}
