//! Depth-peeled maps: the nearest few casters of each texel, seen from the light's centre.

use crate::casters::Casters;
use crate::passes::depth_map::FrustumCasters;
use crate::recorder::Recorder;
use crate::resource::Texture;
use crate::technique::Memory;
use crate::{Error, Frame, Gpu};

/// Square maps of `near / z` as in [`DepthMap`](crate::passes::depth_map::DepthMap), one behind the other: layer `i`
/// holds the i-th nearest surface of each texel, front or back, and 0 where there are no more. Depths descend strictly;
/// surfaces of the same depth to the last bit are one.
pub struct DepthLayers {
    /// `Depth32Float`, `size` x `size` x `layers`; its view is an array even of a single layer.
    pub texture: Texture,
    size: u32,
    /// A view of each layer.
    layers: Vec<wgpu::TextureView>,
    seen: FrustumCasters,
}

impl DepthLayers {
    /// Empty maps of `size` texels a side; `layers` is 1 or more.
    pub fn new(gpu: &Gpu, size: u32, layers: u32, casters: &Casters) -> Result<DepthLayers, Error> {
        gpu.check_size("shadow map", size, size)?;
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT
            | wgpu::TextureUsages::TEXTURE_BINDING
            | wgpu::TextureUsages::COPY_SRC;
        let texture = Texture::array(gpu, "depth layers", [size; 2], layers, wgpu::TextureFormat::Depth32Float, usage);
        let layers = (0..layers).map(|i| texture.layers(i, 1)).collect();
        Ok(DepthLayers { texture, size, layers, seen: FrustumCasters::new(gpu, casters) })
    }

    /// Makes maps in `slot` unless `layers` of this size for these casters are there, and draws what the light's centre
    /// sees and what lies behind it.
    pub fn of_light<'a>(
        slot: &'a mut Option<DepthLayers>,
        recorder: &mut Recorder,
        frame: &Frame,
        size: u32,
        layers: u32,
    ) -> Result<&'a DepthLayers, Error> {
        let casters = &frame.casters;
        let fits = |m: &DepthLayers| m.size == size && m.layers.len() as u32 == layers && m.seen.fits(casters);
        if !slot.as_ref().is_some_and(fits) {
            *slot = None; // Frees the old maps before the new ones are made.
            *slot = Some(DepthLayers::new(recorder.gpu, size, layers, casters)?);
        }
        let maps = slot.as_ref().expect("just made");
        maps.record(recorder, frame)?;
        Ok(maps)
    }

    fn record(&self, recorder: &mut Recorder, frame: &Frame) -> Result<(), Error> {
        let casters = &frame.casters;
        self.seen.cull(recorder, casters, frame.map_clip_from_world())?;
        for (i, layer) in self.layers.iter().enumerate() {
            let nearer = i.checked_sub(1).map(|before| &self.layers[before]);
            self.seen.draw(recorder, "depth layers", casters, layer, nearer)?;
        }
        Ok(())
    }

    /// GPU memory by pass.
    pub fn memory(&self) -> [Memory; 2] {
        [self.seen.memory(), Memory::new("depth layers", self.texture.bytes())]
    }
}
