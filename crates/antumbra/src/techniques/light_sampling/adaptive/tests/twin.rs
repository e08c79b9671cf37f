//! The refinement tree in plain Rust, and its weights in double precision.

use glam::{DVec2, UVec2};
use std::collections::{BTreeMap, BTreeSet};

/// Level, column and row.
pub type Cell = (u32, u32, u32);

pub struct Tree {
    axes: UVec2,
    depth: u32,
    pub split: BTreeSet<Cell>,
    /// Places in the grid of all samples.
    pub samples: BTreeSet<u32>,
}

impl Tree {
    /// A tree of one cell.
    pub fn new(axes: UVec2, depth: u32) -> Tree {
        let mut tree = Tree { axes, depth, split: BTreeSet::new(), samples: BTreeSet::new() };
        tree.samples.extend(tree.corners((0, 0, 0)));
        tree
    }

    /// A tree of which these cells are split.
    pub fn of_splits(axes: UVec2, depth: u32, split: BTreeSet<Cell>) -> Tree {
        let mut tree = Tree::new(axes, depth);
        tree.samples.extend(split.iter().flat_map(|c| tree.added(*c)).collect::<Vec<_>>());
        Tree { split, ..tree }
    }

    fn along(&self, level: u32) -> UVec2 {
        UVec2::ONE + self.axes * ((1 << level) - 1)
    }

    /// All cells of a level, row by row, whether they are in the tree or not.
    pub fn cells_of(&self, level: u32) -> Vec<Cell> {
        let n = self.along(level);
        (0..n.y).flat_map(|y| (0..n.x).map(move |x| (level, x, y))).collect()
    }

    /// All cells, level by level: the order of the GPU's list.
    pub fn all_cells(&self) -> Vec<Cell> {
        (0..=self.depth).flat_map(|level| self.cells_of(level)).collect()
    }

    fn is_in_tree(&self, (level, x, y): Cell) -> bool {
        level == 0 || self.split.contains(&(level - 1, x / 2, y / 2))
    }

    pub fn leaves(&self) -> Vec<Cell> {
        self.all_cells().into_iter().filter(|c| self.is_in_tree(*c) && !self.split.contains(c)).collect()
    }

    /// The sample at so many half edges from a cell's first corner.
    fn sample(&self, (level, x, y): Cell, half_edges: UVec2) -> u32 {
        let edge = 1 << (self.depth - level);
        let at = (UVec2::new(x, y) * edge + half_edges * edge / 2) * self.axes;
        at.y * (self.along(self.depth).x + self.axes.x) + at.x
    }

    pub fn corners(&self, c: Cell) -> [u32; 4] {
        [(0, 0), (2, 0), (0, 2), (2, 2)].map(|(x, y)| self.sample(c, UVec2::new(x, y)))
    }

    /// The middles of a cell's edges and of the cell.
    fn added(&self, c: Cell) -> Vec<u32> {
        let ends = if self.axes == UVec2::ONE { vec![(1, 0), (0, 1), (1, 1), (2, 1), (1, 2)] } else { vec![(1, 1)] };
        ends.into_iter().map(|(x, y)| self.sample(c, UVec2::new(x, y))).collect()
    }

    /// Level by level: the largest measure first, the first in the list among equals, up to the first cell whose
    /// samples exceed the capacity.
    pub fn refine(&mut self, measure: impl Fn(Cell) -> f32, threshold: f32, capacity: usize) {
        for level in 0..self.depth {
            let mut wishes = self.cells_of(level);
            wishes.retain(|c| self.is_in_tree(*c) && measure(*c) >= threshold);
            wishes.sort_by(|a, b| measure(*b).total_cmp(&measure(*a)));
            for cell in wishes {
                let with: BTreeSet<u32> = self.samples.iter().copied().chain(self.added(cell)).collect();
                if with.len() > capacity {
                    break;
                }
                self.samples = with;
                self.split.insert(cell);
            }
        }
    }

    /// A leaf's area, a quarter to each corner.
    pub fn area_weights(&self) -> BTreeMap<u32, f64> {
        let mut weights = BTreeMap::new();
        for leaf in self.leaves() {
            let n = self.along(leaf.0).as_dvec2();
            for sample in self.corners(leaf) {
                *weights.entry(sample).or_insert(0.0) += 0.25 / (n.x * n.y);
            }
        }
        weights
    }

    /// [Schwärzler 2009, eq. 5 and 6]: by the finest subdivision that a sample has a part in, normalised.
    pub fn paper_weights(&self) -> BTreeMap<u32, f64> {
        let mut finest = BTreeMap::new();
        // Level by level, so that the finest comes last.
        for leaf in self.leaves() {
            finest.extend(self.corners(leaf).map(|s| (s, leaf.0)));
        }
        let power = self.axes.element_sum().max(1) as i32;
        let weight = |d: u32| (f64::from(1 << d) + 1.0).powi(-power);
        let sum: f64 = finest.values().map(|d| weight(*d)).sum();
        finest.into_iter().map(|(s, d)| (s, weight(d) / sum)).collect()
    }

    /// How far the leaves around a sample reach to half their edges, as parts of the light: towards smaller and towards
    /// larger coordinates.
    pub fn reach(&self, sample: u32) -> [DVec2; 2] {
        let mut reach = [DVec2::ZERO; 2];
        for leaf in self.leaves() {
            let half = self.axes.as_dvec2() * 0.5 / self.along(leaf.0).as_dvec2();
            for k in (0..4).filter(|k| self.corners(leaf)[*k] == sample) {
                // Corners with x = 1 (or y = 1) have the leaf on the side of smaller coordinates.
                let [x, y] = [1 - (k & 1), 1 - (k >> 1)];
                reach[x].x = reach[x].x.max(half.x);
                reach[y].y = reach[y].y.max(half.y);
            }
        }
        reach
    }
}
