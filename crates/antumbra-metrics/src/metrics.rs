//! The metrics themselves.

use serde::{Deserialize, Serialize};

use crate::image::{Image, MetricsError, Pair};
#[cfg(feature = "perceptual")]
use crate::perceptual;

/// Truth under this is umbra.
pub const UMBRA_BELOW: f32 = 0.001;
/// Truth over this is lit; under it is shadow or penumbra.
pub const LIT_ABOVE: f32 = 0.999;

#[cfg(feature = "perceptual")]
/// How far an image is from the truth. Every figure but `ssim` is 0 at best and 1 at worst. A mean over a class of
/// pixels that the image does not have is 0: `counts` says so.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Metrics {
    /// Mean |error| over shadow and penumbra, the valid pixels whose truth is under 0.999 [Atty 2006, section 5.2.1].
    pub average_error: f64,
    /// Root of the mean squared error over all valid pixels.
    pub rmse: f64,
    /// |error| that 99 % of the valid pixels do not exceed (nearest rank).
    pub p99: f64,
    /// Largest |error| of a valid pixel.
    pub max: f64,
    /// Light leaking into the umbra: mean visibility where the truth is under 0.001.
    pub leak: f64,
    /// False darkness on lit surfaces: mean of 1 - visibility where the truth is over 0.999.
    pub acne: f64,
    /// Structural similarity [Wang 2004], 1 for equal images, above -1: 11 x 11 Gaussian window, mean over the whole
    /// image; invalid pixels are taken from the truth. Images under 11 pixels repeat their border.
    pub ssim: f64,
    /// Mean FLIP error over valid pixels [Andersson 2020]: the visible difference when flipping between the two
    /// visibility images as 8-bit greys at 67 pixels per degree.
    pub flip: f64,
    /// How many pixels each figure stands on.
    pub counts: Counts,
}

/// Pixels of each class, by the truth.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counts {
    /// All pixels that count.
    pub valid: u64,
    /// Truth under 0.999: umbra and penumbra.
    pub shadowed: u64,
    /// Truth in [0.001, 0.999).
    pub penumbra: u64,
    /// Truth under 0.001.
    pub umbra: u64,
    /// Truth over 0.999.
    pub lit: u64,
}

/// [`Metrics`] without those that judge by the eye: a fraction of the time, for changing images.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ErrorMetrics {
    /// As in [`Metrics`].
    pub average_error: f64,
    /// As in [`Metrics`].
    pub rmse: f64,
    /// As in [`Metrics`].
    pub p99: f64,
    /// As in [`Metrics`].
    pub max: f64,
    /// As in [`Metrics`].
    pub leak: f64,
    /// As in [`Metrics`].
    pub acne: f64,
    /// As in [`Metrics`].
    pub counts: Counts,
}

/// Compares `test` with `truth` over the pixels whose entry in `valid` is true (row-major, as the images).
///
/// Values may stray from [0, 1] by a thousandth (rounding) and are clamped. The values of invalid pixels do not matter.
#[cfg(feature = "perceptual")]
pub fn metrics(test: Image, truth: Image, valid: &[bool]) -> Result<Metrics, MetricsError> {
    let pair = Pair::new(test, truth, valid)?;
    let ErrorMetrics { average_error, rmse, p99, max, leak, acne, counts } = errors_of(&pair, valid);
    let (ssim, flip) = (perceptual::ssim(&pair), perceptual::flip(&pair, valid));
    Ok(Metrics { average_error, rmse, p99, max, leak, acne, ssim, flip, counts })
}

/// The same without the metrics that judge by the eye.
pub fn error_metrics(test: Image, truth: Image, valid: &[bool]) -> Result<ErrorMetrics, MetricsError> {
    Ok(errors_of(&Pair::new(test, truth, valid)?, valid))
}

fn errors_of(pair: &Pair, valid: &[bool]) -> ErrorMetrics {
    let mut sums = Sums::default();
    let mut errors = Vec::with_capacity(pair.truth.len());
    for ((&test, &truth), _) in pair.test.iter().zip(&pair.truth).zip(valid).filter(|(_, valid)| **valid) {
        sums.add(f64::from(test), truth);
        errors.push((f64::from(test) - f64::from(truth)).abs());
    }
    let counts = sums.counts;
    ErrorMetrics {
        average_error: mean(sums.shadow_error, counts.shadowed),
        rmse: mean(sums.squared_error, counts.valid).sqrt(),
        max: errors.iter().copied().fold(0.0, f64::max),
        p99: percentile_99(&mut errors),
        leak: mean(sums.umbra_light, counts.umbra),
        acne: mean(sums.lit_darkness, counts.lit),
        counts,
    }
}

/// Sums over the valid pixels, in double precision: a float would lose the small errors of a large image.
#[derive(Default)]
struct Sums {
    shadow_error: f64,
    squared_error: f64,
    umbra_light: f64,
    lit_darkness: f64,
    counts: Counts,
}

impl Sums {
    fn add(&mut self, test: f64, truth: f32) {
        let error = (test - f64::from(truth)).abs();
        self.counts.valid += 1;
        self.squared_error += error * error;
        if truth < LIT_ABOVE {
            self.counts.shadowed += 1;
            self.shadow_error += error;
        }
        if truth < UMBRA_BELOW {
            self.counts.umbra += 1;
            self.umbra_light += test;
        } else if truth < LIT_ABOVE {
            self.counts.penumbra += 1;
        } else if truth > LIT_ABOVE {
            self.counts.lit += 1;
            self.lit_darkness += 1.0 - test;
        }
    }
}

fn mean(sum: f64, count: u64) -> f64 {
    sum / count.max(1) as f64
}

/// Nearest rank: the smallest error that at least 99 % of the errors do not exceed.
fn percentile_99(errors: &mut [f64]) -> f64 {
    let rank = (errors.len() * 99).div_ceil(100);
    *errors.select_nth_unstable_by(rank - 1, f64::total_cmp).1
}
