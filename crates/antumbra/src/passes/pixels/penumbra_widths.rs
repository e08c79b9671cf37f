//! The width of the penumbra at each listed pixel, for debug views.

use crate::gpu::debug_view::DebugLayout;
use crate::gpu::recorder::Recorder;
use crate::gpu::resources::BufferDescription;
use crate::passes::pixels::classify::PenumbraList;

/// Widths along the light's edges, a pair per listed pixel in the list's order, if debug views are captured; see
/// `shaders/penumbra_widths.wesl`.
pub fn penumbra_widths(recorder: &mut Recorder, list: &PenumbraList) -> Option<wgpu::Buffer> {
    let help = "width of the penumbra on a plane parallel to the light, metres, by the mean distance of the blockers: along \
                the light's x, along its y";
    let [width, height] = list.size;
    let layout = DebugLayout::Numbers { stride: 2, channels: 2, size: list.size, list: Some(list.buffer.clone()) };
    let pairs = BufferDescription::new(u64::from(width) * u64::from(height) * 8).debug(help, layout);
    recorder.captures_debug().then(|| recorder.buffer("penumbra widths", pairs))
}
