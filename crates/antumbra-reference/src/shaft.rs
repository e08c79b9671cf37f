//! The part of the hierarchy that can stand between a pixel's points and the light.

use crate::bvh::{Bvh, Node};
use antumbra_scene::Aabb;
use glam::DVec3;

/// Subtrees that one list may hold: enough to skip the top of the tree, few enough to be cheap for every packet.
const MOST_ENTRIES: usize = 24;

/// All segments from one box to another.
pub(crate) struct Shaft {
    from: [DVec3; 2],
    to: [DVec3; 2],
}

impl Shaft {
    /// Segments from any point of `from` to any point of `to`.
    pub fn new(from: Aabb, to: Aabb) -> Shaft {
        // Rays round their directions, so a segment may end a little outside of the box.
        let slack = (to.max.abs().max(to.min.abs()).max(from.max.abs()).max(from.min.abs()) * 1e-6).as_dvec3();
        Shaft {
            from: [from.min.as_dvec3() - slack, from.max.as_dvec3() + slack],
            to: [to.min.as_dvec3() - slack, to.max.as_dvec3() + slack],
        }
    }

    /// Can a segment meet the node's box? At the part t of the way the segments are in the box that interpolates the
    /// two: per axis this overlaps the node for an interval of t, and all three must have some t in common.
    fn meets(&self, node: &Node) -> bool {
        let (mut enter, mut leave) = (0.0f64, 1.0f64);
        let mut above = |from: f64, to: f64, bound: f64| {
            // from + t (to - from) >= bound
            let (rise, need) = (to - from, bound - from);
            if rise > 0.0 {
                enter = enter.max(need / rise);
            } else if rise < 0.0 {
                leave = leave.min(need / rise);
            } else if need > 0.0 {
                leave = f64::NEG_INFINITY;
            }
        };
        let (min, max) = (node.min.as_dvec3(), node.max.as_dvec3());
        for k in 0..3 {
            above(self.from[1][k], self.to[1][k], min[k]);
            above(-self.from[0][k], -self.to[0][k], -max[k]);
        }
        enter <= leave
    }

    /// Nodes below which everything lies that a segment can meet. Empty only if nothing can be met.
    pub fn entries(&self, bvh: &Bvh, out: &mut Vec<u32>) {
        out.clear();
        if bvh.nodes.first().is_some_and(|root| self.meets(root)) {
            out.push(0);
        }
        // Breadth first: `done` counts the leaves that have been put in front.
        let mut done = 0;
        while done < out.len() && out.len() < MOST_ENTRIES {
            let node = &bvh.nodes[out[done] as usize];
            if node.count > 0 {
                done += 1;
                continue;
            }
            out.remove(done);
            out.extend([node.first, node.first + 1].into_iter().filter(|&c| self.meets(&bvh.nodes[c as usize])));
        }
    }
}
