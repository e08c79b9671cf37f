//! What can be set.

use crate::technique::settings::Kind;

crate::choices! {
    /// Who adds up the shadows of the micro-patches.
    pub enum Accumulate {
        /// Each texel of the soft shadow map looks at the patches that can hide something from it.
        Gather = "gather",
        /// Each patch draws its penumbra rectangle, and the blending unit adds [Atty 2006, section 4.1].
        Blend = "blend",
    }
}

crate::choices! {
    /// The numbers in which shadows are added up.
    pub enum Format {
        /// 23 bits of mantissa.
        Float32 = "float32",
        /// 10 bits: all that hardware could blend in 2006 [Atty 2006, section 5.1.3].
        Float16 = "float16",
    }
}

crate::settings! {
    /// Settings of [`Ssm`](super::Ssm).
    pub struct SsmSettings {
        /// Occluder map, receiver map and soft shadow map, texels a side; any number.
        map: u32 = 512, Kind::Integer { min: 1, max: 8192 };
        /// 1: the nearest surfaces of occluders cast. 2: the farthest do as well, and the darker shadow counts.
        passes: u32 = 2, Kind::Integer { min: 1, max: 2 };
        /// Whether patches with a wide penumbra go to coarser maps, fewer and larger. False: the paper's single map.
        hierarchy: bool = true, Kind::Toggle;
        /// With `hierarchy`: texels that a penumbra is wide at least on the level where its patch is put.
        window: u32 = 8, Kind::Integer { min: 2, max: 64 };
        /// Who adds up: texels of the soft shadow map in a compute shader, or rectangles through the blending unit.
        accumulate: Accumulate = Accumulate::Gather, Kind::Choice { options: Accumulate::OPTIONS };
        /// Numbers in which shadows are added up; float16 loses patches that hide less than 1/1024 of the light.
        format: Format = Format::Float32, Kind::Choice { options: Format::OPTIONS };
    }
}
