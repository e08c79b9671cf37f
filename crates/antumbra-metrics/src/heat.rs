//! Error as an image: where a technique is too dark, where too light.

use crate::image::{Image, MetricsError, Pair, RgbImage};

/// The signed error at which the colours saturate.
pub const HEAT_SCALE: f64 = 0.25;

/// The colour of pixels that do not count: background and receivers turned away from the light.
pub const INVALID_COLOR: [u8; 3] = [112, 112, 112];

/// The colour of a signed error (test - truth): near-white for none, red where the test is too light (it leaks), blue
/// where it is too dark. Linear up to ±[`HEAT_SCALE`], then saturated. The sign shows the direction of the error: light
/// bleeding from over-dark contact, acne from a penumbra too wide.
pub fn heat_color(error: f64) -> [u8; 3] {
    let t = 0.5 - 0.5 * (error / HEAT_SCALE).clamp(-1.0, 1.0);
    // ColorBrewer's RdBu: perceptually even arms, distinct with every common colour blindness.
    let color = colorous::RED_BLUE.eval_continuous(t);
    [color.r, color.g, color.b]
}

/// The signed error of every valid pixel as a [`heat_color`]; the others are [`INVALID_COLOR`].
pub fn heat_map(test: Image, truth: Image, valid: &[bool]) -> Result<RgbImage, MetricsError> {
    let pair = Pair::new(test, truth, valid)?;
    let color = |((test, truth), valid): ((&f32, &f32), &bool)| match valid {
        true => heat_color(f64::from(*test) - f64::from(*truth)),
        false => INVALID_COLOR,
    };
    let data = pair.test.iter().zip(&pair.truth).zip(valid).flat_map(color).collect();
    Ok(RgbImage { width: pair.width, height: pair.height, data })
}

/// The legend of a [`heat_map`]: a horizontal bar from -[`HEAT_SCALE`] (too dark) at the centre of the left column to
/// +[`HEAT_SCALE`] (too light) at that of the right one. `width` is at least 2, `height` at least 1 pixel.
pub fn color_bar(width: u32, height: u32) -> RgbImage {
    let last = f64::from(width.saturating_sub(1).max(1));
    let row: Vec<u8> = (0..width).flat_map(|x| heat_color((f64::from(x) / last * 2.0 - 1.0) * HEAT_SCALE)).collect();
    RgbImage { width, height, data: row.repeat(height as usize) }
}
