//! The fraction of the light that a micro-patch hides, against the paper's own construction [Atty 2006, sections 3.3
//! and 3.4].

use crate::testing::{Random, Worst, evaluate};

const KERNEL: &str = "
    import package::techniques::ssm::penumbra::share_of_window;
    fn evaluate(at: u32, to: u32) {
        let low = vec2(input[at], input[at + 1u]);
        let place = vec2(input[at + 3u], input[at + 4u]);
        let half = vec2(input[at + 5u], input[at + 6u]);
        output[to] = share_of_window(low, input[at + 2u], place, half);
    }";

/// A light, a patch and a receiver in metres, along one axis: the light is centred on 0 at depth 0.
#[derive(Clone, Copy, Debug)]
struct Axis {
    light: f64,
    patch_low: f64,
    patch_high: f64,
    patch_z: f64,
    receiver: f64,
    receiver_z: f64,
}

impl Axis {
    /// The fraction of the light's edge that the patch hides, by projecting the patch back to the light.
    fn hidden(&self) -> f64 {
        let back = |p: f64| self.receiver + (p - self.receiver) * self.receiver_z / (self.receiver_z - self.patch_z);
        let (low, high) = (back(self.patch_low), back(self.patch_high));
        (high.min(self.light / 2.0) - low.max(-self.light / 2.0)).max(0.0) / self.light
    }

    /// Middle and edge of the penumbra rectangle at the receiver's depth, by way of the pyramid's apex.
    fn rectangle(&self) -> (f64, f64) {
        let ratio = self.light / (self.patch_high - self.patch_low);
        let apex = ratio / (1.0 + ratio);
        let (apex_x, apex_z) = (apex * 0.5 * (self.patch_low + self.patch_high), apex * self.patch_z);
        (self.receiver_z / apex_z * apex_x, self.light * (self.receiver_z - apex_z) / apex_z)
    }
}

#[test]
fn a_patch_hides_what_its_projection_to_the_light_covers() {
    let mut random = Random(31);
    let (mut input, mut exact) = (Vec::new(), Vec::new());
    for _ in 0..4000 {
        // A map of 2^level texels, tangents from -1 to 1, a patch of one texel.
        let size = 2f64.powf(f64::from(random.within(3.0, 10.0))).floor();
        let texel = 2.0 / size;
        let patch_z = f64::from(random.within(0.3, 3.0));
        let receiver_z = patch_z * f64::from(1.0 + random.decades(-2.0, 1.0));
        let above = 1.0 / patch_z - 1.0 / receiver_z;
        let axes: Vec<(Axis, [f64; 3])> = (0..2)
            .map(|_| {
                let light = f64::from(random.decades(-2.0, 0.5));
                let half = 0.5 * light / texel * above;
                let low = f64::from(random.within(0.0, size as f32)).floor();
                let place = low + 0.5 + f64::from(random.within(-1.2, 1.2)) * (half + 0.5);
                let tangent = |p: f64| p * texel - 1.0;
                let axis = Axis {
                    light,
                    patch_low: tangent(low) * patch_z,
                    patch_high: tangent(low + 1.0) * patch_z,
                    patch_z,
                    receiver: tangent(place) * receiver_z,
                    receiver_z,
                };
                (axis, [low, place, half])
            })
            .collect();
        let [(x, [lx, px, hx]), (y, [ly, py, hy])] = axes[..] else { unreachable!() };
        input.extend([lx, ly, 1.0, px, py, hx, hy].map(|v| v as f32));
        exact.push((x, y, hx.min(hy)));
    }
    let mut worst = Worst::default();
    for ((x, y, narrowest), out) in exact.iter().zip(evaluate(KERNEL, &input, 7, 1)) {
        // Single precision resolves positions to 2^-14 of a texel.
        let allowed = 1e-3 / narrowest.max(0.5) * 10.0 + 1e-4;
        let hidden = x.hidden() * y.hidden();
        let relative = (f64::from(out[0]) - hidden).abs() / if *narrowest < 0.05 { 20.0 } else { 1.0 };
        worst.see(relative / allowed, || format!("{x:?} {y:?}: {} instead of {hidden}", out[0]));
    }
    assert!(worst.error < 1.0, "{worst:?}");
}

#[test]
fn exactly_the_penumbra_rectangle_is_in_penumbra() {
    let mut random = Random(32);
    for _ in 0..4000 {
        let patch_z = f64::from(random.within(0.3, 3.0));
        let low = f64::from(random.within(-2.0, 2.0));
        let mut axis = Axis {
            light: f64::from(random.decades(-2.0, 0.5)),
            patch_low: low,
            patch_high: low + f64::from(random.decades(-3.0, 0.0)),
            patch_z,
            receiver: 0.0,
            receiver_z: patch_z * f64::from(1.0 + random.decades(-2.0, 1.0)),
        };
        let (middle, edge) = axis.rectangle();
        for (part, is_inside) in [(-0.51, false), (-0.49, true), (0.0, true), (0.49, true), (0.51, false)] {
            axis.receiver = middle + part * edge;
            assert_eq!(axis.hidden() > 0.0, is_inside, "{axis:?} at {part} of the rectangle");
        }
    }
}
