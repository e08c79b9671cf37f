//! Figure 11: analytic antialiasing beside drawing the picture many times as large and averaging.

use super::super::kit::{Group, Lab, Part, Ratio, Shown, Table};
use crate::error::CliError;
use crate::report::text;
use crate::{measure, progress, setup};
use antumbra::Spec;
use antumbra_scene::{Camera, Instance, Material, Mesh, RectLight, Scene};
use glam::{Affine3A, Vec2, Vec3};

/// Pixels a side of the picture; supersampled, it is that many times as large.
const SIDE: u32 = 64;
const MAP: u32 = 1024;
/// What is supersampled: the same filter without the pixel's footprint.
const PLAIN: &str = "pcss";

/// What is drawn: its SPEC and how many times as large the picture is.
struct Row {
    spec: String,
    times: u32,
    rmse: f64,
    ms: f64,
}

/// The rows of the figure.
pub struct Smoothed {
    rows: Vec<Row>,
}

/// A level rectangle.
fn sheet(center: [f32; 3], half: [f32; 2]) -> Mesh {
    let corner = |[x, z]: [f32; 2]| Vec3::from(center) + Vec3::new(x * half[0], 0.0, z * half[1]);
    let positions = [[-1.0, 1.0], [1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]].map(corner).to_vec();
    Mesh { positions, indices: vec![0, 1, 2, 0, 2, 3], ..Mesh::default() }
}

/// Bars of a grid over a floor that is seen up to the horizon, and a small light.
fn grid() -> Scene {
    let mut grid = Mesh::default();
    for at in (-50..=50).map(|i| 4.0 * i as f32) {
        for bar in [sheet([at, 8.0, 0.0], [0.8, 200.0]), sheet([0.0, 8.0, at], [200.0, 0.8])] {
            let first = grid.positions.len() as u32;
            grid.positions.extend(bar.positions);
            grid.indices.extend(bar.indices.iter().map(|i| i + first));
        }
    }
    let meshes = vec![sheet([0.0; 3], [400.0; 2]), grid];
    let instance = |mesh| Instance { mesh, world_from_object: Affine3A::IDENTITY, receiver_only: mesh == 0 };
    let (eye, target) = (Vec3::new(0.5, 3.0, 90.0), Vec3::new(1.5, 0.32, 78.0));
    let (center, below) = (Vec3::new(5.0, 60.0, 8.0), Vec3::new(5.0, 0.0, 7.9));
    Scene {
        name: "grid".into(),
        instances: (0..meshes.len()).map(instance).collect(),
        meshes,
        materials: vec![Material::default()],
        camera: Camera { eye, target, up: Vec3::Y, fov_y_deg: 24.0, near: 0.05, far: 1000.0 },
        light: RectLight { center, target: below, up: Vec3::NEG_Z, size: Vec2::splat(0.05), shadow_fov_deg: None },
        size: None,
    }
}

pub fn measure(lab: &Lab) -> Result<Smoothed, CliError> {
    let scene = grid();
    let plain = format!("{PLAIN}:map={MAP}");
    let truth = draw(lab, &scene, &plain, 32)?;
    let mut rows = Vec::new();
    for (spec, times) in [
        (format!("smooth-pcss:map={MAP}"), 1),
        ("fvsm".to_owned(), 1),
        (plain.clone(), 1),
        (plain.clone(), 8),
        (plain, 32),
    ] {
        progress::check_cancelled()?;
        let (values, ms) = if times == 32 { truth.clone() } else { draw(lab, &scene, &spec, times)? };
        let squares: f64 = values.iter().zip(&truth.0).map(|(a, b)| f64::from(a - b).powi(2)).sum();
        rows.push(Row { spec, times, rmse: (squares / values.len() as f64).sqrt(), ms });
    }
    Ok(Smoothed { rows })
}

/// The picture `times` as large, averaged, and the milliseconds of the shadow.
fn draw(lab: &Lab, scene: &Scene, spec: &str, times: u32) -> Result<(Vec<f32>, f64), CliError> {
    let side = SIDE * times;
    lab.gpu.check_size("picture", side, side)?;
    let renderer = setup::renderer(lab.gpu, scene, [side; 2])?;
    let spec: Spec = spec.parse().map_err(antumbra::Error::from)?;
    let frames = if times == 32 { 1 } else { lab.args.gpu.frames };
    let drawn = measure::draw(lab.gpu, &renderer, &spec, frames, |_| ())?;
    let mut averages = vec![0.0; (SIDE * SIDE) as usize];
    for (i, value) in drawn.visibility.iter().enumerate() {
        let (x, y) = (i as u32 % side / times, i as u32 / side / times);
        averages[(y * SIDE + x) as usize] += value / (times * times) as f32;
    }
    let ms = if lab.gpu.is_software() { drawn.cost.wall_ms } else { drawn.cost.total_ms };
    Ok((averages, ms))
}

impl Smoothed {
    fn row(&self, spec: &str, times: u32) -> &Row {
        self.rows.iter().find(|r| r.spec.starts_with(spec) && r.times == times).expect("all rows are measured")
    }

    pub fn part(&self) -> Part {
        let truth = self.row(PLAIN, 32);
        let cells = |row: &Row| {
            let speed = text::ratio(self.row(PLAIN, 8).ms / row.ms);
            vec![row.spec.clone(), format!("{0} x {0}", row.times), text::figure(row.rmse), text::ms(row.ms), speed]
        };
        let heads = vec![
            ("technique", "Name and settings"),
            ("samples", "Of a pixel"),
            ("RMSE", "Against 32 x 32 samples"),
            ("ms", "Milliseconds of the shadow"),
            ("speed", "Over 8 x 8 samples"),
        ];
        let rows = self.rows.iter().map(cells).collect();
        let title = format!("grid, a small light, {SIDE} x {SIDE} pixels");
        Part {
            title: "Figure 11: analytic antialiasing".into(),
            text: format!(
                "A grid over a floor that is seen up to the horizon, a map of {MAP} texels; the truth is the same map by 32 x 32 samples of a pixel, \
                 {} ms. The paper: 280 frames a second where 8 x 8 samples have 30 and look worse.",
                text::ms(truth.ms)
            ),
            shown: vec![Shown::Table(Table { heads, groups: vec![Group { title, rows }] })],
        }
    }

    pub fn ratios(&self) -> Vec<Ratio> {
        let (smooth, many) = (self.row("smooth-pcss", 1), self.row(PLAIN, 8));
        vec![Ratio {
            what: "speed of antialiasing over 8 x 8 samples",
            trial: "figure 11".to_owned(),
            spec: smooth.spec.clone(),
            base: format!("{}, 8 x 8", many.spec),
            paper: Some(280.0 / 30.0),
            ours: many.ms / smooth.ms,
        }]
    }

    pub fn lead(&self) -> String {
        let (smooth, many) = (self.row("smooth-pcss", 1), self.row(PLAIN, 8));
        format!(
            "Analytic antialiasing is off 32 x 32 samples by {} (8 x 8: {}) and {} times as fast as 8 x 8 (paper: 9.3).",
            text::figure(smooth.rmse),
            text::figure(many.rmse),
            text::ratio(many.ms / smooth.ms)
        )
    }

    #[cfg(test)]
    pub fn made_up() -> Smoothed {
        let row = |(spec, times): (&str, u32)| Row { spec: spec.into(), times, rmse: 0.01, ms: f64::from(times) };
        Smoothed { rows: [("smooth-pcss", 1), ("fvsm", 1), (PLAIN, 1), (PLAIN, 8), (PLAIN, 32)].map(row).into() }
    }
}
