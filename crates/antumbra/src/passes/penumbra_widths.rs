//! How wide the penumbra is at each listed pixel. No visibility needs it: it is kept only while people look at it.

use crate::Gpu;
use crate::passes::classify::PenumbraList;
use crate::resource::storage_buffer;
use crate::technique::{InnerContent, InnerPicture, Memory};

/// Label and name.
const WIDTHS: &str = "penumbra widths";

/// Widths along the light's edges, a pair a listed pixel; see `shaders/penumbra_widths.wesl`.
pub struct PenumbraWidths {
    /// In the list's order.
    pub buffer: wgpu::Buffer,
    size: [u32; 2],
}

impl PenumbraWidths {
    /// Makes room in `slot` for the pixels of a list if `wanted`, and takes it away if not.
    pub fn ensure<'a>(
        slot: &'a mut Option<PenumbraWidths>,
        gpu: &Gpu,
        list: &PenumbraList,
        wanted: bool,
    ) -> Option<&'a PenumbraWidths> {
        let size = list.size();
        if !wanted {
            *slot = None;
        } else if slot.as_ref().is_none_or(|w| w.size != size) {
            let bytes = u64::from(size[0]) * u64::from(size[1]) * 8;
            *slot = Some(PenumbraWidths { buffer: storage_buffer(gpu, WIDTHS, bytes), size });
        }
        slot.as_ref()
    }

    /// For looking at.
    pub fn inner_picture(&self, list: &PenumbraList) -> InnerPicture {
        InnerPicture {
            name: WIDTHS,
            help: "width of the penumbra on a plane parallel to the light, metres, as the mean distance of the blockers \
                   tells it: along the light's x, along its y",
            content: InnerContent::Numbers {
                numbers: self.buffer.clone(),
                stride: 2,
                channels: 2,
                size: self.size,
                list: Some(list.buffer.clone()),
            },
        }
    }

    /// GPU memory.
    pub fn memory(&self) -> Memory {
        Memory::new(WIDTHS, self.buffer.size())
    }
}
