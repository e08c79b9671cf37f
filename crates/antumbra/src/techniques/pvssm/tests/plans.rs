//! The kd-tree and the shelves on the GPU against those on the CPU, and the invariants of every plan.

use super::super::decide::{Grid, decide};
use super::super::plan::{Decided, MOST_OF_ROUND, Plan, batch_groups};
use super::super::{Decision, PvssmSettings, PvssmUniform};
use super::{Random, drawn, gpu, scene, shadowed, stat, submit, technique};
use crate::gpu::readback::read_buffer;
use crate::gpu::resources::{buffer_of, uniform};
use glam::{UVec2, Vec2};
use pollster::block_on;

/// A grid in which a few cells need many texels, a region few, and the rest none.
fn random_grid(random: &mut Random, settings: &PvssmSettings) -> Vec<Vec2> {
    let side = settings.grid;
    let mut cells = vec![Vec2::ZERO; (side * side) as usize];
    // No pixel needs more than a tile per cell.
    let most = 10f32.powf(random.within(1.5, 5.0)).min((side * settings.tile) as f32);
    let mut fill = |low: UVec2, size: UVec2, value: Vec2| {
        let high = (low + size).min(UVec2::splat(side));
        for y in low.y..high.y {
            for x in low.x..high.x {
                let cell = &mut cells[(y * side + x) as usize];
                *cell = cell.max(value);
            }
        }
    };
    for k in 0..6 {
        let at = UVec2::new(random.within(0.0, side as f32) as u32, random.within(0.0, side as f32) as u32);
        let size = UVec2::splat(1 + random.within(0.0, side as f32 / f32::from(1u8 << k)) as u32);
        let value = Vec2::new(random.within(0.1, 1.0), random.within(0.1, 1.0)) * most * 2f32.powi(k - 5);
        fill(at, size, value);
    }
    cells
}

/// The invariants of a plan for these cells.
fn check(decided: &Decided, cells: &[Vec2], settings: &PvssmSettings) {
    let side = settings.grid;
    let mut covered = vec![None; cells.len()];
    for (i, tile) in decided.tiles.iter().enumerate() {
        let [x, y, width, height] = tile.cells.to_array();
        assert!(tile.texels.cmpgt(UVec2::ZERO).all() && tile.texels.max_element() <= settings.tile, "{tile:?}");
        assert!((tile.position + tile.texels).max_element() <= settings.tile, "beyond the pool: {tile:?}");
        for other in decided.tiles[..i].iter().filter(|t| t.round == tile.round) {
            let apart = (tile.position + tile.texels).cmple(other.position)
                | (other.position + other.texels).cmple(tile.position);
            assert!(apart.any(), "{tile:?} and {other:?} share texels");
        }
        for cell in (y..y + height).flat_map(|row| (x..x + width).map(move |column| (row * side + column) as usize)) {
            assert_eq!(covered[cell].replace(i), None, "two tiles show cell {cell}");
        }
    }
    for (tile, wanted) in covered.iter().zip(cells) {
        if wanted.x > 0.0 {
            let tile = &decided.tiles[tile.expect("every cell with a resolution is in a tile")];
            let resolution = tile.texels.as_vec2() / Vec2::new(tile.cells.z as f32, tile.cells.w as f32) * side as f32;
            // A single cell is no larger than a tile.
            let most = Vec2::splat((side * settings.tile) as f32);
            let needed = (*wanted / decided.coarser).min(most) * (1.0 - 1e-6);
            assert!(resolution.cmpge(needed).all(), "{resolution} of {tile:?} where {needed} is needed");
        }
    }
    assert!(decided.rounds <= settings.rounds, "{} rounds", decided.rounds);
    for round in 0..decided.rounds {
        let of_round = decided.tiles.iter().filter(|t| t.round == round).count();
        assert!((1..=MOST_OF_ROUND).contains(&of_round), "{of_round} tiles in round {round}");
    }
}

fn settings(random: &mut Random) -> PvssmSettings {
    PvssmSettings {
        grid: 16 << (random.unit() * 3.0) as u32,
        tile: 64 << (random.unit() * 6.0) as u32,
        rounds: 1 + (random.unit() * 15.0) as u32,
        thrifty: random.unit() < 0.5,
        ..PvssmSettings::default()
    }
}

#[test]
fn every_plan_covers_the_needed_cells_and_fits_the_pool() {
    let mut random = Random(81);
    let (mut tiles, mut coarser) = (0, 0);
    for _ in 0..300 {
        let settings = settings(&mut random);
        let cells = random_grid(&mut random, &settings);
        let decided = decide(&Grid::of_cells(settings.grid, cells.clone()), &settings);
        check(&decided, &cells, &settings);
        tiles += decided.tiles.len();
        coarser += usize::from(decided.coarser > 1.0);
    }
    println!("{tiles} tiles in 300 plans, {coarser} plans made coarser");
    assert!(tiles > 1000 && (20..280).contains(&coarser), "the cases are too much alike: {tiles} tiles, {coarser}");
}

#[test]
fn an_empty_grid_has_no_tile_and_one_cell_has_one() {
    let settings = PvssmSettings::default();
    let mut cells = vec![Vec2::ZERO; (settings.grid * settings.grid) as usize];
    let nothing = decide(&Grid::of_cells(settings.grid, cells.clone()), &settings);
    assert_eq!((nothing.tiles.len(), nothing.rounds), (0, 0));
    cells[70] = Vec2::splat(100.0);
    let one = decide(&Grid::of_cells(settings.grid, cells), &settings);
    assert_eq!((one.tiles.len(), one.rounds, one.tiles[0].texels), (1, 1, UVec2::splat(112)));
}

#[test]
fn a_tile_is_split_where_it_would_be_too_large() {
    // 1000 texels for each of 64 cells is 64000 for all: 32 tiles of 2048 per side.
    let settings = PvssmSettings { thrifty: false, rounds: 16, ..PvssmSettings::default() };
    let mut cells = vec![Vec2::splat(10.0); (settings.grid * settings.grid) as usize];
    cells[0] = Vec2::splat(64_000.0);
    let decided = decide(&Grid::of_cells(settings.grid, cells), &settings);
    let finest = &decided.tiles.iter().find(|t| t.cells.x == 0 && t.cells.y == 0).expect("the corner has a tile");
    assert_eq!((finest.cells.z, finest.cells.w, finest.texels), (2, 2, UVec2::splat(2048)), "{decided:?}");
    // Halves of halves, five times along each axis.
    assert_eq!(decided.tiles.len(), 11);
}

fn words(buffer: &wgpu::Buffer) -> Vec<u32> {
    bytemuck::pod_collect_to_vec(&block_on(read_buffer(gpu(), buffer)).unwrap_or_else(|e| panic!("{e}")))
}

#[test]
fn the_gpu_decides_as_the_cpu_does() {
    let renderer = drawn(&scene("square"), [16, 16]);
    let casters = &renderer.frame.casters;
    let mut random = Random(82);
    for round in 0..40 {
        let settings = settings(&mut random);
        let cells = random_grid(&mut random, &settings);
        // Some resolutions are stored at a coarser level.
        let mut stored: Vec<f32> = cells.iter().flat_map(|c| c.to_array()).collect();
        for level in 1..=settings.grid.ilog2() {
            let count = (settings.grid >> level).pow(2);
            stored.extend((0..2 * count).map(|_| 0.0));
            if random.unit() < 0.3 {
                let node = stored.len() - 2 - 2 * (random.unit() * count as f32) as usize;
                let value = random.within(10.0, 1000.0);
                stored[node..node + 2].fill(value);
            }
        }
        let grid = buffer_of(gpu(), "tile grid", bytemuck::cast_slice(&stored), wgpu::BufferUsages::STORAGE);
        let pvssm = uniform(gpu(), "pvssm", &PvssmUniform::new(&settings));
        let mut made = None;
        submit(|recorder| {
            let plan = Plan::ask(recorder, casters, &settings, &pvssm);
            plan.decide(recorder, &grid, None)?;
            made = Some(plan);
            Ok(())
        });
        let plan = made.expect("decided");
        let by_gpu = block_on(Decided::read(gpu(), &plan.tiles)).unwrap_or_else(|e| panic!("{e}"));
        let by_cpu = decide(&Grid::of_stored(settings.grid, &stored), &settings);
        assert_eq!(format!("{by_gpu:?}"), format!("{by_cpu:?}"), "plan {round} with {settings:?}");
        assert_eq!(words(&plan.cells), by_cpu.cells(settings.grid), "cells of plan {round}");
        let arguments = by_cpu.arguments(settings.rounds, &batch_groups(casters));
        assert_eq!(words(&plan.arguments), arguments, "arguments of plan {round}");
    }
}

#[test]
fn waiting_for_the_grid_gives_the_same_visibility() {
    assert_ne!(PvssmSettings::default().decision, Decision::Wait);
    for name in ["fence:slats=12", "plant"] {
        let renderer = drawn(&scene(name), [96, 96]);
        let [gpu, cpu] = ["gpu", "wait"].map(|who| {
            let mut one = technique(&format!("pvssm:map=256,tile=256,rounds=16,decision={who}"));
            let visibility = shadowed(&renderer, &mut one);
            println!("{name}, {who}: {} tiles in {} rounds", stat(&one, "tiles"), stat(&one, "rounds"));
            visibility
        });
        assert!(gpu == cpu, "{name}: the decision changes the visibility");
    }
}

#[test]
fn tiles_are_kept_while_light_and_casters_are_static_only() {
    let mut renderer = drawn(&scene("fence:slats=12"), [96, 96]);
    let mut one = technique("pvssm:map=256,tile=1024");
    let first = shadowed(&renderer, &mut one);
    assert_eq!(stat(&one, "tiles kept"), 0.0);
    let tiles = stat(&one, "tiles");
    renderer.frame.static_casters = true;
    let second = shadowed(&renderer, &mut one);
    assert_eq!(stat(&one, "tiles kept"), tiles, "all of {tiles} tiles");
    assert!(second == first, "kept tiles differ");
    // The light moves: no tile is kept, and the visibility is that of a new instance.
    let mut light = renderer.frame.light;
    light.center.x += 0.3;
    let (view, frustum) = (renderer.frame.view, renderer.frame.frustum);
    renderer.frame.update(view, light, frustum);
    let moved = shadowed(&renderer, &mut one);
    assert_eq!(stat(&one, "tiles kept"), 0.0);
    assert!(moved == shadowed(&renderer, &mut technique("pvssm:map=256,tile=1024")), "an old tile is used");
    assert!(moved != first, "the light has moved");
    // A caster may have moved.
    renderer.frame.static_casters = false;
    shadowed(&renderer, &mut one);
    assert_eq!(stat(&one, "tiles kept"), 0.0);
}
