//! Warnings about errors that an image will have.

use super::SsmSettings;
use super::settings::Format;
use crate::input::frame::BoundFrame;

/// The largest inverse distance of an occluder, in 1/metres, whose patches float16 does not lose, over a receiver at
/// `receiver_q`: 1/zO < 1/zR + 64 tan a / (N L) [Atty 2006, equation 4]. `tan_half` is the tangent of the map's half
/// angle, `size` its texels, `light` the light's width in metres.
pub fn largest_float16_q(receiver_q: f32, tan_half: f32, size: f32, light: f32) -> f32 {
    receiver_q + 64.0 * tan_half / (size * light)
}

/// The warnings of a frame, one sentence each.
pub(super) fn of_frame(frame: &BoundFrame, settings: &SsmSettings) -> Vec<String> {
    let bounds = frame.casters.occluder_bounds();
    if bounds.min.x > bounds.max.x {
        let none = "ssm: no mesh is a caster, as none is above another surface (`Role::Caster`): all receivers are lit";
        return if frame.casters.triangle_count() > 0 { vec![none.to_owned()] } else { Vec::new() };
    }
    let corners = bounds.corners().map(|c| frame.light.light_from_world(c));
    let nearest = corners.iter().fold(f32::INFINITY, |z, c| z.min(c.z)).max(frame.frustum.near);
    let [_, farthest_receiver] = frame.frustum.receivers;
    let mut warnings = Vec::new();
    // float16 loses patches whose window is over 32 times as wide as they are. With a hierarchy the window over the
    // nearest receiver is at most 2 `window` times as wide.
    let may_lose = !settings.hierarchy || settings.window >= 16;
    if settings.format == Format::Float16 && may_lose {
        let limit = |axis: usize| {
            let (tan, light) = (frame.frustum.tan_half[axis], frame.light.size[axis]);
            largest_float16_q(1.0 / farthest_receiver, tan, settings.map as f32, light)
        };
        // The paper's condition is for a square light; this one may be longer along one axis.
        if 1.0 / nearest > limit(0).max(limit(1)) {
            warnings.push(format!(
                "ssm: with format=float16 patches nearer to the light than {:.3} m may be lost [Atty 2006, equation \
                 4]; a smaller `map`, hierarchy=true or format=float32 keeps them",
                1.0 / limit(0).max(limit(1))
            ));
        }
    }
    let beyond = |c: &glam::Vec3| c.z > 0.0 && (c.truncate() / c.z).abs().cmpgt(frame.frustum.tan_half * 1.02).any();
    if frame.light.shadow_fov_deg.is_some() && corners.iter().any(beyond) {
        let degrees = 2.0 * frame.frustum.tan_half.max_element().atan().to_degrees();
        warnings.push(format!(
            "ssm: occluders extend beyond the map's {degrees:.0} degrees and cast no shadow from there: set a wider \
             `shadow_fov_deg` or remove it"
        ));
    }
    warnings
}
