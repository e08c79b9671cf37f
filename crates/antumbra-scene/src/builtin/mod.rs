//! The built-in scenes: made by formula, the same on every machine, each with its own camera and light.
//!
//! A scene is named by a SPEC: `fence`, or with parameters `forest:trees=200,seed=3`.

mod maths;
mod shapes;
mod spec;
mod stage;

mod atrium;
mod basic;
mod cage;
mod fence;
mod forest;
mod layers;
mod pipes;
mod piping;
mod plant;
mod terrain;
#[cfg(test)]
mod tests;
mod tree;
mod windmill;

use crate::{Scene, SceneError};
use spec::{Values, parse};

/// Description of a built-in scene.
#[derive(Clone, Copy, Debug, serde::Serialize)]
pub struct BuiltinInfo {
    /// Name in a SPEC.
    pub name: &'static str,
    /// A few words for a list.
    pub title: &'static str,
    /// Content and use.
    pub description: &'static str,
    /// Parameters of this scene.
    pub parameters: &'static [Parameter],
    /// Triangles over all instances with every parameter at its default.
    pub triangles: usize,
    #[serde(skip)]
    build: fn(&Values) -> Scene,
}

/// A number that can be set in a SPEC as `name=value`.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Parameter {
    /// Name in a SPEC.
    pub name: &'static str,
    /// Value where the SPEC is silent.
    pub default: f64,
    /// Smallest allowed value.
    pub min: f64,
    /// Largest allowed value.
    pub max: f64,
    /// True if only whole numbers make sense.
    pub integer: bool,
    /// Meaning, with its unit.
    pub help: &'static str,
}

impl Parameter {
    const fn count(name: &'static str, default: u32, min: u32, max: u32, help: &'static str) -> Parameter {
        Parameter { name, default: default as f64, min: min as f64, max: max as f64, integer: true, help }
    }

    const fn real(name: &'static str, default: f64, min: f64, max: f64, help: &'static str) -> Parameter {
        Parameter { name, default, min, max, integer: false, help }
    }
}

/// Every built-in scene, simple ones first.
pub fn list() -> &'static [BuiltinInfo] {
    &BUILTINS
}

/// Builds the scene of a SPEC, the part after `builtin:` in a scene argument.
pub fn build(spec: &str) -> Result<Scene, SceneError> {
    let fail = |message| SceneError::Builtin { spec: spec.to_string(), message };
    let (info, values) = parse(spec).map_err(fail)?;
    let mut scene = (info.build)(&values);
    scene.name = format!("builtin:{spec}");
    Ok(scene)
}

static BUILTINS: [BuiltinInfo; 13] = [
    basic::SQUARE,
    basic::DISK,
    basic::SPHERES,
    fence::FENCE,
    layers::LAYERS,
    cage::CAGE,
    terrain::BUMPY,
    terrain::GRID,
    windmill::WINDMILL,
    plant::PLANT,
    forest::FOREST,
    pipes::PIPES,
    atrium::ATRIUM,
];
