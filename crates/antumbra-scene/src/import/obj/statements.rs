//! Statements of an OBJ file, read and checked.

use crate::import::text;
use crate::import::warnings::Warnings;
use crate::{Place, SceneError};
use glam::{DVec3, Vec2};
use indexmap::IndexSet;
use std::ops::Range;

/// Geometry of an OBJ file; every index is in range.
#[derive(Default)]
pub(super) struct Statements {
    pub positions: Vec<DVec3>,
    pub uvs: Vec<Vec2>,
    /// Corners of all faces, one face after the other.
    pub corners: Vec<Corner>,
    pub faces: Vec<Face>,
    /// Names after `usemtl`; the first is "" for faces before any.
    pub materials: IndexSet<String>,
    /// Text after each `mtllib`.
    pub libraries: Vec<String>,
}

/// Corner of a face: indices into [`Statements::positions`] and [`Statements::uvs`].
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub(super) struct Corner {
    pub position: u32,
    pub uv: Option<u32>,
}

/// Polygon with three corners or more.
pub(super) struct Face {
    /// Range in [`Statements::corners`].
    pub corners: Range<usize>,
    /// Index into [`Statements::materials`].
    pub material: usize,
    line: usize,
}

pub(super) fn read(bytes: &[u8], name: &str) -> Result<Statements, SceneError> {
    let out = Statements { materials: IndexSet::from([String::new()]), ..Statements::default() };
    let skipped = Warnings::new(name);
    let mut reader = Reader { name, line: 0, out, material: 0, normals: 0, not_finite: Vec::new(), skipped };
    // A backslash at the end of a line continues the statement.
    let mut joined = Vec::new();
    for (number, line) in (1..).zip(text::plain(bytes).split(|&b| b == b'\n')) {
        if joined.is_empty() {
            reader.line = number;
        }
        let line = line.trim_ascii_end();
        if let Some(start) = line.strip_suffix(b"\\") {
            joined.extend([start, b" "].concat());
        } else if joined.is_empty() {
            reader.statement(line)?;
        } else {
            joined.extend(line);
            reader.statement(&joined)?;
            joined.clear();
        }
    }
    reader.statement(&joined)?;
    reader.check_indices()?;
    Ok(reader.out)
}

struct Reader<'a> {
    name: &'a str,
    line: usize,
    out: Statements,
    material: usize,
    normals: usize,
    /// Vertices that are no points, with their lines. Those that no face uses do no harm.
    not_finite: Vec<(u32, usize)>,
    skipped: Warnings<'a>,
}

impl Reader<'_> {
    fn statement(&mut self, line: &[u8]) -> Result<(), SceneError> {
        // A comment may follow numbers; names may hold a `#`.
        let numbers = line.split(|&b| b == b'#').next().unwrap_or_default();
        let mut words = numbers.split(|b| b.is_ascii_whitespace()).filter(|w| !w.is_empty());
        let Some(keyword) = words.next() else { return Ok(()) };
        let capitals = keyword.iter().any(u8::is_ascii_uppercase).then(|| keyword.to_ascii_lowercase());
        match capitals.as_deref().unwrap_or(keyword) {
            b"v" => self.position(words)?,
            b"vt" => {
                let [u, v] = [self.number(words.next())?, words.next().map_or(Ok(0.0), |w| self.number(Some(w)))?];
                // In OBJ v starts at the bottom of the image, here at the top.
                let uv = Vec2::new(u as f32, 1.0 - v as f32);
                self.out.uvs.push(if uv.is_finite() { uv } else { Vec2::ZERO });
            }
            b"vn" => self.normals += 1,
            b"f" | b"fo" => self.face(words)?,
            b"usemtl" => self.material = self.out.materials.insert_full(text_after(line, keyword)).0,
            b"mtllib" => self.out.libraries.push(text_after(line, keyword)),
            b"p" | b"l" => self.skip("points and lines cast no shadow and are left out"),
            b"curv" | b"curv2" | b"surf" => self.skip("free-form curves and surfaces are left out"),
            b"call" | b"csh" => self.skip("other files are not called; what they hold is left out"),
            b"usemap" => self.skip("usemap is not read; only the textures of materials are"),
            b"shadow_obj" => self.skip("shadow_obj is not read; the surfaces themselves cast the shadow"),
            _ => {}
        }
        Ok(())
    }

    fn skip(&mut self, message: &str) {
        self.skipped.add(format!("line {}", self.line), message);
    }

    fn position<'w>(&mut self, mut words: impl Iterator<Item = &'w [u8]>) -> Result<(), SceneError> {
        let mut next = || self.number(words.next());
        let position = DVec3::new(next()?, next()?, next()?);
        if !position.as_vec3().is_finite() {
            self.not_finite.push((self.out.positions.len() as u32, self.line));
        }
        self.out.positions.push(position);
        Ok(())
    }

    fn number(&self, word: Option<&[u8]>) -> Result<f64, SceneError> {
        let Some(word) = word else { return Err(self.malformed("a number is missing at the end of the line")) };
        let number = std::str::from_utf8(word).ok().and_then(|w| w.parse().ok());
        number.ok_or_else(|| self.malformed(format!("{:?} is not a number", shown(word))))
    }

    fn face<'w>(&mut self, words: impl Iterator<Item = &'w [u8]>) -> Result<(), SceneError> {
        let start = self.out.corners.len();
        for word in words {
            let corner = self.corner(word)?;
            self.out.corners.push(corner);
        }
        if self.out.corners.len() - start < 3 {
            self.out.corners.truncate(start);
            self.skip("faces with fewer than 3 corners are left out");
        } else {
            let corners = start..self.out.corners.len();
            self.out.faces.push(Face { corners, material: self.material, line: self.line });
        }
        Ok(())
    }

    /// Corner of a face: `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    fn corner(&self, word: &[u8]) -> Result<Corner, SceneError> {
        let mut parts = word.split(|&b| b == b'/');
        let position = parts.next().unwrap_or_default();
        let position = self.index(position, word, self.out.positions.len(), "vertices")?;
        let uv = match parts.next() {
            None | Some(b"") => None,
            Some(part) => Some(self.index(part, word, self.out.uvs.len(), "texture coordinates")?),
        };
        match parts.next() {
            None | Some(b"") => {}
            Some(part) => drop(self.index(part, word, self.normals, "normals")?),
        }
        if parts.next().is_some() {
            return Err(self.not_a_corner(word));
        }
        Ok(Corner { position, uv })
    }

    /// Index from 0. The range of an index that counts from the first is checked at the end of the file, since faces
    /// may precede vertices.
    fn index(&self, part: &[u8], word: &[u8], count: usize, what: &'static str) -> Result<u32, SceneError> {
        let text = std::str::from_utf8(part).map_err(|_| self.not_a_corner(word))?;
        let index: i64 = text.parse().map_err(|_| self.not_a_corner(word))?;
        let from_zero = if index < 0 { count as i64 + index } else { index - 1 };
        u32::try_from(from_zero).map_err(|_| self.out_of_range(self.line, index, count, what))
    }

    fn check_indices(&self) -> Result<(), SceneError> {
        let Statements { positions, uvs, corners, faces, .. } = &self.out;
        for face in faces {
            let check = |index: u32, count: usize, what| {
                let out_of_range = || self.out_of_range(face.line, i64::from(index) + 1, count, what);
                if (index as usize) < count { Ok(()) } else { Err(out_of_range()) }
            };
            for corner in &corners[face.corners.clone()] {
                check(corner.position, positions.len(), "vertices")?;
                self.check_finite(corner.position)?;
                corner.uv.map_or(Ok(()), |uv| check(uv, uvs.len(), "texture coordinates"))?;
            }
        }
        Ok(())
    }

    fn check_finite(&self, vertex: u32) -> Result<(), SceneError> {
        let Ok(at) = self.not_finite.binary_search_by_key(&vertex, |&(v, _)| v) else { return Ok(()) };
        Err(SceneError::NotFinite {
            file: self.name.to_string(),
            place: Place::Line(self.not_finite[at].1),
            vertex: vertex as usize,
            position: self.out.positions[vertex as usize].as_vec3().to_array(),
        })
    }

    fn out_of_range(&self, line: usize, index: i64, count: usize, what: &'static str) -> SceneError {
        SceneError::IndexOutOfRange { file: self.name.to_string(), place: Place::Line(line), index, count, what }
    }

    fn not_a_corner(&self, word: &[u8]) -> SceneError {
        self.malformed(format!("{:?} is not a corner of a face, which reads like 7, 7/3, 7//2 or 7/3/2", shown(word)))
    }

    fn malformed(&self, problem: impl Into<String>) -> SceneError {
        let place = Place::Line(self.line);
        SceneError::Malformed { file: self.name.to_string(), place, problem: problem.into() }
    }
}

/// A word for a message.
fn shown(word: &[u8]) -> String {
    text::shortened(&String::from_utf8_lossy(word)).into_owned()
}

/// Name after the keyword at the start of a line. It may hold spaces, and `#`, unless that begins a comment and stands
/// alone: `Material #25` is a name.
pub(super) fn text_after(line: &[u8], keyword: &[u8]) -> String {
    let text = line.trim_ascii_start().strip_prefix(keyword).unwrap_or_default().trim_ascii();
    let is_space = |i: usize| text.get(i).is_none_or(u8::is_ascii_whitespace);
    let comment = (1..text.len()).find(|&i| text[i] == b'#' && is_space(i - 1) && is_space(i + 1));
    String::from_utf8_lossy(text[..comment.unwrap_or(text.len())].trim_ascii()).into_owned()
}
