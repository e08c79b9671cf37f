//! More points a pixel by brute force: the scene is drawn again for each, moved by a part of a pixel.

use crate::input::frame::{Frame, GeometryInput, View, normal_error};
use crate::passes::pixels::geometry_buffer::{GeometryBuffer, ViewUniform};
use crate::gpu::recorder::Recorder;
use crate::gpu::resources::uniform;
use crate::technique::Memory;
use crate::error::Error;
use crate::gpu::device::Gpu;
use glam::{DVec2, Mat4, Vec4};

/// Geometry of one point of every pixel at a time.
pub(super) struct SubPixels {
    geometry: GeometryBuffer,
    /// A view and a frame for each point but the middle.
    moved: Vec<(wgpu::Buffer, Frame)>,
    size: [u32; 2],
}

/// Where a pixel's point lies, in pixels from its middle. Point 0 is the middle; the others fill the pixel evenly, as many
/// as there are [Roberts 2018, "R2"].
pub(super) fn point(index: u32) -> DVec2 {
    let plastic = 1.324_717_957_244_746;
    let step = DVec2::new(1.0 / plastic, 1.0 / (plastic * plastic));
    (step * f64::from(index) + 0.5).fract() - 0.5
}

/// A view whose pixels have this point, in pixels from their middles, where their middles were.
fn moved(view: &View, by: DVec2, size: [u32; 2]) -> View {
    let [x, y] = [-2.0 * by.x / f64::from(size[0]), 2.0 * by.y / f64::from(size[1])];
    let shift = Mat4::from_cols(Vec4::X, Vec4::Y, Vec4::Z, Vec4::new(x as f32, y as f32, 0.0, 1.0));
    View { clip_from_view: shift * view.clip_from_view, ..*view }
}

impl SubPixels {
    /// Views and frames of all points of a frame, in the textures of an earlier one of its size.
    pub fn updated(old: Option<SubPixels>, gpu: &Gpu, frame: &Frame, samples: u32) -> Result<SubPixels, Error> {
        let size = frame.size;
        let geometry = match old {
            Some(old) if old.size == size => old.geometry,
            _ => GeometryBuffer::new(gpu, size)?,
        };
        let input = GeometryInput {
            depth: geometry.depth.view.clone(),
            normal: geometry.normal.view.clone(),
            normal_error: normal_error(geometry.normal.texture.format()),
            size,
        };
        let mut of_points = Vec::new();
        for index in 1..samples {
            let view = moved(&frame.view, point(index), size);
            let buffer = uniform(gpu, "view of a point", &ViewUniform::of(&view));
            let (casters, visibility) = (frame.casters.clone(), frame.visibility.clone());
            let mut of_point = Frame::new(gpu, casters, input.clone(), visibility, view, frame.light)?;
            of_point.update(gpu, view, frame.light, frame.frustum);
            of_points.push((buffer, of_point));
        }
        Ok(SubPixels { geometry, moved: of_points, size })
    }

    /// Draws the geometry of point `index`, from 1 on, and returns the frame that looks at it.
    pub fn record(&mut self, recorder: &mut Recorder, frame: &Frame, index: u32) -> Result<&Frame, Error> {
        let (view, moved) = &self.moved[index as usize - 1];
        self.geometry.draw(recorder, "geometry of points", &frame.casters, view)?;
        Ok(moved)
    }

    /// GPU memory by pass.
    pub fn memory(&self) -> Memory {
        Memory::new("geometry of points", self.geometry.bytes())
    }
}
