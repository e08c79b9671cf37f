//! Predicted virtual soft shadow maps [Shen, Guennebaud, Yang and Feng 2011]: as many shadow map tiles, of such
//! resolutions, as the penumbrae that are seen need.
//!
//! The paper reads the tile grid back and decides on the CPU. Here the GPU decides within the frame: a pool of texels is
//! filled with tiles whose number, place and size the host never learns, and passes that turn out not to be needed are
//! empty indirect draws and dispatches. `decision=wait` is the paper's way.

pub(crate) mod analysis;
pub(crate) mod decide;
pub(crate) mod drawing;
pub(crate) mod filtering;
pub(crate) mod plan;
pub mod fvsm;
pub mod rho;
pub mod settings;
#[cfg(test)]
mod tests;

pub use settings::{Decision, PvssmSettings, Rho};

use crate::passes::maps::light_maps::Drawn;
use crate::gpu::recorder::Recorder;
use crate::error::SpecError;
use crate::gpu::shader::Needs;
use crate::technique::{TechniqueAbout, TechniqueFactory, StatsFuture, InnerPicture, Memory, Technique};
use crate::error::Error;
use crate::input::frame::Frame;
use crate::gpu::device::Gpu;
use crate::gpu_struct;
use analysis::Analysis;
use drawing::Drawing;
use filtering::Filtering;
use glam::{UVec2, Vec2, Vec4};
use plan::Plan;

gpu_struct! {
    /// What all shaders of the technique know.
    pub(crate) struct PvssmUniform {
        /// Coefficients of the polynomial of log2 of the kernel's size in pixels, from the constant on.
        rho: Vec4,
        /// 1 for a texel a pixel, whatever the polynomial.
        one_to_one: u32,
        /// Times as many texels as predicted.
        detail: f32,
        /// Cells of the tile grid a side.
        grid: u32,
        /// Side of the largest tile and of the pool, texels.
        tile: u32,
        /// How often the pool may be filled.
        rounds: u32,
        /// 1 if tiles are split to save texels.
        thrifty: u32,
        /// 1 if tiles of the frame before may still be used.
        may_keep: u32,
        /// Nodes a side that a blocker search looks at.
        search: f32,
        /// Nodes of a tile that a kernel takes, as the side of a square.
        filter_width: f32,
    }
}

impl PvssmUniform {
    pub(crate) fn new(settings: &PvssmSettings, may_keep: bool) -> PvssmUniform {
        PvssmUniform {
            rho: Vec4::from(rho::coefficients(settings)),
            one_to_one: u32::from(settings.rho == Rho::Fitted),
            detail: settings.detail,
            grid: settings.grid,
            tile: settings.tile,
            rounds: settings.rounds,
            thrifty: u32::from(settings.thrifty),
            may_keep: u32::from(may_keep),
            search: settings.search as f32,
            filter_width: settings.filter as f32,
        }
    }
}

/// A tile of the last frame, for reports and viewers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TileView {
    /// Low corner in the map's window, from 0 to 1 along x and y.
    pub low: Vec2,
    /// Size in the map's window.
    pub size: Vec2,
    /// Texels along x and y.
    pub texels: UVec2,
    /// Which filling of the pool it belongs to.
    pub round: u32,
}

/// Soft shadows of any sharpness on scenes of any size.
pub struct Pvssm {
    settings: PvssmSettings,
    analysis: Option<Analysis>,
    plan: Option<Plan>,
    drawing: Option<Drawing>,
    filtering: Option<Filtering>,
    /// What the tiles in the pool show.
    drawn: Option<Drawn>,
}

impl TechniqueFactory for Pvssm {
    type Settings = PvssmSettings;
    const ABOUT: TechniqueAbout = TechniqueAbout {
        name: "pvssm",
        title: "Predicted virtual soft shadow maps",
        source: "Shen 2011",
        summary: "tiles of as many texels as each penumbra needs; antialiased; for scenes of any size, near and far",
    };

    // One workgroup decides on all tiles, in the memory that its threads share.
    const NEEDS: Needs = Needs { workgroup_bytes: 19584, ..Needs::CORE };

    fn make(gpu: &Gpu, settings: PvssmSettings) -> Result<Self, Error> {
        Pvssm::new(gpu, Self::ABOUT.name, settings)
    }
}

impl Pvssm {
    /// The technique under another name: [`Fvsm`](crate::techniques::pvssm::fvsm::Fvsm) is one.
    pub(crate) fn new(gpu: &Gpu, name: &str, settings: PvssmSettings) -> Result<Pvssm, Error> {
        if !settings.grid.is_power_of_two() {
            return Err(Error::Spec(SpecError::Value {
                technique: name.to_owned(),
                key: "grid".to_owned(),
                value: settings.grid.to_string(),
                expected: "expected 16, 32, 64 or 128".to_owned(),
            }));
        }
        gpu.check_size("pool of tiles", settings.tile, settings.tile)?;
        Ok(Pvssm { settings, analysis: None, plan: None, drawing: None, filtering: None, drawn: None })
    }

    /// The tiles of the last frame. Waits for the GPU.
    pub async fn tiles(&self, gpu: &Gpu) -> Result<Vec<TileView>, Error> {
        let Some(plan) = &self.plan else { return Ok(Vec::new()) };
        let part = 1.0 / self.settings.grid as f32;
        let view = |tile: &plan::Tile| TileView {
            low: UVec2::new(tile.cells.x, tile.cells.y).as_vec2() * part,
            size: UVec2::new(tile.cells.z, tile.cells.w).as_vec2() * part,
            texels: tile.texels,
            round: tile.round,
        };
        Ok(plan.read(gpu).await?.tiles.iter().map(view).collect())
    }
}

impl Technique for Pvssm {
    fn record(&mut self, frame: &Frame, recorder: &mut Recorder) -> Result<(), Error> {
        let (gpu, settings) = (recorder.gpu, &self.settings);
        let analysis = Analysis::ensure(&mut self.analysis, gpu, frame, settings)?;
        let rests = frame.static_casters && self.drawn.as_ref().is_some_and(|d| d.is(&Drawn::of(frame)));
        let plan = Plan::ensure(&mut self.plan, gpu, &frame.casters, settings);
        let drawing = Drawing::ensure(&mut self.drawing, gpu, &frame.casters, settings)?;
        let filtering = Filtering::ensure(&mut self.filtering, gpu, frame.size, settings)?;
        plan.update(gpu, settings, rests);

        analysis.low_resolution_map(frame, recorder)?;
        analysis.list_pixels(frame, recorder)?;
        analysis.shape_kernels(frame, recorder, plan)?;
        plan.predict(frame, recorder, analysis)?;
        let rounds = match settings.decision {
            Decision::Gpu => plan.decide(recorder)?,
            Decision::Wait => plan.decide_on_the_cpu(recorder, settings)?,
        };
        filtering.bin_pixels(frame, recorder, analysis, plan)?;
        for round in 0..rounds {
            drawing.draw_tiles(frame, recorder, plan, round)?;
            drawing.reduce_tiles(frame, recorder, plan, round)?;
            filtering.soften(frame, recorder, analysis, plan, drawing, round)?;
        }
        self.drawn = Some(Drawn::of(frame));
        Ok(())
    }

    fn inner_pictures(&self) -> Vec<InnerPicture> {
        let analysis = self.analysis.iter().flat_map(Analysis::inner_pictures);
        let grid = self.plan.iter().map(Plan::inner_picture);
        analysis.chain(grid).chain(self.drawing.iter().map(Drawing::inner_picture)).collect()
    }

    fn memory(&self) -> Vec<Memory> {
        let analysis = self.analysis.iter().flat_map(Analysis::memory);
        let plan = self.plan.iter().map(Plan::memory);
        let drawing = self.drawing.iter().flat_map(Drawing::memory);
        analysis.chain(plan).chain(drawing).chain(self.filtering.iter().map(Filtering::memory)).collect()
    }

    fn stats<'a>(&'a self, gpu: &'a Gpu) -> StatsFuture<'a> {
        Box::pin(async move {
            match &self.plan {
                None => Ok(Vec::new()),
                Some(plan) => Ok(plan.read(gpu).await?.stats()),
            }
        })
    }
}
