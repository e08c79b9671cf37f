//! A technique with editable settings, and its SPEC.

use antumbra::technique::settings::{Kind, Setting};
use antumbra::techniques::spec::find;
use antumbra::{Spec, TechniqueInfo};
use serde_json::{Map, Value};

/// A technique and all its settings.
#[derive(Clone)]
pub struct Choice {
    /// The technique.
    pub technique: &'static TechniqueInfo,
    /// Every key with its value.
    pub settings: Map<String, Value>,
}

impl PartialEq for Choice {
    fn eq(&self, other: &Choice) -> bool {
        self.technique.name == other.technique.name && self.settings == other.settings
    }
}

impl Choice {
    /// A technique with its defaults.
    pub fn new(technique: &'static TechniqueInfo) -> Choice {
        Choice { technique, settings: defaults(technique, &Map::new()) }
    }

    /// The choice of a SPEC.
    pub fn of_spec(spec: &Spec) -> Choice {
        let settings = spec.settings.as_object().cloned().unwrap_or_default();
        Choice { technique: spec.technique, settings }
    }

    /// The technique of this name with its defaults.
    pub fn named(name: &str) -> Result<Choice, antumbra::error::SpecError> {
        find(name).map(Choice::new)
    }

    /// The library's SPEC.
    pub fn spec(&self) -> Spec {
        Spec { technique: self.technique, settings: Value::Object(self.settings.clone()), text: self.text() }
    }

    /// The shortest equal SPEC.
    pub fn text(&self) -> String {
        let presets: Map<String, Value> = self.presets().map(|s| (s.key.to_owned(), self.value(s).clone())).collect();
        let (plain, base) = (defaults(self.technique, &Map::new()), defaults(self.technique, &presets));
        let said = |s: &&Setting| {
            let value = self.value(s);
            let is_preset = presets.contains_key(s.key);
            if is_preset { plain.get(s.key) != Some(value) } else { base.get(s.key) != Some(value) }
        };
        let parts: Vec<String> =
            self.technique.settings.iter().filter(said).map(|s| format!("{}={}", s.key, word(self.value(s)))).collect();
        if parts.is_empty() {
            self.technique.name.to_owned()
        } else {
            format!("{}:{}", self.technique.name, parts.join(","))
        }
    }

    /// The value of a setting.
    pub fn value(&self, setting: &Setting) -> &Value {
        self.settings.get(setting.key).unwrap_or(&Value::Null)
    }

    /// Sets a value; a preset also sets the settings that follow it.
    pub fn set(&mut self, setting: &Setting, value: Value) {
        if self.is_preset(setting) {
            self.settings = defaults(self.technique, &Map::from_iter([(setting.key.to_owned(), value)]));
        } else {
            self.settings.insert(setting.key.to_owned(), value);
        }
    }

    /// True if the setting is a preset.
    pub fn is_preset(&self, setting: &Setting) -> bool {
        let Kind::Choice { options } = setting.kind else { return false };
        let others = |option: &str| {
            let mut all = defaults(self.technique, &Map::from_iter([(setting.key.to_owned(), Value::from(option))]));
            all.remove(setting.key);
            all
        };
        options.windows(2).any(|pair| others(pair[0]) != others(pair[1]))
    }

    fn presets(&self) -> impl Iterator<Item = &'static Setting> {
        self.technique.settings.iter().filter(|s| self.is_preset(s))
    }

    /// The default of `setting`.
    pub fn default_of(&self, setting: &Setting) -> Value {
        let presets: Map<String, Value> = self.presets().map(|s| (s.key.to_owned(), self.value(s).clone())).collect();
        let base = if self.is_preset(setting) { Map::new() } else { presets };
        defaults(self.technique, &base).get(setting.key).cloned().unwrap_or_default()
    }
}

fn defaults(technique: &TechniqueInfo, given: &Map<String, Value>) -> Map<String, Value> {
    (technique.defaults)(given).as_object().cloned().unwrap_or_default()
}

/// A value in the form of a SPEC. JSON would print 32-bit numbers with surplus digits.
fn word(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Number(n) if n.is_f64() => n.as_f64().map_or_else(String::new, |v| (v as f32).to_string()),
        Value::Array(points) => points.iter().map(point).collect::<Vec<_>>().join(";"),
        other => other.to_string(),
    }
}

/// A point in the form of a SPEC.
fn point(value: &Value) -> String {
    value.as_array().into_iter().flatten().map(word).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use antumbra::techniques::TECHNIQUES;

    /// Every setting of every technique, one after the other set to each end of its range.
    fn changes() -> impl Iterator<Item = Choice> {
        TECHNIQUES.iter().flat_map(|technique| {
            technique.settings.iter().flat_map(move |setting| {
                let values: Vec<Value> = match setting.kind {
                    Kind::Integer { min, max } => vec![min.into(), max.into()],
                    Kind::Number { min, max } => vec![min.into(), (0.5 * (min + max)).into()],
                    Kind::Toggle => vec![true.into(), false.into()],
                    Kind::Choice { options } => options.iter().map(|o| Value::from(*o)).collect(),
                    Kind::Points { .. } => vec![serde_json::json!([[0.5, 0.5], [0.25, 0.75]])],
                };
                values.into_iter().map(move |value| {
                    let mut choice = Choice::new(technique);
                    choice.set(setting, value);
                    choice
                })
            })
        })
    }

    #[test]
    fn the_spec_means_the_same() {
        let mut count = 0;
        for choice in changes() {
            let text = choice.text();
            let read = text.parse::<Spec>().unwrap_or_else(|e| panic!("{text}: {e}"));
            let wanted = choice.spec().settings;
            for (key, value) in choice.settings.iter() {
                let got = &read.settings[key];
                let same = got == value || got.as_f64().zip(value.as_f64()).is_some_and(|(a, b)| a as f32 == b as f32);
                assert!(same, "{text}: {key} is {got}, wanted {value} of {wanted}");
            }
            count += 1;
        }
        assert!(count > 100, "only {count} changes were tried");
    }

    #[test]
    fn what_is_not_changed_is_not_said() {
        for technique in TECHNIQUES {
            assert_eq!(Choice::new(technique).text(), technique.name);
        }
    }

    #[test]
    fn a_preset_takes_its_settings_along() {
        let mut choice = Choice::named("backprojection").unwrap();
        let quality = choice.technique.settings.iter().find(|s| s.key == "quality").unwrap();
        assert!(choice.is_preset(quality));
        choice.set(quality, "best".into());
        assert_eq!(
            (choice.text().as_str(), &choice.settings["map"]),
            ("backprojection:quality=best", &Value::from(2048))
        );
        let map = choice.technique.settings.iter().find(|s| s.key == "map").unwrap();
        assert!(!choice.is_preset(map));
        choice.set(map, 512.into());
        assert_eq!(choice.text(), "backprojection:quality=best,map=512");
        assert_eq!(choice.default_of(map), Value::from(2048));
    }
}
