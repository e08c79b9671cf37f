//! Li Shen, Gaël Guennebaud, Baoguang Yang, Jieqing Feng, 2011: Predicted virtual soft shadow maps with high quality
//! filtering, <https://doi.org/10.1111/j.1467-8659.2011.01875.x>.
//!
//! Shadow map tiles, with the number and the resolutions that the penumbrae in the image need. The paper reads the tile
//! grid back and decides on the CPU. Here the GPU decides within the frame: tiles lie in a pool of texels, and their
//! number, positions and sizes never reach the host. Passes that are not needed are indirect draws and dispatches of
//! nothing. `decision=wait` is the paper's way.

pub(crate) mod analysis;
pub(crate) mod decide;
pub(crate) mod drawing;
pub(crate) mod filtering;
pub mod fvsm;
pub(crate) mod plan;
pub mod rho;
pub mod settings;
#[cfg(test)]
mod tests;

pub use fvsm::Fvsm;
pub use settings::{Decision, PvssmSettings, Rho};

use crate::error::{Error, SpecError};
use crate::gpu::device::Gpu;
use crate::gpu::limits::Needs;
use crate::gpu::recorder::Recorder;
use crate::gpu::resources::uniform;
use crate::gpu_struct;
use crate::input::frame::{BoundFrame, MapInput};
use crate::technique::{Description, StatsFuture, Technique, TechniqueFactory};
use analysis::Analysis;
use drawing::{Drawing, Pool};
use filtering::Filtering;
use glam::Vec4;
use plan::{Decided, Plan};

gpu_struct! {
    /// The settings, for all shaders of the technique.
    pub(crate) struct PvssmUniform {
        /// Coefficients of the polynomial of log2 of the kernel's size in pixels, the constant first.
        rho: Vec4,
        /// 1 for one texel per pixel instead of the polynomial.
        one_to_one: u32,
        /// Factor on the predicted texels.
        detail: f32,
        /// Cells of the tile grid per side.
        grid: u32,
        /// Side of the pool, and of the largest tile, texels.
        tile: u32,
        /// Most fillings of the pool.
        rounds: u32,
        /// 1 if tiles are split to save texels.
        thrifty: u32,
        /// Widest blocker search, nodes per side.
        search: f32,
        /// Most nodes of a tile under a kernel, as the side of a square.
        filter_width: f32,
    }
}

impl PvssmUniform {
    pub(crate) fn new(settings: &PvssmSettings) -> PvssmUniform {
        PvssmUniform {
            rho: Vec4::from(rho::coefficients(settings)),
            one_to_one: u32::from(settings.rho == Rho::Fitted),
            detail: settings.detail,
            grid: settings.grid,
            tile: settings.tile,
            rounds: settings.rounds,
            thrifty: u32::from(settings.thrifty),
            search: settings.search as f32,
            filter_width: settings.filter as f32,
        }
    }
}

/// Soft shadows of any sharpness on scenes of any size.
pub struct Pvssm {
    settings: PvssmSettings,
    /// True if the light is a point at its centre.
    point_light: bool,
    /// A `PvssmUniform`.
    uniform: wgpu::Buffer,
    /// The input that the tiles in the pool were drawn for, and their `TilePlan`.
    drawn: Option<(MapInput, wgpu::Buffer)>,
}

impl TechniqueFactory for Pvssm {
    type Settings = PvssmSettings;
    type Technique = Pvssm;
    const DESCRIPTION: Description = Description {
        name: "pvssm",
        title: "Predicted virtual soft shadow maps",
        source: "Shen 2011",
        summary: "tiles of as many texels as each penumbra needs; antialiased; for scenes of any size, near and far",
    };

    // One workgroup decides on all tiles, in the memory that its threads share.
    const NEEDS: Needs = Needs { workgroup_bytes: 19584, ..Needs::CORE };

    fn make(gpu: &Gpu, settings: PvssmSettings) -> Result<Pvssm, Error> {
        Pvssm::new(gpu, Self::DESCRIPTION.name, settings, false)
    }
}

impl Pvssm {
    fn new(gpu: &Gpu, name: &str, settings: PvssmSettings, point_light: bool) -> Result<Pvssm, Error> {
        if !settings.grid.is_power_of_two() {
            return Err(Error::Spec(SpecError::Value {
                technique: name.to_owned(),
                key: "grid".to_owned(),
                value: settings.grid.to_string(),
                expected: "expected 16, 32, 64 or 128".to_owned(),
            }));
        }
        gpu.check_size("pool of tiles", settings.tile, settings.tile)?;
        let uniform = uniform(gpu, "pvssm", &PvssmUniform::new(&settings));
        Ok(Pvssm { settings, point_light, uniform, drawn: None })
    }
}

impl Technique for Pvssm {
    fn record(&mut self, frame: &BoundFrame, recorder: &mut Recorder) -> Result<(), Error> {
        let point = self.point_light.then(|| frame.with_point_light(recorder));
        let (frame, settings) = (point.as_ref().unwrap_or(frame), &self.settings);
        let input = MapInput::of(frame);
        let drawn = self.drawn.take().filter(|(of, _)| frame.static_casters && *of == input).map(|(_, plan)| plan);
        let analysis = Analysis::record(recorder, frame, settings, &self.uniform)?;
        let grid = plan::predict(recorder, frame, settings, &self.uniform, &analysis)?;
        let plan = Plan::ask(recorder, &frame.casters, settings, &self.uniform);
        let rounds = match settings.decision {
            Decision::Gpu => plan.decide(recorder, &grid, drawn)?,
            Decision::Wait => plan.decide_on_the_cpu(recorder, &grid, settings)?,
        };
        let filtering = Filtering::bin_pixels(recorder, frame, settings, &analysis, &plan)?;
        let drawing = Drawing::prepare(recorder, frame, settings)?;
        let mut pool = None;
        for round in 0..rounds {
            drawing.cull(recorder, &frame.casters, &plan, round)?;
            let pool = pool.get_or_insert_with(|| Pool::ask(recorder, settings.tile));
            drawing.draw_tiles(recorder, &frame.casters, &plan, pool, round)?;
            pool.reduce_tiles(recorder, frame, &plan, round)?;
            filtering.soften(recorder, frame, &analysis, &plan, pool, round)?;
        }
        self.drawn = Some((input, plan.tiles));
        Ok(())
    }

    fn stats<'a>(&'a self, gpu: &'a Gpu) -> StatsFuture<'a> {
        Box::pin(async move {
            match &self.drawn {
                None => Ok(Vec::new()),
                Some((_, plan)) => Ok(Decided::read(gpu, plan).await?.stats()),
            }
        })
    }
}
