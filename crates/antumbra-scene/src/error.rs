//! Errors of scenes.

use std::fmt;

/// Why there is no scene: the file, the place in it, and where the message can tell, the way out.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// The scene argument names nothing that can be read.
    #[error("`{argument}`: {message}")]
    Argument {
        /// The argument.
        argument: String,
        /// The error, and a right form.
        message: String,
    },
    /// A built-in scene's name or one of its parameters is wrong.
    #[error("`builtin:{spec}`: {message}")]
    Builtin {
        /// The part after `builtin:`.
        spec: String,
        /// The error, and a right form.
        message: String,
    },
    /// A file, or one that it refers to, cannot be read.
    #[error("cannot read {file}: {source}{}", from_whom(.referrer))]
    Read {
        /// The file that could not be read.
        file: String,
        /// The file that refers to it, if it was not named by the user.
        referrer: Option<String>,
        /// The operating system's message.
        source: std::io::Error,
    },
    /// The file does not follow its format.
    #[error("{file}{place}: {problem}")]
    Malformed {
        /// The file's name.
        file: String,
        /// Where in the file.
        place: Place,
        /// The error, and the expected content.
        problem: String,
    },
    /// The file follows its format and uses a part of it that is not read here.
    #[error("{file}{place}: {feature} is not supported; {advice}")]
    Unsupported {
        /// The file's name.
        file: String,
        /// Where in the file.
        place: Place,
        /// The unsupported feature.
        feature: String,
        /// A workaround.
        advice: String,
    },
    /// A vertex is not a point.
    #[error("{file}{place}: vertex {vertex} is at {position:?}; coordinates must be finite, export the model again")]
    NotFinite {
        /// The file's name.
        file: String,
        /// Where in the file.
        place: Place,
        /// Number of the vertex, from 0.
        vertex: usize,
        /// The value in the file.
        position: [f32; 3],
    },
    /// A vertex is too far away to be rendered in single precision.
    #[error(
        "{file}, mesh {mesh:?}: vertex {vertex} comes to lie at {position:?}; coordinates must stay within 1e9 metres, \
         scale the model down"
    )]
    TooFar {
        /// The file's name.
        file: String,
        /// The mesh's name.
        mesh: String,
        /// Number of the vertex in the mesh, from 0.
        vertex: usize,
        /// Where it is in the world.
        position: [f32; 3],
    },
    /// A triangle uses a vertex that is not there.
    #[error("{file}{place}: index {index} is out of range, there are {count} {what}")]
    IndexOutOfRange {
        /// The file's name.
        file: String,
        /// Where in the file.
        place: Place,
        /// The index as the file gives it.
        index: i64,
        /// How many there are.
        count: usize,
        /// The counted objects, in the plural.
        what: &'static str,
    },
    /// The file says that it holds more than it does.
    #[error(
        "{file}{place}: {what} needs {needed} bytes and only {available} are there; the file is damaged or cut off"
    )]
    Truncated {
        /// The file's name.
        file: String,
        /// Where in the file.
        place: Place,
        /// The sizes that do not fit.
        what: String,
        /// Bytes that the claim needs.
        needed: u128,
        /// Bytes that are there.
        available: usize,
    },
    /// Nothing in the file can be drawn.
    #[error("{file}: there are no triangles in it; {advice}")]
    NoTriangles {
        /// The file's name.
        file: String,
        /// The usual cause.
        advice: String,
    },
}

fn from_whom(referrer: &Option<String>) -> String {
    referrer.as_ref().map_or(String::new(), |r| format!(" ({r} refers to it)"))
}

/// A place in a file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Place {
    /// The file as a whole.
    #[default]
    Whole,
    /// A line, counted from 1.
    Line(usize),
    /// A line and a column, counted from 1.
    LineColumn(usize, usize),
    /// An offset in bytes, from 0.
    Byte(usize),
    /// A part with a name: `mesh 2 "roof", primitive 0`, or a key such as `light.size`.
    Part(String),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Place::Whole => Ok(()),
            Place::Line(line) => write!(f, ", line {line}"),
            Place::LineColumn(line, column) => write!(f, ", line {line}, column {column}"),
            Place::Byte(byte) => write!(f, ", byte {byte}"),
            Place::Part(part) => write!(f, ", {part}"),
        }
    }
}
