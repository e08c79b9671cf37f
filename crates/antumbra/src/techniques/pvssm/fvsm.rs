//! Fitted virtual shadow maps [Giegl and Wimmer 2007]: hard shadows with a texel for each pixel, antialiased.

use super::{Pvssm, PvssmSettings, Rho};
use crate::input::frame::PointFrame;
use crate::gpu::recorder::Recorder;
use crate::gpu::shader::Needs;
use crate::technique::{TechniqueAbout, TechniqueFactory, StatsFuture, InnerPicture, Memory, Technique};
use crate::error::Error;
use crate::input::frame::Frame;
use crate::gpu::device::Gpu;
use serde_json::{Map, Value};

/// [`Pvssm`] of a light that is a point at the light's centre: kernels are the pixels' footprints.
pub struct Fvsm {
    tiles: Pvssm,
    point: Option<PointFrame>,
}

impl TechniqueFactory for Fvsm {
    type Settings = PvssmSettings;
    const ABOUT: TechniqueAbout = TechniqueAbout {
        name: "fvsm",
        title: "Fitted virtual shadow maps",
        source: "Giegl 2007",
        summary: "hard shadows with a texel a pixel, however large the scene; antialiased over the pixel's footprint",
    };

    const NEEDS: Needs = Pvssm::NEEDS;

    fn defaults(_given: &Map<String, Value>) -> PvssmSettings {
        PvssmSettings { rho: Rho::Fitted, ..PvssmSettings::default() }
    }

    fn make(gpu: &Gpu, settings: PvssmSettings) -> Result<Self, Error> {
        Ok(Fvsm { tiles: Pvssm::new(gpu, Self::ABOUT.name, settings)?, point: None })
    }
}

impl Technique for Fvsm {
    fn record(&mut self, frame: &Frame, recorder: &mut Recorder) -> Result<(), Error> {
        self.tiles.record(PointFrame::of(&mut self.point, recorder.gpu, frame), recorder)
    }

    fn inner_pictures(&self) -> Vec<InnerPicture> {
        self.tiles.inner_pictures()
    }

    fn memory(&self) -> Vec<Memory> {
        self.tiles.memory()
    }

    fn stats<'a>(&'a self, gpu: &'a Gpu) -> StatsFuture<'a> {
        self.tiles.stats(gpu)
    }
}
