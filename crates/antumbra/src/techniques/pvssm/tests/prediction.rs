//! The number of texels that a kernel needs, against the paper's polynomials and its equations 4 and 5 in double
//! precision.

use super::super::rho::{self, DYNAMIC, STATIC};
use super::super::{PvssmSettings, PvssmUniform, Rho};
use super::{Random, computed, gpu};
use crate::bindings;
use crate::gpu::resources::uniform;
use crate::gpu::shader::ShaderKey;
use glam::{DMat2, DVec2};

const KERNEL: &str = "
    import package::shaders::smooth_kernel::{spread, kernel_of};
    import package::techniques::pvssm::rho::{rho, size_in_pixels};
    var<storage, read> input: array<vec4<f32>>;
    var<storage, read_write> output: array<vec4<f32>>;
    @compute @workgroup_size(64) fn each(@builtin(global_invocation_id) id: vec3<u32>) {
        if id.x < arrayLength(&output) {
            let u = 0.5 * input[2u * id.x].xy;
            let v = 0.5 * input[2u * id.x].zw;
            let light = input[2u * id.x + 1u].xy;
            let k = kernel_of(spread(u, v) + spread(vec2(light.x, 0.0), vec2(0.0, light.y)));
            let n = size_in_pixels(k, u, v);
            output[id.x] = vec4(n, rho(n.x), rho(n.y));
        }
    }";

/// Sizes in pixels along x and y and the texels for them, for footprints (across, down) and halves of the light's box.
fn on_the_gpu(settings: &PvssmSettings, cases: &[[f32; 8]]) -> Vec<[f32; 4]> {
    let key = ShaderKey::of_source(KERNEL);
    let pvssm = uniform(gpu(), "pvssm", &PvssmUniform::new(settings));
    let set = bindings! { pvssm: &pvssm };
    computed(&key, cases.as_flattened(), set, cases.len() as u32, 16 * cases.len() as u64)
}

#[test]
fn the_polynomials_are_those_of_figure_9() {
    // Read off the paper's formulas by hand, at 1, 8 and 512 pixels.
    for (cubic, [one, eight, most]) in [(DYNAMIC, [0.667, 5.8422, 20.0149]), (STATIC, [0.5477, 4.2374, 6.5299])] {
        for (n, exact) in [(1.0, one), (8.0, eight), (512.0, most), (4096.0, most), (0.1, one)] {
            let ours = rho::texels(cubic, n);
            assert!((ours - exact).abs() < 1e-3, "{ours} instead of {exact} texels for {n} pixels");
        }
    }
}

#[test]
fn a_kernel_gets_the_texels_for_its_size_in_pixels() {
    let mut random = Random(83);
    let cases: Vec<[f32; 8]> = (0..4000)
        .map(|_| {
            let scale = 10f32.powf(random.within(-5.0, -1.0));
            let turn = random.within(0.0, std::f32::consts::TAU);
            let skew = turn + random.within(0.2, 2.9);
            let long = scale * 10f32.powf(random.within(0.0, 1.5));
            let light = 10f32.powf(random.within(-1.0, 3.0)) * scale;
            let [x, y] = [random.within(0.2, 1.0) * light, random.within(0.2, 1.0) * light];
            [scale * turn.cos(), scale * turn.sin(), long * skew.cos(), long * skew.sin(), x, y, 0.0, 0.0]
        })
        .collect();
    for rho in [Rho::Dynamic, Rho::Static, Rho::Linear, Rho::Fitted] {
        let settings = PvssmSettings { rho, detail: 1.5, ..PvssmSettings::default() };
        let mut worst = (0.0, String::new());
        for (case, out) in cases.iter().zip(on_the_gpu(&settings, &cases)) {
            let c = case.map(f64::from);
            let phi = DMat2::from_cols(0.5 * DVec2::new(c[0], c[1]), 0.5 * DVec2::new(c[2], c[3]));
            let s = DMat2::from_diagonal(DVec2::new(c[4], c[5]));
            let variance = phi * phi.transpose() + s * s.transpose();
            // The Cholesky factor's columns are the kernel's axes; eq. 4 takes their components along the map's axes.
            let u = variance.x_axis.x.sqrt();
            let v = (variance.y_axis.y - (variance.x_axis.y / u).powi(2)).sqrt();
            let n = [DVec2::X * u, DVec2::Y * v].map(|axis| (phi.inverse() * axis).length());
            let texels = n.map(|n| {
                let one = if rho == Rho::Fitted { n } else { rho::texels(rho::coefficients(&settings), n) };
                1.5 * one
            });
            for (exact, got) in n.into_iter().chain(texels).zip(out) {
                let off = (f64::from(got) - exact).abs() / exact;
                if off > worst.0 || off.is_nan() {
                    worst = (off, format!("{case:?}: {out:?} instead of {n:?}, {texels:?}"));
                }
            }
        }
        println!("{rho:?}: {worst:?}");
        assert!(worst.0 < 2e-3, "{rho:?}: {worst:?}");
    }
}
