//! Reads `name:key=value,key=value` and reports errors.

use super::{BuiltinInfo, Parameter, list};

/// A value for every parameter of one scene.
pub(super) struct Values {
    parameters: &'static [Parameter],
    values: Vec<f64>,
}

impl Values {
    fn of(info: &BuiltinInfo) -> Values {
        Values { parameters: info.parameters, values: info.parameters.iter().map(|p| p.default).collect() }
    }

    /// A parameter that the scene declares; another name is a mistake in the scene, which its test would find.
    fn get(&self, name: &str) -> f64 {
        let index = self.parameters.iter().position(|p| p.name == name);
        self.values[index.unwrap_or_else(|| panic!("the scene declares no parameter {name}"))]
    }

    pub fn real(&self, name: &str) -> f32 {
        self.get(name) as f32
    }

    pub fn count(&self, name: &str) -> usize {
        self.get(name) as usize
    }

    pub fn seed(&self) -> u64 {
        self.get("seed") as u64
    }
}

/// The scene of a SPEC and the values of its parameters, or the error.
pub(super) fn parse(spec: &str) -> Result<(&'static BuiltinInfo, Values), String> {
    let (name, settings) = spec.split_once(':').unwrap_or((spec, ""));
    let name = name.trim();
    let info = list()
        .iter()
        .find(|info| info.name == name)
        .ok_or_else(|| unknown("built-in scene", name, list().iter().map(|info| info.name)))?;
    let mut values = Values::of(info);
    for setting in settings.split(',').map(str::trim).filter(|s| !s.is_empty()) {
        let (key, text) = setting.split_once('=').ok_or_else(|| format!("`{setting}` should read key=value"))?;
        let (key, text) = (key.trim(), text.trim());
        let index = info.parameters.iter().position(|p| p.name == key).ok_or_else(|| {
            if info.parameters.is_empty() {
                format!("`{name}` has no parameters, so `{key}` cannot be set")
            } else {
                unknown(&format!("parameter of `{name}`"), key, info.parameters.iter().map(|p| p.name))
            }
        })?;
        values.values[index] = read(&info.parameters[index], text)?;
    }
    Ok((info, values))
}

/// The value of one parameter.
fn read(parameter: &Parameter, text: &str) -> Result<f64, String> {
    let Parameter { name, min, max, integer, .. } = *parameter;
    let kind = if integer { "a whole number" } else { "a number" };
    let wrong = || format!("`{name}` should be {kind} from {min} to {max}, not `{text}`");
    let value: f64 = text.parse().map_err(|_| wrong())?;
    let fits = (min..=max).contains(&value) && !(integer && value.fract() != 0.0);
    if fits { Ok(value) } else { Err(wrong()) }
}

/// Names the nearest of `known`, if one is near, and then all of them.
fn unknown(what: &str, name: &str, known: impl Iterator<Item = &'static str> + Clone) -> String {
    let nearest = known
        .clone()
        .map(|k| (strsim::jaro_winkler(&name.to_lowercase(), k), k))
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .filter(|(likeness, _)| *likeness > 0.7)
        .map_or(".".to_string(), |(_, k)| format!("; did you mean `{k}`?"));
    let all: Vec<&str> = known.collect();
    format!("no {what} is called `{name}`{nearest} There are: {}", all.join(", "))
}
