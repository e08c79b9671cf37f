//! Back-projection by packets of pixels that share one walk through the pyramid [Yang 2009].

use super::backprojection::{Backprojection, BackprojectionSettings};
use crate::recorder::Recorder;
use crate::technique::{About, Describe, Memory, Technique};
use crate::{Error, Frame, Gpu};
use serde_json::{Map, Value};

/// [`Backprojection`] with the work of 64 neighbouring pixels shared.
pub struct Packet(Backprojection);

impl Describe for Packet {
    type Settings = BackprojectionSettings;
    const ABOUT: About = About {
        name: "packet",
        title: "Layered back-projection by packets",
        source: "Yang 2009",
        summary: "x",
    };

    fn defaults(given: &Map<String, Value>) -> BackprojectionSettings {
        BackprojectionSettings::suited_to(given)
    }

    fn make(gpu: &Gpu, settings: BackprojectionSettings) -> Result<Self, Error> {
        Backprojection::with_gather(gpu, settings, "techniques::packet::packet").map(Packet)
    }
}

impl Technique for Packet {
    fn record(&mut self, frame: &Frame, recorder: &mut Recorder) -> Result<(), Error> {
        self.0.record(frame, recorder)
    }

    fn memory(&self) -> Vec<Memory> {
        self.0.memory()
    }
}
