//! The number of texels that a kernel needs, by its size in pixels [Shen 2011, section 5.1]: the input of `rho.wesl`.

use super::settings::{PvssmSettings, Rho};

/// Coefficients of a polynomial of log2 of the kernel's size in pixels, the constant first.
pub type Cubic = [f32; 4];

/// The preference of the paper's subjects for moving casters [Shen 2011, figure 9].
pub const DYNAMIC: Cubic = [0.667, 0.7794, 0.3967, -0.02716];
/// Their preference for still scenes.
pub const STATIC: Cubic = [0.5477, 1.406, -0.04687, -0.003944];

/// Kernel sizes in pixels for which the polynomials are valid; others are clamped.
pub const RANGE: [f64; 2] = [1.0, 512.0];

/// The polynomial of these settings.
pub fn coefficients(settings: &PvssmSettings) -> Cubic {
    match settings.rho {
        Rho::Dynamic | Rho::Fitted => DYNAMIC,
        Rho::Static => STATIC,
        Rho::Own => [settings.c0, settings.c1, settings.c2, settings.c3],
        Rho::Linear => [DYNAMIC[0], settings.slope, 0.0, 0.0],
    }
}

/// Texels that a kernel of `n` pixels needs.
pub fn texels(cubic: Cubic, n: f64) -> f64 {
    let x = n.clamp(RANGE[0], RANGE[1]).log2();
    let [a, b, c, d] = cubic.map(f64::from);
    ((d * x + c) * x + b) * x + a
}
