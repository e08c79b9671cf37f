//! Settings of the virtual soft shadow maps.

use super::rho;
use crate::technique::settings::Kind;

crate::choices! {
    /// How many texels a kernel needs.
    pub enum Rho {
        /// What twelve people wanted where casters move: the paper's choice.
        Dynamic = "dynamic",
        /// What they wanted where nothing moves.
        Static = "static",
        /// Growing with the logarithm of the kernel's size by `slope`.
        Linear = "linear",
        /// A texel a pixel [Giegl and Wimmer 2007].
        Fitted = "fitted",
        /// The polynomial of `c0` to `c3`: what `antumbra study rho` has found.
        Own = "own",
    }
}

crate::choices! {
    /// Who decides which tiles are drawn.
    pub enum Decision {
        /// The GPU, within the frame.
        Gpu = "gpu",
        /// The CPU, which waits for the grid: the paper's way.
        Wait = "wait",
    }
}

crate::settings! {
    /// Settings of [`Pvssm`](super::Pvssm) and [`Fvsm`](crate::techniques::pvssm::fvsm::Fvsm).
    pub struct PvssmSettings {
        /// Low-resolution map, texels a side.
        map: u32 = 1024, Kind::Integer { min: 16, max: 8192 };
        /// Largest tile, texels a side; the pool that holds the tiles is as large.
        tile: u32 = 2048, Kind::Integer { min: 64, max: 8192 };
        /// Cells of the tile grid a side: 16, 32, 64 or 128.
        grid: u32 = 64, Kind::Integer { min: 16, max: 128 };
        /// How often the pool may be filled in a frame; all tiles are made coarser where that is not enough.
        rounds: u32 = 16, Kind::Integer { min: 1, max: 16 };
        /// Texels that a kernel needs over its size in pixels.
        rho: Rho = Rho::Dynamic, Kind::Choice { options: Rho::OPTIONS };
        /// Texels more for a kernel twice as wide, where `rho=linear`.
        slope: f32 = 2.0, Kind::Number { min: 0.1, max: 64.0 };
        /// Where `rho=own`: texels at one pixel.
        c0: f32 = rho::DYNAMIC[0], Kind::Number { min: -64.0, max: 64.0 };
        /// Where `rho=own`: coefficient of the logarithm to base 2 of the kernel's size in pixels.
        c1: f32 = rho::DYNAMIC[1], Kind::Number { min: -64.0, max: 64.0 };
        /// Where `rho=own`: coefficient of its square.
        c2: f32 = rho::DYNAMIC[2], Kind::Number { min: -64.0, max: 64.0 };
        /// Where `rho=own`: coefficient of its cube.
        c3: f32 = rho::DYNAMIC[3], Kind::Number { min: -64.0, max: 64.0 };
        /// Times as many texels as predicted, along each axis.
        detail: f32 = 1.0, Kind::Number { min: 0.1, max: 16.0 };
        /// Widest blocker search, in nodes of the depth pyramid a side.
        search: u32 = 16, Kind::Integer { min: 2, max: 256 };
        /// Most nodes of a tile that a kernel is filtered with, as the side of a square; wider ones read a coarser level.
        filter: u32 = 16, Kind::Integer { min: 2, max: 256 };
        /// Whether a tile is split where its halves need far fewer texels together, not only where it is too large.
        thrifty: bool = true, Kind::Toggle;
        /// Whether the GPU decides which tiles are drawn, or the CPU waits for the grid and does.
        decision: Decision = Decision::Gpu, Kind::Choice { options: Decision::OPTIONS };
    }
}
