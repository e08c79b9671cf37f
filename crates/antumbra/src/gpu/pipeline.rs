//! Pipelines, compiled once per device.

use super::bindings::Layout;
use super::limits::Needs;
use super::shader::{Program, ShaderKey};
use crate::error::{Error, ShaderError};
use std::collections::HashMap;
use std::sync::{Arc, Mutex};

/// A compute shader, ready to be dispatched.
pub struct ComputePipeline {
    /// The pipeline.
    pub pipeline: wgpu::ComputePipeline,
    /// Threads per workgroup.
    pub workgroup: [u32; 3],
    pub(crate) layout: Layout,
}

/// A vertex shader with or without a fragment shader.
pub struct RenderPipeline {
    /// The pipeline.
    pub pipeline: wgpu::RenderPipeline,
    pub(crate) layout: Layout,
}

/// Targets of a render pipeline.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct RenderTarget {
    /// Formats of the colour targets.
    pub colors: Vec<wgpu::TextureFormat>,
    /// A `Depth32Float` target with this comparison, if any.
    pub depth: Option<wgpu::CompareFunction>,
    /// Layers that are drawn at once; 1 is an ordinary pass.
    pub layers: u32,
    /// Whether colours are added to the target's.
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

type ComputeKey = (ShaderKey, &'static str);
type RenderKey = (ShaderKey, RenderTarget);

/// All pipelines of a device. They are compiled outside of the locks, so that a thread that compiles does not hold up
/// one that draws; of two threads that compile the same, the first one's pipeline stays.
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

    /// Refuses an entry point that the shader does not have, and a shader that needs more than the device gives, by
    /// name: the driver's messages are for developers, not for users.
    fn check(&self, device: &wgpu::Device, key: &ShaderKey, program: &Program, entry: &str) -> Result<(), Error> {
        if !program.entry_points().any(|known| known == entry) {
            let known = program.entry_points().map(|known| format!("`{known}`")).collect::<Vec<_>>().join(", ");
            let message = format!("no entry point `{entry}`; there are {known}");
            return Err(ShaderError { module: key.module.to_owned(), message }.into());
        }
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
        let workgroup = program.workgroup_size(entry);
        let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(key.module),
            layout: None,
            module: &shader_module(device, key, &program),
            entry_point: Some(entry),
            compilation_options: Default::default(),
            cache: None,
        });
        let layout = layout(key, program, pipeline.get_bind_group_layout(0), &[entry]);
        let made = Arc::new(ComputePipeline { pipeline, workgroup, layout });
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
        let entries: &[&str] = if has_fragment { &["vertex", "fragment"] } else { &["vertex"] };
        for entry in entries {
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
        let layout = layout(key, program, pipeline.get_bind_group_layout(0), entries);
        let made = Arc::new(RenderPipeline { pipeline, layout });
        let mut cache = self.render.lock().expect("only maps are touched under the lock");
        Ok(cache.entry(known).or_insert(made).clone())
    }
}

fn layout(key: &ShaderKey, program: Program, group: wgpu::BindGroupLayout, entries: &[&str]) -> Layout {
    Layout { shader: key.module, group, slots: program.slots(entries), known_names: program.known_names }
}

fn shader_module(device: &wgpu::Device, key: &ShaderKey, program: &Program) -> wgpu::ShaderModule {
    device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(key.module),
        source: wgpu::ShaderSource::Wgsl(program.wgsl.as_str().into()),
    })
}
