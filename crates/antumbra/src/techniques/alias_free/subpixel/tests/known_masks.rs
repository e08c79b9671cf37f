//! Masks that one can tell by hand. The facet lies 4 metres below the light, which faces it; a pixel is 1 decimetre
//! wide, and a column of the 8 x 4 samples an eighth of that.

use super::blockers::{Seen, random_seen, shadows};
use super::*;

/// Seen from beside the light, straight down: x of the image is x of space, y down is -y.
fn floor() -> Seen {
    Seen {
        position: DVec3::new(0.0, 0.0, 4.0),
        normal: DVec3::NEG_Z,
        eye: DVec3::new(0.0, 0.0, -1.0),
        across: DVec3::new(0.1, 0.0, 0.0),
        down: DVec3::new(0.0, -0.1, 0.0),
    }
}

fn grid() -> Pattern {
    Pattern::arranged(Arrangement::Grid, 32)
}

/// The samples that a rule picks.
fn picked(rule: impl Fn(DVec2) -> bool) -> Samples {
    grid().samples().iter().enumerate().fold(0, |bits, (i, s)| bits | Samples::from(rule(*s)) << i)
}

fn shadow(seen: Seen, t: [[f64; 3]; 3]) -> [Samples; 2] {
    let turned = [t[0], t[2], t[1]];
    let cases = [t, turned].map(|t| (seen, t.map(DVec3::from)));
    let [one, other] = shadows(&grid(), &cases)[..] else { panic!("two cases") };
    assert_eq!(one, other, "the order of corners is no matter");
    one
}

#[test]
fn a_triangle_halfway_hides_what_its_doubled_edges_hold() {
    // Edge at x = 0.01 halfway: x = 0.02 on the floor, a fifth of the pixel.
    let t = [[0.01, -9.0, 2.0], [0.01, 9.0, 2.0], [9.0, 0.0, 2.0]];
    let [hidden, invalid] = shadow(floor(), t);
    assert_eq!((hidden, invalid), (picked(|s| s.x > 0.2), 0), "{hidden:032b}");
    assert_ne!(hidden & picked(|s| s.x > 0.2), 0);
}

#[test]
fn a_triangle_through_the_lights_plane_hides_by_what_is_before_the_light() {
    // In the plane x = 0.01 + 0.005 (4 - z) - ...: a wall that leans over the light's plane from one side.
    let t = [[0.01, -9.0, 2.0], [0.01, 9.0, 2.0], [9.0, 0.0, -2.0]];
    let [hidden, invalid] = shadow(floor(), t);
    assert_eq!((hidden, invalid), (picked(|s| s.x > 0.2), 0), "{hidden:032b}");
}

#[test]
fn a_triangle_behind_the_light_hides_nothing() {
    let t = [[0.01, -9.0, -2.0], [0.01, 9.0, -2.0], [9.0, 0.0, -1.0]];
    assert_eq!(shadow(floor(), t), [0, 0]);
    // Also where the cone behind the light, mirrored, would cover the facet.
    let t = [[-9.0, -9.0, -1.0], [9.0, -9.0, -1.0], [0.0, 18.0, -1.0]];
    assert_eq!(shadow(floor(), t), [0, 0]);
}

#[test]
fn a_triangle_below_the_facet_hides_nothing_of_it() {
    let t = [[-9.0, -9.0, 4.5], [9.0, -9.0, 4.5], [0.0, 18.0, 4.5]];
    assert_eq!(shadow(floor(), t), [0, 0]);
    // Nor does the facet's own.
    let t = [[-9.0, -9.0, 4.0], [9.0, -9.0, 4.0], [0.0, 18.0, 4.0]];
    assert_eq!(shadow(floor(), t), [0, 0]);
}

#[test]
fn a_triangle_through_the_facet_ends_at_the_line_where_they_meet_and_makes_samples_invalid() {
    // A slope from the light's side, at x > 0.02, down through the floor: it meets the floor at x = 0.02.
    let t = [[9.02, -90.0, -5.0], [9.02, 90.0, -5.0], [-8.98, 0.0, 13.0]];
    let [hidden, invalid] = shadow(floor(), t);
    // The slope stands over x > 0.02. The light lies below it on the other side: points beyond the slope are hidden.
    assert_eq!(hidden, picked(|s| s.x > 0.2), "hidden {hidden:032b}");
    assert_eq!(invalid, picked(|s| s.x > 0.2), "invalid {invalid:032b}");
    // The same slope whose line leaves the pixel's middle on the other side: valid is where the middle is.
    let t = [[8.98, -90.0, -5.0], [8.98, 90.0, -5.0], [-9.02, 0.0, 13.0]];
    let [hidden, invalid] = shadow(floor(), t);
    assert_eq!(hidden, picked(|s| s.x > -0.2), "hidden {hidden:032b}");
    assert_eq!(invalid, picked(|s| s.x < -0.2), "invalid {invalid:032b}");
}

#[test]
fn only_what_is_seen_through_the_meeting_is_invalid() {
    // The slope at x = 0.02 of above, cut at the pixel's middle: its half parts half of the pixel.
    let [top, bottom] = [-90.0, 90.0].map(|y| [9.02, y, -5.0]);
    let (foot, middle) = ([-8.98, 0.0, 13.0], [9.02, 0.0, -5.0]);
    let beyond = |s: DVec2| s.x > 0.2;
    let [hidden, invalid] = shadow(floor(), [middle, bottom, foot]);
    assert_eq!(invalid, picked(|s| beyond(s) && s.y < 0.0), "invalid {invalid:032b}");
    assert_eq!(hidden & !picked(beyond), 0, "hidden {hidden:032b}");
    // The other half splits the rest, and nothing twice.
    let [_, rest] = shadow(floor(), [top, middle, foot]);
    assert_eq!((invalid & rest, invalid | rest), (0, picked(beyond)), "{invalid:032b} {rest:032b}");
    // One that ends a pixel away splits nothing, though its line passes.
    let aside = [[9.02, 0.2, -5.0], bottom, [-8.98, 0.2, 13.0]];
    assert_eq!(shadow(floor(), aside)[1], 0);
}

/// Visibility of a sample position from the centre through a triangle, by the offset of the position.
fn is_behind(seen: &Seen, [a, b, c]: [DVec3; 3], s: DVec2) -> Option<bool> {
    let (from, to) = (seen.position, seen.place(s)?);
    let n = (b - a).cross(c - a);
    let (low, high) = (n.dot(from - a), n.dot(to - a));
    let at = from + (to - from) * low / (low - high);
    let inside = [(a, b), (b, c), (c, a)].map(|(u, v)| n.cross(v - u).normalize().dot(at - u));
    // Beside an edge of the triangle or of the samples' halves either is right.
    let by = inside.iter().fold(f64::INFINITY, |m, v| m.min(v.abs()));
    let pixel = seen.across.length().max(seen.down.length());
    let clear = by > 0.3 * pixel && low.abs().min(high.abs()) > 0.1 * pixel * n.length();
    clear.then(|| low * high < 0.0 && inside.iter().all(|v| *v > 0.0))
}

#[test]
fn a_sample_is_invalid_if_a_triangle_stands_between_it_and_the_middle() {
    let pattern = Pattern::arranged(Arrangement::Rotated, 32);
    let mut random = Random(31);
    let cases: Vec<_> = (0..6000)
        .map(|_| {
            let seen = random_seen(&mut random);
            let size = 2.0 * seen.across.length();
            let corner = |random: &mut Random| seen.position + random.point(DVec3::splat(-size), DVec3::splat(size));
            (seen, [corner(&mut random), corner(&mut random), corner(&mut random)])
        })
        .collect();
    let (mut looked, mut behind, mut wrong) = (0, 0, 0);
    for ((seen, t), [_, invalid]) in cases.iter().zip(shadows(&pattern, &cases)) {
        for (i, s) in pattern.samples().iter().enumerate().skip(1) {
            let Some(is_behind) = is_behind(seen, *t, *s) else { continue };
            looked += 1;
            behind += u32::from(is_behind);
            wrong += u32::from(is_behind != (invalid >> i & 1 != 0));
        }
    }
    println!("{wrong} of {looked} wrong, {behind} behind a triangle");
    assert!(wrong * 1000 < looked && behind > looked / 100, "{wrong} of {looked} wrong, {behind} behind a triangle");
}

#[test]
fn a_triangle_seen_edge_on_hides_nothing() {
    let t = [[0.0, 0.0, 1.0], [0.5, 0.0, 3.0], [-0.5, 0.0, 3.0]];
    assert_eq!(shadow(floor(), t), [0, 0]);
    // Where it meets the facet, it still splits the pixel.
    let t = [[0.5, 0.03, 5.0], [-0.5, 0.03, 5.0], [0.0, 0.0, 0.0]];
    let [hidden, _] = shadow(floor(), t);
    assert_eq!(hidden, 0);
}

/// Seen along x, a hundredth above the floor's plane: rays that turn up by a pixel see past its horizon.
fn grazing() -> Seen {
    let eye = DVec3::new(-10.0, 0.0, 3.99);
    Seen {
        position: DVec3::new(0.0, 0.0, 4.0),
        normal: DVec3::NEG_Z,
        eye,
        across: DVec3::new(0.0, 0.1, 0.0),
        // Down in the image is towards the floor.
        down: DVec3::new(0.0, 0.0, 0.1),
    }
}

#[test]
fn a_facet_at_a_grazing_angle_ends_at_its_horizon() {
    let text = "
        import package::techniques::alias_free::subpixel::facet::{plane_seen, before_horizon, before_light};
        fn masks(at: u32) -> array<Samples, 2> {
            let f = plane_seen(vector(at), vector(at + 3u), vector(at + 9u), vector(at + 12u), vector(at + 6u), 1.0e-5, 0.0);
            return array(samples_within(before_horizon(f)), samples_within(before_light(f)));
        }";
    let masks = |seen: Seen| {
        let input: Vec<f32> = seen.numbers().iter().flat_map(|v| v.as_vec3().to_array()).collect();
        masks_on_gpu(&grid(), text, &input, 15)[0]
    };
    // The ray through s drops by 0.01 + 0.1 s.y over 10 metres: below the horizon where s.y > -0.1.
    // Past the horizon the plane's points would lie behind the eye: no side counts there.
    let all = half_planes::all(&grid());
    assert_eq!(masks(grazing()), [picked(|s| s.y > -0.1); 2]);
    assert_eq!(masks(floor()), [all, all]);
    // A wall across the light's plane, seen face on: geometry behind the light's plane is not before it.
    let wall = Seen {
        position: DVec3::new(2.0, 0.0, 0.01),
        normal: DVec3::NEG_X,
        eye: DVec3::new(-2.0, 0.0, 0.01),
        across: DVec3::new(0.0, 0.1, 0.0),
        down: DVec3::new(0.0, 0.0, 0.1),
    };
    assert_eq!(masks(wall), [all, picked(|s| s.y > -0.1)]);
}

#[test]
fn a_shadow_on_a_grazing_facet_is_where_its_points_are() {
    // Half of space, y > 0.02, is hidden: on the floor at distance t along the ray it shows at s.x = 0.2 / t.
    let t = [[-90.0, 0.01, 2.0], [90.0, 0.01, 2.0], [0.0, 90.0, 2.0]];
    let [hidden, invalid] = shadow(grazing(), t);
    let expected = picked(|s| {
        let reach = 0.01 / (0.01 + 0.1 * s.y);
        s.y > -0.1 && 0.1 * s.x * reach > 0.02
    });
    let before = picked(|s| s.y > -0.1);
    // The line meets the horizon within the pixel; lines near it may fall to the next entry of the table.
    assert!(((hidden & before) ^ expected).count_ones() <= 1, "{:032b} instead of {expected:032b}", hidden & before);
    assert_eq!(invalid, 0);
}

#[test]
fn a_light_in_the_cameras_plane_is_no_special_case() {
    // The eye's plane z = 0 is that of the light, and the plane through the camera that is parallel to the image plane.
    let seen = Seen { eye: DVec3::new(1.0, 0.0, 0.0), ..floor() };
    let t = [[0.01, -9.0, 2.0], [0.01, 9.0, 2.0], [9.0, 0.0, 2.0]];
    let [hidden, invalid] = shadow(seen, t);
    assert_eq!((hidden, invalid), (picked(|s| s.x > 0.2), 0), "{hidden:032b}");
}
