//! Every technique on every built-in scene: finite, within [0, 1], the same on a second run, no validation error. A
//! technique or a scene that is added to its list is covered here without an edit.

mod common;

use antumbra::Shadows;
use antumbra::gpu::limits::Needs;
use antumbra::scene::SceneRenderer;
use antumbra::techniques::TECHNIQUES;
use antumbra_scene::builtin::{self, BuiltinInfo};
use common::{drawn, quick, shadowed, technique};
use serde_json::Value;

const SIZE: [u32; 2] = [97, 64];

/// The SPEC of a scene whose counts are a sixteenth of their defaults where those take long.
fn small(info: &BuiltinInfo) -> String {
    let counts = ["triangles", "trees", "segments", "side", "bays"];
    let few = info.parameters.iter().filter(|p| counts.contains(&p.name));
    let list: Vec<String> = few.map(|p| format!("{}={}", p.name, p.min.max((p.default / 16.0).round()))).collect();
    format!("{}:{}", info.name, list.join(","))
}

/// What is wrong with a technique on a scene.
fn fault(renderer: &SceneRenderer, spec: &str) -> Option<String> {
    let mut one = technique(spec);
    let mut pictures = Vec::new();
    // The same instance twice, then another.
    for run in ["first", "second"] {
        match shadowed(renderer, &mut one) {
            Ok(picture) => pictures.push(picture),
            Err(e) => return Some(format!("{run} record: {e}")),
        }
    }
    match shadowed(renderer, &mut technique(spec)) {
        Ok(picture) => pictures.push(picture),
        Err(e) => return Some(format!("another instance: {e}")),
    }
    let place = |i: usize| format!("pixel ({}, {})", i as u32 % SIZE[0], i as u32 / SIZE[0]);
    if let Some(i) = pictures[0].iter().position(|v| !(0.0..=1.0).contains(v)) {
        return Some(format!("{} is {}", place(i), pictures[0][i]));
    }
    for (run, other) in ["a second record", "another instance"].iter().zip(&pictures[1..]) {
        let mut differs = (0..other.len()).filter(|&i| other[i].to_bits() != pictures[0][i].to_bits());
        if let Some(i) = differs.next() {
            return Some(format!("{run} gives {} where the first gave {} at {}", other[i], pictures[0][i], place(i)));
        }
    }
    None
}

#[test]
fn every_technique_on_every_scene_is_in_range_and_repeatable() {
    let mut faults = Vec::new();
    for info in builtin::list() {
        let scene = common::builtin(&small(info));
        let renderer = drawn(&scene, SIZE);
        let started = std::time::Instant::now();
        for technique in TECHNIQUES {
            let spec = quick(technique);
            let begun = std::time::Instant::now();
            faults.extend(fault(&renderer, &spec).map(|f| format!("{spec} on {}: {f}", scene.name)));
            if begun.elapsed().as_secs_f32() > 2.0 {
                println!("{}: {spec} took {:.1?}", scene.name, begun.elapsed());
            }
        }
        println!("{}: {} triangles, {:.1?}", scene.name, scene.triangle_count(), started.elapsed());
    }
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults.join("\n"));
}

#[test]
fn a_technique_follows_a_change_of_picture_size_and_casters() {
    let [first, second] =
        [("fence:slats=9", [64, 48]), ("square:", [40, 56])].map(|(s, size)| drawn(&common::builtin(s), size));
    for info in TECHNIQUES {
        let spec = quick(info);
        let mut kept = technique(&spec);
        for (renderer, name) in [(&first, "first"), (&second, "second"), (&first, "first again")] {
            let by_kept = shadowed(renderer, &mut kept).unwrap_or_else(|e| panic!("{spec}, {name}: {e}"));
            let by_new = shadowed(renderer, &mut technique(&spec)).unwrap_or_else(|e| panic!("{spec}, {name}: {e}"));
            assert!(by_kept == by_new, "{spec}: on the {name} scene a used instance differs from a new one");
        }
    }
}

/// Shadows of two lights that one instance records into one encoder, and those of the same frame before and after an
/// update.
#[test]
fn one_instance_serves_several_lights_in_one_encoder() {
    let scene = common::builtin("fence:slats=9");
    let mut other = scene.clone();
    other.light.center += glam::Vec3::new(-1.5, 0.5, 0.3);
    other.light.size *= 0.4;
    let size = [48, 40];
    let [mut first, second] = [&scene, &other].map(|scene| drawn(scene, size));
    let read = |renderer: &SceneRenderer| pollster::block_on(renderer.read_visibility(common::gpu())).expect("reads");
    for info in TECHNIQUES {
        let spec = quick(info);
        let expected = [&first, &second]
            .map(|renderer| shadowed(renderer, &mut technique(&spec)).unwrap_or_else(|e| panic!("{spec}: {e}")));
        let mut shared = technique(&spec);
        common::submit(|encoder| {
            shared.record(common::gpu(), encoder, &first.frame)?;
            shared.record(common::gpu(), encoder, &second.frame)
        })
        .unwrap_or_else(|e| panic!("{spec}: {e}"));
        for (name, renderer, expected) in [("first", &first, &expected[0]), ("second", &second, &expected[1])] {
            assert!(read(renderer) == *expected, "{spec}: the {name} light of an encoder has other shadows than alone");
        }
        // The first frame again, updated to the second light before the encoder is submitted.
        let before = first.frame.clone();
        common::submit(|encoder| {
            shared.record(common::gpu(), encoder, &first.frame)?;
            let [from, to] = [&first, &second].map(|r| r.visibility.texture.as_image_copy());
            encoder.copy_texture_to_texture(from, to, first.visibility.texture.size());
            first.frame.update(before.view, other.light, second.frame.frustum);
            shared.record(common::gpu(), encoder, &first.frame)
        })
        .unwrap_or_else(|e| panic!("{spec}: {e}"));
        let [after_update, before_update] = [&first, &second].map(read);
        first.frame.update(before.view, before.light, before.frustum);
        assert!(before_update == expected[0], "{spec}: an update changes what was recorded before");
        assert!(after_update == expected[1], "{spec}: an update before the submission does not count");
    }
}

#[test]
fn every_technique_says_what_it_is_and_what_memory_it_takes() {
    let renderer = drawn(&common::builtin("square"), [32, 32]);
    for info in TECHNIQUES {
        for text in [info.name, info.title, info.source, info.summary] {
            assert!(!text.is_empty(), "{}: an empty text", info.name);
        }
        let same = TECHNIQUES.iter().filter(|other| other.name == info.name).count();
        assert!(same == 1, "{same} techniques are named `{}`: a SPEC finds only the first", info.name);
        let mut made = technique(info.name);
        shadowed(&renderer, &mut made).unwrap_or_else(|e| panic!("{}: {e}", info.name));
        for memory in made.memory() {
            assert!(memory.bytes > 0 && !memory.pass.is_empty(), "{}: {memory:?}", info.name);
        }
        for setting in info.settings {
            assert!(!setting.help.is_empty(), "{}: `{}` has no help", info.name, setting.key);
            let default = &(info.defaults)(&Default::default())[setting.key];
            let word = match default {
                Value::String(word) => word.clone(),
                // Points; none by default.
                Value::Array(points) if points.is_empty() => String::new(),
                other => other.to_string(),
            };
            let spec = format!("{}:{}={word}", info.name, setting.key);
            assert!(spec.parse::<antumbra::Spec>().is_ok(), "the default itself must be a value: {spec}");
        }
    }
}

/// What a technique says beforehand of its shaders is what they take: the least device that it says it needs is enough,
/// and it asks for no more than that.
#[test]
fn every_technique_knows_what_its_shaders_take() {
    let all = common::gpu();
    // One surface has holes: its shaders look materials up.
    let scene = common::builtin("plant");
    let mut wrong = Vec::new();
    for info in TECHNIQUES {
        // With pipelines of its own.
        let gpu = antumbra::Gpu::from_host(all.device.clone(), all.queue.clone());
        let renderer = SceneRenderer::new(&gpu, &scene, [32, 32]).unwrap_or_else(|e| panic!("{}: {e}", scene.name));
        let spec: antumbra::Spec = quick(info).parse().unwrap_or_else(|e| panic!("{e}"));
        let mut shadows = Shadows::from_spec(&gpu, &spec).unwrap_or_else(|e| panic!("{}: {e}", info.name));
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let recorded = shadows.record(&gpu, &mut encoder, &renderer.frame);
        recorded.unwrap_or_else(|e| panic!("{}: {e}", info.name));
        let measured = gpu.needs().max(Needs::CORE);
        // Other adapters take other ways, which may need less.
        let is_known = if gpu.is_software() { measured == info.needs } else { measured.max(info.needs) == info.needs };
        if !is_known {
            wrong.push(format!("{} says {:?}, its shaders take {measured:?}", info.name, info.needs));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
