//! Shadow maps from many points of the light, in the layers of one texture array, and visibility through them.
//!
//! All maps face along the light's normal, and each window is shifted so that all of them hold the same receivers: in
//! the coordinates tangent xy / z and inverse distance 1 / z the map of light point s is the centre's map, sheared by
//! s.

pub(crate) mod draw;
pub(crate) mod evaluate;

pub use draw::LightMaps;
pub(crate) use draw::{MapSlot, MapStage};
pub use evaluate::Evaluation;
pub(crate) use evaluate::{Entry, entry_list};

use crate::gpu::recorder::Recorder;
use crate::gpu::resources::storage_bytes;
use crate::gpu_struct;
use crate::input::frame::{BoundFrame, light_from_world};
use glam::{DMat4, DVec4, Mat4, Vec2};

gpu_struct! {
    /// A point of the light and the map that is drawn from it.
    pub(crate) struct LightSample {
        clip_from_world: Mat4,
        /// On the light, metres from its centre along its edges.
        point: Vec2,
        /// Half the opening of the map, as tangents.
        tan_half: Vec2,
        /// Middle of the map's window, as a tangent seen from the point.
        tan_middle: Vec2,
    }
}

/// The table of light points on the GPU, an array of `LightSample`: `points` are positions on the light, each in
/// [-1/2, 1/2]². Points of one number are the same for a light of one size.
pub(crate) fn light_samples(recorder: &mut Recorder, frame: &BoundFrame, points: &[Vec2]) -> wgpu::Buffer {
    let (light, f) = (&frame.light, &frame.frustum);
    let (right, up, forward) = light.basis();
    let vectors = [light.center, right, up, forward].map(|v| v.to_array());
    let [c, r, u, n] = vectors;
    let window = [f.tan_half.x, f.tan_half.y, f.near];
    let key =
        [c, r, u, n, [light.size.x, light.size.y, points.len() as f32], window, [f.receivers[0], f.receivers[1], 0.0]];
    let contents = || storage_bytes(&points.iter().map(|p| sample(frame, *p)).collect::<Vec<_>>());
    recorder.buffer_of_key("light samples", bytemuck::bytes_of(&key), contents)
}

/// The map of a light point: an oblique frustum whose window at the middle of the receivers' range of inverse distances
/// is the one of the centre's map, wider by the window's movement between the ends of that range.
fn sample(frame: &BoundFrame, place: Vec2) -> LightSample {
    let (point, f) = (place * frame.light.size, &frame.frustum);
    let [near_q, far_q] = f.receivers.map(|z| 1.0 / z);
    let tan_half = f.tan_half + point.abs() * (0.5 * (near_q - far_q));
    let tan_middle = -point * (0.5 * (near_q + far_q));
    let (tan, middle, p) = (tan_half.as_dvec2(), tan_middle.as_dvec2(), point.as_dvec2());
    // Columns; see Frame::map_clip_from_world. x / z is the tangent from the point, its middle is moved to 0.
    let clip_from_light = DMat4::from_cols(
        DVec4::new(1.0 / tan.x, 0.0, 0.0, 0.0),
        DVec4::new(0.0, -1.0 / tan.y, 0.0, 0.0),
        DVec4::new(-middle.x / tan.x, middle.y / tan.y, 0.0, 1.0),
        DVec4::new(-p.x / tan.x, p.y / tan.y, f64::from(f.near), 0.0),
    );
    let light_from_world = light_from_world(&frame.light);
    LightSample { clip_from_world: (clip_from_light * light_from_world).as_mat4(), point, tan_half, tan_middle }
}
