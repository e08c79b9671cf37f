//! Every figure on cases small enough to compute by hand, and the comparison made to fail.

use antumbra_metrics::{Image, Metrics, MetricsError, Role, metrics};

const W: u32 = 48;
const H: u32 = 32;

fn compare(test: &[f32], truth: &[f32], size: (u32, u32)) -> Metrics {
    masked(test, truth, size, &vec![true; truth.len()])
}

fn masked(test: &[f32], truth: &[f32], (w, h): (u32, u32), valid: &[bool]) -> Metrics {
    metrics(Image::new(w, h, test).unwrap(), Image::new(w, h, truth).unwrap(), valid).unwrap()
}

fn close(a: f64, b: f64) {
    assert!((a - b).abs() < 1e-6, "{a} is not {b}");
}

/// A box's shadow on a plane: umbra in the middle, a linear penumbra that widens to the right, lit around.
fn shadow(shift: f32) -> Vec<f32> {
    let pixel = |i: u32| {
        let (x, y) = ((i % W) as f32 - shift, (i / W) as f32);
        let outside = (x - 22.0).abs().max((y - 16.0).abs() * 1.5) - 12.0;
        (outside / (1.0 + x.max(0.0) * 0.15)).clamp(0.0, 1.0)
    };
    (0..W * H).map(pixel).collect()
}

#[test]
fn metrics_by_hand() {
    // lit, lit, umbra, penumbra; errors 0, -0.25, +0.5, -0.25
    let f = compare(&[1.0, 0.75, 0.5, 0.25], &[1.0, 1.0, 0.0, 0.5], (2, 2));
    close(f.average_error, (0.5 + 0.25) / 2.0);
    close(f.rmse, ((0.0625 + 0.25 + 0.0625) / 4.0_f64).sqrt());
    close(f.p99, 0.5);
    close(f.max, 0.5);
    close(f.leak, 0.5);
    close(f.acne, 0.125);
    let c = f.counts;
    assert_eq!((c.valid, c.shadowed, c.penumbra, c.umbra, c.lit), (4, 2, 1, 1, 2));
}

#[test]
fn p99_leaves_out_the_worst_hundredth() {
    let truth = vec![1.0; 200];
    let mut test = truth.clone();
    test[17] = 0.0;
    test[40] = 0.2;
    test[60] = 0.6;
    let f = compare(&test, &truth, (20, 10));
    close(f.p99, 0.4);
    close(f.max, 1.0);
    close(f.acne, 2.2 / 200.0);
}

#[test]
fn a_class_without_pixels_counts_nothing() {
    let f = compare(&[1.0; 4], &[1.0; 4], (2, 2));
    assert_eq!((f.average_error, f.leak, f.counts.shadowed, f.counts.umbra), (0.0, 0.0, 0, 0));
    let f = compare(&[0.0; 4], &[0.0; 4], (2, 2));
    assert_eq!((f.average_error, f.acne, f.counts.lit), (0.0, 0.0, 0));
}

#[test]
fn equal_images_have_no_error() {
    let f = compare(&shadow(0.0), &shadow(0.0), (W, H));
    assert_eq!((f.average_error, f.rmse, f.p99, f.max, f.leak), (0.0, 0.0, 0.0, 0.0, 0.0));
    close(f.ssim, 1.0);
    close(f.flip, 0.0);
}

#[test]
fn a_shift_of_one_texel_is_seen() {
    let f = compare(&shadow(1.0), &shadow(0.0), (W, H));
    assert!(f.average_error > 0.01 && f.rmse > 0.02 && f.max > 0.3, "{f:?}");
    assert!(f.ssim < 0.99 && f.flip > 0.005, "{f:?}");
}

#[test]
fn a_missing_shadow_is_seen() {
    let f = compare(&vec![1.0; (W * H) as usize], &shadow(0.0), (W, H));
    close(f.leak, 1.0);
    close(f.max, 1.0);
    assert!(f.average_error > 0.5 && f.ssim < 0.9 && f.flip > 0.2, "{f:?}");
}

#[test]
fn a_flipped_image_is_seen() {
    let truth = shadow(0.0);
    let upside_down: Vec<f32> = truth.chunks(W as usize).rev().flatten().copied().collect();
    let mirrored: Vec<f32> = truth.chunks(W as usize).flat_map(|row| row.iter().rev()).copied().collect();
    let inverted: Vec<f32> = truth.iter().map(|v| 1.0 - v).collect();
    for wrong in [upside_down, mirrored, inverted] {
        let f = compare(&wrong, &truth, (W, H));
        assert!(f.average_error > 0.01 && f.ssim < 0.99, "{f:?}");
    }
}

#[test]
fn a_swapped_size_is_refused() {
    let (test, truth) = (shadow(0.0), shadow(0.0));
    let swapped = metrics(Image::new(H, W, &test).unwrap(), Image::new(W, H, &truth).unwrap(), &[true; 1536]);
    assert_eq!(swapped, Err(MetricsError::SizeMismatch { test: (H, W), truth: (W, H) }));
}

#[test]
fn pixels_that_are_not_valid_count_nothing() {
    let truth = shadow(0.0);
    let mut test = truth.clone();
    let mut valid = vec![true; truth.len()];
    for i in (0..truth.len()).filter(|i| i % 48 < 10) {
        valid[i] = false;
        test[i] = [0.0, f32::NAN, 7.0][i % 3];
    }
    let f = masked(&test, &truth, (W, H), &valid);
    assert_eq!((f.max, f.counts.valid), (0.0, u64::from((W - 10) * H)));
    close(f.ssim, 1.0);
    close(f.flip, 0.0);
}

#[test]
fn flip_does_not_thin_out_with_the_background() {
    let truth = shadow(0.0);
    let test = shadow(3.0);
    let all = compare(&test, &truth, (W, H)).flip;
    let mut valid: Vec<bool> = truth.iter().zip(&test).map(|(a, b)| a != b).collect();
    valid[0] = true;
    assert!(masked(&test, &truth, (W, H), &valid).flip > 2.0 * all);
}

#[test]
fn bad_input_is_named() {
    fn image(data: &[f32]) -> Image<'_> {
        Image::new(2, 2, data).unwrap()
    }
    let good = [0.5_f32; 4];
    for value in [f32::NAN, f32::INFINITY, -0.1, 1.01] {
        let bad = [0.5, 0.5, 0.5, value];
        let tested = metrics(image(&bad), image(&good), &[true; 4]).unwrap_err();
        assert!(matches!(tested, MetricsError::Value { role: Role::Test, x: 1, y: 1, .. }), "{tested}");
        let truth = metrics(image(&good), image(&bad), &[true; 4]).unwrap_err();
        assert!(matches!(truth, MetricsError::Value { role: Role::Truth, x: 1, y: 1, .. }), "{truth}");
    }
    assert_eq!(metrics(image(&good), image(&good), &[true; 3]), Err(MetricsError::MaskLength { len: 3, expected: 4 }));
    assert_eq!(metrics(image(&good), image(&good), &[false; 4]), Err(MetricsError::NothingValid));
    assert!(matches!(Image::new(0, 2, &[]), Err(MetricsError::Empty { .. })));
    assert!(matches!(Image::new(2, 2, &good[..3]), Err(MetricsError::Length { len: 3, .. })));
}

#[test]
fn rounding_outside_of_the_range_is_forgiven() {
    let f = compare(&[1.0005, -0.0005, 0.5, 0.5], &[1.0, 0.0, 0.5, 0.5], (2, 2));
    assert_eq!(f.max, 0.0);
}

#[test]
fn metrics_survive_json() {
    let f = compare(&shadow(1.0), &shadow(0.0), (W, H));
    let json = serde_json::to_string(&f).unwrap();
    let back: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(back["average_error"], f.average_error);
    assert_eq!(back["counts"]["umbra"], f.counts.umbra);
}

#[test]
fn the_truth_alone_decides_the_classes() {
    let (shadowed, lit) = ([0.0, 0.0, 0.5, 1.0], [1.0; 4]);
    let missing = compare(&lit, &shadowed, (2, 2));
    let false_shadow = compare(&shadowed, &lit, (2, 2));
    assert_eq!((missing.leak, missing.acne, missing.counts.umbra), (1.0, 0.0, 2));
    assert_eq!((false_shadow.leak, false_shadow.acne, false_shadow.counts.umbra), (0.0, 0.625, 0));
}
