//! Every technique recorded on a device that does nothing: bindings, sizes and formats are checked without a GPU, and a
//! frame like the last one makes nothing new.

mod common;

use antumbra::passes::pixels::geometry_buffer::GeometryBuffer;
use antumbra::scene::{upload, visibility};
use antumbra::technique::settings::{Kind, Setting};
use antumbra::techniques::TECHNIQUES;
use antumbra::{Error, Frame, FrameDescriptor, Gpu, ShadowFrustum, Shadows, Spec, View};
use pollster::block_on;
use std::sync::{Arc, LazyLock};

const SIZE: [u32; 2] = [64, 48];

/// A device that does nothing, with the limits that any technique needs.
static GPU: LazyLock<Gpu> = LazyLock::new(|| {
    let limits = wgpu::Limits {
        max_compute_workgroup_storage_size: 32768,
        max_storage_buffers_per_shader_stage: 16,
        ..wgpu::Limits::default()
    };
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends: wgpu::Backends::NOOP,
        // Checks of indirect arguments by wgpu's own shaders need alignments that this adapter does not have.
        flags: wgpu::InstanceFlags::empty(),
        backend_options: wgpu::BackendOptions { noop: wgpu::NoopBackendOptions::enabled(), ..Default::default() },
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    });
    let adapter = block_on(instance.request_adapter(&Default::default())).expect("always there");
    let description = wgpu::DeviceDescriptor { required_limits: limits, ..Default::default() };
    let (device, queue) = block_on(adapter.request_device(&description)).expect("within its limits");
    Gpu::from_host(device, queue)
});

/// A scene with masked and plain casters and a ground that only receives.
fn frame() -> Frame {
    let scene = common::builtin("plant");
    let geometry = GeometryBuffer::new(&GPU, SIZE).expect("small");
    let visibility = visibility(&GPU, SIZE);
    let view = View::of_camera(&scene.camera, SIZE);
    let descriptor = FrameDescriptor {
        view,
        light: scene.light,
        casters: &Arc::new(upload(&GPU, &scene).expect("uploads")),
        depth: &geometry.depth.view,
        normals: &geometry.normal.view,
        visibility: &visibility.view,
    };
    let mut frame = Frame::new(&GPU, &descriptor).expect("textures go together");
    frame.update(view, scene.light, ShadowFrustum::fit(&scene, &view));
    frame
}

/// The SPECs of a technique: its defaults, and each choice and toggle in turn, with small maps.
fn variants(name: &str, settings: &[Setting]) -> Vec<String> {
    let has = |key: &str| settings.iter().any(|s| s.key == key);
    let small: Vec<&str> = [("map", "map=64"), ("maps", "maps=9"), ("samples", "samples=4"), ("tile", "tile=128")]
        .into_iter()
        .filter_map(|(key, value)| has(key).then_some(value))
        .collect();
    let mut list = vec![format!("{name}:{}", small.join(","))];
    for setting in settings {
        let values: Vec<&str> = match setting.kind {
            Kind::Toggle => vec!["true", "false"],
            Kind::Choice { options } => options.to_vec(),
            _ => continue,
        };
        list.extend(values.iter().map(|v| format!("{name}:{},{}={v}", small.join(","), setting.key)));
    }
    list
}

fn record(shadows: &mut Shadows, frame: &Frame, spec: &str) {
    let result = block_on(GPU.checked(|| {
        let mut encoder = GPU.device.create_command_encoder(&Default::default());
        shadows.record(&GPU, &mut encoder, frame)?;
        GPU.queue.submit([encoder.finish()]);
        GPU.wait()
    }));
    result.unwrap_or_else(|e| panic!("{spec}: {e}"));
}

#[test]
fn every_variant_of_every_technique_binds_what_its_shaders_ask_for() {
    let frame = frame();
    let mut count = 0;
    for info in TECHNIQUES {
        for text in variants(info.name, info.settings) {
            let spec: Spec = text.parse().unwrap_or_else(|e| panic!("{text}: {e}"));
            // Settings that exclude each other or that this device lacks say so when the technique is made; a shader
            // that does not compose is a bug.
            let mut shadows = match Shadows::from_spec(&GPU, &spec) {
                Ok(shadows) => shadows,
                Err(Error::Shader(e)) => panic!("{text}: {e}"),
                Err(_) => continue,
            };
            shadows.set_debug_capture(true);
            record(&mut shadows, &frame, &text);
            count += 1;
        }
    }
    assert!(count > 2 * TECHNIQUES.len(), "only {count} variants were recorded");
}

#[test]
fn a_frame_like_the_last_one_makes_no_resource_and_no_bind_group() {
    let frame = frame();
    for info in TECHNIQUES {
        let text = &variants(info.name, info.settings)[0];
        let mut shadows =
            Shadows::from_spec(&GPU, &text.parse().expect("a variant")).unwrap_or_else(|e| panic!("{text}: {e}"));
        // Counts come back after a frame or two, and lists grow by them.
        (0..4).for_each(|_| record(&mut shadows, &frame, text));
        let made = shadows.resources_made();
        assert!(made > 3, "{text} asks for {made} resources: are they counted?");
        (0..12).for_each(|_| record(&mut shadows, &frame, text));
        assert_eq!(shadows.resources_made(), made, "{text} makes resources in frames that are all alike");
    }
}
