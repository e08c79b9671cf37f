//! More points per pixel by brute force: the scene is drawn again for each, shifted by a fraction of a pixel.

use crate::error::Error;
use crate::gpu::recorder::Recorder;
use crate::input::frame::{BoundFrame, View};
use crate::passes::pixels::geometry_buffer::GeometryBuffer;
use glam::{DVec2, Mat4, Vec4};

/// The point of index `index`, in pixels from the pixel's middle. Point 0 is the middle; any number of points fill the
/// pixel evenly [Roberts 2018, "R2"].
fn point(index: u32) -> DVec2 {
    let plastic = 1.324_717_957_244_746;
    let step = DVec2::new(1.0 / plastic, 1.0 / (plastic * plastic));
    (step * f64::from(index) + 0.5).fract() - 0.5
}

/// A view whose pixel middles lie at an offset, in pixels, from those of `view`.
fn shifted(view: &View, by: DVec2, size: [u32; 2]) -> View {
    let [x, y] = [-2.0 * by.x / f64::from(size[0]), 2.0 * by.y / f64::from(size[1])];
    let shift = Mat4::from_cols(Vec4::X, Vec4::Y, Vec4::Z, Vec4::new(x as f32, y as f32, 0.0, 1.0));
    View { clip_from_view: shift * view.clip_from_view, ..*view }
}

/// Draws the geometry at point `index` of every pixel; returns the frame that is seen there.
pub(super) fn frame_of_point(
    recorder: &mut Recorder,
    frame: &BoundFrame,
    geometry: &GeometryBuffer,
    index: u32,
) -> Result<BoundFrame, Error> {
    let view = shifted(&frame.view, point(index), frame.size);
    geometry.record_as(recorder, "geometry of points", &frame.casters, &view)?;
    Ok(frame.with_view(recorder, view, [&geometry.depth.view, &geometry.normal.view]))
}
