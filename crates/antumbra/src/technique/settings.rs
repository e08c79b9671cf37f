//! Settings of techniques: declared once, with default, range, unit and help, and set by a SPEC such as
//! `pcf:map=1024,pcf=5`.

use crate::error::SpecError;
use serde::{Serialize, de::DeserializeOwned};
use serde_json::{Map, Value};

/// One setting of a technique.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Setting {
    /// Key in a SPEC.
    pub key: &'static str,
    /// Meaning, with its unit.
    pub help: &'static str,
    /// Type and range.
    #[serde(flatten)]
    pub kind: Kind,
}

/// The values of a setting.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "type", rename_all = "lowercase")]
pub enum Kind {
    /// Whole numbers.
    Integer {
        /// Smallest.
        min: u32,
        /// Largest.
        max: u32,
    },
    /// Real numbers.
    Number {
        /// Smallest.
        min: f32,
        /// Largest.
        max: f32,
    },
    /// `true` or `false`.
    Toggle,
    /// One of these words.
    Choice {
        /// The words.
        options: &'static [&'static str],
    },
    /// Points of the unit square, `x y;x y;...`, or one a line as a file has them.
    Points {
        /// Most points.
        max: u32,
    },
}

/// A settings struct made by `settings!`.
pub trait Settings: Serialize + DeserializeOwned + Default {
    /// Its keys, in the order of declaration.
    const FIELDS: &'static [Setting];
}

/// Declares a settings struct: `key: type = default, kind;` with the doc comment, of one line or more,
/// as help.
#[macro_export]
macro_rules! settings {
    ($(#[$meta:meta])* $vis:vis struct $name:ident {
        $($(#[doc = $help:literal])+ $key:ident : $type:ty = $default:expr, $kind:expr;)*
    }) => {
        $(#[$meta])*
        #[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
        #[serde(default, deny_unknown_fields)]
        $vis struct $name { $($(#[doc = $help])+ pub $key: $type),* }

        impl Default for $name {
            fn default() -> Self {
                $name { $($key: $default),* }
            }
        }

        impl $crate::technique::settings::Settings for $name {
            const FIELDS: &'static [$crate::technique::settings::Setting] =
                &[$($crate::technique::settings::Setting {
                    key: stringify!($key),
                    help: concat!($($help),+).trim_ascii(),
                    kind: $kind,
                }),*];
        }
    };
}

/// Declares an enum whose variants are words in a SPEC, with the list of words as `OPTIONS`.
#[macro_export]
macro_rules! choices {
    ($(#[$meta:meta])* $vis:vis enum $name:ident { $($(#[$variant_meta:meta])* $variant:ident = $word:literal),* $(,)? }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
        $vis enum $name { $($(#[$variant_meta])* #[serde(rename = $word)] $variant),* }

        impl $name {
            /// The words that name the variants.
            pub const OPTIONS: &'static [&'static str] = &[$($word),*];
        }
    };
}

/// The name among `names` that is most like `asked`, if any is alike at all.
pub fn nearest(asked: &str, names: impl Iterator<Item = &'static str>) -> Option<&'static str> {
    names
        .map(|n| (strsim::normalized_damerau_levenshtein(&asked.to_lowercase(), n), n))
        .filter(|(likeness, _)| *likeness > 0.4)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, n)| n)
}

/// Reads `key=value,key=value` (or nothing) for a technique with these settings.
pub fn parse_values(technique: &str, fields: &'static [Setting], text: &str) -> Result<Map<String, Value>, SpecError> {
    let technique = technique.to_owned();
    let mut values = Map::new();
    for part in text.split(',').filter(|p| !p.trim().is_empty()) {
        let Some((key, value)) = part.split_once('=') else {
            return Err(SpecError::Form { technique, part: part.to_owned() });
        };
        let (key, value) = (key.trim(), value.trim());
        let Some(field) = fields.iter().find(|f| f.key == key) else {
            return Err(SpecError::UnknownKey {
                nearest: nearest(key, fields.iter().map(|f| f.key)),
                known: fields.iter().map(|f| f.key).collect(),
                key: key.to_owned(),
                technique,
            });
        };
        let parsed = parse_value(field.kind, value).map_err(|expected| SpecError::Value {
            technique: technique.clone(),
            key: key.to_owned(),
            value: value.to_owned(),
            expected,
        })?;
        if values.insert(key.to_owned(), parsed).is_some() {
            return Err(SpecError::Twice { technique, key: key.to_owned() });
        }
    }
    Ok(values)
}

fn parse_value(kind: Kind, text: &str) -> Result<Value, String> {
    match kind {
        Kind::Integer { min, max } => {
            let expected = || format!("expected a whole number from {min} to {max}");
            text.parse::<u32>().ok().filter(|v| (min..=max).contains(v)).map(Value::from).ok_or_else(expected)
        }
        Kind::Number { min, max } => {
            let expected = || format!("expected a number from {min} to {max}");
            text.parse::<f32>().ok().filter(|v| (min..=max).contains(v)).map(Value::from).ok_or_else(expected)
        }
        Kind::Toggle => text.parse::<bool>().map(Value::from).map_err(|_| "expected true or false".to_owned()),
        Kind::Choice { options } => {
            let found = options.iter().find(|o| **o == text).map(|o| Value::from(*o));
            found.ok_or_else(|| format!("expected one of {}", options.join(", ")))
        }
        Kind::Points { max } => parse_points(text, max as usize),
    }
}

fn parse_points(text: &str, max: usize) -> Result<Value, String> {
    let mut points = Vec::new();
    for (i, point) in text.split([';', '\n']).map(str::trim).filter(|p| !p.is_empty()).enumerate() {
        let numbers: Option<Vec<f32>> = point.split_whitespace().map(|n| n.parse().ok()).collect();
        let pair = numbers.filter(|n| n.len() == 2 && n.iter().all(|v| (0.0..=1.0).contains(v)));
        let expected = || format!("point {} is `{point}`: expected two numbers from 0 to 1", i + 1);
        points.push(Value::from(pair.ok_or_else(expected)?));
    }
    let few = points.len() <= max;
    if few { Ok(Value::from(points)) } else { Err(format!("expected up to {max} points, not {}", points.len())) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FIELDS: &[Setting] = &[
        Setting { key: "map", help: "", kind: Kind::Integer { min: 1, max: 100 } },
        Setting { key: "width", help: "", kind: Kind::Number { min: 0.0, max: 1.0 } },
        Setting { key: "points", help: "", kind: Kind::Points { max: 2 } },
        Setting { key: "lookup", help: "", kind: Kind::Choice { options: &["nearest", "linear"] } },
    ];

    #[test]
    fn values_are_typed_and_ranged() {
        let v = parse_values("t", FIELDS, "map=7, width=0.5,lookup=linear,points=0.5 0.5;\n 1 0.25\n").unwrap();
        let points = serde_json::json!([[0.5, 0.5], [1.0, 0.25]]);
        assert_eq!(Value::Object(v), serde_json::json!({"map": 7, "width": 0.5, "lookup": "linear", "points": points}));
        // No points are the technique's own.
        assert_eq!(parse_values("t", FIELDS, "points=").unwrap()["points"], serde_json::json!([]));
        for bad in ["points=0.5", "points=0 0;1 1;0 1", "points=0 2", "points=0 x"] {
            assert!(parse_values("t", FIELDS, bad).is_err(), "{bad} must be refused");
        }
        for bad in ["map=0", "map=101", "map=-1", "map=x", "width=nan", "width=2", "lookup=cubic", "map", "map=1,map=2"]
        {
            assert!(parse_values("t", FIELDS, bad).is_err(), "{bad} must be refused");
        }
    }

    #[test]
    fn the_nearest_key_is_suggested() {
        let error = parse_values("t", FIELDS, "mpa=3").unwrap_err();
        assert!(error.to_string().contains("did you mean `map`"), "{error}");
    }
}
