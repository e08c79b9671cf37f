//! Pipelines, recording, timing and limits: what their documentation promises.

mod common;

use antumbra::gpu::readback::read_buffer;
use antumbra::gpu::recorder::{Recorder, Work};
use antumbra::gpu::resources::{Resources, storage_buffer};
use antumbra::gpu::shader::ShaderKey;
use antumbra::{AdapterChoice, Error, Gpu, Spec, Timer, bindings};
use common::{builtin, drawn, gpu, quick, technique};
use pollster::block_on;

/// A kernel that adds one to each number.
fn add_one() -> ShaderKey {
    let text = "
        var<storage, read_write> numbers: array<u32>;
        @compute @workgroup_size(64) fn add_one(@builtin(global_invocation_id) id: vec3<u32>) {
            if id.x < arrayLength(&numbers) { numbers[id.x] += 1u; }
        }";
    ShaderKey::of_source(text)
}

#[test]
fn missing_and_unknown_bindings_are_errors_that_name_shader_and_resource() {
    let gpu = gpu();
    let pipeline = gpu.compute_pipeline(&add_one(), "add_one").expect("composes");
    let buffer = storage_buffer(gpu, "numbers", 400);
    let bound = |set: &[antumbra::gpu::bindings::Binding]| {
        gpu.submit(|recorder| recorder.compute("bound", &pipeline, &[set], Work::Groups([1, 1, 1])))
    };
    let missing = bound(bindings! {}).expect_err("nothing is bound").to_string();
    assert!(missing.contains("kernel") && missing.contains("nothing is bound to `numbers`"), "{missing}");
    let unknown = bound(bindings! { numbers: &buffer, other: &buffer }).expect_err("one too many").to_string();
    assert!(unknown.contains("kernel") && unknown.contains("`other`"), "{unknown}");
    assert!(bound(bindings! { numbers: &buffer }).is_ok());
}

#[test]
fn resources_are_kept_from_frame_to_frame_counted_and_shown() {
    use antumbra::gpu::resources::BufferDescription;
    use antumbra::gpu::texture::TextureDescription;
    let (gpu, mut resources) = (gpu(), Resources::default());
    let pipeline = gpu.compute_pipeline(&add_one(), "add_one").expect("composes");
    let frame = |size: u32, resources: &mut Resources| {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let mut recorder = Recorder::new(gpu, &mut encoder, resources);
        let texel = TextureDescription::new([size; 2], wgpu::TextureFormat::R32Float, "made up");
        let textures = [recorder.texture("map", texel), recorder.texture("map", texel)];
        let numbers = recorder.buffer("numbers", BufferDescription::new(400).cleared());
        recorder
            .compute("add", &pipeline, &[bindings! { numbers: &numbers }], Work::Groups([1, 1, 1]))
            .expect("records");
        drop(recorder);
        gpu.queue.submit([encoder.finish()]);
        let words: Vec<u32> = bytemuck::pod_collect_to_vec(&block_on(read_buffer(gpu, &numbers)).expect("reads"));
        (textures, words[0])
    };
    let ([first, second], one) = frame(8, &mut resources);
    assert!(first != second, "each request of a label has a resource of its own");
    let made = resources.made();
    let (again, cleared) = frame(8, &mut resources);
    assert!(again == [first, second] && resources.made() == made, "what fits is kept, in the order of requests");
    assert_eq!([one, cleared], [1, 1], "a cleared buffer is zero at the start of every frame");
    assert_eq!(resources.memory().iter().map(|m| (m.pass, m.bytes)).collect::<Vec<_>>(), [("add", 2 * 256 + 400)]);
    let names: Vec<_> = resources.debug_views().iter().map(|view| (view.name, view.help)).collect();
    assert_eq!(names, [("map", "made up"); 2]);
    let (larger, _) = frame(16, &mut resources);
    assert_eq!((larger[0].size(), resources.made()), ([16, 16], made + 2), "what does not fit is made anew");
}

#[test]
fn threads_are_rounded_up_to_workgroups() {
    let gpu = gpu();
    let pipeline = gpu.compute_pipeline(&add_one(), "add_one").expect("composes");
    assert_eq!(pipeline.workgroup, [64, 1, 1]);
    let buffer = storage_buffer(gpu, "numbers", 400);
    let set = [&bindings! { numbers: &buffer }[..]];
    let recorded = gpu.submit(|recorder| {
        recorder.compute("threads", &pipeline, &set, Work::Threads([100, 1, 1]))?;
        recorder.compute("groups", &pipeline, &set, Work::Groups([1, 1, 1]))
    });
    recorded.expect("records");
    let bytes = block_on(read_buffer(gpu, &buffer)).expect("reads");
    let numbers: Vec<u32> = bytemuck::pod_collect_to_vec(&bytes);
    let expected: Vec<u32> = (0..100).map(|i| if i < 64 { 2 } else { 1 }).collect();
    assert_eq!(numbers, expected, "100 threads are two workgroups, one workgroup is 64 threads");
}

#[test]
fn a_pipeline_is_compiled_once_for_all_clones() {
    let one = gpu().compute_pipeline(&add_one(), "add_one").expect("composes");
    let other = gpu().clone().compute_pipeline(&add_one(), "add_one").expect("composes");
    assert!(std::sync::Arc::ptr_eq(&one, &other));
}

#[test]
fn passes_of_one_name_are_timed_together_in_the_order_of_recording() {
    let gpu = gpu();
    let pipeline = gpu.compute_pipeline(&add_one(), "add_one").expect("composes");
    let buffer = storage_buffer(gpu, "numbers", 4 << 20);
    let mut timer = Timer::new(gpu).expect("makes a timer");
    for _frame in 0..2 {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let mut resources = Resources::default();
        let mut recorder = Recorder::new(gpu, &mut encoder, &mut resources).timed(Some(&timer));
        for label in ["one", "two", "one", "three", "one"] {
            let set = bindings! { numbers: &buffer };
            recorder.compute(label, &pipeline, &[set], Work::Groups([1 << 14, 1, 1])).expect("records");
        }
        drop(recorder);
        let times = timer.finish(gpu, encoder).expect("finishes");
        if !gpu.capabilities.timestamps {
            assert!(times.iter().all(|(_, ms)| ms.is_none()), "{times:?}");
            continue;
        }
        let names: Vec<&str> = times.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["one", "two", "three"]);
        let [one, two, three] = [0, 1, 2].map(|i| times[i].1.expect("timed"));
        // Three equal passes against one: a margin of a half for a machine that is busy with other things.
        assert!(two > 0.0 && three > 0.0 && one > 1.5 * two.min(three), "{times:?}");
    }
}

#[test]
fn every_pass_of_a_technique_is_timed_under_the_label_that_its_memory_bears() {
    let renderer = drawn(&builtin("square"), [64, 64]);
    for info in antumbra::techniques::TECHNIQUES {
        let mut made = technique(&quick(info));
        let mut timer = Timer::new(gpu()).expect("makes a timer");
        let mut encoder = gpu().device.create_command_encoder(&Default::default());
        made.record_timed(gpu(), &mut encoder, &renderer.frame, Some(&timer)).expect("records");
        let times = timer.finish(gpu(), encoder).expect("finishes");
        assert!(!gpu().capabilities.timestamps || !times.is_empty(), "{}", info.name);
        for memory in made.memory().iter().filter(|_| gpu().capabilities.timestamps) {
            let known = times.iter().any(|(label, _)| label == memory.pass);
            assert!(known, "{}: no pass is called `{}`: {times:?}", info.name, memory.pass);
        }
    }
}

#[test]
fn sizes_that_the_device_cannot_hold_are_refused() {
    let max = gpu().capabilities.max_texture_size;
    for (width, height) in [(0, 4), (4, 0), (max + 1, 4), (4, u32::MAX)] {
        let error = gpu().check_size("image", width, height).expect_err("must be refused").to_string();
        for part in ["image", &width.to_string(), &height.to_string(), &max.to_string()] {
            assert!(error.contains(part), "{error} lacks {part}");
        }
    }
    assert!(gpu().check_size("image", 1, max).is_ok());
    let scene = builtin("square");
    assert!(antumbra::scene::SceneRenderer::new(gpu(), &scene, [0, 5]).is_err());
    assert!(antumbra::scene::SceneRenderer::new(gpu(), &scene, [max + 1, 5]).is_err());
}

#[test]
fn a_validation_error_is_returned_and_the_device_lives_on() {
    let gpu = gpu();
    let broken = block_on(gpu.checked(|| {
        let wrong = wgpu::BufferDescriptor {
            label: Some("mapped for reading and for storage"),
            size: 16,
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::STORAGE,
            mapped_at_creation: false,
        };
        let _broken = gpu.device.create_buffer(&wrong);
        Ok(())
    }));
    assert!(matches!(broken, Err(Error::Validation(_))), "{broken:?}");
    assert!(block_on(gpu.checked(|| Ok(()))).is_ok());
}

#[test]
fn an_adapter_that_is_not_there_is_named_with_those_that_are() {
    for asked in ["no such adapter", "99"] {
        let choice: AdapterChoice = asked.parse().expect("any text is a choice");
        let error = block_on(Gpu::new(&choice)).err().expect("must be refused").to_string();
        assert!(error.contains(asked) && error.contains(&gpu().info.name), "{error}");
    }
    assert_eq!("0".parse(), Ok(AdapterChoice::Index(0)));
    let name = gpu().info.name.to_uppercase();
    let found = block_on(Gpu::new(&AdapterChoice::Name(name.clone()))).unwrap_or_else(|e| panic!("{name}: {e}"));
    assert_eq!(found.info.name, gpu().info.name);
}

/// The message of a SPEC that is refused.
fn refusal(spec: &str) -> String {
    spec.parse::<Spec>().err().unwrap_or_else(|| panic!("{spec} was taken")).to_string()
}

#[test]
fn a_spec_that_cannot_be_read_is_refused_with_the_way_out() {
    for (spec, words) in [
        ("pcff", "did you mean `pcf`?"),
        ("", "unknown technique ``"),
        ("zzzzzz", "`antumbra techniques` lists them"),
        ("pcf:mpa=3", "did you mean `map`?"),
        ("pcf:qqq=3", "its settings are: map, pcf, lookup"),
        ("hard:map=1,map=2", "expected a whole number from 16 to 16384"),
        ("hard:map=16,map=32", "`map` is set twice"),
        ("hard:map", "`map` is not of the form key=value"),
        ("pcf:lookup=cubic", "expected one of nearest, hardware, bilinear"),
        ("pcf:pcf=2.5", "expected a whole number from 1 to 33"),
        ("pcf:map=99999999999", "expected a whole number"),
    ] {
        assert!(refusal(spec).contains(words), "{spec}: {}", refusal(spec));
    }
}

#[test]
fn a_spec_keeps_its_text_and_fills_in_the_defaults() {
    let spec: Spec = "pcf: map = 512 , pcf=3".parse().expect("blanks do not count");
    assert_eq!(spec.text, "pcf: map = 512 , pcf=3");
    assert_eq!(spec.settings, serde_json::json!({"map": 512, "pcf": 3, "lookup": "bilinear"}));
    assert_eq!("pcss".parse::<Spec>().expect("known").settings["map"], 2048);
}

#[test]
fn settings_that_are_no_settings_are_refused_by_the_constructor() {
    for info in antumbra::techniques::TECHNIQUES {
        for wrong in [serde_json::json!({"map": "wide"}), serde_json::json!({"no such key": 1}), serde_json::json!(3)] {
            let made = (info.make)(gpu(), wrong.clone());
            assert!(matches!(made, Err(Error::Spec(_))), "{} from {wrong}", info.name);
        }
    }
}
