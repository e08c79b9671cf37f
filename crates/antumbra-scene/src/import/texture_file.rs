//! Images for textures: PNG and JPEG.

use crate::{Material, Texture};
use image::{ImageFormat, ImageReader, Limits, RgbaImage};
use std::io::Cursor;

/// Decodes a PNG or JPEG file; the error does not name the file.
pub(super) fn decode(bytes: &[u8]) -> Result<RgbaImage, String> {
    let mut reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(|e| e.to_string())?;
    if !matches!(reader.format(), Some(ImageFormat::Png | ImageFormat::Jpeg)) {
        return Err("the image is neither PNG nor JPEG; convert it to PNG".to_string());
    }
    // A few bytes can claim gigabytes.
    let mut limits = Limits::default();
    limits.max_image_width = Some(16384);
    limits.max_image_height = Some(16384);
    limits.max_alloc = Some(1 << 30);
    reader.limits(limits);
    Ok(reader.decode().map_err(|e| e.to_string())?.into_rgba8())
}

/// Forgets the mask of a material that it leaves whole: a cut-out surface costs a texture lookup per shadow sample.
pub(super) fn drop_idle_mask(material: &mut Material) {
    let Some(cutoff) = material.alpha_cutoff else { return };
    let texels = material.texture.as_ref().map_or(255, |t| smallest_alpha(t));
    if material.base_color.w * (f32::from(texels) / 255.0) >= cutoff {
        material.alpha_cutoff = None;
    }
}

fn smallest_alpha(texture: &Texture) -> u8 {
    texture.rgba.iter().skip(3).step_by(4).copied().min().unwrap_or(255)
}
