//! The box around each cluster, measured once on the GPU: borrowed vertices never come to the CPU.

use crate::casters::{BatchLayout, Casters};
use crate::shader::ShaderKey;
use crate::{Error, Gpu, bindings};

/// Fills [`Casters`]' table of boxes.
pub(crate) fn measure(gpu: &Gpu, casters: &Casters) -> Result<(), Error> {
    let pipeline = gpu.compute_pipeline(&ShaderKey::new("passes::cluster_bounds").with::<BatchLayout>(), "measure")?;
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let mut pass = encoder.begin_compute_pass(&Default::default());
    pass.set_pipeline(&pipeline.pipeline);
    for batch in casters.batches.iter().filter(|b| b.item_count > 0) {
        pass.set_bind_group(0, &pipeline.bind_group(gpu, 0, bindings! { boxes: &casters.cluster_bounds }), &[]);
        pass.set_bind_group(1, &pipeline.bind_group(gpu, 1, &batch.bindings(casters)), &[]);
        let side = batch.item_count.min(1 << 15);
        pass.dispatch_workgroups(side, batch.item_count.div_ceil(side), 1);
    }
    drop(pass);
    gpu.queue.submit([encoder.finish()]);
    Ok(())
}
