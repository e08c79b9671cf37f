//! Guarantees of patches about the texels below them, tested by pyramids over maps that know the texels of each
//! surface.

use super::{Patch, merge};
use glam::DVec2;
use proptest::prelude::*;

/// Content of a map at a texel's centre.
#[derive(Clone, Copy, Debug)]
struct Texel {
    at: DVec2,
    q: f64,
}

#[derive(Clone, Debug)]
struct Node {
    patch: Patch,
    /// Of the nearer surface.
    near: Vec<Texel>,
    /// Of the farther one.
    far: Vec<Texel>,
    /// Of the nearer surface now, after having been of the farther one of a node below.
    raised: Vec<Texel>,
}

/// Square maps of inverse distances.
#[derive(Clone, Debug)]
struct Map {
    side: usize,
    q: Vec<f64>,
}

impl Map {
    fn of(side: usize, q: impl Fn(DVec2) -> f64) -> Map {
        let at = |i: usize| DVec2::new((i % side) as f64, (i / side) as f64) + 0.5;
        Map { side, q: (0..side * side).map(|i| q(at(i))).collect() }
    }

    fn at(&self, x: i32, y: i32) -> f64 {
        let inside = |v: i32| (0..self.side as i32).contains(&v);
        if inside(x) && inside(y) { self.q[y as usize * self.side + x as usize] } else { 0.0 }
    }

    /// As `slope_along` of `passes/patch_pyramid.wesl`.
    fn slope(&self, x: i32, y: i32) -> DVec2 {
        let along = |dx: i32, dy: i32| {
            let [a, before, q, after, b] = [-2, -1, 0, 1, 2].map(|k| self.at(x + k * dx, y + k * dy));
            if (q - 2.0 * before + a).abs() < (q - 2.0 * after + b).abs() { q - before } else { after - q }
        };
        DVec2::new(along(1, 0), along(0, 1))
    }

    fn texels(&self) -> Vec<Node> {
        let node = |i: usize| {
            let (x, y) = ((i % self.side) as i32, (i / self.side) as i32);
            let q = self.at(x, y);
            if q == 0.0 {
                return Node { patch: Patch::NONE, near: vec![], far: vec![], raised: vec![] };
            }
            let near = vec![Texel { at: DVec2::new(x.into(), y.into()) + 0.5, q }];
            Node { patch: Patch::plane(q, self.slope(x, y)), near, far: vec![], raised: vec![] }
        };
        (0..self.q.len()).map(node).collect()
    }

    /// All levels above the texels: of each its nodes' width in texels, and the nodes.
    fn levels(&self) -> Vec<(usize, Vec<Node>)> {
        let mut all = vec![(1, self.texels())];
        while let Some((width, below)) = all.last().filter(|(_, below)| below.len() > 1) {
            let row = self.side / width;
            let children = |i: usize| {
                let (x, y) = (2 * (i % (row / 2)), 2 * (i / (row / 2)));
                [0, 1, row, row + 1].map(|k| &below[y * row + x + k])
            };
            let next = (2 * width, (0..below.len() / 4).map(|i| merge_nodes(children(i))).collect());
            all.push(next);
        }
        all.split_off(1)
    }
}

fn merge_nodes(children: [&Node; 4]) -> Node {
    let (patch, middle) = merge(&children.map(|c| c.patch));
    let mut node = Node { patch, near: vec![], far: vec![], raised: vec![] };
    for c in children {
        let near = c.patch.near >= middle;
        (if near { &mut node.near } else { &mut node.far }).extend(&c.near);
        (if near { &mut node.raised } else { &mut node.far }).extend(&c.raised);
        (if c.patch.far >= middle { &mut node.raised } else { &mut node.far }).extend(&c.far);
    }
    node
}

/// Fields with ramps, steps, walls, holes and noise, and squares with a plane each.
fn any_map() -> impl Strategy<Value = Map> {
    let noise = prop::collection::vec(0.0f64..1.0, 256);
    let kind = (0..6, 0.1f64..3.0, 0.1f64..3.0, -0.3f64..0.3, -0.3f64..0.3, -20.0f64..20.0);
    (noise, kind, direction()).prop_map(|(noise, (kind, a, b, sx, sy, offset), turn)| {
        Map::of(16, move |at| {
            let n = noise[at.y as usize * 16 + at.x as usize];
            let ramp = |q: f64| (8.0 * q + (at - 8.0).dot(DVec2::new(sx, sy))).max(0.0);
            let beyond = at.dot(turn) > offset;
            match kind {
                0 => n,
                1 => ramp(if beyond { a } else { b }),
                2 => ramp(if beyond { a } else { 0.0 }) * f64::from(u8::from(beyond)),
                3 => ramp(a) + 0.1 * n,
                4 => {
                    if n > 0.7 {
                        0.0
                    } else {
                        ramp(if n > 0.4 { a } else { b })
                    }
                }
                _ => {
                    let [square, within] = [(at / 4.0).floor(), at.rem_euclid(DVec2::splat(4.0)) - 2.0];
                    let of = |k: usize| noise[(square.y as usize * 4 + square.x as usize) * 3 + k];
                    (1.0 + of(0) + within.dot(DVec2::new(of(1), of(2)) - 0.5)).max(0.0)
                }
            }
        })
    })
}

fn direction() -> impl Strategy<Value = DVec2> {
    (0.0f64..std::f64::consts::TAU).prop_map(DVec2::from_angle)
}

/// Violations of the patches' guarantees.
#[derive(Debug, Default)]
struct Beyond {
    /// Above their node's top.
    top: f64,
    /// Off their node's plane, more than its residual: texels that have always been of the nearer surface, and others.
    residual: f64,
    raised: f64,
}

fn beyond(map: &Map) -> Beyond {
    let mut beyond = Beyond::default();
    for (width, nodes) in map.levels() {
        let row = map.side / width;
        for (i, node) in nodes.iter().enumerate() {
            let middle = (DVec2::new((i % row) as f64, (i / row) as f64) + 0.5) * width as f64;
            let p = node.patch;
            for t in node.near.iter().chain(&node.far).chain(&node.raised) {
                beyond.top = beyond.top.max(t.q - p.top());
            }
            let off = |t: &Texel| (t.q - p.near - p.slope.dot((t.at - middle) / width as f64)).abs() - p.residual;
            beyond.residual = node.near.iter().map(off).fold(beyond.residual, f64::max);
            beyond.raised = node.raised.iter().map(off).fold(beyond.raised, f64::max);
        }
    }
    beyond
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(512) })]

    #[test]
    fn a_plane_of_any_slope_is_one_patch_at_every_level(q in 1e-3f64..1e3, turn in direction(), steep in 0.0f64..1.0) {
        // At most so steep that the plane stays before the map's eye.
        let slope = turn * steep * q / 12.0;
        let map = Map::of(16, |at| q + slope.dot(at - 8.0));
        for (width, nodes) in map.levels() {
            let row = 16 / width;
            for (i, p) in nodes.iter().map(|n| n.patch).enumerate() {
                let middle = (DVec2::new((i % row) as f64, (i / row) as f64) + 0.5) * width as f64;
                let off = (p.near - q - slope.dot(middle - 8.0)).abs().max((p.slope - slope * width as f64).length());
                prop_assert!(p.share == 1.0 && p.residual < 1e-12 * q && off < 1e-12 * q, "{width}: {p:?}");
            }
        }
    }

    #[test]
    fn texels_keep_to_the_top_of_their_node_and_to_its_residual(map in any_map()) {
        let beyond = beyond(&map);
        prop_assert!(beyond.top < 1e-9 && beyond.residual < 1e-9, "{beyond:?}");
    }

    #[test]
    #[ignore = "a farther surface that has become the nearer one is kept by its mean alone, and forgets its range"]
    fn texels_of_a_raised_surface_keep_to_its_residual(map in any_map()) {
        let beyond = beyond(&map);
        prop_assert!(beyond.raised < 1e-9, "{beyond:?}");
    }

    #[test]
    fn the_share_of_an_occluder_is_the_share_of_its_texels(
        near in 2.0f64..10.0, behind in 0.1f64..1.0, covered in prop::collection::vec(any::<bool>(), 64),
    ) {
        // Texels over nothing; over a ground, whose texels beside an occluder may be a ramp, squares of four texels.
        for (far, square) in [(0.0, 1), (behind, 4)] {
            let map = Map::of(8 * square, |at| {
                let [x, y] = [at.x, at.y].map(|v| v as usize / square);
                if covered[y * 8 + x] { near } else { far }
            });
            for (width, nodes) in map.levels() {
                for n in nodes {
                    let count = n.near.iter().chain(&n.far).chain(&n.raised).filter(|t| t.q == near).count();
                    let share = count as f64 / (width * width) as f64;
                    // Means are rounded, so two surfaces may lie at the one depth.
                    let part = |q: f64, share: f64| if (q - near).abs() < 1e-9 { share } else { 0.0 };
                    let kept = part(n.patch.near, n.patch.share) + part(n.patch.far, n.patch.far_share);
                    prop_assert!((kept - share).abs() < 1e-12, "{width}: {share}, {:?}", n.patch);
                }
            }
        }
    }
}

/// A quarter is a ramp from 0.25 to 1.75, one lies at 1.5, two at 1. The ramp's middle is nearer to those at 1, so it
/// is of the farther surface, though its upper end is nearer than all else.
#[test]
fn a_ramp_beside_a_plateau() {
    let map = Map::of(8, |at| match (at.x < 4.0, at.y < 4.0) {
        (true, true) => 0.5 * at.x,
        (false, true) => 1.5,
        _ => 1.0,
    });
    let beyond = beyond(&map);
    assert!(beyond.top < 1e-9, "{beyond:?}: {:?}", map.levels().last().map(|l| l.1[0].patch));
}
