//! The numbers after the header.

use super::header::{Element, Encoding, Header, Kind, Property};
use crate::{Place, SceneError};

/// Reads numbers one after the other.
pub(super) struct Body<'a> {
    /// The file's name.
    pub name: &'a str,
    bytes: &'a [u8],
    at: usize,
    line: usize,
    encoding: Encoding,
}

impl<'a> Body<'a> {
    pub fn new(bytes: &'a [u8], header: &Header, name: &'a str) -> Body<'a> {
        Body { name, bytes, at: header.bytes, line: header.lines + 1, encoding: header.encoding }
    }

    /// Where the reader is.
    pub fn place(&self) -> Place {
        if self.encoding == Encoding::Ascii { Place::Line(self.line) } else { Place::Byte(self.at) }
    }

    /// Refuses an element whose items cannot fit into the rest of the file.
    pub fn check_claim(&self, element: &Element) -> Result<(), SceneError> {
        let least: usize = element.properties.iter().map(|p| self.least_size(p.least_size())).sum();
        let needed = element.count as u128 * least as u128;
        self.check_rest(needed, || format!("element {} with {} items", element.name, element.count))
    }

    /// Bytes of a number: in ASCII at least a digit and a space.
    fn least_size(&self, binary: usize) -> usize {
        if self.encoding == Encoding::Ascii { 2 } else { binary }
    }

    fn check_rest(&self, needed: u128, what: impl Fn() -> String) -> Result<(), SceneError> {
        let available = self.bytes.len() - self.at;
        // The last number of an ASCII file needs no space behind it.
        let spare = usize::from(self.encoding == Encoding::Ascii);
        if needed <= (available + spare) as u128 {
            return Ok(());
        }
        Err(self.truncated(needed, what()))
    }

    fn truncated(&self, needed: u128, what: String) -> SceneError {
        let available = self.bytes.len() - self.at;
        SceneError::Truncated { file: self.name.to_string(), place: self.place(), what, needed, available }
    }

    /// Passes over all items of an element.
    pub fn skip(&mut self, element: &Element) -> Result<(), SceneError> {
        let fixed = element.properties.iter().all(|p| matches!(p, Property::Scalar { .. }));
        if fixed && self.encoding != Encoding::Ascii {
            // In range: `check_claim` came first.
            self.at += element.count * element.properties.iter().map(Property::least_size).sum::<usize>();
            return Ok(());
        }
        let count = if element.properties.is_empty() { 0 } else { element.count };
        for _ in 0..count {
            element.properties.iter().try_for_each(|p| self.skip_property(p))?;
        }
        Ok(())
    }

    pub fn skip_property(&mut self, property: &Property) -> Result<(), SceneError> {
        match *property {
            Property::Scalar { kind, .. } => self.scalar(kind).map(drop),
            Property::List { length, item, .. } => {
                let length = self.length(length, item)?;
                if self.encoding != Encoding::Ascii {
                    self.at += length * item.size();
                    return Ok(());
                }
                (0..length).try_for_each(|_| self.scalar(item).map(drop))
            }
        }
    }

    /// Calls `each` with every item of a list of whole numbers.
    pub fn list(&mut self, length: Kind, item: Kind, mut each: impl FnMut(i64)) -> Result<(), SceneError> {
        for _ in 0..self.length(length, item)? {
            let value = self.scalar(item)?;
            if value.fract() != 0.0 {
                return Err(self.malformed(format!("{value} is not an index")));
            }
            each(value as i64);
        }
        Ok(())
    }

    /// A list's length, which the rest of the file has room for.
    fn length(&mut self, length: Kind, item: Kind) -> Result<usize, SceneError> {
        let value = self.scalar(length)?;
        if value < 0.0 || value.fract() != 0.0 {
            return Err(self.malformed(format!("{value} is not the length of a list")));
        }
        self.check_rest((value as u128).saturating_mul(self.least_size(item.size()) as u128), || {
            format!("a list of {value} numbers")
        })?;
        Ok(value as usize)
    }

    /// The next number. A double holds every one exactly.
    pub fn scalar(&mut self, kind: Kind) -> Result<f64, SceneError> {
        if self.encoding == Encoding::Ascii {
            return self.word();
        }
        Ok(match kind {
            Kind::I8 => f64::from(self.take::<1>()?[0] as i8),
            Kind::U8 => f64::from(self.take::<1>()?[0]),
            Kind::I16 => f64::from(i16::from_le_bytes(self.take()?)),
            Kind::U16 => f64::from(u16::from_le_bytes(self.take()?)),
            Kind::I32 => f64::from(i32::from_le_bytes(self.take()?)),
            Kind::U32 => f64::from(u32::from_le_bytes(self.take()?)),
            Kind::F32 => f64::from(f32::from_le_bytes(self.take()?)),
            Kind::F64 => f64::from_le_bytes(self.take()?),
        })
    }

    /// The next bytes, the least significant first.
    fn take<const N: usize>(&mut self) -> Result<[u8; N], SceneError> {
        let Some(bytes) = self.bytes[self.at..].first_chunk::<N>() else {
            return Err(self.truncated(N as u128, "a number".to_string()));
        };
        self.at += N;
        let mut bytes = *bytes;
        if self.encoding == Encoding::BigEndian {
            bytes.reverse();
        }
        Ok(bytes)
    }

    fn word(&mut self) -> Result<f64, SceneError> {
        while let Some(byte) = self.bytes.get(self.at).filter(|b| b.is_ascii_whitespace()) {
            self.line += usize::from(*byte == b'\n');
            self.at += 1;
        }
        let rest = &self.bytes[self.at..];
        let word = &rest[..rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len())];
        if word.is_empty() {
            return Err(self.malformed("the file ends where a number should be; it is damaged or cut off".to_string()));
        }
        self.at += word.len();
        let number = std::str::from_utf8(word).ok().and_then(|w| w.parse().ok());
        number.ok_or_else(|| {
            // A damaged file may hold a very long word.
            let shown = String::from_utf8_lossy(&word[..word.len().min(40)]);
            self.malformed(format!("{shown:?} is not a number"))
        })
    }

    fn malformed(&self, problem: String) -> SceneError {
        SceneError::Malformed { file: self.name.to_string(), place: self.place(), problem }
    }
}
