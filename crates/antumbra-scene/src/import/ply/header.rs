//! The header, which says what follows and how it is written.

use crate::{Place, SceneError};

/// How numbers are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// Type of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Kind {
    fn parse(word: &str) -> Option<Kind> {
        Some(match word {
            "char" | "int8" => Kind::I8,
            "uchar" | "uint8" => Kind::U8,
            "short" | "int16" => Kind::I16,
            "ushort" | "uint16" => Kind::U16,
            "int" | "int32" => Kind::I32,
            "uint" | "uint32" => Kind::U32,
            "float" | "float32" => Kind::F32,
            "double" | "float64" => Kind::F64,
            _ => return None,
        })
    }

    /// Bytes in the binary encodings.
    pub fn size(self) -> usize {
        match self {
            Kind::I8 | Kind::U8 => 1,
            Kind::I16 | Kind::U16 => 2,
            Kind::I32 | Kind::U32 | Kind::F32 => 4,
            Kind::F64 => 8,
        }
    }

    fn is_integer(self) -> bool {
        !matches!(self, Kind::F32 | Kind::F64)
    }
}

/// A value or a list of values that every item of an element has.
#[derive(Debug)]
pub(super) enum Property {
    Scalar { kind: Kind, name: String },
    List { length: Kind, item: Kind, name: String },
}

impl Property {
    pub fn is_scalar(&self, wanted: &str) -> bool {
        matches!(self, Property::Scalar { name, .. } if name == wanted)
    }

    /// Bytes that it takes at least in the binary encodings.
    pub fn least_size(&self) -> usize {
        match self {
            Property::Scalar { kind, .. } => kind.size(),
            Property::List { length, .. } => length.size(),
        }
    }
}

/// True for the name of the list of a face's corners: the two spellings are equally common.
pub(super) fn holds_corners(name: &str) -> bool {
    name == "vertex_indices" || name == "vertex_index"
}

/// A kind of item and how many of it there are.
#[derive(Debug)]
pub(super) struct Element {
    pub name: String,
    pub count: usize,
    pub properties: Vec<Property>,
}

/// What a file holds.
#[derive(Debug)]
pub(super) struct Header {
    pub encoding: Encoding,
    pub elements: Vec<Element>,
    /// Where the body begins.
    pub bytes: usize,
    /// Lines of the header.
    pub lines: usize,
}

pub(super) fn read(bytes: &[u8], name: &str) -> Result<Header, SceneError> {
    let fail = |line: usize, problem: String| SceneError::Malformed {
        file: name.to_string(),
        place: Place::Line(line),
        problem,
    };
    let (mut encoding, mut elements, mut at) = (None, Vec::new(), 0);
    for (i, line) in bytes.split_inclusive(|&b| b == b'\n').enumerate() {
        let number = i + 1;
        at += line.len();
        if number == 1 {
            if line.trim_ascii() != b"ply" {
                return Err(fail(1, "a PLY file begins with a line that says `ply`".to_string()));
            }
            continue;
        }
        // Comments may be in any encoding; what counts is ASCII.
        let line = String::from_utf8_lossy(line);
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        match words[..] {
            [] | ["comment" | "obj_info", ..] => {}
            ["format", format, _] => encoding = Some(read_format(format).map_err(|problem| fail(number, problem))?),
            ["element", name, count] => {
                let count = count.parse().map_err(|_| fail(number, format!("{count:?} is not a count")))?;
                elements.push(Element { name: name.to_string(), count, properties: Vec::new() });
            }
            ["property", ref words @ ..] => {
                let property = read_property(words).map_err(|problem| fail(number, problem))?;
                let orphan = || fail(number, "there is no element before this property".to_string());
                elements.last_mut().ok_or_else(orphan)?.properties.push(property);
            }
            ["end_header"] => {
                let encoding = encoding.ok_or_else(|| fail(number, "the header has no `format` line".to_string()))?;
                return Ok(Header { encoding, elements, bytes: at, lines: number });
            }
            _ => return Err(fail(number, format!("{:?} does not belong into a PLY header", line.trim()))),
        }
    }
    let lines = bytes.split_inclusive(|&b| b == b'\n').count();
    Err(fail(lines.max(1), "the header has no `end_header`; the file is not PLY or cut off".to_string()))
}

fn read_format(format: &str) -> Result<Encoding, String> {
    match format {
        "ascii" => Ok(Encoding::Ascii),
        "binary_little_endian" => Ok(Encoding::LittleEndian),
        "binary_big_endian" => Ok(Encoding::BigEndian),
        _ => Err(format!("format {format:?} is not ascii, binary_little_endian or binary_big_endian")),
    }
}

fn read_property(words: &[&str]) -> Result<Property, String> {
    let kind = |word: &str| Kind::parse(word).ok_or_else(|| format!("{word:?} is not a type of PLY"));
    match *words {
        ["list", length, item, name] => {
            let (length, item, name) = (kind(length)?, kind(item)?, name.to_string());
            if !length.is_integer() || (holds_corners(&name) && !item.is_integer()) {
                return Err(format!("the list {name:?} needs whole numbers for its length and its indices"));
            }
            Ok(Property::List { length, item, name })
        }
        [word, name] => Ok(Property::Scalar { kind: kind(word)?, name: name.to_string() }),
        _ => Err("a property reads `property TYPE NAME` or `property list TYPE TYPE NAME`".to_string()),
    }
}
