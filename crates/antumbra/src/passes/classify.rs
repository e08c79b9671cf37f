//! Which pixels need a filter at all: lit, dark and turned-away pixels are answered at once, penumbra pixels are listed.

use crate::frame::{Frame, FrameUniform};
use crate::passes::{depth_map::DepthMap, depth_pyramid::DepthPyramid};
use crate::recorder::{Recorder, Work, dispatch};
use crate::resource::storage_buffer;
use crate::shader::ShaderKey;
use crate::technique::{InnerContent, InnerPicture, Memory};
use crate::{Error, Gpu, bindings};

/// The pixels in penumbra, for an indirect dispatch of 64 threads a workgroup; see `shaders/penumbra_list.wesl`.
pub struct PenumbraList {
    /// Indirect arguments, the count, then the pixels.
    pub buffer: wgpu::Buffer,
    /// Indirect arguments, the count, then for each tile of 8 x 8 pixels that has some the first and how many.
    pub tiles: wgpu::Buffer,
    size: [u32; 2],
}

/// Which pixels are listed besides those in penumbra.
#[derive(Clone, Copy, Debug, Default)]
pub struct Listing {
    /// What the light's centre sees nothing of may be lit from its rim, through a gap that the centre does not see: only
    /// techniques that look from nowhere else trust the map that it is dark; others get such pixels listed.
    pub trust_dark: bool,
    /// For techniques that filter over the pixel's footprint on the map: what falls into it counts too.
    pub footprints: bool,
}

impl PenumbraList {
    /// Room for every pixel.
    pub fn new(gpu: &Gpu, size: [u32; 2]) -> PenumbraList {
        let pixels = u64::from(size[0]) * u64::from(size[1]);
        let tiles = u64::from(size[0].div_ceil(8)) * u64::from(size[1].div_ceil(8));
        PenumbraList {
            buffer: storage_buffer(gpu, "penumbra pixels", 16 + 8 * pixels),
            tiles: storage_buffer(gpu, "penumbra tiles", 16 + 8 * tiles),
            size,
        }
    }

    /// Makes a list in `slot` unless one for a picture of this size is there.
    pub fn ensure<'a>(slot: &'a mut Option<PenumbraList>, gpu: &Gpu, size: [u32; 2]) -> &'a PenumbraList {
        if slot.as_ref().is_none_or(|l| l.size != size) {
            *slot = Some(PenumbraList::new(gpu, size));
        }
        slot.as_ref().expect("just made")
    }

    /// Pixels of the picture that it is for.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Writes the visibility of known pixels and lists the others, whose visibility is -1 until the technique writes it.
    /// What is lit by the map surely is.
    pub fn record(
        &self,
        recorder: &mut Recorder,
        frame: &Frame,
        map: &DepthMap,
        pyramid: &DepthPyramid,
        listing: Listing,
    ) -> Result<(), Error> {
        let key = ShaderKey::new("passes::classify")
            .feature("trust_dark", listing.trust_dark)
            .feature("footprints", listing.footprints)
            .with::<FrameUniform>();
        let classify = recorder.gpu.compute_pipeline(&key, "classify_pixels")?;
        let finish = recorder.gpu.compute_pipeline(&key, "finish")?;
        for counted in [&self.buffer, &self.tiles] {
            recorder.encoder.clear_buffer(counted, 0, Some(16));
        }
        let set = frame.bindings(bindings! {
            depth_map: &map.texture,
            pyramid_bounds: &pyramid.bounds,
            penumbra: &self.buffer,
            tiles: &self.tiles,
        });
        let [width, height] = frame.geometry.size;
        recorder.compute_pass("pixel classification", |gpu, pass| {
            pass.set_pipeline(&classify.pipeline);
            pass.set_bind_group(0, &classify.bind_group(gpu, 0, &set), &[]);
            dispatch(pass, &classify, Work::Threads([width, height, 1]));
            pass.set_pipeline(&finish.pipeline);
            pass.set_bind_group(0, &finish.bind_group(gpu, 0, &set), &[]);
            pass.dispatch_workgroups(1, 1, 1);
        });
        Ok(())
    }

    /// For looking at.
    pub fn inner_picture(&self) -> InnerPicture {
        InnerPicture {
            name: "penumbra list",
            help: "pixels that are looked at closely; all others are known to be lit or dark",
            content: InnerContent::Pixels { list: self.buffer.clone(), size: self.size },
        }
    }

    /// GPU memory by pass.
    pub fn memory(&self) -> Memory {
        Memory::new("pixel classification", self.buffer.size() + self.tiles.size())
    }
}
