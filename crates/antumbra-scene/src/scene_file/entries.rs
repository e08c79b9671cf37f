//! The keys of a scene file. Places are in double precision, since a scene may lie far from the origin.

use serde::de::{Deserialize, Deserializer, Error, SeqAccess, Visitor};
use std::fmt;

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SceneEntry {
    pub width: Option<u32>,
    pub height: Option<u32>,
    pub meshes: Vec<MeshEntry>,
    pub camera: Option<CameraEntry>,
    pub light: Option<LightEntry>,
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MeshEntry {
    pub path: Option<String>,
    pub builtin: Option<String>,
    #[serde(default)]
    pub translate: [f64; 3],
    #[serde(default)]
    pub rotate_deg: [f64; 3],
    #[serde(default)]
    pub scale: Scale,
    #[serde(default)]
    pub receiver_only: bool,
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CameraEntry {
    pub eye: [f64; 3],
    pub target: [f64; 3],
    pub up: Option<[f32; 3]>,
    #[serde(default = "default_fov")]
    pub fov_y_deg: f32,
    pub near: Option<f32>,
    pub far: Option<f32>,
}

fn default_fov() -> f32 {
    45.0
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LightEntry {
    pub center: [f64; 3],
    pub target: [f64; 3],
    pub up: Option<[f32; 3]>,
    pub size: [f32; 2],
    pub shadow_fov_deg: Option<f32>,
}

/// One number, or one an axis.
#[derive(Clone, Copy)]
pub(super) enum Scale {
    Uniform(f64),
    Axes([f64; 3]),
}

impl Default for Scale {
    fn default() -> Scale {
        Scale::Uniform(1.0)
    }
}

/// By hand, because serde's untagged enums say no more than "did not match any variant".
impl<'de> Deserialize<'de> for Scale {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Scale, D::Error> {
        deserializer.deserialize_any(ScaleVisitor)
    }
}

struct ScaleVisitor;

impl<'de> Visitor<'de> for ScaleVisitor {
    type Value = Scale;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a number or three numbers")
    }

    fn visit_f64<E: Error>(self, x: f64) -> Result<Scale, E> {
        Ok(Scale::Uniform(x))
    }

    fn visit_i64<E: Error>(self, x: i64) -> Result<Scale, E> {
        Ok(Scale::Uniform(x as f64))
    }

    fn visit_u64<E: Error>(self, x: u64) -> Result<Scale, E> {
        Ok(Scale::Uniform(x as f64))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut numbers: A) -> Result<Scale, A::Error> {
        let mut axes = [0.0; 3];
        for (i, axis) in axes.iter_mut().enumerate() {
            *axis = numbers.next_element()?.ok_or_else(|| A::Error::invalid_length(i, &self))?;
        }
        match numbers.next_element::<f64>()? {
            None => Ok(Scale::Axes(axes)),
            Some(_) => Err(A::Error::invalid_length(4, &self)),
        }
    }
}
