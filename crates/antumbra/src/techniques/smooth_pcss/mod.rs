//! Percentage-closer soft shadows with antialiased windows [Shen 2011, section 4]: the window is that of the light, seen
//! through the blockers, and that of the pixel, seen through the receiver's plane. Soft and hard transitions are filtered
//! alike, also where many texels fall into a pixel.

use super::pcss::{Pcss, PcssSettings};
use crate::recorder::Recorder;
use crate::technique::{About, Describe, InnerPicture, Memory, Technique};
use crate::{Error, Frame, Gpu};

/// [`Pcss`] over the pixel's footprint.
pub struct SmoothPcss(Pcss);

impl Describe for SmoothPcss {
    type Settings = PcssSettings;
    const ABOUT: About = About {
        name: "smooth-pcss",
        title: "Percentage-closer soft shadows, antialiased",
        source: "Shen 2011, section 4",
        summary: "the same over the pixel's footprint on the map: hard transitions and far shadows are smooth too",
    };

    fn make(gpu: &Gpu, settings: PcssSettings) -> Result<Self, Error> {
        Pcss::with_antialias(gpu, settings, true).map(SmoothPcss)
    }
}

impl Technique for SmoothPcss {
    fn record(&mut self, frame: &Frame, recorder: &mut Recorder) -> Result<(), Error> {
        self.0.record(frame, recorder)
    }

    fn look_inside(&mut self, looked_at: bool) {
        self.0.look_inside(looked_at);
    }

    fn inner_pictures(&self) -> Vec<InnerPicture> {
        self.0.inner_pictures()
    }

    fn memory(&self) -> Vec<Memory> {
        self.0.memory()
    }
}
