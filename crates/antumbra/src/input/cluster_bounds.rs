//! The box around each cluster, measured once on the GPU: a host's vertices never come to the CPU.

use super::casters::Casters;
use crate::bindings;
use crate::error::Error;
use crate::gpu::device::Gpu;
use crate::gpu::recorder::Work;
use crate::gpu::shader::ShaderKey;

/// Fills the table of boxes of [`Casters`].
pub(crate) fn measure(gpu: &Gpu, casters: &Casters) -> Result<(), Error> {
    let pipeline = gpu.compute_pipeline(&ShaderKey::new("input::cluster_bounds"), "measure")?;
    gpu.submit(|recorder| {
        for batch in casters.batches.iter().filter(|b| b.cluster_count > 0) {
            let set = [&bindings! { boxes: &casters.cluster_bounds }[..], &batch.bindings(casters)];
            let side = batch.cluster_count.min(1 << 15);
            let work = Work::Groups([side, batch.cluster_count.div_ceil(side), 1]);
            recorder.compute("cluster bounds", &pipeline, &set, work)?;
        }
        Ok(())
    })
}
