//! A scene on the GPU: times of techniques, and the error of the soft shadow map.

use super::truth::MapTruth;
use crate::Error;
use crate::kit::Runner;
use crate::measure::LoadedScene;
use antumbra::techniques::ssm::{Ssm, SsmSettings};
use antumbra::{Shadows, Spec, TechniqueFactory};
use antumbra_reference::Tracer;
use antumbra_scene::Scene;
use pollster::block_on;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::rc::Rc;

/// Pixels of the image that the map is projected on: few, since the map is measured.
const IMAGE: [u32; 2] = [128, 128];

pub struct Stage<'a> {
    pub scene: Scene,
    pub loaded: LoadedScene<'a>,
    tracer: Tracer,
    /// By the size of the map.
    truths: RefCell<BTreeMap<u32, Rc<MapTruth>>>,
}

/// Result of one setting.
#[derive(Clone, Debug)]
pub struct Sample {
    /// Name and settings.
    pub spec: String,
    /// Error of the map, as the paper measures it.
    pub error: f64,
    /// Milliseconds of the shadow.
    pub ms: f64,
    /// Fraction of the patches that float16 loses.
    pub lost: f64,
}

impl<'a> Stage<'a> {
    pub fn new(runner: &'a Runner, scene: Scene) -> Result<Stage<'a>, Error> {
        let loaded = runner.load(&scene, IMAGE)?;
        Ok(Stage { loaded, tracer: Tracer::new(&scene), truths: RefCell::default(), scene })
    }

    /// Renders `ssm` with these settings and measures its time (see [`LoadedScene::cost`] for `frames`) and error.
    pub fn sample(&self, spec: &str, frames: u32) -> Result<Sample, Error> {
        let gpu = self.loaded.gpu;
        let mut ssm = self.create(spec)?;
        let ms = self.loaded.cost(&mut ssm, frames, |_| ())?.comparable_ms(gpu);
        let stats = self.loaded.stats(&ssm)?;
        let lost = stats["float16 loses"] / stats["patches"].max(1.0);
        Ok(Sample { spec: spec.to_owned(), error: self.truth(&ssm)?.error(gpu, ssm.technique())?, ms, lost })
    }

    /// Milliseconds of a frame of any technique.
    pub fn time(&self, spec: &str, frames: u32) -> Result<f64, Error> {
        Ok(self.loaded.render(&spec.parse()?, frames, |_| ())?.cost.comparable_ms(self.loaded.gpu))
    }

    /// The technique itself, whose maps can be read.
    pub fn create(&self, spec: &str) -> Result<Shadows<Ssm>, Error> {
        let (gpu, spec): (_, Spec) = (self.loaded.gpu, spec.parse()?);
        let settings: SsmSettings = serde_json::from_value(spec.settings).expect("settings of `ssm`");
        Ok(Shadows::new(block_on(gpu.checked(|| Ssm::make(gpu, settings)))?))
    }

    fn truth(&self, ssm: &Shadows<Ssm>) -> Result<Rc<MapTruth>, Error> {
        let ssm = ssm.technique();
        let size = ssm.maps().map_or(0, |maps| maps.soft_shadow.size()[0]);
        if let Some(truth) = self.truths.borrow().get(&size) {
            return Ok(truth.clone());
        }
        let LoadedScene { gpu, renderer, .. } = &self.loaded;
        let truth = Rc::new(MapTruth::of(gpu, &self.scene, &self.tracer, &renderer.frame, ssm)?);
        self.truths.borrow_mut().insert(size, truth.clone());
        Ok(truth)
    }
}
