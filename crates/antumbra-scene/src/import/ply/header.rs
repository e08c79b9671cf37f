//! The header: the encoding of the body, and its elements with their properties.

use crate::{Place, SceneError};

/// Encoding of the body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// Scalar type.
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
    fn parse(word: &str) -> Result<Kind, String> {
        Ok(match word {
            "char" | "int8" => Kind::I8,
            "uchar" | "uint8" => Kind::U8,
            "short" | "int16" => Kind::I16,
            "ushort" | "uint16" => Kind::U16,
            "int" | "int32" => Kind::I32,
            "uint" | "uint32" => Kind::U32,
            "float" | "float32" => Kind::F32,
            "double" | "float64" => Kind::F64,
            _ => return Err(format!("{word:?} is not a type of PLY")),
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

/// Property of every item of an element: a scalar, or a list where there is a type of its `length`.
#[derive(Debug)]
pub(super) struct Property {
    pub name: String,
    pub kind: Kind,
    pub length: Option<Kind>,
}

impl Property {
    /// True for the list of a face's vertices; both spellings are common.
    pub fn holds_corners(&self) -> bool {
        self.length.is_some() && matches!(self.name.as_str(), "vertex_indices" | "vertex_index")
    }

    /// The value that stands for one in a colour.
    pub fn one(&self) -> f64 {
        match self.kind {
            Kind::F32 | Kind::F64 => 1.0,
            Kind::U8 | Kind::I8 => 255.0,
            _ => 65535.0,
        }
    }
}

/// Element: `count` items that all have the same properties.
#[derive(Debug)]
pub(super) struct Element {
    pub name: String,
    pub count: usize,
    pub properties: Vec<Property>,
}

#[derive(Debug)]
pub(super) struct Header {
    pub encoding: Encoding,
    pub elements: Vec<Element>,
    /// Textures that comments name, as several programs do.
    pub textures: usize,
    /// Offset of the body.
    pub bytes: usize,
    /// Lines before the body.
    pub lines: usize,
    /// The last byte of every line: LF, or CR alone.
    pub line_end: u8,
}

pub(super) fn read(bytes: &[u8], name: &str) -> Result<Header, SceneError> {
    let malformed = |line: usize, problem: &str| {
        let (file, place) = (name.to_string(), Place::Line(line));
        SceneError::Malformed { file, place, problem: problem.to_string() }
    };
    let (mut encoding, mut elements, mut textures, mut at, mut number) = (None, Vec::new(), 0, 0, 0);
    let line_end = if bytes.starts_with(b"ply\r") && bytes.get(4) != Some(&b'\n') { b'\r' } else { b'\n' };
    for line in bytes.split_inclusive(|&b| b == line_end) {
        (at, number) = (at + line.len(), number + 1);
        if number == 1 {
            if line.trim_ascii() != b"ply" {
                return Err(malformed(1, "a PLY file begins with a line that says `ply`"));
            }
            continue;
        }
        // Comments may be in any encoding; keywords and names are ASCII.
        let line = String::from_utf8_lossy(line);
        let words: Vec<&str> = line.split_ascii_whitespace().collect();
        if words == ["end_header"] {
            let encoding = encoding.ok_or_else(|| malformed(number, "the header has no `format` line"))?;
            return Ok(Header { encoding, elements, textures, bytes: at, lines: number, line_end });
        }
        textures += usize::from(words.starts_with(&["comment", "TextureFile"]));
        statement(&words, &mut encoding, &mut elements).map_err(|problem| malformed(number, &problem))?;
    }
    Err(malformed(number.max(1), "the header has no `end_header`; the file is not PLY or cut off"))
}

fn statement(words: &[&str], encoding: &mut Option<Encoding>, elements: &mut Vec<Element>) -> Result<(), String> {
    match *words {
        [] | ["comment" | "obj_info", ..] => {}
        ["format", format, _] => {
            *encoding = Some(match format {
                "ascii" => Encoding::Ascii,
                "binary_little_endian" => Encoding::LittleEndian,
                "binary_big_endian" => Encoding::BigEndian,
                _ => {
                    return Err(format!("format {format:?} is not ascii, binary_little_endian or binary_big_endian"));
                }
            });
        }
        ["element", name, count] => {
            let count = count.parse().map_err(|_| format!("{count:?} is not a count"))?;
            elements.push(Element { name: name.to_string(), count, properties: Vec::new() });
        }
        ["property", ref words @ ..] => {
            let element = elements.last_mut().ok_or("there is no element before this property")?;
            element.properties.push(property(words)?);
        }
        _ => {
            // A damaged file may hold a very long line.
            let shown: String = words.join(" ").chars().take(40).collect();
            return Err(format!("{shown:?} does not belong into a PLY header"));
        }
    }
    Ok(())
}

fn property(words: &[&str]) -> Result<Property, String> {
    let (length, kind, name) = match *words {
        ["list", length, kind, name] => (Some(Kind::parse(length)?), Kind::parse(kind)?, name),
        [kind, name] => (None, Kind::parse(kind)?, name),
        _ => return Err("a property reads `property TYPE NAME` or `property list TYPE TYPE NAME`".to_string()),
    };
    let property = Property { name: name.to_string(), kind, length };
    if length.is_some_and(|l| !l.is_integer()) || (property.holds_corners() && !kind.is_integer()) {
        return Err(format!("the list {name:?} needs whole numbers for its length and its indices"));
    }
    Ok(property)
}
