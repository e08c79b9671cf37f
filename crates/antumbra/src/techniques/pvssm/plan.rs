//! The tile grid, its pyramid and the plan of tiles that is made of it [Shen 2011, section 5.2, steps 4 to 6].

use super::decide::{Grid, decide};
use super::{PvssmSettings, PvssmUniform, analysis::Analysis};
use crate::input::casters::Casters;
use crate::input::frame::FrameUniform;
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::resources::{buffer_of, read_buffer, storage_buffer, uniform};
use crate::gpu::shader::{HostStruct, ShaderKey};
use crate::technique::{InnerContent, InnerPicture, Memory};
use crate::error::Error;
use crate::input::frame::Frame;
use crate::gpu::device::Gpu;
use crate::{bindings, gpu_struct};
use glam::{UVec2, UVec4};

gpu_struct! {
    /// A part of the map's window that is drawn at a resolution of its own.
    pub(crate) struct Tile {
        /// First cell of the grid, along x and y, and how many.
        cells: UVec4,
        /// First texel in the pool.
        place: UVec2,
        /// Texels along x and y.
        texels: UVec2,
        /// When it is in the pool.
        round: u32,
        /// 1 if it is drawn in this frame, 0 if it is kept.
        fresh: u32,
    }
}

/// Tiles of a frame, at most; see `tiles.wesl`.
pub(crate) const MOST_TILES: usize = 256;
/// Rounds of a frame, at most.
pub(crate) const MOST_ROUNDS: usize = 16;
/// Tiles of a round, at most; see `decide.wesl`.
pub(crate) const MOST_OF_ROUND: usize = 64;
/// Texels a side of the coarsest nodes over the pool; see `tiles.wesl`.
pub(crate) const LARGEST_NODE: u32 = 16;
/// Words of a round's arguments before those of its batches.
const ROUND_WORDS: u64 = 10;
/// Words before the tiles in the plan, and of a tile.
const HEADER_WORDS: usize = 8 + 4 * MOST_ROUNDS;
const TILE_WORDS: usize = 12;

/// What was decided.
#[derive(Clone, Debug, Default)]
pub(crate) struct Decided {
    /// The tiles, in the order of their rounds.
    pub tiles: Vec<Tile>,
    /// How often the pool is filled.
    pub rounds: u32,
    /// Tiles that are kept from the frame before.
    pub kept: u32,
    /// How much coarser than asked for all tiles are.
    pub coarser: f32,
    /// Where the next tile may be put: x, y and height of the last shelf.
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
            words.extend([t.place.x, t.place.y, t.texels.x, t.texels.y, t.round, t.fresh, 0, 0]);
        }
        words
    }

    fn of_words(words: &[u32]) -> Decided {
        let tile = |w: &[u32]| Tile {
            cells: UVec4::from_slice(w),
            place: UVec2::from_slice(&w[4..]),
            texels: UVec2::from_slice(&w[6..]),
            round: w[8],
            fresh: w[9],
        };
        let tiles = words[HEADER_WORDS..].chunks_exact(TILE_WORDS).take(words[0] as usize).map(tile).collect();
        let shelf = [words[4], words[5], words[6]];
        Decided { tiles, rounds: words[1], kept: words[2], coarser: f32::from_bits(words[3]), shelf }
    }

    /// For each cell its tile's number plus one, 0 where there is none.
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

    /// Where the tiles end that a round draws anew, in the largest nodes from the pool's corner.
    fn end_of_round(&self, round: u32) -> UVec2 {
        let drawn = self.tiles.iter().filter(|t| t.round == round && t.fresh != 0);
        drawn.map(|t| (t.place + t.texels) / LARGEST_NODE).fold(UVec2::ZERO, UVec2::max)
    }

    /// The words of the indirect arguments of each round: the draw that wipes its tiles, the pyramid over them, the culling
    /// of each batch.
    fn arguments(&self, rounds: u32, batches: &[u32]) -> Vec<u32> {
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

/// Buffers of the decision.
pub(crate) struct Plan {
    /// A `PvssmUniform`.
    pub uniform: wgpu::Buffer,
    /// The pyramid over the grid: two resolutions a node.
    grid: wgpu::Buffer,
    /// A `TilePlan`; see `tiles.wesl`.
    pub tiles: wgpu::Buffer,
    /// The tile of each cell.
    pub cells: wgpu::Buffer,
    /// Indirect arguments; see [`Plan::wipe_offset`].
    pub arguments: wgpu::Buffer,
    batch_groups: wgpu::Buffer,
    batches: Vec<u32>,
    side: u32,
    rounds: u32,
}

/// Label of the decision's passes.
const GRID: &str = "tile grid";
const DECISION: &str = "tile decision";

impl Plan {
    /// Makes it in `slot` unless one for these casters is there.
    pub fn ensure<'a>(slot: &'a mut Option<Plan>, gpu: &Gpu, casters: &Casters, settings: &PvssmSettings) -> &'a Plan {
        let batches: Vec<u32> = casters.batches.iter().map(|b| b.cluster_count.div_ceil(64)).collect();
        if slot.as_ref().is_none_or(|p| p.batches != batches) {
            *slot = Some(Plan::new(gpu, batches, settings));
        }
        slot.as_ref().expect("just made")
    }

    fn new(gpu: &Gpu, batches: Vec<u32>, settings: &PvssmSettings) -> Plan {
        let (side, rounds) = (settings.grid, settings.rounds);
        let nodes: u64 = (0..=side.ilog2()).map(|level| u64::from(side >> level).pow(2)).sum();
        // Never empty: a binding may not be.
        let groups: Vec<u32> = if batches.is_empty() { vec![0] } else { batches.clone() };
        Plan {
            uniform: uniform(gpu, "pvssm", &PvssmUniform::new(settings, false)),
            grid: storage_buffer(gpu, "tile grid", 8 * nodes),
            tiles: storage_buffer(gpu, "tile plan", 4 * (HEADER_WORDS + TILE_WORDS * MOST_TILES) as u64),
            cells: storage_buffer(gpu, "tile of each cell", 4 * u64::from(side * side)),
            arguments: storage_buffer(
                gpu,
                "tile arguments",
                u64::from(rounds) * (4 * ROUND_WORDS + 12 * groups.len() as u64),
            ),
            batch_groups: buffer_of(
                gpu,
                "workgroups of batches",
                bytemuck::cast_slice(&groups),
                wgpu::BufferUsages::STORAGE,
            ),
            batches,
            side,
            rounds,
        }
    }

    /// Sets what counts for this frame.
    pub fn update(&self, gpu: &Gpu, settings: &PvssmSettings, may_keep: bool) {
        gpu.queue.write_buffer(&self.uniform, 0, &PvssmUniform::new(settings, may_keep).uniform_bytes());
    }

    fn key(module: &'static str) -> ShaderKey {
        ShaderKey::new(module)
    }

    /// Notes in the grid what each kernel needs.
    pub fn predict(&self, frame: &Frame, recorder: &mut Recorder, analysis: &Analysis) -> Result<(), Error> {
        let pipeline = recorder.gpu.compute_pipeline(&Self::key("techniques::pvssm::predict"), "predict_resolution")?;
        recorder.encoder.clear_buffer(&self.grid, 0, None);
        let set = frame.bindings(bindings! {
            penumbra_pixels: &analysis.list.buffer,
            penumbra_tiles: &analysis.list.tiles,
            pvssm: &self.uniform,
            kernels: &analysis.kernels,
            noted: &self.grid,
        });
        recorder.compute(GRID, &pipeline, &set, Work::Indirect(&analysis.list.tiles, 0));
        Ok(())
    }

    /// Decides on the GPU. Returns how many rounds have to be recorded, as the host cannot know how many there are.
    pub fn decide(&self, recorder: &mut Recorder) -> Result<u32, Error> {
        let pipeline = recorder.gpu.compute_pipeline(&Self::key("techniques::pvssm::decide"), "decide")?;
        let set = bindings! {
            pvssm: &self.uniform,
            made_plan: &self.tiles,
            made_cells: &self.cells,
            resolutions: &self.grid,
            tile_arguments: &self.arguments,
            batch_groups: &self.batch_groups,
        };
        recorder.compute(DECISION, &pipeline, set, Work::Groups([1, 1, 1]));
        Ok(self.rounds)
    }

    /// Submits what is recorded so far, waits for the grid and decides on the CPU. Returns the number of rounds.
    pub fn decide_on_the_cpu(&self, recorder: &mut Recorder, settings: &PvssmSettings) -> Result<u32, Error> {
        let gpu = recorder.gpu;
        let encoder = gpu.device.create_command_encoder(&Default::default());
        let before = std::mem::replace(recorder.encoder, encoder);
        gpu.queue.submit([before.finish()]);
        let decided = decide(&pollster::block_on(self.read_grid(gpu))?, settings);
        for (buffer, words) in [
            (&self.tiles, decided.words()),
            (&self.cells, decided.cells(self.side)),
            (&self.arguments, decided.arguments(self.rounds, &self.batches)),
        ] {
            gpu.queue.write_buffer(buffer, 0, bytemuck::cast_slice(&words));
        }
        Ok(decided.rounds)
    }

    /// The grid as it was noted. Waits for the GPU.
    pub async fn read_grid(&self, gpu: &Gpu) -> Result<Grid, Error> {
        let noted: Vec<f32> = bytemuck::pod_collect_to_vec(&read_buffer(gpu, &self.grid).await?);
        Ok(Grid::of_noted(self.side, &noted))
    }

    /// What was decided last. Waits for the GPU.
    pub async fn read(&self, gpu: &Gpu) -> Result<Decided, Error> {
        let words: Vec<u32> = bytemuck::pod_collect_to_vec(&read_buffer(gpu, &self.tiles).await?);
        Ok(Decided::of_words(&words))
    }

    /// Puts a pyramid in the place of what kernels have noted.
    #[cfg(test)]
    pub fn write_grid(&self, gpu: &Gpu, noted: &[f32]) {
        gpu.queue.write_buffer(&self.grid, 0, bytemuck::cast_slice(noted));
    }

    /// The tile of each cell, as decided last.
    #[cfg(test)]
    pub async fn read_cells(&self, gpu: &Gpu) -> Result<Vec<u32>, Error> {
        Ok(bytemuck::pod_collect_to_vec(&read_buffer(gpu, &self.cells).await?))
    }

    /// The indirect arguments, as decided last.
    #[cfg(test)]
    pub async fn read_arguments(&self, gpu: &Gpu) -> Result<Vec<u32>, Error> {
        Ok(bytemuck::pod_collect_to_vec(&read_buffer(gpu, &self.arguments).await?))
    }

    /// The indirect arguments of a plan.
    #[cfg(test)]
    pub fn arguments_of(&self, decided: &Decided) -> Vec<u32> {
        decided.arguments(self.rounds, &self.batches)
    }

    /// Where the arguments of the draw that wipes a round's tiles begin, in bytes.
    pub fn wipe_offset(&self, round: u32) -> u64 {
        u64::from(round) * (4 * ROUND_WORDS + 12 * self.batches.len().max(1) as u64)
    }

    /// Where the arguments of two levels of the pyramid over a round's tiles begin, in bytes.
    pub fn reduce_offset(&self, round: u32, step: u64) -> u64 {
        self.wipe_offset(round) + 16 + 12 * step
    }

    /// Where the arguments of the culling of a batch in a round begin, in bytes.
    pub fn cull_offset(&self, round: u32, batch: usize) -> u64 {
        self.wipe_offset(round) + 4 * ROUND_WORDS + 12 * batch as u64
    }

    /// For looking at.
    pub fn inner_picture(&self) -> InnerPicture {
        InnerPicture {
            name: GRID,
            help: "resolution that each cell of the window needs, as texels over the whole window: along x, along y",
            content: InnerContent::Numbers {
                numbers: self.grid.clone(),
                stride: 2,
                channels: 2,
                size: [self.side; 2],
                list: None,
            },
        }
    }

    /// GPU memory.
    pub fn memory(&self) -> Memory {
        let buffers = [&self.grid, &self.tiles, &self.cells, &self.arguments, &self.batch_groups];
        Memory::new(DECISION, buffers.iter().map(|b| b.size()).sum())
    }
}
