//! The two tables of section 5.2, as speeds over the plain shadow map.

use crate::Error;
use crate::kit::{Experiment, Ratio, Run, Runner, Section, Trial, columns, split, with_map};
use crate::measure::Pass;
use crate::page::text;
use crate::table::{Table, column};
use antumbra_scene::builtin;

/// The paper's rows and our SPECs. Its variance shadow maps have a mip chain and 16x anisotropy.
const ROWS: [(&str, &str); 6] = [
    ("Shadow Map", "hard"),
    ("Bil. PCF 1x1", "pcf:pcf=1,lookup=bilinear"),
    ("VSM", "vsm:blur=1"),
    ("PCF 3x3", "pcf:pcf=3,lookup=nearest"),
    ("Bil. PCF 3x3", "pcf:pcf=3,lookup=bilinear"),
    ("VSM 3x3", "vsm:blur=3"),
];
const MAPS: [u32; 4] = [128, 256, 512, 1024];
/// Frames per second of the paper, row by row, for these maps at 1024 x 768.
const FPS_BY_MAP: [[f64; 4]; 6] = [
    [340.0, 334.0, 314.0, 243.0],
    [224.0, 219.0, 209.0, 175.0],
    [265.0, 255.0, 228.0, 154.0],
    [153.0, 151.0, 149.0, 130.0],
    [22.0, 22.0, 22.0, 21.0],
    [254.0, 225.0, 154.0, 63.0],
];
const IMAGES: [[u32; 2]; 4] = [[640, 480], [800, 600], [1024, 768], [1280, 960]];
/// The same for these image sizes and a map of 512.
const FPS_BY_IMAGE: [[f64; 4]; 6] = [
    [470.0, 470.0, 314.0, 210.0],
    [457.0, 309.0, 209.0, 133.0],
    [450.0, 334.0, 228.0, 159.0],
    [336.0, 229.0, 149.0, 92.0],
    [53.0, 33.0, 22.0, 15.0],
    [230.0, 195.0, 154.0, 119.0],
];
/// The scene: few triangles, one light, an object on a plain.
const SCENE: &str = "fence";
/// Width of the paper's images that --size replaces.
const FULL: u32 = 1024;

/// Names of the trials, with the SPECs of each.
pub fn names() -> Vec<(String, Vec<String>)> {
    let specs = |map| ROWS.iter().map(|(_, spec)| with_map(spec, map)).collect::<Vec<_>>();
    let by_map = MAPS.map(|map| (format!("map {map}"), specs(map)));
    let by_image = IMAGES.map(|[w, h]| (format!("image {w} x {h}"), specs(512)));
    by_map.into_iter().chain(by_image).collect()
}

pub fn experiments(runner: &Runner) -> Result<Vec<Experiment>, Error> {
    // A smaller --size reduces all images by the same factor.
    let factor = f64::from(runner.size([FULL, 768])[0]) / f64::from(FULL);
    let sizes = [[FULL, 768]; 4].into_iter().chain(IMAGES);
    let experiment = |((name, specs), size): ((String, Vec<String>), [u32; 2])| {
        let size = size.map(|side| ((f64::from(side) * factor).round() as u32).max(1));
        Ok(Experiment::new(name, builtin::build(SCENE)?, size, specs)?.with_point_light())
    };
    names().into_iter().zip(sizes).map(experiment).collect()
}

/// Columns of passes that techniques share: heading, explanation, name of the pass.
const SHARED_PASSES: [(&str, &str, &str); 6] = [
    ("culling", "Choosing what is drawn into the map", "cluster culling"),
    ("depth", "Depth of the nearest casters", "depth map"),
    ("background", "Depth of the farthest surfaces that only receive", "background map"),
    ("storing", "Computing the moments of the depths", "moments"),
    ("blur", "Gaussian over the map", "moment blur"),
    ("mips", "Reducing the map to coarser levels", "moment mip chain"),
];

pub fn sections(trials: &[Trial]) -> Vec<Section> {
    let [by_map, by_image] = split(trials, [MAPS.len(), IMAGES.len()]);
    let maps = "One image size, maps of 128 to 1024 texels per side.";
    let images = "A map of 512 texels, images of 640 x 480 to 1280 x 960.";
    vec![
        section("Size of the map", by_map, &FPS_BY_MAP, maps),
        section("Size of the image", by_image, &FPS_BY_IMAGE, images),
    ]
}

fn section(title: &str, trials: &[Trial], fps: &[[f64; 4]; 6], what: &str) -> Section {
    let text = format!(
        "{what} Speeds are relative to the plain shadow map of the same map and image. The paper's frames include the \
         scene and its shading, on a GeForce 6800GT; here the shadow counts alone, so differences are larger. Where \
         variance shadow maps fall behind, the passes show why: storing, blurring and reducing the map cost time per \
         texel, and the shader filters where the adapter lacks a reliable anisotropic sampler."
    );
    Section::new(title, text, vec![speeds(trials, fps).into(), passes(trials).into()])
}

/// Speeds, ours beside the paper's.
fn speeds(trials: &[Trial], fps: &[[f64; 4]; 6]) -> Table {
    /// Trial, run, index in [`ROWS`], and the paper's frames per second over those of its shadow map.
    type Row<'a> = (&'a Trial, &'a Run, (usize, f64));
    let columns = [
        columns::technique(),
        column("in the paper", "The paper's name for it", "", |(_, _, (i, _)): &Row| ROWS[*i].0.to_owned()),
        columns::ms(),
        column("speed", "Milliseconds of the plain shadow map over those of this row", "", |(trial, run, _): &Row| {
            text::ratio(run.speed_over(&trial.runs[0]))
        }),
        column(
            "paper",
            "The paper's frames per second over those of its shadow map",
            "",
            |(_, _, (_, paper)): &Row| text::ratio(*paper),
        ),
        columns::rmse(),
        columns::megabytes(),
    ];
    let groups = trials.iter().enumerate().map(|(column, trial)| {
        let paper = move |i: usize| fps[i][column] / fps[0][column];
        let rows = trial.runs.iter().enumerate().map(move |(i, run)| (trial, run, (i, paper(i))));
        (format!("{}, {}", trial.name, trial.pixels()), rows)
    });
    Table::grouped(&columns, groups)
}

/// Milliseconds of each shared pass, then of all others together.
fn passes(trials: &[Trial]) -> Table {
    type Row<'a> = (&'a Trial, &'a Run);
    let ms = |run: &Run, selects: &dyn Fn(&Pass) -> bool| text::or_dash(run.cost.ms_of(selects).map(text::ms));
    let shared = SHARED_PASSES.map(|(heading, help, name)| {
        column(heading, help, "ms", move |(_, run): &Row| ms(run, &|pass| !pass.host && pass.name == name))
    });
    let is_shared = |name: &str| SHARED_PASSES.iter().any(|(.., shared)| name == *shared);
    let lookup = column("lookup", "All other passes: reading the map at each pixel", "ms", move |(_, run): &Row| {
        ms(run, &|pass| !pass.host && !is_shared(&pass.name))
    });
    let columns: Vec<_> = [columns::technique(), columns::ms()].into_iter().chain(shared).chain([lookup]).collect();
    Table::grouped(&columns, trials.iter().map(|trial| (trial.name.clone(), trial.rows())))
}

/// Speed of blurred moments over bilinear comparisons of the same width.
fn blurred_over_compared(trial: &Trial) -> Option<f64> {
    let of = |i: usize| trial.runs.get(i);
    Some(of(5)?.speed_over(of(4)?))
}

pub fn lead(trials: &[Trial]) -> String {
    let at_512 = trials.iter().find(|trial| trial.name == "map 512");
    at_512.and_then(blurred_over_compared).map_or(String::new(), |speed| {
        format!(
            "A 3x3 blurred variance shadow map of 512 is {} times as fast as bilinear 3x3 percentage-closer filtering \
             (paper: {}).",
            text::ratio(speed),
            text::ratio(154.0 / 22.0)
        )
    })
}

pub fn ratios(trial: &Trial) -> Vec<Ratio> {
    let column = MAPS.iter().position(|map| trial.name == format!("map {map}"));
    let paper = |i: usize| column.map(|c| FPS_BY_MAP[i][c] / FPS_BY_MAP[0][c]);
    let runs = trial.runs.iter().enumerate().skip(1);
    runs.map(|(i, run)| Ratio::speed("speed", trial, run, &trial.runs[0], paper(i))).collect()
}
