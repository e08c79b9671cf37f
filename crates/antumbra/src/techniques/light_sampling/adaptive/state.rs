//! The shape of the tree, known to the host before the GPU decides, and the tree's buffers.

use super::{AdaptiveSamplingSettings, Criterion, LIGHT_VIEW, Space};
use crate::error::Error;
use crate::gpu::bindings::Binding;
use crate::gpu::device::Gpu;
use crate::gpu::readback::read_buffer;
use crate::gpu::recorder::Recorder;
use crate::gpu::resources::{BufferDescription, UniformArray, storage_bytes};
use crate::input::frame::BoundFrame;
use crate::passes::maps::light_maps::draw::Layers;
use crate::passes::maps::light_maps::{Evaluation, LightMaps, MapSlot, MapStage};
use crate::techniques::light_sampling::uniform::{Evaluate, Weights};
use crate::{binding_array, gpu_struct};
use glam::{UVec2, Vec2};
use std::ops::Range;

gpu_struct! {
    /// Constants of all shaders of the technique.
    pub(crate) struct AdaptiveUniform {
        /// Tiles of 8 x 8 points that are compared.
        tiles: UVec2,
        /// 1 for each edge that the light has.
        axes: UVec2,
        /// Finest level.
        depth: u32,
        /// Most samples.
        capacity: u32,
        /// 0 if measures are floats, 1 if they are numbers of points.
        criterion: u32,
        /// Measure from which on a cell is split.
        threshold: f32,
        gamma: f32,
        /// Pixels from one point to the next.
        stride: u32,
        /// Texels per side of the filter.
        width: i32,
        by_area: u32,
        /// Metres.
        light_size: Vec2,
        /// Largest change of visibility in a frame that the weights of a steady tree make.
        pace: f32,
        /// Blocks a side that a cell's window is read in, at most about.
        taps: f32,
    }
}

gpu_struct! {
    /// A round of refinement.
    pub(crate) struct PlanUniform {
        level: u32,
        /// 1 if maps of the last frame are still valid.
        maps_valid: u32,
        /// 1 if weights go to their goals at once.
        jump: u32,
    }
}

/// The finest level of a rectangle: more cost more than they show.
const DEEPEST_RECTANGLE: u32 = 5;

/// Points that are compared on the screen, at most about: the cost of a comparison does not depend on the image size.
const POINTS: f32 = 32_768.0;

/// See `AdaptiveUniform::pace`: too little to be seen as a jump.
const PACE: f32 = 0.01;

/// Layers that are drawn and added up at a time where memory is to be saved.
const CHUNK: u32 = 8;

/// In a [`MapSlot`]: not in the tree. See `tree.wesl`.
const UNUSED: u32 = u32::MAX;

/// The shape of the grid of samples: it depends on which edges the light has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shape {
    /// 1 for each edge that the light has.
    pub axes: UVec2,
    /// Finest level.
    pub depth: u32,
}

impl Shape {
    /// For a light of `size` metres.
    pub fn new(size: Vec2, depth: u32) -> Shape {
        let axes = UVec2::new(u32::from(size.x > 0.0), u32::from(size.y > 0.0));
        let deepest = [0, 7, DEEPEST_RECTANGLE][(axes.x + axes.y) as usize];
        Shape { axes, depth: depth.min(deepest) }
    }

    /// For a light of `size` metres, as fine as the settings can make it: by the local criterion, a cell that is
    /// smaller than the tolerance is never split.
    pub fn of_settings(size: Vec2, settings: &AdaptiveSamplingSettings) -> Shape {
        let shape = Shape::new(size, settings.depth);
        let can_split = |level: &u32| 1.0 / shape.cells_at(*level) as f32 >= settings.tolerance;
        match settings.criterion {
            Criterion::Local => Shape { depth: (0..shape.depth).take_while(can_split).count() as u32, ..shape },
            Criterion::Absolute | Criterion::Relative => shape,
        }
    }

    fn cells_at(&self, level: u32) -> u32 {
        1 << (level * (self.axes.x + self.axes.y))
    }

    fn cells(&self) -> u32 {
        (0..=self.depth).map(|level| self.cells_at(level)).sum()
    }

    /// Samples of a tree that is refined to `level` everywhere.
    pub fn samples_at(&self, level: u32) -> u32 {
        let along = |axis: u32| (1 << (level * axis)) + axis;
        along(self.axes.x) * along(self.axes.y)
    }

    /// All samples, row by row: places on the light in [-1/2, 1/2]².
    pub fn places(&self) -> Vec<Vec2> {
        let steps = (1 << self.depth) as f32;
        let count = self.axes * (1 << self.depth) + UVec2::ONE;
        let place = |i: UVec2| (i.as_vec2() / steps - 0.5) * self.axes.as_vec2();
        (0..count.y).flat_map(|y| (0..count.x).map(move |x| place(UVec2::new(x, y)))).collect()
    }

    /// The layers that the maps of a level can be drawn to: before them are those that surely exist, beyond them is
    /// nothing even if every cell was split.
    fn layers_of(&self, level: u32, capacity: u32) -> Range<u32> {
        // The first cell that is split in a round brings five samples on a rectangle, one on a line.
        let least = if self.axes == UVec2::ONE { 5 } else { 1 };
        let first = match level {
            0 => 0,
            1 => self.samples_at(0),
            _ => self.samples_at(1) + least * (level - 2),
        };
        first.min(capacity)..self.samples_at(level).min(capacity)
    }
}

/// Layers that are drawn together, and the place of their stage in the list of stages.
#[derive(Clone, Copy)]
pub(super) struct Chunk {
    pub index: u32,
    pub stage: MapStage,
}

/// The shape of the tree and its rounds: everything that the host knows before the GPU decides.
pub(super) struct TreePlan {
    pub key: TreeKey,
    pub shape: Shape,
    pub capacity: u32,
    /// True if only a chunk of the maps is in memory at a time.
    pub is_chunked: bool,
    /// Tiles that are compared.
    pub tiles: u32,
    /// Positions of all samples on the light.
    pub points: Vec<Vec2>,
    pub layers: Layers,
    uniform: AdaptiveUniform,
    stages: Vec<MapStage>,
    /// For each level, first with all maps drawn, then with static maps: its stages.
    chunks: [Vec<Range<u32>>; 2],
    pub evaluation: Evaluation,
}

/// The input that a plan depends on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TreeKey {
    image: [u32; 2],
    light_size: Vec2,
    clusters: u32,
    batches: usize,
}

impl TreeKey {
    pub fn of(frame: &BoundFrame) -> TreeKey {
        let casters = &frame.casters;
        let (image, light_size) = (frame.size, frame.light.size);
        TreeKey { image, light_size, clusters: casters.cluster_count, batches: casters.batches.len() }
    }
}

impl TreePlan {
    pub fn new(gpu: &Gpu, settings: &AdaptiveSamplingSettings, frame: &BoundFrame) -> Result<TreePlan, Error> {
        let key = TreeKey::of(frame);
        let shape = Shape::of_settings(key.light_size, settings);
        let capacity = Self::capacity(gpu, settings, shape);
        let at_once = Self::maps_at_once(gpu, settings, capacity);
        let layers = Layers::new(gpu, at_once, &frame.casters);
        let uniform = uniform_of(settings, shape, capacity, key.image, key.light_size);
        let mut stages = Vec::new();
        let chunks = [false, true].map(|is_static| {
            let slots = |level| if is_static { 0..capacity } else { shape.layers_of(level, capacity) };
            (0..=shape.depth).map(|level| push_stages(&mut stages, &layers, at_once, slots(level), level)).collect()
        });
        Ok(TreePlan {
            evaluation: Evaluation::new(gpu, settings.pcf, capacity, capacity)?,
            is_chunked: settings.evaluation == Evaluate::Accumulate,
            tiles: uniform.tiles.x * uniform.tiles.y,
            points: shape.places(),
            key,
            shape,
            capacity,
            layers,
            uniform,
            stages,
            chunks,
        })
    }

    /// Number of samples that the tree may have.
    fn capacity(gpu: &Gpu, settings: &AdaptiveSamplingSettings, shape: Shape) -> u32 {
        let most = shape.samples_at(shape.depth).min(settings.maps);
        match settings.evaluation {
            // The corners of the light are always drawn.
            Evaluate::Array => most.min(LightMaps::most(gpu, settings.map).max(shape.samples_at(0))),
            Evaluate::Accumulate => most,
        }
    }

    /// Number of maps in memory.
    fn maps_at_once(gpu: &Gpu, settings: &AdaptiveSamplingSettings, capacity: u32) -> u32 {
        match settings.evaluation {
            Evaluate::Array => capacity,
            // Whole groups of layers, so that chunks do not overlap.
            Evaluate::Accumulate => capacity.min(CHUNK.next_multiple_of(gpu.capabilities.layers_per_pass)),
        }
    }

    /// The index of a round in the list of plans.
    pub fn round(level: u32, maps_valid: bool, jump: bool) -> u32 {
        4 * level + 2 * u32::from(maps_valid) + u32::from(jump)
    }

    /// The stages that a round draws.
    pub fn chunks(&self, level: u32, is_static: bool) -> impl Iterator<Item = Chunk> {
        let range = self.chunks[usize::from(is_static)][level as usize].clone();
        range.map(|index| Chunk { index, stage: self.stages[index as usize] })
    }

    /// The tree's buffers, kept from frame to frame.
    pub fn tree(&self, recorder: &mut Recorder) -> Tree {
        let TreePlan { shape, capacity, uniform, .. } = self;
        let samples = shape.samples_at(shape.depth);
        let points = (uniform.tiles.x * uniform.tiles.y).next_multiple_of(64) * 64;
        let TreeKey { image, light_size, clusters, batches } = self.key;
        let key = [image[0], image[1], light_size.x.to_bits(), light_size.y.to_bits(), clusters, batches as u32];
        let key = bytemuck::bytes_of(&key);
        let mut words = |label, count: u32, words: u64| {
            recorder.buffer(label, BufferDescription::new(u64::from(count) * words * 4))
        };
        let tree = words("tree", 1, 12);
        let cells = words("tree cells", shape.cells(), 3);
        let grid = words("grid of samples", samples, 12);
        let active_cells = words("cells to compare", shape.cells(), 1);
        let fresh_layers = words("maps to reproject", samples.max(shape.cells()), 1);
        let entries = words("sample weights", capacity + 1, 8);
        let nowhere = || vec![0xff; 4 * samples as usize];
        let unused = || storage_bytes(&vec![MapSlot { sample: u32::MAX, stage: UNUSED }; *capacity as usize]);
        let rounds = (0..=shape.depth).flat_map(|level| {
            [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(maps_valid, jump)| PlanUniform { level, maps_valid, jump })
        });
        Tree {
            layer_of: recorder.buffer_of_key("layers of samples", key, nowhere),
            slots: recorder.buffer_of_key("map slots", key, unused),
            uniform: recorder.uniform("adaptive sampling", uniform),
            rounds: recorder.uniforms("refinement round", rounds),
            stages: recorder.uniforms("map stages", self.stages.iter().copied()),
            values: recorder
                .buffer("reprojected maps", BufferDescription::new(u64::from(*capacity) * u64::from(points) * 4)),
            tree,
            cells,
            grid,
            active_cells,
            fresh_layers,
            entries,
        }
    }
}

/// The tree on the GPU.
pub(super) struct Tree {
    pub uniform: wgpu::Buffer,
    pub rounds: UniformArray,
    pub stages: UniformArray,
    pub tree: wgpu::Buffer,
    pub cells: wgpu::Buffer,
    pub grid: wgpu::Buffer,
    pub layer_of: wgpu::Buffer,
    pub slots: wgpu::Buffer,
    pub active_cells: wgpu::Buffer,
    pub fresh_layers: wgpu::Buffer,
    pub values: wgpu::Buffer,
    pub entries: wgpu::Buffer,
}

impl Tree {
    /// The resources that the tree's shaders share.
    pub fn bindings(&self) -> [Binding<'_>; 8] {
        binding_array! {
            adaptive: &self.uniform,
            tree: &self.tree,
            cells: &self.cells,
            grid: &self.grid,
            layer_of: &self.layer_of,
            slots: &self.slots,
            active_cells: &self.active_cells,
            fresh_layers: &self.fresh_layers,
        }
    }

    /// Makes an empty tree of buffers that held another.
    pub fn reset(&self, recorder: &mut Recorder) {
        let zeroed = [&self.tree, &self.cells, &self.grid, &self.active_cells, &self.fresh_layers, &self.entries];
        zeroed.into_iter().for_each(|buffer| recorder.clear(buffer, None));
        recorder.clear(&self.values, None);
    }
}

/// Number of samples, and of maps that the last frame drew.
pub(super) async fn stats(gpu: &Gpu, tree: &wgpu::Buffer) -> Result<Vec<(&'static str, f64)>, Error> {
    let words: Vec<u32> = bytemuck::pod_collect_to_vec(&read_buffer(gpu, tree).await?);
    Ok(vec![("maps", words[3].into()), ("maps drawn", words[7].into())])
}

/// Appends the stages that draw a run of slots, `layers` at a time; returns their range in the list.
fn push_stages(stages: &mut Vec<MapStage>, layout: &Layers, layers: u32, slots: Range<u32>, level: u32) -> Range<u32> {
    let first = stages.len() as u32;
    let chunks = slots.start / layers..slots.end.div_ceil(layers);
    stages.extend(chunks.map(|chunk| {
        let base = chunk * layers;
        layout.stage(level, base, slots.start.saturating_sub(base)..(slots.end - base).min(layers))
    }));
    first..stages.len() as u32
}

fn uniform_of(
    settings: &AdaptiveSamplingSettings,
    shape: Shape,
    capacity: u32,
    image: [u32; 2],
    light_size: Vec2,
) -> AdaptiveUniform {
    let pixels = image[0] as f32 * image[1] as f32;
    let (size, stride) = match settings.space {
        Space::Camera => (image, (pixels / POINTS).sqrt().ceil().max(1.0) as u32),
        Space::Light => ([LIGHT_VIEW; 2], 1),
    };
    let tiles = UVec2::from(size.map(|s| s.div_ceil(8 * stride)));
    // A point stands for `stride`² pixels, or for the texels of a map that share its place in the light's view.
    let map_texels = (settings.map as f32).powi(2);
    let point_texels = match settings.space {
        Space::Camera => (stride * stride) as f32,
        Space::Light => map_texels / (LIGHT_VIEW * LIGHT_VIEW) as f32,
    };
    let is_local = settings.criterion == Criterion::Local;
    AdaptiveUniform {
        tiles,
        axes: shape.axes,
        depth: shape.depth,
        capacity,
        criterion: u32::from(!is_local),
        threshold: if is_local { settings.tolerance } else { settings.epsilon * map_texels / point_texels },
        gamma: settings.gamma,
        stride,
        width: settings.pcf as i32,
        by_area: u32::from(settings.weights == Weights::Area),
        light_size,
        pace: PACE,
        // An edge that moves crosses half as much of a cell at a time.
        taps: (settings.taps * if settings.steady { 2 } else { 1 }) as f32,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grid_has_its_samples_on_the_rim_and_lines_have_one_row() {
        let square = Shape::new(Vec2::ONE, 2);
        assert_eq!((square.samples_at(2), square.cells(), square.places().len()), (25, 21, 25));
        assert_eq!((square.places()[0], square.places()[24]), (Vec2::splat(-0.5), Vec2::splat(0.5)));
        let line = Shape::new(Vec2::Y, 3);
        assert_eq!((line.samples_at(3), line.cells(), line.places().len()), (9, 15, 9));
        assert!(line.places().iter().all(|p| p.x == 0.0));
        let point = Shape::new(Vec2::ZERO, 4);
        assert_eq!((point.depth, point.samples_at(0), point.places()), (0, 1, vec![Vec2::ZERO]));
    }

    #[test]
    fn a_tree_is_no_deeper_than_its_tolerance_lets_it_grow() {
        let depth = |size, tolerance| {
            let settings = AdaptiveSamplingSettings { tolerance, ..Default::default() };
            Shape::of_settings(size, &settings).depth
        };
        assert_eq!([1.0, 0.25, 0.07, 0.0625, 0.0].map(|t| depth(Vec2::ONE, t)), [1, 2, 2, 3, 4]);
        assert_eq!(depth(Vec2::X, 0.07), 4);
    }

    #[test]
    fn layers_of_a_level_begin_after_what_surely_exists() {
        let square = Shape::new(Vec2::ONE, 4);
        let ranges: Vec<_> = (0..=4).map(|level| square.layers_of(level, 128)).collect();
        assert_eq!(ranges, [0..4, 4..9, 9..25, 14..81, 19..128]);
        let line = Shape::new(Vec2::X, 3);
        assert_eq!((0..=3).map(|l| line.layers_of(l, 128)).collect::<Vec<_>>(), [0..2, 2..3, 3..5, 4..9]);
    }
}
