//! Limited resources of shaders.

use crate::error::Error;

/// Resources of one shader that devices limit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Needs {
    /// Storage buffers.
    pub storage_buffers: u32,
    /// Storage textures.
    pub storage_textures: u32,
    /// Textures that are sampled or loaded from.
    pub sampled_textures: u32,
    /// Memory that a workgroup shares.
    pub workgroup_bytes: u32,
}

impl Needs {
    /// The limits of every WebGPU device.
    pub const CORE: Needs =
        Needs { storage_buffers: 8, storage_textures: 4, sampled_textures: 16, workgroup_bytes: 16384 };

    /// The larger of each.
    pub fn max(self, other: Needs) -> Needs {
        Needs {
            storage_buffers: self.storage_buffers.max(other.storage_buffers),
            storage_textures: self.storage_textures.max(other.storage_textures),
            sampled_textures: self.sampled_textures.max(other.sampled_textures),
            workgroup_bytes: self.workgroup_bytes.max(other.workgroup_bytes),
        }
    }

    /// Refuses a device with lower limits. `shader` is who needs it.
    pub(crate) fn check(&self, shader: &'static str, limits: &wgpu::Limits) -> Result<(), Error> {
        let pairs = [
            ("storage buffers", self.storage_buffers, limits.max_storage_buffers_per_shader_stage),
            ("storage textures", self.storage_textures, limits.max_storage_textures_per_shader_stage),
            ("textures", self.sampled_textures, limits.max_sampled_textures_per_shader_stage),
            ("bytes of workgroup memory", self.workgroup_bytes, limits.max_compute_workgroup_storage_size),
        ];
        match pairs.into_iter().find(|(_, needed, given)| needed > given) {
            None => Ok(()),
            Some((what, needed, given)) => Err(Error::Limit { shader, what, needed, given }),
        }
    }
}
