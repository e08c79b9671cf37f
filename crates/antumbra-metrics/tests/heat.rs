//! The error as a picture.

use antumbra_metrics::{HEAT_SCALE, INVALID_COLOR, Image, MetricsError, color_bar, heat_color, heat_map};

#[test]
fn too_light_is_red_too_dark_is_blue() {
    let [r, _, b] = heat_color(0.2);
    assert!(r > b + 80);
    let [r, _, b] = heat_color(-0.2);
    assert!(b > r + 80);
    assert!(heat_color(0.0).iter().all(|c| *c > 235));
    assert_eq!(heat_color(HEAT_SCALE), heat_color(1.0));
    assert_eq!(heat_color(-HEAT_SCALE), heat_color(-1.0));
}

#[test]
fn larger_errors_are_never_paler() {
    let luma = |e: f64| heat_color(e).iter().map(|c| u32::from(*c)).sum::<u32>();
    for sign in [-1.0, 1.0] {
        for i in 1..=50 {
            let (less, more) = (f64::from(i - 1) / 200.0, f64::from(i) / 200.0);
            assert!(luma(sign * more) <= luma(sign * less) + 3, "at {more}");
        }
    }
}

#[test]
fn a_map_has_one_colour_a_pixel() {
    let (test, truth) = ([0.5, 0.75, 0.25, 0.0], [0.5, 0.5, 0.5, 1.0]);
    let valid = [true, true, true, false];
    let map = heat_map(Image::new(2, 2, &test).unwrap(), Image::new(2, 2, &truth).unwrap(), &valid).unwrap();
    assert_eq!((map.width, map.height), (2, 2));
    assert_eq!(map.data, [heat_color(0.0), heat_color(0.25), heat_color(-0.25), INVALID_COLOR].concat());
}

#[test]
fn a_map_of_two_sizes_is_refused() {
    let (a, b) = ([0.5; 2], [0.5; 2]);
    let refused = heat_map(Image::new(2, 1, &a).unwrap(), Image::new(1, 2, &b).unwrap(), &[true; 2]);
    assert!(matches!(refused, Err(MetricsError::SizeMismatch { .. })));
}

#[test]
fn the_bar_runs_from_too_dark_to_too_light() {
    let bar = color_bar(101, 3);
    assert_eq!((bar.width, bar.height, bar.data.len()), (101, 3, 101 * 3 * 3));
    assert_eq!(bar.data[..3], heat_color(-HEAT_SCALE));
    assert_eq!(bar.data[150..153], heat_color(0.0));
    assert_eq!(bar.data[300..303], heat_color(HEAT_SCALE));
}
