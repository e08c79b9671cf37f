//! Back-projection by packets of pixels that share one walk through the pyramid [Yang 2009].

use super::{Backprojection, BackprojectionSettings, Spacing};
use crate::gpu::recorder::Recorder;
use crate::error::SpecError;
use crate::technique::{TechniqueAbout, TechniqueFactory, InnerPicture, Memory, Technique};
use crate::error::Error;
use crate::input::frame::Frame;
use crate::gpu::device::Gpu;
use serde_json::{Map, Value};

/// [`Backprojection`] with the work of 64 neighbouring pixels shared.
pub struct Packet(Backprojection);

impl TechniqueFactory for Packet {
    type Settings = BackprojectionSettings;
    const ABOUT: TechniqueAbout = TechniqueAbout {
        name: "packet",
        title: "Layered back-projection by packets",
        source: "Yang 2009",
        summary: "the same by 64 pixels at a time, which walk through the upper map together; as quick or slow as their adapter",
    };

    fn defaults(given: &Map<String, Value>) -> BackprojectionSettings {
        BackprojectionSettings { spacing: Spacing::S1, ..BackprojectionSettings::suited_to(given) }
    }

    fn make(gpu: &Gpu, settings: BackprojectionSettings) -> Result<Self, Error> {
        if settings.spacing != Spacing::S1 {
            return Err(Error::Spec(SpecError::Value {
                technique: Self::ABOUT.name.to_owned(),
                key: "spacing".to_owned(),
                value: settings.spacing.pixels().to_string(),
                expected: "a packet is of pixels beside each other: leave it at 1, or take `backprojection`".to_owned(),
            }));
        }
        Backprojection::with_gather(gpu, settings, "techniques::backprojection::packet", true).map(Packet)
    }
}

impl Technique for Packet {
    fn record(&mut self, frame: &Frame, recorder: &mut Recorder) -> Result<(), Error> {
        self.0.record(frame, recorder)
    }

    fn inner_pictures(&self) -> Vec<InnerPicture> {
        self.0.inner_pictures()
    }

    fn memory(&self) -> Vec<Memory> {
        self.0.memory()
    }
}
