//! A scene made ready: what is drawn on it, how long that takes, and how far the soft shadow map is from the truth.

use super::super::kit::Lab;
use super::truth::MapTruth;
use crate::error::CliError;
use crate::{measure, setup};
use antumbra::scene::SceneRenderer;
use antumbra::technique::Describe;
use antumbra::techniques::ssm::{Ssm, SsmSettings};
use antumbra::{Error, Spec, Technique};
use antumbra_reference::Tracer;
use antumbra_scene::Scene;
use pollster::block_on;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::rc::Rc;

/// Pixels of the picture that the map is projected on: few, since the map is what is measured.
pub const PICTURE: [u32; 2] = [128, 128];

pub struct Stage<'a> {
    pub lab: &'a Lab<'a>,
    pub scene: Scene,
    pub renderer: SceneRenderer,
    tracer: Tracer,
    /// By the size of the map.
    truths: RefCell<BTreeMap<u32, Rc<MapTruth>>>,
}

/// What one setting came to.
#[derive(Clone, Debug)]
pub struct Sample {
    /// Name and settings.
    pub spec: String,
    /// Of the map, as the paper measures it.
    pub error: f64,
    /// A frame's shadow.
    pub ms: f64,
    /// Patches that float16 would lose, as a part of all.
    pub lost: f64,
}

impl<'a> Stage<'a> {
    pub fn new(lab: &'a Lab, scene: Scene) -> Result<Stage<'a>, CliError> {
        let renderer = setup::renderer(lab.gpu, &scene, PICTURE)?;
        Ok(Stage { lab, renderer, tracer: Tracer::new(&scene), truths: RefCell::default(), scene })
    }

    /// Draws, times (if `frames` is not 0 with that many frames) and judges `ssm` with these settings.
    pub fn sample(&self, spec: &str, frames: u32) -> Result<Sample, CliError> {
        let gpu = self.lab.gpu;
        let mut ssm = self.made(spec)?;
        let ms = self.milliseconds(&mut ssm, frames)?;
        let figures: BTreeMap<_, _> = block_on(gpu.checked(|| block_on(ssm.figures(gpu))))?.into_iter().collect();
        let truth = self.truth(&ssm)?;
        let lost = figures["float16 loses"] / figures["patches"].max(1.0);
        Ok(Sample { spec: spec.to_owned(), error: truth.error(gpu, &ssm)?, ms, lost })
    }

    /// Milliseconds of a frame of any technique.
    pub fn time(&self, spec: &str, frames: u32) -> Result<f64, CliError> {
        let spec: Spec = spec.parse().map_err(Error::from)?;
        let mut technique = block_on(self.lab.gpu.checked(|| spec.make(self.lab.gpu)))?;
        self.milliseconds(&mut *technique, frames)
    }

    /// The technique itself, so that its maps can be read.
    pub fn made(&self, spec: &str) -> Result<Ssm, CliError> {
        let spec: Spec = spec.parse().map_err(Error::from)?;
        let settings: SsmSettings = serde_json::from_value(spec.settings).expect("settings of `ssm` are `ssm`'s");
        Ok(block_on(self.lab.gpu.checked(|| Ssm::make(self.lab.gpu, settings)))?)
    }

    /// On a software adapter wall time, whatever the timestamps say: both sides of every ratio by one clock.
    fn milliseconds(&self, technique: &mut dyn Technique, frames: u32) -> Result<f64, CliError> {
        let cost = measure::measure(self.lab.gpu, &self.renderer, technique, frames, |_| ())?;
        Ok(if self.lab.gpu.is_software() { cost.wall_ms } else { cost.total_ms })
    }

    fn truth(&self, ssm: &Ssm) -> Result<Rc<MapTruth>, CliError> {
        let size = ssm.soft_shadow_map().texture.width();
        if let Some(truth) = self.truths.borrow().get(&size) {
            return Ok(truth.clone());
        }
        let truth = Rc::new(MapTruth::of(self.lab.gpu, &self.scene, &self.tracer, &self.renderer.frame, ssm)?);
        self.truths.borrow_mut().insert(size, truth.clone());
        Ok(truth)
    }
}
