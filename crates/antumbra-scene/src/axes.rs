//! Axes of cameras and lights.

use glam::Vec3;

/// Sine of the angle between `forward` and `up` below which `up` fixes no rotation in single precision.
const LEAST_SINE: f32 = 1e-4;

/// Unit vectors (right, up, forward). Where `up` is parallel to `forward`, -Z takes its place, or Y if that is parallel
/// too: a light in a ceiling faces down whatever its `up` says. A `forward` of zero is taken for -Y.
pub(crate) fn axes(forward: Vec3, up: Vec3) -> (Vec3, Vec3, Vec3) {
    let forward = forward.try_normalize().unwrap_or(Vec3::NEG_Y);
    let across = |up: Vec3| {
        let right = forward.cross(up.try_normalize()?);
        (right.length() > LEAST_SINE).then(|| right.normalize())
    };
    let right = across(up).or_else(|| across(Vec3::NEG_Z)).or_else(|| across(Vec3::Y)).unwrap_or(Vec3::X);
    (right, right.cross(forward), forward)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_are_orthonormal_whatever_up_says() {
        for forward in [Vec3::NEG_Y, Vec3::Y, Vec3::NEG_Z, Vec3::Z, Vec3::X, Vec3::new(1e-5, -1.0, 0.0), Vec3::ZERO] {
            for up in [Vec3::Y, Vec3::NEG_Z, Vec3::Z, forward, Vec3::ZERO, Vec3::splat(f32::NAN), Vec3::Y * 1e-30] {
                let (right, up_axis, forward_axis) = axes(forward, up);
                let products = [right.dot(up_axis), right.dot(forward_axis), up_axis.dot(forward_axis)];
                let lengths = [right, up_axis, forward_axis].map(Vec3::length);
                let right_angles = products.iter().all(|p| p.abs() < 1e-6);
                assert!(right_angles, "forward {forward}, up {up}: products {products:?}");
                assert!(lengths.iter().all(|l| (l - 1.0).abs() < 1e-6), "forward {forward}, up {up}: {lengths:?}");
            }
        }
    }

    #[test]
    fn an_up_that_is_not_parallel_keeps_its_rotation() {
        let (right, up, _) = axes(Vec3::new(0.0, -1.0, 0.0), Vec3::new(1.0, 5.0, 0.0));
        assert_eq!((right, up), (Vec3::Z, Vec3::X));
    }
}
