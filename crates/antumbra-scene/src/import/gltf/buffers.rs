//! The bytes behind buffers and buffer views.

use super::{File, label, malformed};
use crate::import::ReadFile;
use crate::import::text::{abridged, shortened};
use crate::{Place, SceneError};
use data_encoding::BASE64_NOPAD;
use gltf_json::{Index, Root, buffer};
use percent_encoding::percent_decode_str;
use std::borrow::Cow;

/// Every buffer of a file, in memory.
pub(super) struct Buffers<'a> {
    buffers: Vec<Cow<'a, [u8]>>,
}

impl<'a> Buffers<'a> {
    pub fn load(
        root: &Root,
        name: &str,
        mut binary: Option<&'a [u8]>,
        read_file: &mut ReadFile,
    ) -> Result<Buffers<'a>, SceneError> {
        let mut buffers = Vec::new();
        for (i, buffer) in root.buffers.iter().enumerate() {
            let place = label("buffer", i, &buffer.name);
            let bytes = match &buffer.uri {
                Some(uri) => Cow::Owned(read_uri(uri, name, &place, read_file)?),
                None => Cow::Borrowed(binary.take().ok_or_else(|| {
                    malformed(
                        name,
                        Place::Part(place.clone()),
                        "it has no uri, and the file has no binary chunk for it",
                    )
                })?),
            };
            if buffer.byte_length.0 > bytes.len() as u64 {
                return Err(SceneError::Truncated {
                    file: name.to_string(),
                    place: Place::Part(place),
                    what: "the buffer".to_string(),
                    needed: buffer.byte_length.0.into(),
                    available: bytes.len(),
                });
            }
            buffers.push(bytes);
        }
        Ok(Buffers { buffers })
    }

    /// How many bytes there are in all buffers.
    pub fn total(&self) -> usize {
        self.buffers.iter().map(|b| b.len()).sum()
    }
}

impl<'a> File<'a> {
    /// The bytes of a buffer view and its stride, if it states one.
    pub fn view(&self, index: Index<buffer::View>, place: &str) -> Result<(&'a [u8], Option<usize>), SceneError> {
        let view = self.get(&self.root.buffer_views, index, "buffer views", place)?;
        let place = format!("{place}, bufferView {}", index.value());
        let buffer = self.buffers.buffers.get(view.buffer.value());
        let bytes: &[u8] = buffer.ok_or_else(|| SceneError::IndexOutOfRange {
            file: self.name.to_string(),
            place: Place::Part(place.clone()),
            index: view.buffer.value() as i64,
            count: self.buffers.buffers.len(),
            what: "buffers",
        })?;
        let start = view.byte_offset.unwrap_or_default().0;
        let end = u128::from(start) + u128::from(view.byte_length.0);
        if end > bytes.len() as u128 {
            return Err(self.truncated(place, "the view", end, bytes.len()));
        }
        Ok((&bytes[start as usize..end as usize], view.byte_stride.map(|s| s.0).filter(|&s| s > 0)))
    }

    pub fn truncated(&self, place: String, what: &str, needed: u128, available: usize) -> SceneError {
        SceneError::Truncated {
            file: self.name.to_string(),
            place: Place::Part(place),
            what: what.to_string(),
            needed,
            available,
        }
    }
}

/// The bytes of a data URI, or of the file that a relative one names.
pub(super) fn read_uri(uri: &str, name: &str, place: &str, read_file: &mut ReadFile) -> Result<Vec<u8>, SceneError> {
    let bad = |problem: &str| malformed(name, Place::Part(place.to_string()), problem);
    if uri.get(..5).is_some_and(|scheme| scheme.eq_ignore_ascii_case("data:")) {
        let (kind, payload) = uri.split_once(',').ok_or_else(|| bad("the data URI has no comma"))?;
        if !kind.to_ascii_lowercase().ends_with(";base64") {
            return Ok(percent_decode_str(payload).collect());
        }
        let payload = payload.trim_end_matches('=');
        return BASE64_NOPAD
            .decode(payload.as_bytes())
            .map_err(|e| bad(&format!("the data URI is not valid base64: {e}")));
    }
    if uri.contains("://") {
        return Err(SceneError::Unsupported {
            file: name.to_string(),
            place: Place::Part(place.to_string()),
            feature: format!("the address {:?}", shortened(uri)),
            advice: "download it and refer to it by a relative path".to_string(),
        });
    }
    let path = percent_decode_str(uri).decode_utf8().map_err(|_| bad("the uri is not UTF-8"))?;
    // No file system has names of this length: it is a payload whose scheme is misspelt.
    if path.len() > 4096 {
        return Err(bad(&format!("{:?} is neither a data URI nor a path", shortened(&path))));
    }
    read_file(&path).map_err(|source| SceneError::Read {
        file: shortened(&path).into_owned(),
        referrer: Some(format!("{name}, {place}")),
        source: std::io::Error::new(source.kind(), abridged(&source.to_string())),
    })
}
