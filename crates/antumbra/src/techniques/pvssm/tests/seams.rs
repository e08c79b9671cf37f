//! Kernels that overlap several tiles: many tiles give the result of one map of the same resolution.

use super::super::analysis::Analysis;
use super::super::drawing::{Drawing, Pool};
use super::super::filtering::Filtering;
use super::super::plan::{Decided, Plan};
use super::super::{PvssmSettings, PvssmUniform};
use super::{drawn, gpu, scene, submit};
use crate::gpu::resources::{buffer_of, uniform};
use crate::scene::SceneRenderer;
use pollster::block_on;

const SIZE: [u32; 2] = [128, 96];
/// Texels over the whole window.
const RESOLUTION: f32 = 256.0;

/// The visibility if every cell needs the same resolution, and the number of tiles and rounds.
fn with_constant_resolution(renderer: &SceneRenderer, tile: u32) -> (Vec<f32>, [u32; 2]) {
    let settings = PvssmSettings { map: 256, tile, rounds: 16, grid: 16, thrifty: false, ..PvssmSettings::default() };
    let gpu = gpu();
    let nodes: u32 = (0..=4).map(|level| (16u32 >> level).pow(2)).sum();
    let mut stored = vec![0.0; 2 * nodes as usize];
    stored[..2 * 256].fill(RESOLUTION);
    let grid = buffer_of(gpu, "tile grid", bytemuck::cast_slice(&stored), wgpu::BufferUsages::STORAGE);
    let pvssm = uniform(gpu, "pvssm", &PvssmUniform::new(&settings));
    let mut made = None;
    submit(|recorder| {
        let frame = &renderer.frame.bind(recorder)?;
        let analysis = Analysis::record(recorder, frame, &settings, &pvssm)?;
        let plan = Plan::ask(recorder, &frame.casters, &settings, &pvssm);
        plan.decide(recorder, &grid, None)?;
        let filtering = Filtering::bin_pixels(recorder, frame, &settings, &analysis, &plan)?;
        let drawing = Drawing::prepare(recorder, frame, &settings)?;
        let pool = Pool::ask(recorder, tile);
        for round in 0..settings.rounds {
            drawing.cull(recorder, &frame.casters, &plan, round)?;
            drawing.draw_tiles(recorder, &frame.casters, &plan, &pool, round)?;
            pool.reduce_tiles(recorder, frame, &plan, round)?;
            filtering.soften(recorder, frame, &analysis, &plan, &pool, round)?;
        }
        made = Some(plan.tiles);
        Ok(())
    });
    let decided = block_on(Decided::read(gpu, &made.expect("decided"))).expect("reads");
    let visibility = block_on(renderer.read_visibility(gpu)).expect("reads");
    (visibility, [decided.tiles.len() as u32, decided.rounds])
}

#[test]
fn tiles_of_one_resolution_are_one_map() {
    for (name, most_over) in [("fence:slats=9", 4), ("square", 0), ("layers", 150), ("plant", 20)] {
        let renderer = drawn(&scene(name), SIZE);
        let (whole, one) = with_constant_resolution(&renderer, 256);
        assert_eq!(one, [1, 1], "{name}");
        for (tile, expected) in [(128, [4, 4]), (64, [16, 16])] {
            let (parts, tiles) = with_constant_resolution(&renderer, tile);
            assert_eq!(tiles, expected, "{name}: tiles and rounds of {tile} texels");
            let differences: Vec<f32> = whole.iter().zip(&parts).map(|(a, b)| (a - b).abs()).collect();
            let worst = differences.iter().copied().fold(0.0, f32::max);
            let over = differences.iter().filter(|d| **d >= 1e-3).count();
            let penumbra = whole.iter().filter(|v| (0.01..0.99).contains(*v)).count();
            let mean = differences.iter().sum::<f32>() / penumbra as f32;
            println!("{name}, tiles of {tile}: {mean} in the mean, at most {worst}, {over} of {penumbra} over 1e-3");
            assert!(penumbra > 200, "{name}: {penumbra} pixels in penumbra");
            assert!(mean < 3e-4, "{name}, tiles of {tile}: {mean} in the mean");
            // Rasterisers move corners to a grid of 1/256 texel, relative to which positions in the pool differ. Where
            // an edge passes the middle of a texel, that texel may be drawn in one map and not in the other. It is a
            // hundredth of the kernels that it lies in. Sheets over each other have many such edges, a receiver over
            // which nothing but one caster lies has almost none.
            assert!(worst < 0.025, "{name}, tiles of {tile}: {worst}");
            assert!(over <= most_over, "{name}, tiles of {tile}: {over} pixels, {worst}");
        }
    }
}
