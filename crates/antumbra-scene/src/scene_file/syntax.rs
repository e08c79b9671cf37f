//! TOML or JSON to entries, with messages that name the line.

use super::Format;
use crate::import::text;
use crate::{Place, SceneError};
use serde::de::DeserializeOwned;

pub(super) fn read<T: DeserializeOwned>(bytes: &[u8], format: Format, name: &str) -> Result<T, SceneError> {
    let fail = |place, problem| SceneError::Malformed { file: name.to_string(), place, problem };
    let bytes = text::plain(bytes);
    let text = std::str::from_utf8(&bytes)
        .map_err(|e| fail(Place::Byte(e.valid_up_to()), "the file is not text in UTF-8 or UTF-16".to_string()))?;
    match format {
        Format::Toml => toml::from_str(text).map_err(|e| {
            let place = e.span().map_or(Place::Whole, |span| line_column(text, span.start));
            fail(place, friendly(e.message()))
        }),
        Format::Json => serde_json::from_str(text).map_err(|e| {
            let message = e.to_string();
            let message = message.split(" at line ").next().unwrap_or(&message);
            fail(Place::LineColumn(e.line(), e.column()), friendly(message))
        }),
    }
}

/// Line and column of a byte, both from 1, the column in characters.
fn line_column(text: &str, byte: usize) -> Place {
    let before = text.get(..byte).unwrap_or(text);
    let line_start = before.rfind('\n').map_or(0, |i| i + 1);
    Place::LineColumn(before.matches('\n').count() + 1, before[line_start..].chars().count() + 1)
}

/// Serde's words for an unknown key, with the key that is probably meant.
fn friendly(message: &str) -> String {
    let quoted: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
    let [key, known @ ..] = &quoted[..] else { return text::abridged(message).into_owned() };
    if !message.starts_with("unknown field") {
        return text::abridged(message).into_owned();
    }
    let likeness = |k: &str| strsim::jaro_winkler(&key.to_lowercase(), k);
    let nearest = known.iter().max_by(|a, b| likeness(a).total_cmp(&likeness(b))).filter(|k| likeness(k) > 0.7);
    let question = nearest.map_or(String::new(), |k| format!(", did you mean `{k}`?"));
    let key = text::shortened(key);
    format!("there is no key `{key}` here{question} (known: {})", known.join(", "))
}
