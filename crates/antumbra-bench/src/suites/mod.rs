//! One suite per paper.

pub mod adaptive;
pub mod backprojection;
pub mod pvssm;
mod shapes;
pub mod ssm;
pub mod subpixel;
pub mod vsm;
