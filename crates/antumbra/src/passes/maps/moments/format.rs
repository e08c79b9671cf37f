//! Formats of a moment map's texels.

use crate::error::Error;
use crate::gpu::device::Gpu;
use crate::gpu::shader::StorageFormat;

crate::choices! {
    /// How a texel of a moment map is stored.
    pub enum TexelFormat {
        /// One 32-bit number.
        R32Float = "r32float",
        /// Two 32-bit numbers.
        Rg32Float = "rg32float",
        /// Four 32-bit numbers.
        Rgba32Float = "rgba32float",
        /// One 16-bit number.
        R16Float = "r16float",
        /// Two 16-bit numbers.
        Rg16Float = "rg16float",
        /// Four 16-bit numbers.
        Rgba16Float = "rgba16float",
        /// Four 16-bit fractions from 0 to 1.
        Rgba16Unorm = "rgba16unorm",
        /// Four 8-bit fractions from -1 to 1.
        Rgba8Snorm = "rgba8snorm",
        /// Two 32-bit numbers, each over two 16-bit channels.
        Split = "split",
    }
}

impl TexelFormat {
    /// As a texture.
    pub fn texture(self) -> wgpu::TextureFormat {
        use wgpu::TextureFormat as F;
        match self {
            TexelFormat::R32Float => F::R32Float,
            TexelFormat::Rg32Float => F::Rg32Float,
            TexelFormat::Rgba32Float => F::Rgba32Float,
            TexelFormat::R16Float => F::R16Float,
            TexelFormat::Rg16Float => F::Rg16Float,
            TexelFormat::Rgba16Float | TexelFormat::Split => F::Rgba16Float,
            TexelFormat::Rgba16Unorm => F::Rgba16Unorm,
            TexelFormat::Rgba8Snorm => F::Rgba8Snorm,
        }
    }

    /// As shaders store to it.
    pub fn storage(self) -> StorageFormat {
        StorageFormat(match self {
            TexelFormat::Split => "rgba16float",
            other => other.name(),
        })
    }

    /// Whether two channels make a number.
    pub fn is_split(self) -> bool {
        self == TexelFormat::Split
    }

    /// As in a setting.
    pub fn name(self) -> &'static str {
        TexelFormat::OPTIONS[self as usize]
    }

    /// The part of a number of size 1 by which rounding moves it at most.
    pub fn rounding(self) -> f32 {
        match self {
            TexelFormat::R32Float | TexelFormat::Rg32Float | TexelFormat::Rgba32Float => 2f32.powi(-24),
            TexelFormat::R16Float | TexelFormat::Rg16Float | TexelFormat::Rgba16Float => 2f32.powi(-12),
            TexelFormat::Rgba16Unorm => 2f32.powi(-17),
            TexelFormat::Rgba8Snorm => 2f32.powi(-8),
            TexelFormat::Split => 2f32.powi(-23),
        }
    }

    /// Whether the device's sampler filters it.
    pub fn is_filtered(self, gpu: &Gpu) -> bool {
        let wide = matches!(self, TexelFormat::R32Float | TexelFormat::Rg32Float | TexelFormat::Rgba32Float);
        !wide || gpu.capabilities.float32_filtering
    }

    /// Refuses a format that the device does not store; `instead` is one that works everywhere.
    pub fn check(self, gpu: &Gpu, instead: &'static str) -> Result<(), Error> {
        let there = match self {
            TexelFormat::R16Float | TexelFormat::Rg16Float => gpu.capabilities.adapter_formats,
            TexelFormat::Rgba16Unorm => gpu.capabilities.norm16,
            _ => true,
        };
        if there { Ok(()) } else { Err(Error::Format { format: self.name(), instead }) }
    }
}
