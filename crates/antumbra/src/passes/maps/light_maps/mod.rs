//! Shadow maps from many points of the light, in the layers of one texture array, and what a receiver sees through them.
//!
//! All maps look along the light's normal, and each window is shifted so that all of them hold the same receivers: in the
//! coordinates tangent xy / z and inverse distance 1 / z the map of light point s is the centre's map, sheared by s.

pub(crate) mod draw;
pub(crate) mod evaluate;

pub use draw::LightMaps;
pub(crate) use draw::{MapSlot, MapStage};
pub(crate) use evaluate::Entry;
pub use evaluate::Evaluation;

use crate::gpu::resources::{storage_bytes, storage_of};
use crate::input::casters::Casters;
use crate::input::frame::Frame;
use crate::gpu::device::Gpu;
use crate::input::frustum::ShadowFrustum;
use crate::gpu_struct;
use antumbra_scene::RectLight;
use glam::{DMat4, DVec4, Mat4, Vec2};
use std::sync::{Arc, Weak};

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

/// The table of points that maps are drawn from, on the GPU.
pub struct LightSamples {
    /// An array of `LightSample`.
    pub buffer: wgpu::Buffer,
    made_for: (RectLight, ShadowFrustum, usize),
}

impl LightSamples {
    /// Makes the table in `slot` unless it is there: `points` are places on the light, each in [-1/2, 1/2]².
    pub fn ensure<'a>(
        slot: &'a mut Option<LightSamples>,
        gpu: &Gpu,
        frame: &Frame,
        points: &[Vec2],
    ) -> &'a LightSamples {
        let key = (frame.light, frame.frustum, points.len());
        if slot.as_ref().is_none_or(|s| s.made_for != key) {
            let samples: Vec<LightSample> = points.iter().map(|p| sample(frame, *p)).collect();
            let old = slot.take().filter(|s| s.made_for.2 == key.2).map(|s| s.buffer);
            let buffer = match old {
                Some(buffer) => {
                    gpu.queue.write_buffer(&buffer, 0, &storage_bytes(&samples));
                    buffer
                }
                None => storage_of(gpu, "light samples", &samples),
            };
            *slot = Some(LightSamples { buffer, made_for: key });
        }
        slot.as_ref().expect("just made")
    }
}

/// The map of a light point: an oblique frustum whose window at the middle of the receivers' range of inverse distances
/// is the one of the centre's map, wider by what the window moves between the ends of that range.
fn sample(frame: &Frame, place: Vec2) -> LightSample {
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
    let light_from_world = crate::input::frame::light_from_world(&frame.light);
    LightSample { clip_from_world: (clip_from_light * light_from_world).as_mat4(), point, tan_half, tan_middle }
}
