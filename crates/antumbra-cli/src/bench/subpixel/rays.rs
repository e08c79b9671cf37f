//! Figures 8, 9 and 11: beside rays through the same samples of every pixel.

use super::super::kit::{Group, Lab, Part, Shown, Table};
use super::{SIZE, with_point_light};
use crate::error::CliError;
use crate::report::text;
use crate::{measure, setup};
use antumbra::scene::SceneRenderer;
use antumbra::techniques::alias_free::subpixel::SubpixelSettings;
use antumbra::{Error, Spec};
use antumbra_metrics::RgbImage;
use antumbra_reference::{Reference, trace_centre};
use antumbra_scene::builtin;
use glam::Vec2;
use std::collections::BTreeMap;

/// Scenes with what they show; the first is figure 8, the last figure 9.
const SCENES: [(&str, &str); 4] = [
    ("curved receivers (figure 8)", "spheres:segments=64"),
    ("planar receivers", "fence"),
    ("wires", "cage"),
    ("a bumpy receiver (figure 9)", "bumpy"),
];
const SPEC: &str = "subpixel:samples=32,statistics=true";
const ALL_VALID: &str = "subpixel:samples=32,validity=false,statistics=true";

/// A picture of visibility beside that of rays.
struct Case {
    what: &'static str,
    scene: String,
    spec: &'static str,
    /// Mean difference over silhouette pixels, and over the pixels that are partly in shadow.
    over_silhouette: f64,
    over_partial: f64,
    work: BTreeMap<&'static str, f64>,
    pictures: [RgbImage; 3],
}

pub struct Compared {
    cases: Vec<Case>,
    /// Figure 11: samples and picture.
    cage: Vec<(u32, RgbImage)>,
}

/// Compares each scene, without and with the validity mask.
pub fn compare(lab: &Lab) -> Result<Compared, CliError> {
    // Rays at every sample are slow: half of the picture each way.
    let size = lab.size(SIZE).map(|side| (side / 2).max(1));
    let mut cases = Vec::new();
    for (what, name) in SCENES {
        eprintln!("rays at the same samples: {name}");
        let scene = with_point_light(builtin::build(name)?);
        let renderer = setup::renderer(lab.gpu, &scene, size)?;
        let rays = rays(&scene, size, SPEC)?;
        for spec in [SPEC, ALL_VALID] {
            cases.push(case(lab, (what, name), spec, &renderer, &rays)?);
        }
    }
    let scene = with_point_light(builtin::build("cage")?);
    let renderer = setup::renderer(lab.gpu, &scene, size)?;
    let picture = |samples: u32| {
        let spec: Spec = super::table::spec(samples).parse().map_err(Error::from)?;
        measure::draw(lab.gpu, &renderer, &spec, 0, |_| ())?;
        let data = setup::picture(lab.gpu, &renderer)?;
        Ok((samples, RgbImage { width: size[0], height: size[1], data }))
    };
    let cage = [1, 8, 32, 128].into_iter().map(picture).collect::<Result<_, CliError>>()?;
    Ok(Compared { cases, cage })
}

/// Rays through the samples of a SPEC of `subpixel`.
fn rays(scene: &antumbra_scene::Scene, size: [u32; 2], spec: &str) -> Result<Reference, CliError> {
    let spec: Spec = spec.parse().map_err(Error::from)?;
    let settings: SubpixelSettings = serde_json::from_value(spec.settings).expect("settings of `subpixel` are its own");
    let places: Vec<Vec2> = settings.pattern()?.samples().iter().map(|s| s.as_vec2() + 0.5).collect();
    Ok(trace_centre(scene, size, &places)?)
}

fn case(
    lab: &Lab,
    (what, scene): (&'static str, &str),
    spec: &'static str,
    renderer: &SceneRenderer,
    rays: &Reference,
) -> Result<Case, CliError> {
    let parsed: Spec = spec.parse().map_err(Error::from)?;
    let drawn = measure::draw(lab.gpu, renderer, &parsed, 1, |_| ())?;
    let work: BTreeMap<_, _> = drawn.work.into_iter().collect();
    let valid = || rays.valid.iter().enumerate().filter(|(_, v)| **v).map(|(i, _)| i);
    let off = |i: usize| f64::from((drawn.visibility[i] - rays.visibility[i]).abs());
    let is_partial = |v: f32| v > 0.0 && v < 1.0;
    let partial: Vec<f64> =
        valid().filter(|&i| is_partial(drawn.visibility[i]) || is_partial(rays.visibility[i])).map(off).collect();
    let sum: f64 = valid().map(off).sum();
    let shaded = |visibility: &[f32]| -> Result<RgbImage, CliError> {
        renderer.write_visibility(lab.gpu, visibility);
        Ok(RgbImage { width: rays.width, height: rays.height, data: setup::picture(lab.gpu, renderer)? })
    };
    let ten_times = (0..rays.valid.len()).flat_map(|i| {
        let off = if rays.valid[i] { (2550.0 * off(i)).min(255.0) as u8 } else { 0 };
        [off; 3]
    });
    let difference = RgbImage { width: rays.width, height: rays.height, data: ten_times.collect() };
    Ok(Case {
        what,
        scene: scene.to_owned(),
        spec,
        over_silhouette: sum / work.get("silhouette pixels").copied().unwrap_or(f64::NAN),
        over_partial: partial.iter().sum::<f64>() / partial.len().max(1) as f64,
        work,
        pictures: [shaded(&drawn.visibility)?, shaded(&rays.visibility)?, difference],
    })
}

impl Compared {
    pub fn lead(&self) -> String {
        let of = |scene: &str, spec: &str| self.cases.iter().find(|c| c.scene == scene && c.spec == spec);
        let (Some(plane), Some(bumpy)) = (of("fence", SPEC), of("bumpy", SPEC)) else { return String::new() };
        let valid = bumpy.work.get("valid samples half in shadow").copied().unwrap_or(f64::NAN);
        format!(
            "Beside rays through the same 32 samples visibility is off by {} over the silhouette pixels of planar \
             receivers; on the bumpy receiver {valid:.1} of 32 samples are valid (paper: 18.5).",
            text::figure(plane.over_silhouette)
        )
    }

    pub fn parts(self) -> Vec<Part> {
        let row = |c: &Case| {
            let number = |of| c.work.get(of).map_or("–".to_owned(), |v| format!("{v:.1}"));
            vec![
                c.spec.trim_end_matches(",statistics=true").to_owned(),
                text::figure(c.over_silhouette),
                text::figure(c.over_partial),
                number("valid samples"),
                number("valid samples half in shadow"),
                c.work.get("silhouette pixels").map_or("–".to_owned(), |n| text::count(*n as u64)),
            ]
        };
        let groups = SCENES.iter().map(|(what, scene)| Group {
            title: format!("{what}: {scene}"),
            rows: self.cases.iter().filter(|c| c.what == *what).map(row).collect(),
        });
        let heads = vec![
            ("technique", "Name and settings"),
            ("silhouette", "Mean difference of visibility over the silhouette pixels"),
            ("half in shadow", "Mean difference over the pixels that are neither lit nor dark"),
            (
                "valid",
                "Samples that the validity mask leaves, mean over silhouette pixels; the paper: 18.5 of 32 on its bumpy receiver",
            ),
            ("valid, half in shadow", "The same over pixels that are neither lit nor dark"),
            ("pixels", "Silhouette pixels"),
        ];
        let groups: Vec<Group> = groups.collect();
        let mut parts = vec![Part {
            title: "Rays at the same samples (figures 8 and 9)".into(),
            text: "Visibility beside rays through the same 32 samples of every pixel, with and without the validity mask. \
                   On planes only the table's rounding of lines differs; where a pixel holds more than one surface, its \
                   facet stands for all of them."
                .into(),
            shown: vec![Shown::Table(Table { heads, groups })],
        }];
        let shown = self.cases.into_iter().filter(|c| c.spec == SPEC || c.scene == "bumpy");
        let pictures = shown.flat_map(|c| {
            let off = text::figure(c.over_silhouette);
            let names = [c.spec.trim_end_matches(",statistics=true"), "rays", "10 x the difference"];
            let remarks = [c.scene.clone(), c.scene.clone(), format!("{off} over silhouettes")];
            names
                .into_iter()
                .map(str::to_owned)
                .zip(remarks)
                .zip(c.pictures)
                .map(|((n, r), p)| (n, r, p))
                .collect::<Vec<_>>()
        });
        parts.push(Part {
            title: "Ours, rays, ten times the difference (figure 8)".into(),
            text: "Pixels that see a silhouette of what they look at, or turn away from the light, are black in the \
                   difference."
                .into(),
            shown: vec![Shown::Gallery(pictures.collect())],
        });
        let cage = self.cage.into_iter().map(|(n, p)| (super::table::spec(n), format!("{n} samples"), p));
        parts.push(Part {
            title: "Samples on thin wires (figure 11)".into(),
            text: "The paper: shadows of the cage's lines are missed at 1 and at 8 samples, 32 hold almost all of them, 128 \
                   are smooth."
                .into(),
            shown: vec![Shown::Gallery(cage.collect())],
        });
        parts
    }
}
