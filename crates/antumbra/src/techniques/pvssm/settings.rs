//! Settings of the virtual soft shadow maps.

use super::rho;
use crate::technique::settings::Kind;

crate::choices! {
    /// The number of texels that a kernel needs.
    pub enum Rho {
        /// The preference of twelve people for moving casters: the paper's choice.
        Dynamic = "dynamic",
        /// Their preference for still scenes.
        Static = "static",
        /// Linear in the logarithm of the kernel's size, by `slope`.
        Linear = "linear",
        /// One texel per pixel [Giegl and Wimmer 2007].
        Fitted = "fitted",
        /// The polynomial of `c0` to `c3`, such as the result of `antumbra study rho`.
        Own = "own",
    }
}

crate::choices! {
    /// The processor that decides which tiles are drawn.
    pub enum Decision {
        /// The GPU, within the frame.
        Gpu = "gpu",
        /// The CPU, after waiting for the grid: the paper's way.
        Wait = "wait",
    }
}

crate::settings! {
    /// Settings of [`Pvssm`](super::Pvssm) and [`Fvsm`](crate::techniques::pvssm::fvsm::Fvsm).
    pub struct PvssmSettings {
        /// Low-resolution map, texels per side.
        map: u32 = 1024, Kind::Integer { min: 16, max: 8192 };
        /// Largest tile, texels per side; the pool that holds the tiles is as large.
        tile: u32 = 2048, Kind::Integer { min: 64, max: 8192 };
        /// Cells of the tile grid per side: 16, 32, 64 or 128.
        grid: u32 = 64, Kind::Integer { min: 16, max: 128 };
        /// Most fillings of the pool in a frame; all tiles are made coarser if that is not enough.
        rounds: u32 = 16, Kind::Integer { min: 1, max: 16 };
        /// Texels that a kernel needs over its size in pixels.
        rho: Rho = Rho::Dynamic, Kind::Choice { options: Rho::OPTIONS };
        /// With `rho=linear`: additional texels for a kernel twice as wide.
        slope: f32 = 2.0, Kind::Number { min: 0.1, max: 64.0 };
        /// With `rho=own`: texels at one pixel.
        c0: f32 = rho::DYNAMIC[0], Kind::Number { min: -64.0, max: 64.0 };
        /// With `rho=own`: coefficient of the logarithm to base 2 of the kernel's size in pixels.
        c1: f32 = rho::DYNAMIC[1], Kind::Number { min: -64.0, max: 64.0 };
        /// With `rho=own`: coefficient of its square.
        c2: f32 = rho::DYNAMIC[2], Kind::Number { min: -64.0, max: 64.0 };
        /// With `rho=own`: coefficient of its cube.
        c3: f32 = rho::DYNAMIC[3], Kind::Number { min: -64.0, max: 64.0 };
        /// Factor on the predicted texels along each axis.
        detail: f32 = 1.0, Kind::Number { min: 0.1, max: 16.0 };
        /// Widest blocker search, in nodes of the depth pyramid per side.
        search: u32 = 16, Kind::Integer { min: 2, max: 256 };
        /// Most nodes of a tile under a kernel, as the side of a square; wider kernels read a coarser level.
        filter: u32 = 16, Kind::Integer { min: 2, max: 256 };
        /// Whether tiles are also split if their halves need far fewer texels together, not only if they are too large.
        thrifty: bool = true, Kind::Toggle;
        /// The processor that decides which tiles are drawn: the GPU, or the CPU after waiting for the grid.
        decision: Decision = Decision::Gpu, Kind::Choice { options: Decision::OPTIONS };
    }
}
