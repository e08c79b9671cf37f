//! Where maps are spent: within the budget, at thin casters too, and by what the camera or the light sees.

use crate::common::{camera, compared, cuboid, drawn, gpu, ground, light, scene, submit, technique, truth};
use crate::{SIZE, hovering, seen, stat, visibility};
use antumbra::View;
use antumbra::scene::SceneRenderer;
use antumbra_metrics::Metrics;
use antumbra_reference::Reference;
use glam::Vec2;

#[test]
fn a_budget_of_maps_is_kept_and_spent_once() {
    for size in [Vec2::new(0.9, 0.7), Vec2::new(1.1, 0.0)] {
        let scene = hovering(size);
        let (renderer, truth) = (seen(&scene), truth(&scene, SIZE, 1024));
        for budget in [4, 5, 8, 20, 63] {
            let mut adaptive = technique(&format!("adaptive-sampling:tolerance=0,map=128,maps={budget}"));
            let found = visibility(&renderer, &mut adaptive);
            let (maps, drawn) = (stat(&adaptive, "maps"), stat(&adaptive, "maps drawn"));
            let error = compared(&found, &truth).average_error;
            println!("light of {size} m: {maps} maps of {budget}, {drawn} drawn, error {error:.4}");
            assert!(found.iter().all(|v| (0.0..=1.0).contains(v)), "{size}, {budget} maps: beyond [0, 1]");
            assert!(maps <= budget, "{size}: {maps} maps of {budget}");
            // A cell of a rectangle brings five samples at most, so fewer are left over.
            assert!(maps + 5 > budget || maps == 17, "{size}: only {maps} maps of {budget}");
            assert_eq!(drawn, maps, "{size}, {budget} maps: some are drawn twice or never");
            let bound = if budget < 20 { 0.12 } else { 0.03 };
            assert!(error < bound, "{size}, {budget} maps: error {error}");
        }
    }
}

/// Metrics and number of maps.
fn spent(renderer: &SceneRenderer, truth: &Reference, settings: &str) -> (Metrics, u32) {
    let mut adaptive = technique(&format!("adaptive-sampling:map=256,{settings}"));
    let found = visibility(renderer, &mut adaptive);
    (compared(&found, truth), stat(&adaptive, "maps"))
}

#[test]
fn a_thin_wire_is_overlooked_by_the_paper_s_criterion_and_found_by_the_local_one() {
    // 4 mm thick, 2 m long. Its shadows from two corners of the light differ at few pixels of the picture, however
    // wrong these are. 0.01 is for maps of 512 texels and pictures of 1024 x 768: 1/300 of the pixels. Here, with maps
    // of 256 texels, that share is 0.001.
    let size = [160, 120];
    let wire = cuboid([-1.0, 0.598, -0.002], [1.0, 0.602, 0.002]);
    let view = camera([0.0, 3.9, 2.7], [0.0, 0.0, -0.05], 45.0);
    let scene = scene(vec![ground(20.0), wire], view, light([-0.7, 3.2, 0.5], [0.0, 0.3, 0.0], 0.5));
    let (renderer, truth) = (drawn(&scene, size), truth(&scene, size, 1024));
    let (local, many) = spent(&renderer, &truth, "filter=pcf,tolerance=0.02");
    println!("local: {many} maps, error {:.4}, at most {:.3}", local.average_error, local.max);
    assert!(local.counts.penumbra > 200 && many >= 20, "{many} maps, {:?}", local.counts);
    for epsilon in [0.001, 0.01, 0.02] {
        let settings = format!("filter=pcf,criterion=relative,weights=paper,epsilon={epsilon}");
        let (paper, few) = spent(&renderer, &truth, &settings);
        println!("epsilon {epsilon}: {few} maps, error {:.4}, at most {:.3}", paper.average_error, paper.max);
        assert!((4..=9).contains(&few), "epsilon {epsilon}: {few} maps");
        assert!(local.average_error < 0.5 * paper.average_error, "epsilon {epsilon}: {paper:?}, local {local:?}");
        assert!(local.max < 0.6 * paper.max, "epsilon {epsilon}: at most {}, local {}", paper.max, local.max);
    }
}

#[test]
fn a_finer_threshold_takes_more_maps_and_errs_less() {
    let scene = hovering(Vec2::new(0.9, 0.7));
    let (renderer, truth) = (seen(&scene), truth(&scene, SIZE, 1024));
    for (what, thresholds) in [
        ("filter=cell,tolerance", [0.3, 0.1, 0.03]),
        ("filter=pcf,tolerance", [0.3, 0.1, 0.03]),
        ("filter=pcf,criterion=relative,epsilon", [0.02, 0.01, 0.005]),
    ] {
        let table = thresholds.map(|t| {
            let (figures, maps) = spent(&renderer, &truth, &format!("{what}={t}"));
            (t, maps, figures.average_error)
        });
        println!("{what}: (threshold, maps, error) {table:.4?}");
        assert!(table.windows(2).all(|w| w[1].1 > w[0].1), "{what}: maps do not rise: {table:?}");
        assert!(table[2].2 < 0.5 * table[0].2, "{what}: the error does not fall: {table:?}");
    }
}

#[test]
fn far_away_shadows_take_fewer_maps_unless_the_light_s_view_decides() {
    let scene = hovering(Vec2::new(0.9, 0.7));
    let mut renderer = seen(&scene);
    let eyes = [1.0, 4.0, 12.0].map(|far| camera([1.5 * far, 1.7 * far, 2.6 * far], [0.1, 0.3, 0.1], 42.0));
    let mut maps = |settings: &str| {
        eyes.map(|eye| {
            let (light, frustum) = (renderer.frame.light, renderer.frame.frustum);
            renderer.frame.update(View::of_camera(&eye, SIZE), light, frustum);
            submit(|encoder| renderer.record_geometry(gpu(), encoder, None)).unwrap_or_else(|e| panic!("{e}"));
            let mut adaptive = technique(&format!("adaptive-sampling:{settings}"));
            visibility(&renderer, &mut adaptive);
            stat(&adaptive, "maps")
        })
    };
    for settings in ["tolerance=0.03", "criterion=relative", "criterion=absolute,gamma=0.1"] {
        let by_camera = maps(&format!("map=64,{settings}"));
        println!("{settings}: {by_camera:?} maps");
        let falls = by_camera[0] >= by_camera[1] && by_camera[1] >= by_camera[2] && by_camera[0] > 2 * by_camera[2];
        assert!(falls, "{settings}: {by_camera:?} maps");
    }
    for settings in ["criterion=relative", "criterion=absolute,gamma=0.1"] {
        let by_light = maps(&format!("map=256,depth=3,space=light,{settings}"));
        println!("{settings},space=light: {by_light:?} maps");
        let is_steady = by_light.iter().all(|m| *m == by_light[0]);
        assert!((9..128).contains(&by_light[0]) && is_steady, "{settings}: {by_light:?} maps");
    }
}
