//! `shaders/smooth_kernel.wesl`: the window of a soft, antialiased shadow [Shen 2011, eq. 2 and appendix].

use crate::testing::{Random, Worst, evaluate};
use glam::{DMat2, DVec2};

/// A parallelogram by its half axes.
#[derive(Clone, Copy, Debug)]
struct Window {
    u: DVec2,
    v: DVec2,
}

impl Window {
    fn random(random: &mut Random, low: f32, high: f32) -> [f32; 4] {
        let mut axis = || {
            let (length, turn) = (random.decades(low, high), random.within(0.0, std::f32::consts::TAU));
            [length * turn.cos(), length * turn.sin()]
        };
        let (u, v) = (axis(), axis());
        [u[0], u[1], v[0], v[1]]
    }

    fn of(numbers: &[f32]) -> Window {
        let n: Vec<f64> = numbers.iter().map(|x| f64::from(*x)).collect();
        Window { u: DVec2::new(n[0], n[1]), v: DVec2::new(n[2], n[3]) }
    }

    /// Covariance of a point that is anywhere in it, by the definition: mean over a lattice of n x n places of the
    /// parallelogram, which is exact but for the factor 1 - 1 / n^2.
    fn covariance(&self) -> DMat2 {
        const N: i32 = 16;
        let place = |i: i32| f64::from(2 * i + 1) / f64::from(N) - 1.0;
        let mut sum = DMat2::ZERO;
        for i in 0..N {
            for j in 0..N {
                let p = place(i) * self.u + place(j) * self.v;
                sum += DMat2::from_cols(p * p.x, p * p.y);
            }
        }
        sum * (1.0 / (f64::from(N * N) * (1.0 - 1.0 / f64::from(N * N))))
    }
}

#[test]
fn a_convolution_has_the_covariance_of_both_windows() {
    const KERNEL: &str = "
        import package::shaders::smooth_kernel::{Kernel, spread, kernel_of};
        fn pair(at: u32) -> vec2<f32> { return vec2(input[at], input[at + 1u]); }
        fn evaluate(at: u32, to: u32) {
            let k = kernel_of(spread(pair(at), pair(at + 2u)) + spread(pair(at + 4u), pair(at + 6u)));
            output[to] = k.u.x;
            output[to + 1u] = k.u.y;
            output[to + 2u] = k.v;
        }";
    let mut random = Random(5);
    let input: Vec<f32> = (0..4000)
        .flat_map(|_| [Window::random(&mut random, -2.0, 2.0), Window::random(&mut random, -2.0, 2.0)])
        .flatten()
        .collect();
    let mut worst = Worst::default();
    for (windows, k) in input.chunks_exact(8).zip(evaluate(KERNEL, &input, 8, 3)) {
        let both = Window::of(&windows[..4]).covariance() + Window::of(&windows[4..]).covariance();
        let one = Window::of(&[k[0], k[1], 0.0, k[2]]).covariance();
        let off = (both - one).abs();
        let size = both.x_axis.x + both.y_axis.y;
        worst.see((off.x_axis + off.y_axis).element_sum() / size, || format!("{windows:?} gave {k:?}"));
        assert!(k[0] > 0.0 && k[2] > 0.0, "{windows:?} gave {k:?}");
    }
    // The Cholesky factor of a thin window is a small difference of large squares; a window is at least 1 / 1000 wide.
    assert!(worst.error < 2e-5, "{worst:?}");
}

/// Sums the overlap of a window with all nodes, as the filter's loop does.
const SUM: &str = "
    import package::shaders::smooth_kernel::{Kernel, Panel, kernel_area, panel, coverage};
    fn evaluate(at: u32, to: u32) {
        let k = Kernel(vec2(input[at], input[at + 1u]), input[at + 2u]);
        let within = vec2(input[at + 3u], input[at + 4u]);
        let width = input[at + 5u];
        var sum = 0.0;
        var least = 0.0;
        let last = i32(floor((within.x + k.u.x) / width));
        for (var i = i32(floor((within.x - k.u.x) / width)); i <= last; i++) {
            let p = panel(k, f32(i) * width - within.x, width);
            let bottom = i32(floor((within.y + p.y + k.v) / width));
            for (var j = i32(floor((within.y + p.y - k.v) / width)); j <= bottom; j++) {
                let area = coverage(k, p, f32(j) * width - within.y, width);
                sum += area;
                least = min(least, area);
            }
        }
        output[to] = sum;
        output[to + 1u] = kernel_area(k);
        output[to + 2u] = least;
    }";

#[test]
fn coverages_sum_to_the_windows_area_down_to_a_hundredth_of_a_texel() {
    let mut random = Random(7);
    let mut input = Vec::new();
    for _ in 0..20000 {
        let width = 2f32.powf(random.within(0.0, 4.0).floor());
        let (x, v) = (random.decades(-2.0, 1.5), random.decades(-2.0, 1.5));
        input.extend([x, x * random.within(-3.0, 3.0), v, width * random.unit(), width * random.unit(), width]);
    }
    let mut worst = Worst::default();
    for (given, found) in input.chunks_exact(6).zip(evaluate(SUM, &input, 6, 3)) {
        let area = 4.0 * f64::from(given[0]) * f64::from(given[2]);
        let error = (f64::from(found[0]) - area).abs().max((f64::from(found[1]) - area).abs()) / area;
        // Edges are rounded as places of the window are, to 2^-24 of the distance from its middle.
        let reach = f64::from(given[0].max(given[1].abs() + given[2]) + given[5]);
        let allowed = 1.0 + reach / f64::from(given[0].min(given[2]));
        worst.see(error / allowed, || format!("{given:?} gave {found:?}, area {area}"));
        assert!(found[2] >= 0.0, "a negative coverage: {given:?} gave {found:?}");
    }
    // Some thousand areas are added one by one.
    assert!(worst.error < 2e-6, "{worst:?}");
}

#[test]
fn a_coverage_is_that_of_the_panels_box() {
    const ONE: &str = "
        import package::shaders::smooth_kernel::{Kernel, Panel, panel, coverage};
        fn evaluate(at: u32, to: u32) {
            let k = Kernel(vec2(input[at], input[at + 1u]), input[at + 2u]);
            let p = panel(k, input[at + 3u], input[at + 5u]);
            output[to] = coverage(k, p, input[at + 4u], input[at + 5u]);
        }";
    let mut random = Random(9);
    let mut input = Vec::new();
    for _ in 0..20000 {
        let width = 2f32.powf(random.within(0.0, 4.0).floor());
        let (x, v) = (random.decades(-2.0, 1.5), random.decades(-2.0, 1.5));
        let reach = x + width;
        let corner = [random.within(-reach, reach), random.within(-v - width, v + width)];
        input.extend([x, x * random.within(-3.0, 3.0), v, corner[0], corner[1], width]);
    }
    let mut worst = Worst::default();
    for (given, found) in input.chunks_exact(6).zip(evaluate(ONE, &input, 6, 1)) {
        let g: Vec<f64> = given.iter().map(|x| f64::from(*x)).collect();
        let (left, right) = (g[3].max(-g[0]), (g[3] + g[5]).min(g[0]));
        let middle = 0.5 * (left + right) * g[1] / g[0];
        let rows = (g[4] + g[5]).min(middle + g[2]) - g[4].max(middle - g[2]);
        let area = (right - left).max(0.0) * rows.max(0.0);
        let scale = g[5] * (g[5] + g[0].abs() + g[1].abs());
        worst.see((f64::from(found[0]) - area).abs() / scale, || format!("{given:?} gave {found:?}, not {area}"));
    }
    assert!(worst.error < 1e-6, "{worst:?}");
}
