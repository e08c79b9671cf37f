//! A hierarchy that is built part by part: the triangles are halved until each part is small, each part gets a tree of its
//! own, and the halves are the tree above them.

use crate::bvh::{Bounds, Bvh, Node, tree};
use crate::geometry::{Geometry, Triangle};
use glam::Vec3;
use obvhs::BvhBuildParams;

/// Triangles of a part at most: its tree takes some tens of milliseconds.
const MOST: usize = 1 << 13;

/// Builds the tree and puts the triangles in its order; none once `pause` says to stop.
pub(crate) async fn build(geometry: Geometry, pause: &mut impl AsyncFnMut() -> bool) -> Option<(Bvh, Geometry)> {
    let count = geometry.triangles.len();
    let mut ordered =
        Geometry { triangles: Vec::with_capacity(count), sources: Vec::with_capacity(count), cutouts: Vec::new() };
    if count == 0 {
        return Some((Bvh { nodes: Vec::new() }, geometry));
    }
    let scale = geometry.triangles.iter().flat_map(|t| t.vertices).fold(Vec3::ZERO, |m, v| m.max(v.abs()));
    let mut order: Vec<u32> = (0..count as u32).collect();
    let nothing = Node { min: Vec3::ZERO, max: Vec3::ZERO, first: 0, count: 0 };
    let mut nodes = vec![nothing];
    // Nodes to fill, each with its run of the order.
    let mut open = vec![(0usize, 0..count)];
    // Nodes above the parts, a parent before its children.
    let mut inner = Vec::new();
    while let Some((at, run)) = open.pop() {
        if run.len() <= MOST {
            add_part(&geometry, &order[run], scale, (&mut nodes, at), &mut ordered);
        } else {
            let middle = run.start + run.len() / 2;
            halve(&geometry.triangles, &mut order[run.clone()]);
            let first = nodes.len();
            nodes.extend([nothing; 2]);
            nodes[at].first = first as u32;
            inner.push(at);
            open.extend([(first, run.start..middle), (first + 1, middle..run.end)]);
        }
        if !pause().await {
            return None;
        }
    }
    for at in inner.into_iter().rev() {
        let first = nodes[at].first as usize;
        let (a, b) = (nodes[first], nodes[first + 1]);
        (nodes[at].min, nodes[at].max) = (a.min.min(b.min), a.max.max(b.max));
    }
    ordered.cutouts = geometry.cutouts;
    Some((Bvh { nodes }, ordered))
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
        // All but the root, which has its place, follow what is there.
        let first = if node.count > 0 { node.first + triangle_base } else { node.first - 1 + node_base };
        Node { first, ..node }
    });
    nodes[at] = moved.next().expect("a part has triangles");
    nodes.extend(moved);
}

#[cfg(test)]
mod tests {
    use crate::tracer::{Ray, Tracer};
    use antumbra_scene::slices::at_once;
    use glam::Vec3;

    #[test]
    fn rays_meet_the_same_as_in_one_tree() {
        // Several parts, and one.
        for spec in ["forest:trees=40", "square"] {
            let scene = antumbra_scene::builtin::build(spec).unwrap();
            let mut pauses = 0;
            let parts = at_once(Tracer::with_pauses(&scene, &mut async || {
                pauses += 1;
                true
            }));
            let (parts, whole) = (parts.unwrap(), Tracer::new(&scene));
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
            println!("{spec}: {} triangles, {pauses} pauses, {met} of 3000 rays met something", parts.triangle_count());
            assert!(met > 500, "{met}");
        }
    }

    #[test]
    fn nobody_waits() {
        let scene = antumbra_scene::builtin::build("square").unwrap();
        assert!(at_once(Tracer::with_pauses(&scene, &mut async || false)).is_none());
    }
}
