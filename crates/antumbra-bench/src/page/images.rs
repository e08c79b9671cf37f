//! Images as PNG.

use super::files::ReportError;
use antumbra_metrics::RgbImage;
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};

/// Half the size, each pixel the mean of up to four.
pub fn halved(image: &RgbImage) -> RgbImage {
    let (width, height) = (image.width.div_ceil(2), image.height.div_ceil(2));
    let at = |x: u32, y: u32, c: u32| {
        let (x, y) = (x.min(image.width - 1), y.min(image.height - 1));
        u32::from(image.data[((y * image.width + x) * 3 + c) as usize])
    };
    let mean = |x: u32, y: u32, c: u32| {
        let sum: u32 = [(0, 0), (1, 0), (0, 1), (1, 1)].iter().map(|(i, j)| at(2 * x + i, 2 * y + j, c)).sum();
        ((sum + 2) / 4) as u8
    };
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    RgbImage { width, height, data: pixels.flat_map(|(x, y)| [0, 1, 2].map(|c| mean(x, y, c))).collect() }
}

/// An sRGB image as PNG.
pub fn rgb(image: &RgbImage) -> Result<Vec<u8>, ReportError> {
    png(&image.data, image.width, image.height, ExtendedColorType::Rgb8)
}

/// Values in [0, 1], row 0 on top, as an 8-bit grey PNG.
pub fn grey(width: u32, height: u32, values: &[f32]) -> Result<Vec<u8>, ReportError> {
    let bytes: Vec<u8> = values.iter().map(|v| (v.clamp(0.0, 1.0) * 255.0).round() as u8).collect();
    png(&bytes, width, height, ExtendedColorType::L8)
}

/// A PNG as a data URL.
pub fn embedded(png: &[u8]) -> String {
    format!("data:image/png;base64,{}", BASE64_STANDARD.encode(png))
}

fn png(bytes: &[u8], width: u32, height: u32, color: ExtendedColorType) -> Result<Vec<u8>, ReportError> {
    let mut out = Vec::new();
    PngEncoder::new_with_quality(&mut out, CompressionType::Default, FilterType::Adaptive)
        .write_image(bytes, width, height, color)?;
    Ok(out)
}
