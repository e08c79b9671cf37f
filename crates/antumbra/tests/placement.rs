//! Nothing is lost: one box in turn in each of 8 x 8 places of the map, with maps of any size, against the truth. Sizes
//! that are halved must be rounded up, or the last nodes of a level vanish with all that lies below them.

mod common;

use antumbra::techniques::TECHNIQUES;
use antumbra_reference::Reference;
use antumbra_scene::Scene;
use common::{camera, compared, cuboid, drawn, ground, light, scene, shadowed, technique, truth};
use glam::Vec3;
use std::collections::HashMap;

/// Texels per side: powers of two are covered by all other tests.
const MAPS: [u32; 7] = [17, 100, 768, 1000, 1536, 1537, 3072];
/// Edges of the light, metres.
const LIGHTS: [f32; 2] = [0.04, 0.4];
/// Places along each side of the map.
const PLACES: u32 = 8;
const SIZE: [u32; 2] = [40, 40];
/// Opening of the map's frustum.
const FOV_DEG: f32 = 50.0;

/// A box above the ground in the middle of a place of the map of a light aslant, and a camera above its shadow.
fn placed([x, y]: [u32; 2], edge: f32) -> Scene {
    let mut light = light([1.2, 3.0, 0.8], [0.0; 3], edge);
    light.shadow_fov_deg = Some(FOV_DEG);
    let (right, up, forward) = light.basis();
    let tangent = |i: u32| ((2 * i + 1) as f32 / PLACES as f32 - 1.0) * (0.5 * FOV_DEG).to_radians().tan();
    let ray = forward + tangent(x) * right + tangent(y) * up;
    // At this height a place is a little wider than the box.
    let at = |height: f32| light.center + ray * ((height - light.center.y) / ray.y);
    let (middle, shadow) = (at(0.25), at(0.0));
    let half = 0.11 * (middle - light.center).length() / 3.0;
    let caster = cuboid((middle - half).to_array(), (middle + half).to_array());
    // From the side away from the light, where the box hides nothing of its shadow.
    let eye = shadow + Vec3::new(-0.5, 1.4, -0.4);
    scene(vec![ground(6.0), caster], camera(eye.to_array(), shadow.to_array(), 40.0), light)
}

/// The error of a technique in one place.
struct Placement {
    spec: String,
    place: [u32; 2],
    edge: f32,
    /// Average error over the shadow.
    error: f64,
    /// Shadow that is drawn, relative to the truth's.
    darkness: f64,
}

/// Scenes and truths, made when they are asked for.
#[derive(Default)]
struct Truths(HashMap<([u32; 2], u32), (Scene, Reference)>);

impl Truths {
    fn of(&mut self, place: [u32; 2], edge: f32) -> &(Scene, Reference) {
        self.0.entry((place, edge.to_bits())).or_insert_with(|| {
            let scene = placed(place, edge);
            let truth = truth(&scene, SIZE, 256);
            (scene, truth)
        })
    }

    fn placement(&mut self, spec: String, place: [u32; 2], edge: f32) -> Placement {
        let (scene, truth) = self.of(place, edge);
        let visibility = shadowed(&drawn(scene, SIZE), &mut technique(&spec));
        let visibility = visibility.unwrap_or_else(|e| panic!("{spec} in {place:?}: {e}"));
        let dark = |v: &[f32]| {
            let valid = v.iter().zip(&truth.valid).filter(|(_, valid)| **valid);
            valid.map(|(v, _)| f64::from(1.0 - v)).sum::<f64>()
        };
        let darkness = dark(&visibility) / dark(&truth.visibility);
        Placement { error: compared(&visibility, truth).average_error, darkness, spec, place, edge }
    }
}

/// SPECs of all techniques with a map of this size; of those without a map once only.
fn specs(map: u32) -> impl Iterator<Item = String> {
    let with_map = move |t: &antumbra::TechniqueInfo| t.settings.iter().any(|s| s.key == "map");
    TECHNIQUES.iter().filter(move |t| with_map(t) || map == MAPS[0]).map(move |t| {
        let few =
            [("samples", 16), ("maps", 16)].into_iter().filter(|(key, _)| t.settings.iter().any(|s| s.key == *key));
        let few: Vec<String> = few.map(|(key, count)| format!(",{key}={count}")).collect();
        if with_map(t) { format!("{}:map={map}{}", t.name, few.concat()) } else { t.name.to_owned() }
    })
}

/// Prints the worst of each technique.
fn report(placements: &[Placement]) {
    for technique in TECHNIQUES {
        for map in MAPS {
            let start = format!("{}:map={map}", technique.name);
            let of = placements.iter().filter(|p| p.spec == start || p.spec.starts_with(&format!("{start},")));
            if let Some(worst) = of.max_by(|a, b| a.error.total_cmp(&b.error)) {
                println!(
                    "{:32} {:?} light {:.2} m: error {:.3}, {:.2} of the shadow",
                    worst.spec, worst.place, worst.edge, worst.error, worst.darkness
                );
            }
        }
    }
}

/// What is lost or invented: less than half of the truth's shadow, or more than three times as much. In a map of 17
/// texels the box is a texel or two wide, and the kernels of filterable maps are wider.
fn check(placements: &[Placement]) {
    report(placements);
    let filterable = ["vsm", "evsm", "msm", "esm", "csm", "savsm", "vssm", "cssm"];
    let is_wide = |p: &Placement| filterable.iter().any(|name| p.spec.starts_with(&format!("{name}:map=17")));
    let wrong = placements.iter().filter(|p| !is_wide(p) && !(0.5..3.0).contains(&p.darkness));
    let place =
        |p: &Placement| format!("{} in {:?}, light {} m: {:.2} of the shadow", p.spec, p.place, p.edge, p.darkness);
    let faults: Vec<String> = wrong.map(place).collect();
    assert!(faults.is_empty(), "{} of {}:\n{}", faults.len(), placements.len(), faults.join("\n"));
}

/// Every technique in one place of a map, a third of them in the last corner, where levels end.
#[test]
fn nothing_is_lost_in_one_place() {
    let (mut truths, mut placements, mut turn) = (Truths::default(), Vec::new(), 0);
    for map in [MAPS[0], MAPS[1], MAPS[2], MAPS[5]] {
        for spec in specs(map) {
            let place = if turn % 3 == 0 { [PLACES - 1; 2] } else { [7 - turn % 3, turn / 3 % PLACES] };
            placements.push(truths.placement(spec, place, LIGHTS[turn as usize % 2]));
            turn += 5;
        }
    }
    check(&placements);
}

/// Every technique in every place of a map.
fn in_all_places(map: u32) {
    let (mut truths, mut placements) = (Truths::default(), Vec::new());
    for spec in specs(map) {
        for place in (0..PLACES * PLACES).map(|i| [i % PLACES, i / PLACES]) {
            placements.extend(LIGHTS.map(|edge| truths.placement(spec.clone(), place, edge)));
        }
    }
    check(&placements);
}

macro_rules! all_places {
    ($($name:ident: $map:expr,)*) => {
        $(#[test]
        #[ignore = "ten minutes or more"]
        fn $name() {
            in_all_places(MAPS[$map]);
        })*
    };
}

all_places! {
    all_places_of_a_map_of_17: 0,
    all_places_of_a_map_of_100: 1,
    all_places_of_a_map_of_768: 2,
    all_places_of_a_map_of_1000: 3,
    all_places_of_a_map_of_1536: 4,
    all_places_of_a_map_of_1537: 5,
    all_places_of_a_map_of_3072: 6,
}
