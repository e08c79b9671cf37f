//! What holds for every pair of images.

use antumbra_metrics::{Image, Metrics, metrics};
use proptest::prelude::*;

fn compare(test: &[f32], truth: &[f32], w: u32, valid: &[bool]) -> Metrics {
    let h = truth.len() as u32 / w;
    metrics(Image::new(w, h, test).unwrap(), Image::new(w, h, truth).unwrap(), valid).unwrap()
}

/// Lit, umbra and everything between, so that every class has members.
fn visibility() -> impl Strategy<Value = f32> {
    prop_oneof![Just(0.0f32), Just(1.0f32), 0.0f32..=1.0]
}

/// Two images of one size up to 24 x 24 with a mask that leaves at least one pixel.
fn pair() -> impl Strategy<Value = (u32, Vec<f32>, Vec<f32>, Vec<bool>)> {
    (1u32..24, 1u32..24).prop_flat_map(|(w, h)| {
        let n = (w * h) as usize;
        let image = || prop::collection::vec(visibility(), n);
        (Just(w), image(), image(), prop::collection::vec(any::<bool>(), n)).prop_map(|(w, a, b, mut valid)| {
            valid[0] = true;
            (w, a, b, valid)
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn metrics_stay_in_their_bounds((w, a, b, valid) in pair()) {
        let f = compare(&a, &b, w, &valid);
        for figure in [f.average_error, f.rmse, f.p99, f.max, f.leak, f.acne, f.flip] {
            prop_assert!((0.0..=1.0).contains(&figure), "{f:?}");
        }
        prop_assert!(f.ssim > -1.0 && f.ssim <= 1.0 + 1e-12);
        prop_assert!(f.p99 <= f.max && f.rmse <= f.max + 1e-12 && f.average_error <= f.max + 1e-12);
        prop_assert_eq!(f.counts.shadowed, f.counts.umbra + f.counts.penumbra);
        prop_assert!(f.counts.shadowed + f.counts.lit <= f.counts.valid);
    }

    #[test]
    fn equal_images_are_perfect((w, a, _, valid) in pair()) {
        let f = compare(&a, &a, w, &valid);
        prop_assert_eq!((f.average_error, f.rmse, f.p99, f.max), (0.0, 0.0, 0.0, 0.0));
        prop_assert!((f.ssim - 1.0).abs() < 1e-9 && f.flip < 1e-6);
    }

    #[test]
    fn error_magnitudes_are_symmetric((w, a, b, valid) in pair()) {
        let (f, g) = (compare(&a, &b, w, &valid), compare(&b, &a, w, &valid));
        prop_assert!((f.rmse - g.rmse).abs() < 1e-12);
        prop_assert_eq!((f.p99, f.max), (g.p99, g.max));
    }

    #[test]
    fn what_is_not_valid_never_matters((w, a, b, valid) in pair(), noise in visibility()) {
        let mut other = a.clone();
        for (v, valid) in other.iter_mut().zip(&valid) {
            if !valid { *v = noise; }
        }
        prop_assert_eq!(compare(&a, &b, w, &valid), compare(&other, &b, w, &valid));
    }
}
