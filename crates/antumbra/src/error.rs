//! What can go wrong, said once.

use crate::shader::ShaderError;

/// An error of the library. Each message says what to do.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// No driver at all.
    #[error(
        "no graphics adapter was found: install a Vulkan driver (on Debian and Ubuntu: mesa-vulkan-drivers, which needs no GPU)"
    )]
    NoAdapter,
    /// `--adapter` names none of them.
    #[error("there is no adapter `{asked}`; the adapters are: {}", .known.join(", "))]
    UnknownAdapter {
        /// Name or index as given.
        asked: String,
        /// Names of what there is.
        known: Vec<String>,
    },
    /// The adapter refused.
    #[error("the adapter {adapter} gives no device: {message}")]
    Device {
        /// Its name.
        adapter: String,
        /// Its reason.
        message: String,
    },
    /// The device went away.
    #[error("the GPU device was lost: {0}")]
    Lost(String),
    /// In a browser nobody waits for the GPU.
    #[error("this reads from the GPU in the middle of a frame, which a browser does not allow")]
    CannotWait,
    /// A shader needs more of something than the device gives.
    #[error("{shader} needs {needed} {what} in one shader, and this adapter gives {given}")]
    Limit {
        /// The shader's module.
        shader: &'static str,
        /// What there are too few of.
        what: &'static str,
        /// How many it needs.
        needed: u32,
        /// How many there are.
        given: u32,
    },
    /// The device has no memory left.
    #[error("the GPU is out of memory: {0}; a smaller `map` or picture needs less")]
    OutOfMemory(String),
    /// A bug of ours.
    #[error("GPU validation failed, which is a bug in antumbra: {0}")]
    Validation(String),
    /// A bug of ours.
    #[error(transparent)]
    Shader(#[from] ShaderError),
    /// A picture or map that the device cannot hold.
    #[error("{what}: {width} x {height} is outside of 1 to {max}, the largest texture of this adapter")]
    Size {
        /// Picture, shadow map, ...
        what: &'static str,
        /// Texels.
        width: u32,
        /// Texels.
        height: u32,
        /// The device's limit.
        max: u32,
    },
    /// A texture format that a setting asks for and the device lacks.
    #[error("this adapter cannot store `format={format}`; {instead} works on every adapter")]
    Format {
        /// As in the setting.
        format: &'static str,
        /// What to set instead.
        instead: &'static str,
    },
    /// A technique SPEC that cannot be read.
    #[error(transparent)]
    Spec(#[from] crate::settings::SpecError),
    /// A mesh that cannot be borrowed.
    #[error("mesh {mesh}: {message}")]
    Casters {
        /// Its place in the list.
        mesh: usize,
        /// What is wrong and what would be right.
        message: String,
    },
    /// A pattern of samples that cannot be used.
    #[error("`points`: {message}")]
    Pattern {
        /// What is wrong and what would be right.
        message: String,
    },
}
