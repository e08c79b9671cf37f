//! Tables of the costs: levels against the flat map, and the paper's way over the CPU.

use super::readback::{self, Steps};
use super::stage::{Sample, Stage};
use crate::Error;
use crate::kit::Section;
use crate::page::text;
use crate::table::{Table, column};

/// Map of the comparisons whose results are targets.
pub const LARGE: u32 = 512;

/// Levels against the flat map: error minus that of the flat map, and the flat map's milliseconds over those of levels,
/// for [`LARGE`].
pub fn levels(stage: &Stage) -> Result<(Section, (f64, f64)), Error> {
    /// A sample and that of the flat map.
    type Row = (Sample, Sample);
    let of_map = |map: u32| {
        let sample = |rest| stage.sample(&format!("ssm:map={map},{rest}"), 1);
        let flat = sample("hierarchy=false")?;
        let levels = ["window=4", "window=8", "window=16"].map(|rest| Ok((sample(rest)?, flat.clone())));
        let rows =
            std::iter::once(Ok((flat.clone(), flat.clone()))).chain(levels).collect::<Result<Vec<Row>, Error>>()?;
        Ok((format!("{map} x {map}"), rows))
    };
    let groups = [128, 256, LARGE].map(of_map).into_iter().collect::<Result<Vec<(String, Vec<Row>)>, Error>>()?;
    let (usual, flat) = &groups[2].1[2];
    let last = (usual.error - flat.error, flat.ms / usual.ms);
    let columns = [
        column("technique", "Name and settings", "", |(s, _): &Row| s.spec.clone()),
        column("error", "Average error of the soft shadow map", "", |(s, _): &Row| text::metric(s.error)),
        column("− flat", "The same minus that of the flat map", "", |(s, flat): &Row| {
            format!("{:+.4}", s.error - flat.error)
        }),
        column("ms", "GPU time of the shadow", "ms", |(s, _): &Row| text::ms(s.ms)),
        column("speed", "Milliseconds of the flat map over these", "", |(s, flat): &Row| text::ratio(flat.ms / s.ms)),
    ];
    let section = Section::new(
        "Levels against the flat map",
        "Light of 0.1, two passes. On a level a penumbra is `window` to twice as many texels wide, or narrower on the \
         finest; 8 is the default. The paper hopes for it in its section 7.",
        vec![Table::grouped(&columns, groups).into()],
    );
    Ok((section, last))
}

/// The paper's own way: read the map back, loop, blend. The number is ours over the CPU's way for [`LARGE`].
pub fn over_the_cpu(stage: &Stage, frames: u32) -> Result<(Section, f64), Error> {
    /// A SPEC, its milliseconds, and those of the CPU's way.
    type Row = (String, f64, Steps);
    let of_map = |map: u32| -> Result<Row, Error> {
        let spec = format!("ssm:map={map},passes=1");
        let ours = stage.time(&spec, frames)?;
        Ok((spec, ours, readback::frame(stage, map)?))
    };
    let rows = [of_map(128)?, of_map(LARGE)?];
    let last = rows[1].1 / rows[1].2.total();
    let columns = [
        column("technique", "Name and settings", "", |(spec, ..): &Row| spec.clone()),
        column("ms", "Ours, the rendering of the maps included", "ms", |(_, ours, _): &Row| text::ms(*ours)),
        column("read", "The paper's way: reading the occluder map back", "ms", |(.., s): &Row| text::ms(s.read)),
        column("loop", "The CPU's loop over its texels", "ms", |(.., s): &Row| text::ms(s.looped)),
        column(
            "blend",
            "Uploading and drawing the rectangles, without the rendering of the maps",
            "ms",
            |(.., s): &Row| text::ms(s.blended),
        ),
        column("ours ÷", "Ours over these three", "", |(_, ours, s): &Row| text::ratio(ours / s.total())),
    ];
    let section = Section::new(
        "Without the CPU",
        "One pass, light of 0.1. The paper's way reads the occluder map back, computes the rectangles on the CPU and \
         blends them; it names the transfer as its bottleneck. On a software adapter the transfer costs nothing and the \
         rectangles most.",
        vec![Table::new(&columns, &stage.scene.name, rows).into()],
    );
    Ok((section, last))
}
