//! A hierarchy that is built part by part: the triangles are halved until each part is small, each part gets a tree of
//! its own, and the halves are the tree above them.

use crate::bvh::{Bounds, Bvh, Node, tree};
use crate::geometry::{Geometry, Triangle};
use glam::Vec3;
use obvhs::BvhBuildParams;
use std::ops::Range;

/// Triangles of a part at most: its tree takes some tens of milliseconds.
const MOST: usize = 1 << 13;

/// A tree under construction: an iterator whose every step halves a run of triangles or builds the tree of a part.
pub(crate) struct PartsBuild {
    geometry: Geometry,
    /// The triangles in the order of the parts so far.
    ordered: Geometry,
    scale: Vec3,
    order: Vec<u32>,
    nodes: Vec<Node>,
    /// Nodes to fill, each with its run of the order.
    open: Vec<(usize, Range<usize>)>,
    /// Nodes above the parts, a parent before its children.
    inner: Vec<usize>,
}

const NOTHING: Node = Node { min: Vec3::ZERO, max: Vec3::ZERO, first: 0, count: 0 };

impl PartsBuild {
    /// Begins with all triangles in one run.
    pub fn new(geometry: Geometry) -> PartsBuild {
        let count = geometry.triangles.len();
        PartsBuild {
            ordered: Geometry {
                triangles: Vec::with_capacity(count),
                sources: Vec::with_capacity(count),
                cutouts: Vec::new(),
            },
            scale: geometry.triangles.iter().flat_map(|t| t.vertices).fold(Vec3::ZERO, |m, v| m.max(v.abs())),
            order: (0..count as u32).collect(),
            nodes: if count == 0 { Vec::new() } else { vec![NOTHING] },
            open: if count == 0 { Vec::new() } else { vec![(0, 0..count)] },
            inner: Vec::new(),
            geometry,
        }
    }

    /// The tree and the triangles in its order, once the iterator has ended.
    pub fn finish(mut self) -> (Bvh, Geometry) {
        for at in self.inner.into_iter().rev() {
            let first = self.nodes[at].first as usize;
            let (a, b) = (self.nodes[first], self.nodes[first + 1]);
            (self.nodes[at].min, self.nodes[at].max) = (a.min.min(b.min), a.max.max(b.max));
        }
        self.ordered.cutouts = self.geometry.cutouts;
        (Bvh { nodes: self.nodes }, self.ordered)
    }
}

impl Iterator for PartsBuild {
    type Item = ();

    fn next(&mut self) -> Option<()> {
        let (at, run) = self.open.pop()?;
        if run.len() <= MOST {
            add_part(&self.geometry, &self.order[run], self.scale, (&mut self.nodes, at), &mut self.ordered);
        } else {
            let middle = run.start + run.len() / 2;
            halve(&self.geometry.triangles, &mut self.order[run.clone()]);
            let first = self.nodes.len();
            self.nodes.extend([NOTHING; 2]);
            self.nodes[at].first = first as u32;
            self.inner.push(at);
            self.open.extend([(first, run.start..middle), (first + 1, middle..run.end)]);
        }
        Some(())
    }
}

/// Puts the half with the smaller coordinates first, along the axis on which the triangles' middles are spread most.
fn halve(triangles: &[Triangle], order: &mut [u32]) {
    let middle = |i: u32| triangles[i as usize].vertices.iter().sum::<Vec3>();
    let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for &i in order.iter() {
        (low, high) = (low.min(middle(i)), high.max(middle(i)));
    }
    let axis = (high - low).max_position();
    let half = order.len() / 2;
    order.select_nth_unstable_by(half, |&a, &b| middle(a)[axis].total_cmp(&middle(b)[axis]).then(a.cmp(&b)));
}

/// The tree of a part, its root at a place that is there already, and its triangles.
fn add_part(
    geometry: &Geometry,
    order: &[u32],
    scale: Vec3,
    (nodes, at): (&mut Vec<Node>, usize),
    ordered: &mut Geometry,
) {
    let bounds: Vec<Bounds> = order.iter().map(|&i| Bounds::of(&geometry.triangles[i as usize])).collect();
    let part = tree(&bounds, &BvhBuildParams::medium_build());
    let (node_base, triangle_base) = (nodes.len() as u32, ordered.triangles.len() as u32);
    let places = part.primitive_indices.iter().map(|&k| order[k as usize] as usize);
    places.clone().for_each(|i| ordered.triangles.push(geometry.triangles[i]));
    places.for_each(|i| ordered.sources.push(geometry.sources[i]));
    let mut moved = part.nodes.iter().map(|n| {
        let node = Node::of(n, scale);
        // All but the root are appended.
        let first = if node.count > 0 { node.first + triangle_base } else { node.first - 1 + node_base };
        Node { first, ..node }
    });
    nodes[at] = moved.next().expect("a part has triangles");
    nodes.extend(moved);
}

#[cfg(test)]
mod tests {
    use crate::tracer::{Ray, Tracer, TracerBuild};
    use glam::Vec3;

    #[test]
    fn rays_meet_the_same_as_in_one_tree() {
        // Several parts, and one.
        for spec in ["forest:trees=40", "square"] {
            let scene = antumbra_scene::builtin::build(spec).unwrap();
            let mut build = TracerBuild::new(&scene);
            let steps = build.by_ref().count();
            let (parts, whole) = (build.finish(), Tracer::new(&scene));
            assert_eq!(parts.triangle_count(), whole.triangle_count());
            let eye = scene.camera.eye;
            let mut met = 0;
            for k in 0..3000 {
                let turn = f64::from(k) * 0.618;
                let to = Vec3::new((4.0 * turn.sin()) as f32, (k % 50) as f32 * 0.05, (4.0 * turn.cos()) as f32);
                let ray = Ray::new(eye, to - eye);
                let [a, b] = [&parts, &whole].map(|t| t.nearest(&ray).map(|h| h.t));
                assert_eq!(a, b, "{spec}: ray {k}");
                assert_eq!(parts.occluded(eye, to), whole.occluded(eye, to), "{spec}: segment {k}");
                met += usize::from(a.is_some());
            }
            println!("{spec}: {} triangles, {steps} steps, {met} of 3000 rays met something", parts.triangle_count());
            assert!(met > 500, "{met}");
        }
    }
}
