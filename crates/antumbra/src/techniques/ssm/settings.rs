//! Settings of the technique.

use crate::technique::settings::Kind;

crate::choices! {
    /// How the shadows of the micro-patches are accumulated.
    pub enum Accumulate {
        /// Each texel of the soft shadow map sums over the patches that may hide some of the light from it.
        Gather = "gather",
        /// Each patch draws its penumbra rectangle with additive blending [Atty 2006, section 4.1].
        Blend = "blend",
    }
}

crate::choices! {
    /// Number format of the accumulated shadows.
    pub enum Format {
        /// 23 bits of mantissa.
        Float32 = "float32",
        /// 10 bits of mantissa: the blending hardware of 2006 [Atty 2006, section 5.1.3].
        Float16 = "float16",
    }
}

crate::settings! {
    /// Settings of [`Ssm`](super::Ssm).
    pub struct SsmSettings {
        /// Occluder map, receiver map and soft shadow map, texels per side; any number.
        map: u32 = 512, Kind::Integer { min: 1, max: 8192 };
        /// 1: the nearest surfaces of occluders cast. 2: the farthest do too, and the darker shadow counts.
        passes: u32 = 2, Kind::Integer { min: 1, max: 2 };
        /// Put patches with wide penumbrae on coarser maps, as fewer and larger patches. False: the paper's single map.
        hierarchy: bool = true, Kind::Toggle;
        /// With `hierarchy`: smallest width of a patch's penumbra on its level, texels.
        window: u32 = 8, Kind::Integer { min: 2, max: 64 };
        /// How shadows are accumulated: summed by texels in a compute shader, or as rectangles by blending.
        accumulate: Accumulate = Accumulate::Gather, Kind::Choice { options: Accumulate::OPTIONS };
        /// Number format of the sums; float16 loses patches that hide less than 1/1024 of the light.
        format: Format = Format::Float32, Kind::Choice { options: Format::OPTIONS };
    }
}
