//! The body of a PLY file: the properties of every item, in sequence.

use super::header::{Element, Encoding, Header, Kind, Property};
use crate::{Place, SceneError};

pub(super) struct Body<'a> {
    /// The file's name.
    pub name: &'a str,
    bytes: &'a [u8],
    at: usize,
    line: usize,
    encoding: Encoding,
    line_end: u8,
    /// Values of the property that was read last.
    values: Vec<f64>,
}

impl<'a> Body<'a> {
    pub fn new(bytes: &'a [u8], header: &Header, name: &'a str) -> Body<'a> {
        let Header { encoding, bytes: at, lines, line_end, .. } = *header;
        Body { name, bytes, at, line: lines + 1, encoding, line_end, values: Vec::new() }
    }

    /// Position of the reader.
    pub fn place(&self) -> Place {
        if self.encoding == Encoding::Ascii { Place::Line(self.line) } else { Place::Byte(self.at) }
    }

    /// Refuses an element whose items cannot fit into the rest of the file.
    pub fn check_claim(&self, element: &Element) -> Result<(), SceneError> {
        let least: usize = element.properties.iter().map(|p| self.least_size(p.length.unwrap_or(p.kind))).sum();
        let needed = element.count as u128 * least as u128;
        self.check_rest(needed, || format!("element {} with {} items", element.name, element.count))
    }

    /// Bytes of a number: in ASCII at least a digit and a space.
    fn least_size(&self, kind: Kind) -> usize {
        if self.encoding == Encoding::Ascii { 2 } else { kind.size() }
    }

    fn check_rest(&self, needed: u128, what: impl Fn() -> String) -> Result<(), SceneError> {
        let available = self.bytes.len() - self.at;
        // The last number of an ASCII file needs no space behind it.
        let spare = usize::from(self.encoding == Encoding::Ascii);
        if needed <= (available + spare) as u128 {
            return Ok(());
        }
        let (file, place) = (self.name.to_string(), self.place());
        Err(SceneError::Truncated { file, place, what: what(), needed, available })
    }

    /// The next property: one value, or the values of a list. A double holds every type exactly.
    pub fn property(&mut self, property: &Property) -> Result<&[f64], SceneError> {
        let count = property.length.map_or(Ok(1), |length| self.length(length, property.kind))?;
        self.values.clear();
        for _ in 0..count {
            let value = self.scalar(property.kind)?;
            self.values.push(value);
        }
        Ok(&self.values)
    }

    /// Length of a list, checked against the rest of the file.
    fn length(&mut self, length: Kind, kind: Kind) -> Result<usize, SceneError> {
        let value = self.scalar(length)?;
        if value < 0.0 || value.fract() != 0.0 {
            return Err(self.malformed(format!("{value} is not the length of a list")));
        }
        let needed = (value as u128).saturating_mul(self.least_size(kind) as u128);
        self.check_rest(needed, || format!("a list of {value} numbers"))?;
        Ok(value as usize)
    }

    fn scalar(&mut self, kind: Kind) -> Result<f64, SceneError> {
        if self.encoding == Encoding::Ascii {
            return self.word();
        }
        Ok(match kind {
            Kind::I8 => i8::from_le_bytes(self.take()?).into(),
            Kind::U8 => u8::from_le_bytes(self.take()?).into(),
            Kind::I16 => i16::from_le_bytes(self.take()?).into(),
            Kind::U16 => u16::from_le_bytes(self.take()?).into(),
            Kind::I32 => i32::from_le_bytes(self.take()?).into(),
            Kind::U32 => u32::from_le_bytes(self.take()?).into(),
            Kind::F32 => f32::from_le_bytes(self.take()?).into(),
            Kind::F64 => f64::from_le_bytes(self.take()?),
        })
    }

    /// The next bytes, the least significant first.
    fn take<const N: usize>(&mut self) -> Result<[u8; N], SceneError> {
        self.check_rest(N as u128, || "a number".to_string())?;
        let mut bytes = [0; N];
        bytes.copy_from_slice(&self.bytes[self.at..][..N]);
        self.at += N;
        if self.encoding == Encoding::BigEndian {
            bytes.reverse();
        }
        Ok(bytes)
    }

    fn word(&mut self) -> Result<f64, SceneError> {
        let rest = &self.bytes[self.at..];
        let start = rest.iter().position(|b| !b.is_ascii_whitespace()).unwrap_or(rest.len());
        let (space, rest) = rest.split_at(start);
        let word = rest.split(u8::is_ascii_whitespace).next().unwrap_or_default();
        self.line += space.iter().filter(|&&b| b == self.line_end).count();
        if word.is_empty() {
            return Err(self.malformed("the file ends where a number should be; it is damaged or cut off".to_string()));
        }
        self.at += space.len() + word.len();
        let number = std::str::from_utf8(word).ok().and_then(|w| w.parse().ok());
        number.ok_or_else(|| {
            // A damaged file may hold a very long word.
            let shown = String::from_utf8_lossy(&word[..word.len().min(40)]);
            self.malformed(format!("{shown:?} is not a number"))
        })
    }

    pub fn malformed(&self, problem: String) -> SceneError {
        SceneError::Malformed { file: self.name.to_string(), place: self.place(), problem }
    }
}
