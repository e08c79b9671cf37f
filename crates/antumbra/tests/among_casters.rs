//! A light among its casters, as a host hands it over that knows no more than the box around them.

mod common;

use antumbra::ShadowFrustum;
use antumbra::techniques::TECHNIQUES;
use common::{camera, compared, cuboid, drawn, ground, light, scene, shadowed, technique, truth};
use std::time::Instant;

const SIZE: [u32; 2] = [96, 72];

/// A panel one metre above the ground, beside a box that is higher: the shadow is that of the fitted frustum, in about
/// the same time.
#[test]
fn a_panel_beside_a_box_that_is_higher_casts_its_shadow() {
    let meshes = vec![ground(4.0), cuboid([-0.8, 0.0, -0.8], [0.8, 1.6, 0.8])];
    let view = camera([-3.2, 2.8, 3.4], [-0.6, 0.2, 0.3], 50.0);
    let panel = light([1.3, 1.0, 0.2], [1.3, 0.0, 0.2], 0.4);
    let scene = scene(meshes, view, panel);
    let truth = truth(&scene, SIZE, 256);
    let mut renderer = drawn(&scene, SIZE);
    let around = ShadowFrustum::around(&panel, &renderer.frame.casters.bounds());
    let fitted = renderer.frame.frustum;
    println!("around {around:?}\nfitted {fitted:?}");
    let mut wrong = Vec::new();
    for info in TECHNIQUES {
        let [around, fitted] = [around, fitted].map(|frustum| {
            renderer.frame.update(renderer.frame.view, panel, frustum);
            let has_map = info.settings.iter().any(|s| s.key == "map");
            let mut shadows = technique(&if has_map { format!("{}:map=512", info.name) } else { info.name.to_owned() });
            shadowed(&renderer, &mut shadows).unwrap_or_else(|e| panic!("{}: {e}", info.name));
            let begun = Instant::now();
            let visibility = shadowed(&renderer, &mut shadows).unwrap_or_else(|e| panic!("{}: {e}", info.name));
            (compared(&visibility, &truth), begun.elapsed().as_secs_f32())
        });
        println!(
            "{:18} around: error {:.3} leak {:.3} acne {:.4} {:.2} s; fitted: error {:.3} leak {:.3} acne {:.4} {:.2} s",
            info.name,
            around.0.average_error,
            around.0.leak,
            around.0.acne,
            around.1,
            fitted.0.average_error,
            fitted.0.leak,
            fitted.0.acne,
            fitted.1,
        );
        let lost = around.0.leak > 0.1 || around.0.average_error > 1.2 * fitted.0.average_error + 0.01;
        if lost || around.1 > 4.0 * fitted.1 + 1.0 {
            wrong.push(info.name);
        }
    }
    assert!(wrong.is_empty(), "{wrong:?}");
}
