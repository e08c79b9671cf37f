//! Metrics that judge by the eye, by libraries.

use crate::image::Pair;

/// The library's window has to fit once.
const MIN_SIDE: u32 = 11;

/// Mean structural similarity on 16-bit greys: 8 bits would hide errors under 1/510.
///
/// `iqa` weighs an 11 x 11 Gaussian window as [Wang 2004] does and is tested against his code; `image-compare` was
/// not taken because it sums the variance of its boxes where the formula wants the mean.
pub(crate) fn ssim(pair: &Pair) -> f64 {
    let (width, height) = (pair.width.max(MIN_SIDE), pair.height.max(MIN_SIDE));
    let gray = |values: &[f32]| {
        let at = |x: u32, y: u32| values[(y.min(pair.height - 1) * pair.width + x.min(pair.width - 1)) as usize];
        let samples = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
        let samples = samples.map(|(x, y)| (at(x, y) * f32::from(u16::MAX)).round() as u16);
        iqa::Image::gray16(width, height, samples.collect()).expect("one sample a pixel")
    };
    iqa::ssim(&gray(&pair.truth), &gray(&pair.test), iqa::SsimOptions::default())
        .expect("both images have one size that holds the window")
}

/// Mean FLIP error over valid pixels. The greys are the code values of a visibility PNG, so that the figure can be
/// checked with any other FLIP tool.
pub(crate) fn flip(pair: &Pair, valid: &[bool]) -> f64 {
    let rgb = |values: &[f32]| {
        let bytes: Vec<u8> = values.iter().flat_map(|v| [(v * 255.0).round() as u8; 3]).collect();
        nv_flip::FlipImageRgb8::with_data(pair.width, pair.height, &bytes)
    };
    let map = nv_flip::flip(rgb(&pair.truth), rgb(&pair.test), nv_flip::DEFAULT_PIXELS_PER_DEGREE).to_vec();
    let counted = map.iter().zip(valid).filter(|(_, valid)| **valid);
    let (sum, count) = counted.fold((0.0, 0), |(sum, count), (error, _)| (sum + f64::from(*error), count + 1));
    sum / f64::from(count.max(1))
}
