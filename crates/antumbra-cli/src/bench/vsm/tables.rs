//! The two tables of section 5.2, as speeds over the plain shadow map.

use super::super::kit::{Group, Lab, Part, Ratio, Run, Shown, Table, Trial, specs, with_map};
use super::{Job, with_point_light};
use crate::error::CliError;
use crate::report::text;
use antumbra_scene::builtin;

/// The paper's rows, and what they are here. Its variance shadow maps have a mip chain and 16x anisotropy.
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
const PICTURES: [[u32; 2]; 4] = [[640, 480], [800, 600], [1024, 768], [1280, 960]];
/// The same for these pictures and a map of 512.
const FPS_BY_PICTURE: [[f64; 4]; 6] = [
    [470.0, 470.0, 314.0, 210.0],
    [457.0, 309.0, 209.0, 133.0],
    [450.0, 334.0, 228.0, 159.0],
    [336.0, 229.0, 149.0, 92.0],
    [53.0, 33.0, 22.0, 15.0],
    [230.0, 195.0, 154.0, 119.0],
];
/// The scene: few triangles, one light, a plain with something on it.
const SCENE: &str = "fence";
/// Width of the paper's pictures that --size stands for.
const FULL: u32 = 1024;

/// Names of the trials, with the SPECs of each.
pub fn names() -> Vec<(String, Vec<String>)> {
    let specs = |map| ROWS.iter().map(|(_, spec)| with_map(spec, map)).collect::<Vec<_>>();
    let by_map = MAPS.map(|map| (format!("map {map}"), specs(map)));
    let by_picture = PICTURES.map(|[w, h]| (format!("picture {w} x {h}"), specs(512)));
    by_map.into_iter().chain(by_picture).collect()
}

pub fn jobs(lab: &Lab) -> Result<Vec<Job>, CliError> {
    // A smaller --size makes all pictures smaller by the same part.
    let part = f64::from(lab.size([FULL, 768])[0]) / f64::from(FULL);
    let sizes = [[FULL, 768]; 4].into_iter().chain(PICTURES);
    let job = |((name, texts), size): ((String, Vec<String>), [u32; 2])| {
        Ok(Job {
            name,
            scene: with_point_light(builtin::build(SCENE)?),
            size: size.map(|side| ((f64::from(side) * part).round() as u32).max(1)),
            specs: specs(texts)?,
            hard: true,
            pictures: false,
            frames: lab.args.gpu.frames,
        })
    };
    names().into_iter().zip(sizes).map(job).collect()
}

const HEADS: [(&str, &str); 7] = [
    ("technique", "Name and settings"),
    ("in the paper", "The paper's name for it"),
    ("ms", "GPU milliseconds of the shadow alone"),
    ("speed", "Milliseconds of the plain shadow map over these"),
    ("paper", "The paper's frames per second over those of its shadow map"),
    ("RMSE", "Root of the mean squared error beside a hard shadow filtered over the pixel"),
    ("MB", "GPU memory that the technique owns, 10⁶ bytes"),
];
/// Columns of passes that techniques share: heading, meaning, and the pass's own name.
const SHARED_PASSES: [(&str, &str, &str); 6] = [
    ("culling", "Choosing what is drawn into the map", "cluster culling"),
    ("depth", "Depth of the nearest casters", "depth map"),
    ("background", "Depth of the farthest surfaces that only take shadows", "background map"),
    ("storing", "Moments from depths", "moments"),
    ("blur", "Gaussian over the map", "moment blur"),
    ("mips", "Reducing the map to coarser levels", "moment mip chain"),
];

fn pass_heads() -> Vec<(&'static str, &'static str)> {
    let shared = SHARED_PASSES.iter().map(|(head, meaning, _)| (*head, *meaning));
    let first = [("technique", "Name and settings"), ("ms", "GPU milliseconds of the shadow alone")];
    first.into_iter().chain(shared).chain([("lookup", "All passes but these: reading the map at each pixel")]).collect()
}

pub fn parts(trials: &[Trial]) -> Vec<Part> {
    let (by_map, by_picture) = trials.split_at(MAPS.len().min(trials.len()));
    vec![
        part("Size of the map", by_map, &FPS_BY_MAP, "One picture, maps of 128 to 1024 texels a side."),
        part(
            "Size of the picture",
            by_picture,
            &FPS_BY_PICTURE,
            "A map of 512 texels, pictures of 640 x 480 to 1280 x 960.",
        ),
    ]
}

fn part(title: &str, trials: &[Trial], fps: &[[f64; 4]; 6], what: &str) -> Part {
    let group = |(column, trial): (usize, &Trial)| Group {
        title: format!("{}, {}", trial.name, trial.pixels()),
        rows: trial
            .runs
            .iter()
            .enumerate()
            .map(|(i, run)| row(trial, i, run, fps[i][column] / fps[0][column]))
            .collect(),
    };
    let passes = |trial: &Trial| Group {
        title: trial.name.clone(),
        rows: trial.runs.iter().map(|run| [vec![run.spec.clone(), run.ms()], passes(run)].concat()).collect(),
    };
    Part {
        title: title.into(),
        text: format!(
            "{what} Speeds are relative to the plain shadow map of the same map and picture. The paper's frames have the \
             scene and its shading in them, on a GeForce 6800GT; here the shadow counts alone, so that differences show \
             more. Where variance shadow maps fall behind, the passes say why: storing, blurring and reducing the map are \
             paid for each texel, and filtering here is the shader's where the adapter has no anisotropic sampler that \
             can be trusted."
        ),
        shown: vec![
            Shown::Table(Table { heads: HEADS.to_vec(), groups: trials.iter().enumerate().map(group).collect() }),
            Shown::Table(Table { heads: pass_heads(), groups: trials.iter().map(passes).collect() }),
        ],
    }
}

fn row(trial: &Trial, i: usize, run: &Run, paper: f64) -> Vec<String> {
    vec![
        run.spec.clone(),
        ROWS[i].0.to_owned(),
        run.ms(),
        text::ratio(run.speed_over(&trial.runs[0])),
        text::ratio(paper),
        text::figure(run.figures.rmse),
        text::megabytes(run.cost.total_bytes),
    ]
}

/// Milliseconds of each shared pass by its timestamps, then of all others together.
fn passes(run: &Run) -> Vec<String> {
    let sum_of = |is: &dyn Fn(&str) -> bool| {
        let these = run.cost.passes.iter().filter(|pass| !pass.host && is(&pass.name));
        let times: Vec<f64> = these.filter_map(|pass| pass.ms).collect();
        if times.is_empty() { "–".to_owned() } else { text::ms(times.iter().sum()) }
    };
    let shared = SHARED_PASSES.iter().map(|(_, _, name)| sum_of(&|pass| pass == *name));
    shared.chain([sum_of(&|pass| SHARED_PASSES.iter().all(|(_, _, name)| pass != *name))]).collect()
}

/// Blurred moments beside bilinear comparisons of the same width, at a map of 512.
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
    let ratio = |(i, run): (usize, &Run)| Ratio {
        what: "speed",
        trial: trial.name.clone(),
        spec: run.spec.clone(),
        base: trial.runs[0].spec.clone(),
        paper: column.map(|c| FPS_BY_MAP[i][c] / FPS_BY_MAP[0][c]),
        ours: run.speed_over(&trial.runs[0]),
    };
    trial.runs.iter().enumerate().skip(1).map(ratio).collect()
}
