//! Extensions that are read, that make no difference to a shadow, and that are neither.

use super::File;
use crate::import::text::shortened;
use crate::{Place, SceneError};
use gltf_json::{Root, Value};
use std::collections::BTreeMap;

/// The extensions that a file may require.
const SUPPORTED: &[&str] = &[
    "EXT_mesh_gpu_instancing",
    "KHR_lights_punctual",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_unlit",
    "KHR_mesh_quantization",
    "KHR_node_visibility",
    "KHR_texture_transform",
];

/// Extensions with these beginnings do not decide what casts: they shade, describe or animate, name other levels of
/// detail and other images, or compress what the file holds uncompressed as well.
const HARMLESS: &[&str] = &[
    "AGI_stk_metadata",
    "CESIUM_primitive_outline",
    "CESIUM_RTC",
    "EXT_feature_metadata",
    "EXT_instance_features",
    "EXT_lights_",
    "EXT_mesh_features",
    "EXT_meshopt_compression",
    "EXT_structural_metadata",
    "EXT_texture_",
    "KHR_animation_pointer",
    "KHR_audio",
    "KHR_materials_",
    "KHR_meshopt_compression",
    "KHR_physics",
    "KHR_techniques_webgl",
    "KHR_texture_",
    "KHR_xmp",
    "MSFT_lod",
    "MSFT_packing_",
    "MSFT_texture_dds",
    "OMI_",
    "VRM",
];

/// Surfaces that let light through: exceptions of [`HARMLESS`].
const TRANSPARENT: &[&str] = &["KHR_materials_diffuse_transmission", "KHR_materials_transmission"];

/// Refuses a file that requires what is not read.
pub(super) fn check(root: &Root, name: &str) -> Result<(), SceneError> {
    match root.extensions_required.iter().find(|e| !SUPPORTED.contains(&e.as_str())) {
        None => Ok(()),
        Some(extension) => Err(SceneError::Unsupported {
            file: name.to_string(),
            place: Place::Part("extensionsRequired".to_string()),
            feature: shortened(extension).into_owned(),
            advice: advice(extension).to_string(),
        }),
    }
}

fn advice(extension: &str) -> &'static str {
    match extension {
        "KHR_draco_mesh_compression" | "EXT_meshopt_compression" | "KHR_meshopt_compression" => {
            "export the model without mesh compression, or undo it with `gltf-transform copy`"
        }
        "KHR_texture_basisu" | "EXT_texture_webp" | "EXT_texture_avif" => "export the model with PNG or JPEG textures",
        _ => "export the model without this extension",
    }
}

/// Names the optional extensions that are not read and may decide what casts.
pub(super) fn warn(file: &File) {
    let listed = || (0, "extensionsUsed".to_string());
    let mut uses: Uses = file.root.extensions_used.iter().map(|e| (e.as_str(), listed())).collect();
    const KEY: &[u8] = b"\"extensions\"";
    if file.json.windows(KEY.len()).any(|w| w == KEY) {
        for (list, items) in file.values().as_object().into_iter().flatten() {
            for (i, item) in items.as_array().into_iter().flatten().enumerate() {
                count(item, &|| format!("{list}[{i}]"), &mut uses);
            }
        }
    }
    let is_harmless = |e: &str| HARMLESS.iter().any(|h| e.starts_with(h)) && !TRANSPARENT.contains(&e);
    for (extension, (count, first)) in uses.into_iter().filter(|(e, _)| !SUPPORTED.contains(e) && !is_harmless(e)) {
        let effect = if TRANSPARENT.contains(&extension) {
            "these surfaces cast shadows like any other"
        } else {
            "if it decides what is shown, shadows differ"
        };
        let message = format!("the extension {} is not read; {effect}", shortened(extension));
        file.warnings.add_many(count.max(1), first, message);
    }
}

/// How many objects have each extension, and the first of them.
type Uses<'v> = BTreeMap<&'v str, (usize, String)>;

fn count<'v>(value: &'v Value, place: &dyn Fn() -> String, uses: &mut Uses<'v>) {
    match value {
        Value::Array(items) => items.iter().for_each(|item| count(item, place, uses)),
        Value::Object(items) => {
            for (key, item) in items.iter().filter(|(key, _)| *key != "extras") {
                let extensions = item.as_object().filter(|_| key == "extensions");
                for extension in extensions.into_iter().flat_map(|e| e.keys()) {
                    let (times, first) = uses.entry(extension).or_default();
                    if *times == 0 {
                        *first = place();
                    }
                    *times += 1;
                }
                count(item, place, uses);
            }
        }
        _ => {}
    }
}
