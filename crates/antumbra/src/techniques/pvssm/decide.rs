//! The kd-tree over the tile grid and the shelves of the pool on the CPU [Giegl and Wimmer 2007]: the paper's way, and
//! the twin of `kd_tree.wesl` and `decide.wesl`.

use super::PvssmSettings;
use super::plan::{Decided, LARGEST_NODE, MOST_OF_ROUND, MOST_TILES, Tile};
use glam::{UVec2, UVec4, Vec2};

/// The resolution that each cell needs: texels over the whole window along x and y; 0 where no kernel is.
#[derive(Clone, Debug)]
pub(crate) struct Grid {
    /// Level 0 is the grid, row by row; each further level has half the side and the maxima of four nodes.
    levels: Vec<Vec<Vec2>>,
    side: u32,
}

impl Grid {
    /// From the pyramid as `predict.wesl` stores it, level after level.
    pub fn of_stored(side: u32, stored: &[f32]) -> Grid {
        let mut rest = stored;
        let mut levels: Vec<Vec<Vec2>> = Vec::new();
        for level in 0..=side.ilog2() {
            let count = ((side >> level) * (side >> level)) as usize;
            let (own, after) = rest.split_at(2 * count);
            levels.push(own.chunks_exact(2).map(Vec2::from_slice).collect());
            rest = after;
        }
        // Resolutions of coarse levels are passed on to all cells below.
        for level in (1..levels.len()).rev() {
            let width = side >> (level - 1);
            for i in 0..levels[level - 1].len() as u32 {
                let above = levels[level][((i / width / 2) * (width / 2) + i % width / 2) as usize];
                let own = &mut levels[level - 1][i as usize];
                *own = own.max(above);
            }
        }
        Grid::of_cells(side, levels.swap_remove(0))
    }

    /// From its cells.
    pub fn of_cells(side: u32, cells: Vec<Vec2>) -> Grid {
        let mut levels = vec![cells];
        for level in 1..=side.ilog2() {
            let (width, below) = (side >> level, &levels[level as usize - 1]);
            let of = |i: u32| {
                let at = |dx, dy| below[((2 * (i / width) + dy) * 2 * width + 2 * (i % width) + dx) as usize];
                at(0, 0).max(at(1, 0)).max(at(0, 1)).max(at(1, 1))
            };
            levels.push((0..width * width).map(of).collect());
        }
        Grid { levels, side }
    }

    /// The highest resolution of the cells of a node.
    fn resolution(&self, node: Node) -> Vec2 {
        let level = node.level.min_element();
        let (first, count, width) = (node.low >> level, UVec2::ONE << (node.level - level), self.side >> level);
        let rows = first.y..first.y + count.y;
        let all = rows.flat_map(|y| (first.x..first.x + count.x).map(move |x| (y * width + x) as usize));
        all.map(|at| self.levels[level as usize][at]).fold(Vec2::ZERO, Vec2::max)
    }

    /// Texels of a node if all tiles are coarser by a factor; zero for a node without kernels.
    fn texels(&self, node: Node, coarser: f32) -> UVec2 {
        let needed = self.resolution(node) / coarser * (UVec2::ONE << node.level).as_vec2() / self.side as f32;
        if needed.x <= 0.0 { UVec2::ZERO } else { UVec2::new(in_steps(needed.x), in_steps(needed.y)) }
    }
}

/// A rectangle of cells whose sides are powers of two.
#[derive(Clone, Copy, Debug)]
struct Node {
    low: UVec2,
    level: UVec2,
}

impl Node {
    fn half(mut self, axis: usize, which: u32) -> Node {
        self.level[axis] -= 1;
        self.low[axis] += which << self.level[axis];
        self
    }
}

/// Rounds up to four steps per octave, and to whole nodes of the pyramid.
fn in_steps(texels: f32) -> u32 {
    let t = (texels.min(1.0e6).ceil() as u32).max(LARGEST_NODE);
    t.next_multiple_of((1 << (t.ilog2() - 2)).max(LARGEST_NODE))
}

/// See `kd_tree.wesl`.
const WORTH_SPLITTING: f32 = 65536.0;
const THRIFT: f32 = 0.5;
const COARSENING: f32 = std::f32::consts::SQRT_2;

/// The axis along which a node is split, if it is.
fn split_axis(grid: &Grid, node: Node, texels: UVec2, coarser: f32, settings: &PvssmSettings) -> Option<usize> {
    let excess = texels.as_vec2() / settings.tile as f32;
    if excess.max_element() > 1.0 {
        let first = usize::from(excess.y > excess.x);
        let other = 1 - first;
        return match node.level[first] > 0 {
            true => Some(first),
            false => (node.level[other] > 0 && excess[other] > 1.0).then_some(other),
        };
    }
    let area = |t: UVec2| (t.x * t.y) as f32;
    if !settings.thrifty || area(texels) < WORTH_SPLITTING {
        return None;
    }
    let halves = |axis: usize| (0..2).map(|i| area(grid.texels(node.half(axis, i), coarser))).sum::<f32>();
    let costs = (0..2).filter(|&axis| node.level[axis] > 0).map(|axis| (halves(axis), axis));
    let cheapest = costs.min_by(|a, b| a.0.total_cmp(&b.0));
    cheapest.filter(|(cost, _)| *cost < THRIFT * area(texels)).map(|(_, axis)| axis)
}

/// The leaves, along the Morton curve.
fn leaves(grid: &Grid, coarser: f32, settings: &PvssmSettings) -> Vec<(Node, UVec2)> {
    let mut found = Vec::new();
    let mut open = vec![Node { low: UVec2::ZERO, level: UVec2::splat(grid.side.ilog2()) }];
    while let Some(node) = open.pop() {
        let texels = grid.texels(node, coarser);
        if texels == UVec2::ZERO {
            continue;
        }
        match split_axis(grid, node, texels, coarser, settings) {
            Some(axis) => open.extend([node.half(axis, 0), node.half(axis, 1)]),
            None => found.push((node, texels.min(UVec2::splat(settings.tile / LARGEST_NODE * LARGEST_NODE)))),
        }
    }
    let bits = |v: u32| (0..8).map(|b| ((v >> b) & 1) << (2 * b)).sum::<u32>();
    found.sort_by_key(|(node, _)| bits(node.low.x) + 2 * bits(node.low.y));
    found
}

/// Puts tiles on shelves, the highest first.
fn pack(leaves: &[(Node, UVec2)], settings: &PvssmSettings, coarser: f32) -> Decided {
    let mut order: Vec<usize> = (0..leaves.len()).collect();
    order.sort_by_key(|&i| (std::cmp::Reverse([leaves[i].1.y, leaves[i].1.x]), i));
    let (mut tiles, mut round, mut of_round, mut at) = (Vec::new(), 0, 0, [0; 3]);
    for i in order {
        let (node, size) = leaves[i];
        if at[0] + size.x > settings.tile || size.y > at[2] {
            at = [0, at[1] + at[2], size.y];
        }
        if at[1] + size.y > settings.tile || of_round == MOST_OF_ROUND {
            (round, of_round, at) = (round + 1, 0, [0, 0, size.y]);
        }
        let cells = UVec2::ONE << node.level;
        let cells = UVec4::new(node.low.x, node.low.y, cells.x, cells.y);
        tiles.push(Tile { cells, position: UVec2::new(at[0], at[1]), texels: size, round, fresh: 1 });
        at[0] += size.x;
        of_round += 1;
    }
    let rounds = if tiles.is_empty() { 0 } else { round + 1 };
    Decided { tiles, rounds, kept: 0, coarser, shelf: at }
}

/// The plan for a grid; all tiles are drawn.
pub(crate) fn decide(grid: &Grid, settings: &PvssmSettings) -> Decided {
    let mut coarser = 1.0;
    for _ in 0..16 {
        let leaves = leaves(grid, coarser, settings);
        if leaves.len() <= MOST_TILES {
            let decided = pack(&leaves, settings, coarser);
            if decided.rounds <= settings.rounds {
                return decided;
            }
        }
        coarser *= COARSENING;
    }
    unreachable!("everything fits one tile when it is 256 times coarser")
}
