//! The bounding volume hierarchy: built by `obvhs`, kept in our own small nodes with boxes made safe for rounding.

use crate::geometry::{Geometry, Triangle};
use glam::{Vec3, Vec3A};
use obvhs::bvh2::{Bvh2, leaf_collapser::collapse, node::Bvh2Node, reinsertion::ReinsertionOptimizer};
use obvhs::{BvhBuildParams, aabb, ploc::PlocBuilder};

/// A box and its content: two nodes side by side, or a run of triangles.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node {
    pub min: Vec3,
    /// First triangle of a leaf, or the first of the two children.
    pub first: u32,
    pub max: Vec3,
    /// Number of triangles in a leaf, zero for an inner node.
    pub count: u32,
}

/// A binary tree over triangles that stand in leaf order; no nodes if there are no triangles.
pub(crate) struct Bvh {
    pub nodes: Vec<Node>,
}

pub(crate) struct Bounds(aabb::Aabb);

impl obvhs::Boundable for Bounds {
    fn aabb(&self) -> aabb::Aabb {
        self.0
    }
}

impl Bounds {
    /// Of a triangle.
    pub fn of(triangle: &Triangle) -> Bounds {
        Bounds(aabb::Aabb::from_points(&triangle.vertices.map(Vec3A::from)))
    }
}

impl Bvh {
    /// Builds the tree and puts the triangles in its order.
    pub fn build(geometry: &mut Geometry) -> Bvh {
        if geometry.triangles.is_empty() {
            return Bvh { nodes: Vec::new() };
        }
        let bounds: Vec<Bounds> = geometry.triangles.iter().map(Bounds::of).collect();
        let bvh = tree(&bounds, &BvhBuildParams::medium_build());
        geometry.reorder(&bvh.primitive_indices);
        let scale = geometry.triangles.iter().flat_map(|t| t.vertices).fold(Vec3::ZERO, |m, v| m.max(v.abs()));
        Bvh { nodes: bvh.nodes.iter().map(|n| Node::of(n, scale)).collect() }
    }
}

impl Node {
    /// A node of `obvhs`; no coordinate of the scene is larger than `scale`.
    pub fn of(node: &Bvh2Node, scale: Vec3) -> Node {
        let (min, max) = (Vec3::from(node.aabb().min), Vec3::from(node.aabb().max));
        Node { min: min - pad(min, scale), max: max + pad(max, scale), first: node.first_index, count: node.prim_count }
    }
}

/// The steps of `obvhs::bvh2::builder::build_bvh2`, which also takes the time: there is no such clock in a browser.
pub(crate) fn tree(bounds: &[Bounds], how: &BvhBuildParams) -> Bvh2 {
    let indices = (0..bounds.len() as u32).collect();
    let mut builder = PlocBuilder::with_capacity(bounds.len());
    let mut bvh =
        builder.build(how.ploc_search_distance, bounds, indices, how.sort_precision, how.search_depth_threshold);
    let mut optimizer = ReinsertionOptimizer::default();
    optimizer.run(&mut bvh, how.reinsertion_batch_ratio, None);
    collapse(&mut bvh, how.max_prims_per_leaf.clamp(1, 255), how.collapse_traversal_cost);
    let rest = how.reinsertion_batch_ratio * how.post_collapse_reinsertion_batch_ratio_multiplier;
    optimizer.run(&mut bvh, rest, None);
    bvh
}

/// Keeps a ray that runs exactly in a face of the box inside of it, whatever the sign of a zero direction.
fn pad(bound: Vec3, scale: Vec3) -> Vec3 {
    bound.abs() * f32::EPSILON + scale * 1e-12 + Vec3::splat(1e-24)
}
