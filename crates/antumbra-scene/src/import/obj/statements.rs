//! The lines of an OBJ file, read and checked.

use crate::{Place, SceneError};
use glam::{Vec2, Vec3};
use std::borrow::Cow;
use std::collections::HashMap;

/// Stands for "no texture coordinate".
pub(super) const NONE: u32 = u32::MAX;

/// What an OBJ file says; every index is in range.
#[derive(Default)]
pub(super) struct Statements {
    pub positions: Vec<Vec3>,
    pub uvs: Vec<Vec2>,
    /// Position and texture coordinate of every corner of every face, one face after the other.
    pub corners: Vec<[u32; 2]>,
    pub faces: Vec<Face>,
    /// Names after `usemtl`; the first is "" for faces before any.
    pub materials: Vec<String>,
    /// What follows `mtllib`, once a line.
    pub libraries: Vec<String>,
}

/// A polygon.
pub(super) struct Face {
    /// One past its last corner in [`Statements::corners`]; it begins where the face before ends.
    pub end: usize,
    /// Index into [`Statements::materials`].
    pub material: usize,
    line: usize,
}

/// Reads all lines.
pub(super) fn read(bytes: &[u8], name: &str) -> Result<Statements, SceneError> {
    let mut reader = Reader {
        name,
        line: 0,
        out: Statements { materials: vec![String::new()], ..Statements::default() },
        material: 0,
        numbers: HashMap::from([(String::new(), 0)]),
        normals: 0,
        skipped: [None; 3],
    };
    let mut lines = bytes.split(|&b| b == b'\n');
    while let Some(first) = lines.next() {
        reader.line += 1;
        let (line, more) = joined(first, &mut lines);
        reader.statement(&line)?;
        reader.line += more;
    }
    reader.check_indices()?;
    for (what, line) in SKIPPED.iter().zip(reader.skipped) {
        if let Some(line) = line {
            tracing::warn!("{name}, line {line}: {what} are left out (and maybe more below)");
        }
    }
    Ok(reader.out)
}

const SKIPPED: [&str; 3] = ["points and lines", "free-form curves and surfaces", "faces with fewer than 3 corners"];

/// A line together with those that follow it after a backslash, and how many those are.
fn joined<'a>(first: &'a [u8], lines: &mut impl Iterator<Item = &'a [u8]>) -> (Cow<'a, [u8]>, usize) {
    let (mut line, mut more) = (Cow::Borrowed(first.trim_ascii_end()), 0);
    while let Some(start) = line.strip_suffix(b"\\") {
        let mut longer = start.to_vec();
        longer.push(b' ');
        let Some(next) = lines.next() else { return (longer.into(), more) };
        longer.extend_from_slice(next.trim_ascii_end());
        (line, more) = (longer.into(), more + 1);
    }
    (line, more)
}

struct Reader<'a> {
    name: &'a str,
    line: usize,
    out: Statements,
    material: usize,
    numbers: HashMap<String, usize>,
    normals: usize,
    /// First line of each kind of [`SKIPPED`].
    skipped: [Option<usize>; 3],
}

impl Reader<'_> {
    fn statement(&mut self, line: &[u8]) -> Result<(), SceneError> {
        let mut words = line.split(|b| b.is_ascii_whitespace()).filter(|w| !w.is_empty());
        let Some(keyword) = words.next() else { return Ok(()) };
        match keyword {
            b"v" => self.position(words)?,
            b"vt" => {
                let [u, v] = [self.number(words.next())?, words.next().map_or(Ok(0.0), |w| self.number(Some(w)))?];
                // OBJ counts v from the bottom of the picture, a texture here from its top.
                let uv = Vec2::new(u, 1.0 - v);
                self.out.uvs.push(if uv.is_finite() { uv } else { Vec2::ZERO });
            }
            b"vn" => self.normals += 1,
            b"f" | b"fo" => self.face(words)?,
            b"usemtl" => self.use_material(text_after(line, keyword)),
            b"mtllib" => self.out.libraries.push(text_after(line, keyword)),
            b"p" | b"l" => self.skip(0),
            b"curv" | b"curv2" | b"surf" => self.skip(1),
            _ => {}
        }
        Ok(())
    }

    fn skip(&mut self, kind: usize) {
        self.skipped[kind].get_or_insert(self.line);
    }

    fn position<'w>(&mut self, mut words: impl Iterator<Item = &'w [u8]>) -> Result<(), SceneError> {
        let mut next = || self.number(words.next());
        let position = Vec3::new(next()?, next()?, next()?);
        if !position.is_finite() {
            return Err(SceneError::NotFinite {
                file: self.name.to_string(),
                place: Place::Line(self.line),
                vertex: self.out.positions.len(),
                position: position.to_array(),
            });
        }
        self.out.positions.push(position);
        Ok(())
    }

    fn number(&self, word: Option<&[u8]>) -> Result<f32, SceneError> {
        let Some(word) = word else { return Err(self.malformed("a number is missing at the end of the line")) };
        let number = std::str::from_utf8(word).ok().and_then(|w| w.parse().ok());
        number.ok_or_else(|| self.malformed(format!("{:?} is not a number", String::from_utf8_lossy(word))))
    }

    fn use_material(&mut self, name: String) {
        let next = self.out.materials.len();
        self.material = *self.numbers.entry(name).or_insert_with_key(|name| {
            self.out.materials.push(name.clone());
            next
        });
    }

    fn face<'w>(&mut self, words: impl Iterator<Item = &'w [u8]>) -> Result<(), SceneError> {
        let start = self.out.corners.len();
        for word in words {
            let corner = self.corner(word)?;
            self.out.corners.push(corner);
        }
        if self.out.corners.len() - start < 3 {
            self.out.corners.truncate(start);
            self.skip(2);
        } else {
            self.out.faces.push(Face { end: self.out.corners.len(), material: self.material, line: self.line });
        }
        Ok(())
    }

    /// A corner: `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    fn corner(&self, word: &[u8]) -> Result<[u32; 2], SceneError> {
        let mut parts = word.split(|&b| b == b'/');
        let position = parts.next().unwrap_or_default();
        let position = self.index(position, word, self.out.positions.len(), "vertices")?;
        let uv = match parts.next() {
            None | Some(b"") => NONE,
            Some(part) => self.index(part, word, self.out.uvs.len(), "texture coordinates")?,
        };
        match parts.next() {
            None | Some(b"") => {}
            Some(part) => drop(self.index(part, word, self.normals, "normals")?),
        }
        if parts.next().is_some() {
            return Err(self.not_a_corner(word));
        }
        Ok([position, uv])
    }

    /// An index from 0. One that counts back from the last is resolved; whether one that counts from the first is in
    /// range is known at the end of the file only, see [`Reader::check_indices`].
    fn index(&self, part: &[u8], word: &[u8], count: usize, what: &'static str) -> Result<u32, SceneError> {
        let text = std::str::from_utf8(part).map_err(|_| self.not_a_corner(word))?;
        let index: i64 = text.parse().map_err(|_| self.not_a_corner(word))?;
        let from_zero = if index < 0 { count as i64 + index } else { index - 1 };
        let valid = u32::try_from(from_zero).ok().filter(|&i| i != NONE);
        valid.ok_or_else(|| self.out_of_range(self.line, index, count, what))
    }

    fn check_indices(&self) -> Result<(), SceneError> {
        let counts = [(self.out.positions.len(), "vertices"), (self.out.uvs.len(), "texture coordinates")];
        let mut start = 0;
        for face in &self.out.faces {
            for corner in &self.out.corners[start..face.end] {
                for (&index, (count, what)) in corner.iter().zip(counts) {
                    if index as usize >= count && index != NONE {
                        return Err(self.out_of_range(face.line, i64::from(index) + 1, count, what));
                    }
                }
            }
            start = face.end;
        }
        Ok(())
    }

    fn out_of_range(&self, line: usize, index: i64, count: usize, what: &'static str) -> SceneError {
        SceneError::IndexOutOfRange { file: self.name.to_string(), place: Place::Line(line), index, count, what }
    }

    fn not_a_corner(&self, word: &[u8]) -> SceneError {
        self.malformed(format!(
            "{:?} is not a corner of a face, which reads like 7, 7/3, 7//2 or 7/3/2",
            String::from_utf8_lossy(word)
        ))
    }

    fn malformed(&self, problem: impl Into<String>) -> SceneError {
        let place = Place::Line(self.line);
        SceneError::Malformed { file: self.name.to_string(), place, problem: problem.into() }
    }
}

/// What follows a keyword, which may hold spaces.
pub(super) fn text_after(line: &[u8], keyword: &[u8]) -> String {
    let rest = line.trim_ascii_start().strip_prefix(keyword).unwrap_or_default();
    String::from_utf8_lossy(rest.trim_ascii()).into_owned()
}
