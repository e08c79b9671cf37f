//! Images and values as the bytes of a file.

use std::io;

/// A format for one number per pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// NumPy, float32, height x width.
    Npy,
    /// OpenEXR, one 32-bit float channel `Y`.
    Exr,
    /// 16-bit grey, 1 is white.
    Png,
}

/// One number per pixel, row 0 on top, as the bytes of a file.
pub fn encode_values(format: Format, size: [u32; 2], values: &[f32]) -> io::Result<Vec<u8>> {
    match format {
        Format::Npy => npy(size, values),
        Format::Exr => exr(size, values).map_err(io::Error::other),
        Format::Png => {
            let grey = values.iter().map(|v| (v.clamp(0.0, 1.0) * 65535.0).round() as u16);
            let bytes: Vec<u8> = grey.flat_map(u16::to_ne_bytes).collect();
            png(size, &bytes, image::ExtendedColorType::L16)
        }
    }
}

/// 8-bit sRGB triples as a PNG.
pub fn encode_rgb(size: [u32; 2], rgb: &[u8]) -> io::Result<Vec<u8>> {
    png(size, rgb, image::ExtendedColorType::Rgb8)
}

fn npy([width, height]: [u32; 2], values: &[f32]) -> io::Result<Vec<u8>> {
    use npyz::WriterBuilder;
    let mut bytes = Vec::with_capacity(values.len() * 4 + 128);
    let shape = [u64::from(height), u64::from(width)];
    let mut writer = npyz::WriteOptions::<f32>::new().default_dtype().shape(&shape).writer(&mut bytes).begin_nd()?;
    writer.extend(values.iter().copied())?;
    writer.finish()?;
    Ok(bytes)
}

fn exr([width, height]: [u32; 2], values: &[f32]) -> exr::error::Result<Vec<u8>> {
    use exr::prelude::*;
    let channel = AnyChannel::new("Y", FlatSamples::F32(values.to_vec()));
    let layer = Layer::new(
        (width as usize, height as usize),
        LayerAttributes::default(),
        Encoding::FAST_LOSSLESS,
        AnyChannels::sort(std::iter::once(channel).collect()),
    );
    let mut bytes = io::Cursor::new(Vec::new());
    Image::from_layer(layer).write().non_parallel().to_buffered(&mut bytes)?;
    Ok(bytes.into_inner())
}

fn png([width, height]: [u32; 2], bytes: &[u8], color: image::ExtendedColorType) -> io::Result<Vec<u8>> {
    use image::ImageEncoder;
    let mut out = Vec::new();
    let encoder = image::codecs::png::PngEncoder::new(&mut out);
    encoder.write_image(bytes, width, height, color).map_err(io::Error::other)?;
    Ok(out)
}
