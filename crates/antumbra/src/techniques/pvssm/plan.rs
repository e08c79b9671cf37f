//! The tile grid, its pyramid and the plan of tiles that is made of it [Shen 2011, section 5.2, steps 4 to 6].

use super::PvssmSettings;
use super::analysis::Analysis;
use super::decide::{Grid, decide};
use crate::error::Error;
use crate::gpu::bindings::Binding;
use crate::gpu::debug_view::DebugLayout;
use crate::gpu::device::Gpu;
use crate::gpu::readback::read_buffer;
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::resources::{BufferDescription, UniformArray};
use crate::gpu::shader::ShaderKey;
use crate::input::casters::Casters;
use crate::input::frame::BoundFrame;
use crate::{binding_array, bindings, gpu_struct};
use glam::{UVec2, UVec4};
use pollster::block_on;

gpu_struct! {
    /// A rectangle of the map's window that is drawn at a resolution of its own.
    pub(crate) struct Tile {
        /// First cell of the grid and number of cells, each along x and y.
        cells: UVec4,
        /// First texel in the pool.
        position: UVec2,
        /// Texels along x and y.
        texels: UVec2,
        /// The filling of the pool that holds it.
        round: u32,
        /// 1 if it is drawn in this frame, 0 if it is kept.
        fresh: u32,
    }
}

gpu_struct! {
    /// One filling of the pool.
    pub(crate) struct RoundUniform {
        round: u32,
    }
}

gpu_struct! {
    /// The input of a decision besides the grid.
    pub(crate) struct DecisionUniform {
        /// 1 if the tiles of the last plan are valid.
        may_keep: u32,
    }
}

/// Tiles of a frame, at most; see `tiles.wesl`.
pub(crate) const MOST_TILES: usize = 256;
/// Rounds of a frame, at most.
pub(crate) const MOST_ROUNDS: usize = 16;
/// Tiles of a round, at most; see `decide.wesl`.
pub(crate) const MOST_OF_ROUND: usize = 64;
/// Texels per side of the coarsest nodes over the pool; see `tiles.wesl`.
pub(crate) const LARGEST_NODE: u32 = 16;
/// Words of a round's arguments before those of its batches.
const ROUND_WORDS: u64 = 10;
/// Words before the tiles in the plan, and of a tile.
const HEADER_WORDS: usize = 8 + 4 * MOST_ROUNDS;
const TILE_WORDS: usize = 12;

/// A plan on the CPU.
#[derive(Clone, Debug, Default)]
pub(crate) struct Decided {
    /// The tiles, in the order of their rounds.
    pub tiles: Vec<Tile>,
    /// Fillings of the pool.
    pub rounds: u32,
    /// Tiles that are kept from the last frame.
    pub kept: u32,
    /// Factor by which all tiles are coarser than needed.
    pub coarser: f32,
    /// Position of the next tile, x and y, and height of the last shelf.
    pub shelf: [u32; 3],
}

impl Decided {
    /// Names and values for reports.
    pub fn stats(&self) -> Vec<(&'static str, f64)> {
        let texels: u64 = self.tiles.iter().map(|t| u64::from(t.texels.x) * u64::from(t.texels.y)).sum();
        vec![
            ("tiles", self.tiles.len() as f64),
            ("tiles kept", f64::from(self.kept)),
            ("rounds", f64::from(self.rounds)),
            ("megatexels", texels as f64 / f64::from(1 << 20)),
            ("coarser", f64::from(self.coarser)),
        ]
    }

    /// The plan's words, as in `tiles.wesl`.
    fn words(&self) -> Vec<u32> {
        let [x, y, height] = self.shelf;
        let mut words = vec![self.tiles.len() as u32, self.rounds, self.kept, self.coarser.to_bits(), x, y, height, 0];
        for round in 0..MOST_ROUNDS as u32 {
            let of_round = || self.tiles.iter().filter(|t| t.round == round);
            let first = self.tiles.iter().position(|t| t.round == round).unwrap_or(self.tiles.len());
            let drawn = of_round().filter(|t| t.fresh != 0).count();
            let [x, y] = self.end_of_round(round).to_array();
            words.extend([first as u32, of_round().count() as u32, drawn as u32, x | y << 16]);
        }
        for t in &self.tiles {
            words.extend(t.cells.to_array());
            words.extend([t.position.x, t.position.y, t.texels.x, t.texels.y, t.round, t.fresh, 0, 0]);
        }
        words
    }

    /// Reads a `TilePlan`. Waits for the GPU: for tests and reports.
    pub async fn read(gpu: &Gpu, plan: &wgpu::Buffer) -> Result<Decided, Error> {
        let words: Vec<u32> = bytemuck::pod_collect_to_vec(&read_buffer(gpu, plan).await?);
        let tile = |w: &[u32]| Tile {
            cells: UVec4::from_slice(w),
            position: UVec2::from_slice(&w[4..]),
            texels: UVec2::from_slice(&w[6..]),
            round: w[8],
            fresh: w[9],
        };
        let tiles = words[HEADER_WORDS..].chunks_exact(TILE_WORDS).take(words[0] as usize).map(tile).collect();
        let shelf = [words[4], words[5], words[6]];
        Ok(Decided { tiles, rounds: words[1], kept: words[2], coarser: f32::from_bits(words[3]), shelf })
    }

    /// The number of each cell's tile plus one, 0 for none.
    pub fn cells(&self, grid: u32) -> Vec<u32> {
        let mut cells = vec![0; (grid * grid) as usize];
        for (i, tile) in self.tiles.iter().enumerate() {
            let [x, y, width, height] = tile.cells.to_array();
            for row in y..y + height {
                cells[(row * grid + x) as usize..][..width as usize].fill(i as u32 + 1);
            }
        }
        cells
    }

    /// End of the tiles that a round draws, in largest nodes from the pool's corner.
    fn end_of_round(&self, round: u32) -> UVec2 {
        let drawn = self.tiles.iter().filter(|t| t.round == round && t.fresh != 0);
        drawn.map(|t| (t.position + t.texels) / LARGEST_NODE).fold(UVec2::ZERO, UVec2::max)
    }

    /// The indirect arguments of each round: the draw that clears its tiles, the pyramid over them, the culling of each
    /// batch, which takes this many workgroups.
    pub fn arguments(&self, rounds: u32, batches: &[u32]) -> Vec<u32> {
        let of_round = |round: u32| {
            let drawn = self.tiles.iter().filter(|t| t.round == round && t.fresh != 0).count() as u32;
            let cull = batches.iter().flat_map(move |groups| {
                let groups = if drawn > 0 { *groups } else { 0 };
                [groups.min(1 << 15), groups.div_ceil(1 << 15), 1]
            });
            let [x, y] = self.end_of_round(round).to_array();
            let reduce = [x.div_ceil(2), y.div_ceil(2), 1, x.div_ceil(8), y.div_ceil(8), 1];
            [6, drawn, 0, 0].into_iter().chain(reduce).chain(cull).collect::<Vec<u32>>()
        };
        (0..rounds).flat_map(of_round).collect()
    }
}

/// Stores the resolution that each kernel needs in the grid's pyramid: two numbers per node.
pub(crate) fn predict(
    recorder: &mut Recorder,
    frame: &BoundFrame,
    settings: &PvssmSettings,
    uniform: &wgpu::Buffer,
    analysis: &Analysis,
) -> Result<wgpu::Buffer, Error> {
    let side = settings.grid;
    let nodes: u64 = (0..=side.ilog2()).map(|level| u64::from(side >> level).pow(2)).sum();
    let help = "resolution that each cell of the window needs, as texels over the whole window: along x, along y";
    let layout = DebugLayout::Numbers { stride: 2, channels: 2, size: [side; 2], list: None };
    let grid = recorder.buffer("tile grid", BufferDescription::new(8 * nodes).cleared().debug(help, layout));
    let pipeline =
        recorder.gpu.compute_pipeline(&ShaderKey::new("techniques::pvssm::predict"), "predict_resolution")?;
    let own = bindings! { pvssm: uniform, grid_nodes: &grid };
    let set = [&frame.bindings()[..], &analysis.bindings(), own];
    recorder.compute("tile grid", &pipeline, &set, Work::Indirect(&analysis.list.tiles, 0))?;
    Ok(grid)
}

/// The plan on the GPU, which [`Plan::decide`] or [`Plan::decide_on_the_cpu`] fills.
pub(crate) struct Plan {
    /// A `PvssmUniform`.
    uniform: wgpu::Buffer,
    /// A `TilePlan`; see `tiles.wesl`. It stays from frame to frame, as the tiles do.
    pub tiles: wgpu::Buffer,
    /// The tile of each cell.
    pub cells: wgpu::Buffer,
    /// Indirect arguments; see [`Decided::arguments`].
    pub arguments: wgpu::Buffer,
    /// A `RoundUniform` for each round.
    pub rounds: UniformArray,
    /// Workgroups that cull each batch.
    batch_groups: Vec<u32>,
    most_rounds: u32,
}

impl Plan {
    /// A plan for these casters, to be filled.
    pub fn ask(recorder: &mut Recorder, casters: &Casters, settings: &PvssmSettings, uniform: &wgpu::Buffer) -> Plan {
        let batch_groups = batch_groups(casters);
        let (side, rounds) = (u64::from(settings.grid), settings.rounds);
        let mut buffer = |label, words| recorder.buffer(label, BufferDescription::new(4 * words));
        Plan {
            uniform: uniform.clone(),
            tiles: buffer("tile plan", (HEADER_WORDS + TILE_WORDS * MOST_TILES) as u64),
            cells: buffer("tile of each cell", side * side),
            arguments: buffer("tile arguments", u64::from(rounds) * (ROUND_WORDS + 3 * batch_groups.len() as u64)),
            rounds: recorder.uniforms("rounds", (0..rounds).map(|round| RoundUniform { round })),
            batch_groups,
            most_rounds: rounds,
        }
    }

    /// Decides on the GPU; tiles of the plan `drawn` may be kept. Returns the number of rounds to record: all of them,
    /// as the host does not learn how many there are.
    pub fn decide(
        &self,
        recorder: &mut Recorder,
        grid: &wgpu::Buffer,
        drawn: Option<wgpu::Buffer>,
    ) -> Result<u32, Error> {
        // Every recorded frame requests both plan and pool: if the plan is the same one, so is the pool.
        let may_keep = u32::from(drawn.as_ref() == Some(&self.tiles));
        let decision = recorder.uniform("tile decision", &DecisionUniform { may_keep });
        let key = bytemuck::cast_slice(&self.batch_groups);
        let groups = recorder.buffer_of_key("workgroups of batches", key, || key.to_vec());
        let pipeline = recorder.gpu.compute_pipeline(&ShaderKey::new("techniques::pvssm::decide"), "decide")?;
        let set = bindings! {
            pvssm: &self.uniform,
            decision: &decision,
            made_plan: &self.tiles,
            made_cells: &self.cells,
            resolutions: grid,
            tile_arguments: &self.arguments,
            batch_groups: &groups,
        };
        recorder.compute("tile decision", &pipeline, &[set], Work::Groups([1, 1, 1]))?;
        Ok(self.most_rounds)
    }

    /// Submits the passes recorded so far, waits for the grid and decides on the CPU. Returns the number of rounds.
    pub fn decide_on_the_cpu(
        &self,
        recorder: &mut Recorder,
        grid: &wgpu::Buffer,
        settings: &PvssmSettings,
    ) -> Result<u32, Error> {
        let gpu = recorder.gpu;
        let before = std::mem::replace(recorder.encoder(), gpu.device.create_command_encoder(&Default::default()));
        gpu.queue.submit([before.finish()]);
        let stored: Vec<f32> = bytemuck::pod_collect_to_vec(&block_on(read_buffer(gpu, grid))?);
        let decided = decide(&Grid::of_stored(settings.grid, &stored), settings);
        for (buffer, words) in [
            (&self.tiles, decided.words()),
            (&self.cells, decided.cells(settings.grid)),
            (&self.arguments, decided.arguments(self.most_rounds, &self.batch_groups)),
        ] {
            gpu.queue.write_buffer(buffer, 0, bytemuck::cast_slice(&words));
        }
        Ok(decided.rounds)
    }

    /// The resources of `tiles.wesl`.
    pub fn bindings(&self) -> [Binding<'_>; 3] {
        binding_array! { pvssm: &self.uniform, tile_plan: &self.tiles, tile_of_cell: &self.cells }
    }

    /// First byte of the arguments of the draw that clears a round's tiles.
    pub fn clear_offset(&self, round: u32) -> u64 {
        4 * u64::from(round) * (ROUND_WORDS + 3 * self.batch_groups.len() as u64)
    }

    /// First byte of the arguments of two levels of the pyramid over a round's tiles.
    pub fn reduce_offset(&self, round: u32, step: u32) -> u64 {
        self.clear_offset(round) + 16 + 12 * u64::from(step)
    }

    /// First byte of the arguments of the culling of a batch in a round.
    pub fn cull_offset(&self, round: u32, batch: usize) -> u64 {
        self.clear_offset(round) + 4 * ROUND_WORDS + 12 * batch as u64
    }
}

/// Workgroups that cull each batch, with one entry at least: a binding is never empty.
pub(crate) fn batch_groups(casters: &Casters) -> Vec<u32> {
    let groups: Vec<u32> = casters.batches.iter().map(|b| b.cluster_count.div_ceil(64)).collect();
    if groups.is_empty() { vec![0] } else { groups }
}
