//! Figure 11: analytic antialiasing beside supersampling.

use crate::Error;
use crate::kit::{Ratio, Runner, Section};
use crate::page::text;
use crate::suites::shapes::{instance, rectangle};
use crate::table::{Table, column};
use antumbra_scene::{Camera, Material, Mesh, RectLight, Scene};
use glam::{Vec2, Vec3};

/// Pixels per side of the image before supersampling.
const SIDE: u32 = 64;
const MAP: u32 = 1024;
/// The supersampled technique: the same filter without the pixel's footprint.
const PLAIN: &str = "pcss";

/// Samples per side of the reference.
const REFERENCE: u32 = 32;

/// A SPEC, its samples per side of a pixel, and its result.
struct Row {
    spec: String,
    samples_per_side: u32,
    rmse: f64,
    ms: f64,
}

/// The rows of the figure.
pub struct Antialiased {
    rows: Vec<Row>,
}

/// Bars of a grid over a floor that extends to the horizon, and a small light.
fn grid() -> Scene {
    let mut grid = Mesh::default();
    for at in (-50..=50).map(|i| 4.0 * i as f32) {
        for bar in [rectangle(Vec3::new(at, 8.0, 0.0), [0.8, 200.0]), rectangle(Vec3::new(0.0, 8.0, at), [200.0, 0.8])]
        {
            let first = grid.positions.len() as u32;
            grid.positions.extend(bar.positions);
            grid.indices.extend(bar.indices.iter().map(|i| i + first));
        }
    }
    let meshes = vec![rectangle(Vec3::ZERO, [400.0; 2]), grid];
    let (eye, target) = (Vec3::new(0.5, 3.0, 90.0), Vec3::new(1.5, 0.32, 78.0));
    let (center, below) = (Vec3::new(5.0, 60.0, 8.0), Vec3::new(5.0, 0.0, 7.9));
    Scene {
        name: "grid".into(),
        instances: (0..meshes.len()).map(|mesh| instance(mesh, mesh == 0)).collect(),
        meshes,
        materials: vec![Material::default()],
        camera: Camera { eye, target, up: Vec3::Y, fov_y_deg: 24.0, near: 0.05, far: 1000.0 },
        light: RectLight { center, target: below, up: Vec3::NEG_Z, size: Vec2::splat(0.05), shadow_fov_deg: None },
        size: None,
    }
}

pub fn measure(runner: &Runner) -> Result<Antialiased, Error> {
    let scene = grid();
    let plain = format!("{PLAIN}:map={MAP}");
    let truth = draw(runner, &scene, &plain, REFERENCE)?;
    let mut rows = Vec::new();
    for (spec, samples_per_side) in [
        (format!("smooth-pcss:map={MAP}"), 1),
        ("fvsm".to_owned(), 1),
        (plain.clone(), 1),
        (plain.clone(), 8),
        (plain, REFERENCE),
    ] {
        runner.monitor.check()?;
        let (values, ms) =
            if samples_per_side == REFERENCE { truth.clone() } else { draw(runner, &scene, &spec, samples_per_side)? };
        let squares: f64 = values.iter().zip(&truth.0).map(|(a, b)| f64::from(a - b).powi(2)).sum();
        rows.push(Row { spec, samples_per_side, rmse: (squares / values.len() as f64).sqrt(), ms });
    }
    Ok(Antialiased { rows })
}

/// The mean visibility of each pixel at this number of samples per side, and the milliseconds of the shadow.
fn draw(runner: &Runner, scene: &Scene, spec: &str, samples_per_side: u32) -> Result<(Vec<f32>, f64), Error> {
    let side = SIDE * samples_per_side;
    let loaded = runner.load(scene, [side; 2])?;
    let frames = if samples_per_side == REFERENCE { 1 } else { runner.frames };
    let rendered = loaded.render(&spec.parse()?, frames, |_| ())?;
    let mut averages = vec![0.0; (SIDE * SIDE) as usize];
    for (i, value) in rendered.visibility.iter().enumerate() {
        let (x, y) = (i as u32 % side / samples_per_side, i as u32 / side / samples_per_side);
        averages[(y * SIDE + x) as usize] += value / samples_per_side.pow(2) as f32;
    }
    Ok((averages, rendered.cost.comparable_ms(runner.gpu)))
}

impl Antialiased {
    fn row(&self, spec: &str, samples_per_side: u32) -> &Row {
        self.rows
            .iter()
            .find(|r| r.spec.starts_with(spec) && r.samples_per_side == samples_per_side)
            .expect("all rows are measured")
    }

    pub fn section(&self) -> Section {
        let eight = self.row(PLAIN, 8).ms;
        let columns = [
            column("technique", "Name and settings", "", |row: &&Row| row.spec.clone()),
            column("samples", "Samples per pixel", "", |row: &&Row| format!("{0} x {0}", row.samples_per_side)),
            column("RMSE", "Against 32 x 32 samples", "", |row: &&Row| text::metric(row.rmse)),
            column("ms", "GPU time of the shadow", "ms", |row: &&Row| text::ms(row.ms)),
            column("speed", "Over 8 x 8 samples", "", move |row: &&Row| text::ratio(eight / row.ms)),
        ];
        let title = format!("grid, a small light, {SIDE} x {SIDE} pixels");
        let text = format!(
            "A grid over a floor that extends to the horizon, a map of {MAP} texels; the reference is the same map at \
             32 x 32 samples per pixel, {} ms. The paper reports 280 frames per second, and 30 for 8 x 8 samples, \
             which look worse.",
            text::ms(self.row(PLAIN, REFERENCE).ms)
        );
        let table = Table::new(&columns, title, &self.rows);
        Section::new("Figure 11: analytic antialiasing", text, vec![table.into()])
    }

    pub fn ratio(&self) -> Ratio {
        let (smooth, many) = (self.row("smooth-pcss", 1), self.row(PLAIN, 8));
        Ratio {
            what: "speed of antialiasing over 8 x 8 samples",
            trial: "figure 11".to_owned(),
            spec: smooth.spec.clone(),
            base: format!("{}, 8 x 8", many.spec),
            paper: Some(280.0 / 30.0),
            ours: many.ms / smooth.ms,
        }
    }

    pub fn lead(&self) -> String {
        let (smooth, many) = (self.row("smooth-pcss", 1), self.row(PLAIN, 8));
        format!(
            "Analytic antialiasing has an RMSE of {} against 32 x 32 samples (8 x 8: {}) and is {} times as fast as 8 x 8 \
             (paper: 9.3).",
            text::metric(smooth.rmse),
            text::metric(many.rmse),
            text::ratio(many.ms / smooth.ms)
        )
    }

    #[cfg(test)]
    pub fn made_up() -> Antialiased {
        let row = |(spec, samples_per_side): (&str, u32)| Row {
            spec: spec.into(),
            samples_per_side,
            rmse: 0.01,
            ms: f64::from(samples_per_side),
        };
        Antialiased {
            rows: [("smooth-pcss", 1), ("fvsm", 1), (PLAIN, 1), (PLAIN, 8), (PLAIN, REFERENCE)].map(row).into(),
        }
    }
}
