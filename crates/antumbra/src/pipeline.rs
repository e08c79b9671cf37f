//! Pipelines that are compiled once a device, and bind groups made by the names in the shader.

use crate::shader::{Bindings, Needs, Program, ShaderKey};
use crate::{Error, Gpu};
use std::collections::HashMap;
use std::sync::{Arc, Mutex};

/// A name in the shader and what stands behind it.
pub type Binding<'a> = (&'static str, wgpu::BindingResource<'a>);

/// What can stand behind a name in a shader.
pub trait Bindable {
    /// As `wgpu` wants it.
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
impl Bindable for crate::resource::Texture {
    fn resource(&self) -> wgpu::BindingResource<'_> {
        self.view.resource()
    }
}

/// `bindings! { depth_map: &map, frame: &uniform }`: resources under their names in the shader.
#[macro_export]
macro_rules! bindings {
    ($($name:ident : $value:expr),* $(,)?) => {
        &[$((stringify!($name), $crate::pipeline::Bindable::resource($value))),*]
    };
}

/// A compute shader, ready to be dispatched.
pub struct ComputePipeline {
    /// The pipeline.
    pub pipeline: wgpu::ComputePipeline,
    /// Threads a workgroup.
    pub workgroup: [u32; 3],
    slots: Bindings,
    name: &'static str,
}

/// A vertex shader with or without a fragment shader.
pub struct RenderPipeline {
    /// The pipeline.
    pub pipeline: wgpu::RenderPipeline,
    slots: Bindings,
    name: &'static str,
}

/// What a render pipeline writes.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct RenderTarget {
    /// Formats of the colour targets.
    pub colors: Vec<wgpu::TextureFormat>,
    /// A `Depth32Float` target with this comparison, if any.
    pub depth: Option<wgpu::CompareFunction>,
    /// Layers that are drawn at once; 1 is an ordinary pass.
    pub layers: u32,
    /// Whether colours are added to what is there.
    pub adds: bool,
    /// Depths a texel: 1, or 4 by multisampling.
    pub samples: u32,
    /// Whether every pixel that a triangle touches is drawn; needs the capability `conservative_rasterization`.
    pub conservative: bool,
}

impl Default for RenderTarget {
    fn default() -> Self {
        RenderTarget { colors: Vec::new(), depth: None, layers: 1, adds: false, samples: 1, conservative: false }
    }
}

impl RenderTarget {
    /// The layers as a mask, as `wgpu` wants it; none for an ordinary pass.
    pub fn layer_mask(layers: u32) -> Option<std::num::NonZeroU32> {
        std::num::NonZeroU32::new(if layers > 1 { u32::MAX >> (32 - layers) } else { 0 })
    }
}

impl ComputePipeline {
    /// The resources of one group. Names that this variant does not use are passed over, missing ones are a bug.
    pub fn bind_group(&self, gpu: &Gpu, group: u32, bindings: &[Binding]) -> wgpu::BindGroup {
        bind_group(gpu, self.name, &self.pipeline.get_bind_group_layout(group), &self.slots, group, bindings)
    }
}

impl RenderPipeline {
    /// The resources of one group. Names that this variant does not use are passed over, missing ones are a bug.
    pub fn bind_group(&self, gpu: &Gpu, group: u32, bindings: &[Binding]) -> wgpu::BindGroup {
        bind_group(gpu, self.name, &self.pipeline.get_bind_group_layout(group), &self.slots, group, bindings)
    }
}

fn bind_group(
    gpu: &Gpu,
    name: &'static str,
    layout: &wgpu::BindGroupLayout,
    slots: &Bindings,
    group: u32,
    bindings: &[Binding],
) -> wgpu::BindGroup {
    let entries: Vec<_> = slots
        .iter()
        .filter(|(_, slot)| slot.0 == group)
        .map(|(variable, &(_, binding))| {
            let found = bindings.iter().find(|(name, _)| name == variable);
            let (_, resource) = found.unwrap_or_else(|| panic!("{name}: nothing is bound to `{variable}`"));
            wgpu::BindGroupEntry { binding, resource: resource.clone() }
        })
        .collect();
    gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some(name), layout, entries: &entries })
}

type ComputeKey = (ShaderKey, &'static str);
type RenderKey = (ShaderKey, RenderTarget);

/// All pipelines of a device. They are compiled outside of the locks, so that a thread that compiles does not hold up one
/// that draws; of two threads that compile the same, the first one's pipeline stays.
#[derive(Default)]
pub(crate) struct PipelineCache {
    compute: Mutex<HashMap<ComputeKey, Arc<ComputePipeline>>>,
    render: Mutex<HashMap<RenderKey, Arc<RenderPipeline>>>,
    most: Mutex<Needs>,
}

impl PipelineCache {
    /// The most that any shader has asked for.
    pub(crate) fn needs(&self) -> Needs {
        *self.most.lock().expect("only numbers are moved under the lock")
    }

    /// Refuses a shader that needs more than the device gives, by name: what the driver says is for us, not for users.
    fn check(&self, device: &wgpu::Device, key: &ShaderKey, program: &Program, entry: &str) -> Result<(), Error> {
        let needs = program.needs(entry);
        let mut most = self.most.lock().expect("only numbers are moved under the lock");
        *most = most.max(needs);
        needs.check(key.module, &device.limits())
    }

    pub(crate) fn compute(
        &self,
        device: &wgpu::Device,
        key: &ShaderKey,
        entry: &'static str,
    ) -> Result<Arc<ComputePipeline>, Error> {
        let known = (key.clone(), entry);
        if let Some(found) = self.compute.lock().expect("only maps are touched under the lock").get(&known) {
            return Ok(found.clone());
        }
        let program = Program::compose(key)?;
        self.check(device, key, &program, entry)?;
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(key.module),
            layout: None,
            module: &shader_module(device, key, &program),
            entry_point: Some(entry),
            compilation_options: Default::default(),
            cache: None,
        });
        let made = Arc::new(ComputePipeline {
            pipeline,
            workgroup: program.workgroup_size(entry),
            slots: program.bindings(&[entry]),
            name: key.module,
        });
        let mut cache = self.compute.lock().expect("only maps are touched under the lock");
        Ok(cache.entry(known).or_insert(made).clone())
    }

    pub(crate) fn render(
        &self,
        device: &wgpu::Device,
        key: &ShaderKey,
        target: &RenderTarget,
    ) -> Result<Arc<RenderPipeline>, Error> {
        let known = (key.clone(), target.clone());
        if let Some(found) = self.render.lock().expect("only maps are touched under the lock").get(&known) {
            return Ok(found.clone());
        }
        let program = Program::compose(key)?;
        let has_fragment = program.entry_points().any(|e| e == "fragment");
        for entry in ["vertex", "fragment"] {
            self.check(device, key, &program, entry)?;
        }
        let module = shader_module(device, key, &program);
        let one = wgpu::BlendFactor::One;
        let sum = wgpu::BlendComponent { src_factor: one, dst_factor: one, operation: wgpu::BlendOperation::Add };
        let blend = target.adds.then_some(wgpu::BlendState { color: sum, alpha: sum });
        let color = |&format| Some(wgpu::ColorTargetState { format, blend, write_mask: wgpu::ColorWrites::ALL });
        let colors: Vec<_> = target.colors.iter().map(color).collect();
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(key.module),
            layout: None,
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("vertex"),
                compilation_options: Default::default(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState { conservative: target.conservative, ..Default::default() },
            depth_stencil: target.depth.map(|compare| wgpu::DepthStencilState {
                format: wgpu::TextureFormat::Depth32Float,
                depth_write_enabled: Some(true),
                depth_compare: Some(compare),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: wgpu::MultisampleState { count: target.samples, ..Default::default() },
            fragment: has_fragment.then_some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("fragment"),
                compilation_options: Default::default(),
                targets: &colors,
            }),
            multiview_mask: RenderTarget::layer_mask(target.layers),
            cache: None,
        });
        let entries: &[&str] = if has_fragment { &["vertex", "fragment"] } else { &["vertex"] };
        let made = Arc::new(RenderPipeline { pipeline, slots: program.bindings(entries), name: key.module });
        let mut cache = self.render.lock().expect("only maps are touched under the lock");
        Ok(cache.entry(known).or_insert(made).clone())
    }
}

fn shader_module(device: &wgpu::Device, key: &ShaderKey, program: &Program) -> wgpu::ShaderModule {
    device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(key.module),
        source: wgpu::ShaderSource::Wgsl(program.wgsl.as_str().into()),
    })
}
