//! One experiment: a scene, its size, techniques and the sampling of the reference.

use crate::Error;
use crate::truth::TruthSettings;
use antumbra::Spec;
use antumbra_scene::Scene;

/// Techniques to measure on one scene at one size.
pub struct Experiment {
    /// Name of its trial in the suite.
    pub name: String,
    /// The scene.
    pub scene: Scene,
    /// Size of the image, pixels.
    pub size: [u32; 2],
    /// The techniques.
    pub specs: Vec<Spec>,
    /// Whether frames are timed; otherwise a single frame is rendered, where only the error matters.
    pub timed: bool,
    /// Whether the report shows the image of each technique.
    pub keeps_images: bool,
    /// Sampling of the reference, from that of the command line.
    pub truth: fn(&TruthSettings) -> TruthSettings,
}

impl Experiment {
    /// A timed experiment with the reference's usual sampling. Fails on an unknown SPEC, before anything is measured.
    pub fn new(
        name: impl Into<String>,
        scene: Scene,
        size: [u32; 2],
        specs: impl IntoIterator<Item = impl AsRef<str>>,
    ) -> Result<Experiment, Error> {
        let specs = specs.into_iter().map(|text| text.as_ref().parse()).collect::<Result<_, _>>()?;
        Ok(Experiment {
            name: name.into(),
            scene,
            size,
            specs,
            timed: true,
            keeps_images: false,
            truth: TruthSettings::clone,
        })
    }

    /// The same with the light reduced to a point, for which one shadow ray per primary ray is exact.
    pub fn with_point_light(self) -> Experiment {
        Experiment { scene: point_light(self.scene), truth: TruthSettings::of_point_light, ..self }
    }

    /// The same without timing.
    pub fn untimed(self) -> Experiment {
        Experiment { timed: false, ..self }
    }

    /// The same with the images of the techniques kept.
    pub fn with_images(self) -> Experiment {
        Experiment { keeps_images: true, ..self }
    }
}

/// The scene with its light reduced to a point.
pub fn point_light(mut scene: Scene) -> Scene {
    scene.light.size = [0.0; 2].into();
    scene
}

/// A SPEC with a map of this size.
pub fn with_map(spec: &str, map: u32) -> String {
    format!("{spec}{}map={map}", if spec.contains(':') { ',' } else { ':' })
}
