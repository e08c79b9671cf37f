//! Bind groups by the names in the shader, kept as long as they are used.

use super::shader::Slot;
use crate::error::Error;
use std::collections::HashMap;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::num::NonZero;

/// A name in the shader and the resource behind it.
pub type Binding<'a> = (&'static str, wgpu::BindingResource<'a>);

/// A resource that a name in a shader can stand for.
pub trait Bindable {
    /// As `wgpu` takes it.
    fn resource(&self) -> wgpu::BindingResource<'_>;
}

impl Bindable for wgpu::Buffer {
    fn resource(&self) -> wgpu::BindingResource<'_> {
        self.as_entire_binding()
    }
}
impl Bindable for wgpu::TextureView {
    fn resource(&self) -> wgpu::BindingResource<'_> {
        wgpu::BindingResource::TextureView(self)
    }
}
impl Bindable for wgpu::Sampler {
    fn resource(&self) -> wgpu::BindingResource<'_> {
        wgpu::BindingResource::Sampler(self)
    }
}
impl Bindable for wgpu::BindingResource<'_> {
    fn resource(&self) -> wgpu::BindingResource<'_> {
        self.clone()
    }
}
impl Bindable for super::texture::Texture {
    fn resource(&self) -> wgpu::BindingResource<'_> {
        self.view.resource()
    }
}

/// `bindings! { depth_map: &map, frame: &uniform }`: resources under their names in the shader.
#[macro_export]
macro_rules! bindings {
    ($($name:ident : $value:expr),* $(,)?) => {
        &$crate::binding_array! { $($name : $value),* }
    };
}

/// The same by value, to be returned from a function.
#[macro_export]
macro_rules! binding_array {
    ($($name:ident : $value:expr),* $(,)?) => {
        [$((stringify!($name), $crate::gpu::bindings::Bindable::resource($value))),*]
    };
}

/// The resources that a pipeline binds.
#[derive(Debug)]
pub(crate) struct Layout {
    pub shader: &'static str,
    pub group: wgpu::BindGroupLayout,
    pub slots: Vec<Slot>,
    /// Names that other variants of the shader may bind, sorted.
    pub known_names: Vec<String>,
}

/// A resource of a bind group, owned.
#[derive(Debug, PartialEq, Eq)]
enum Bound {
    Buffer(wgpu::Buffer, u64, Option<NonZero<u64>>),
    Texture(wgpu::TextureView),
    Sampler(wgpu::Sampler),
}

impl Bound {
    fn of(resource: &wgpu::BindingResource) -> Bound {
        match resource {
            wgpu::BindingResource::Buffer(b) => Bound::Buffer(b.buffer.clone(), b.offset, b.size),
            wgpu::BindingResource::TextureView(view) => Bound::Texture((*view).clone()),
            wgpu::BindingResource::Sampler(sampler) => Bound::Sampler((*sampler).clone()),
            _ => unreachable!("`Bindable` makes no other"),
        }
    }

    fn is(&self, resource: &wgpu::BindingResource) -> bool {
        match (self, resource) {
            (Bound::Buffer(buffer, offset, size), wgpu::BindingResource::Buffer(b)) => {
                buffer == b.buffer && (*offset, *size) == (b.offset, b.size)
            }
            (Bound::Texture(view), wgpu::BindingResource::TextureView(v)) => view == *v,
            (Bound::Sampler(sampler), wgpu::BindingResource::Sampler(s)) => sampler == *s,
            _ => false,
        }
    }
}

fn hash_resource(resource: &wgpu::BindingResource, hasher: &mut DefaultHasher) {
    match resource {
        wgpu::BindingResource::Buffer(b) => (b.buffer, b.offset).hash(hasher),
        wgpu::BindingResource::TextureView(view) => view.hash(hasher),
        wgpu::BindingResource::Sampler(sampler) => sampler.hash(hasher),
        _ => {}
    }
}

#[derive(Debug)]
struct Kept {
    layout: wgpu::BindGroupLayout,
    resources: Vec<Bound>,
    group: wgpu::BindGroup,
    used: u64,
}

/// Bind groups of earlier frames, found again by their layout and resources.
#[derive(Debug, Default)]
pub(crate) struct BindGroups {
    kept: HashMap<u64, Vec<Kept>>,
    /// Number of bind groups made so far.
    pub made: u64,
}

impl BindGroups {
    /// The bind group of these resources; the same one while nothing changes. Names that another variant of the shader
    /// uses are passed over; a missing name and one that no variant knows are errors.
    pub fn get(
        &mut self,
        device: &wgpu::Device,
        layout: &Layout,
        sets: &[&[Binding]],
        frame: u64,
    ) -> Result<wgpu::BindGroup, Error> {
        let find = |slot: &Slot| {
            let mut all = sets.iter().flat_map(|set| set.iter());
            let found = all.find(|(name, _)| *name == slot.name).map(|(_, resource)| resource);
            found.ok_or_else(|| Error::MissingBinding { shader: layout.shader, name: slot.name.clone() })
        };
        let mut hasher = DefaultHasher::new();
        layout.group.hash(&mut hasher);
        for slot in &layout.slots {
            hash_resource(find(slot)?, &mut hasher);
        }
        let bucket = self.kept.entry(hasher.finish()).or_default();
        let same = |kept: &&mut Kept| {
            let resources = layout.slots.iter().zip(&kept.resources);
            kept.layout == layout.group && resources.into_iter().all(|(s, r)| find(s).is_ok_and(|f| r.is(f)))
        };
        if let Some(kept) = bucket.iter_mut().find(same) {
            kept.used = frame;
            return Ok(kept.group.clone());
        }
        let unknown = |(name, _): &&Binding| layout.known_names.binary_search_by(|n| n.as_str().cmp(name)).is_err();
        if let Some((name, _)) = sets.iter().flat_map(|set| set.iter()).find(unknown) {
            return Err(Error::UnknownBinding { shader: layout.shader, name });
        }
        let found =
            layout.slots.iter().map(|slot| Ok((slot.binding, find(slot)?))).collect::<Result<Vec<_>, Error>>()?;
        let entries: Vec<_> = found
            .iter()
            .map(|&(binding, resource)| wgpu::BindGroupEntry { binding, resource: resource.clone() })
            .collect();
        let label = Some(layout.shader);
        let group =
            device.create_bind_group(&wgpu::BindGroupDescriptor { label, layout: &layout.group, entries: &entries });
        let resources = found.iter().map(|(_, resource)| Bound::of(resource)).collect();
        bucket.push(Kept { layout: layout.group.clone(), resources, group: group.clone(), used: frame });
        self.made += 1;
        Ok(group)
    }

    /// Drops those that were last used before a frame.
    pub fn retain_since(&mut self, frame: u64) {
        self.kept.retain(|_, bucket| {
            bucket.retain(|kept| kept.used >= frame);
            !bucket.is_empty()
        });
    }
}
