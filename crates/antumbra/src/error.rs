//! What can go wrong, said once.

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
    #[error("the GPU is out of memory: {0}; a smaller `map` or image needs less")]
    OutOfMemory(String),
    /// A bug of ours.
    #[error("GPU validation failed, which is a bug in antumbra: {0}")]
    Validation(String),
    /// A pass that does not bind a resource of its shader.
    #[error("{shader}: nothing is bound to `{name}`")]
    MissingBinding {
        /// The shader's module.
        shader: &'static str,
        /// The resource.
        name: String,
    },
    /// A pass that binds a name that no variant of its shader declares.
    #[error("{shader}: no variant of the shader declares `{name}`, which is bound")]
    UnknownBinding {
        /// The shader's module.
        shader: &'static str,
        /// The name.
        name: &'static str,
    },
    /// A bug of ours.
    #[error(transparent)]
    Shader(#[from] ShaderError),
    /// An image or map that the device cannot hold.
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
    Spec(#[from] SpecError),
    /// Textures or matrices of a frame that do not go together.
    #[error("frame: {0}")]
    Frame(String),
    /// A mesh whose buffers cannot be used.
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

/// A shader that does not compose or does not validate. The message holds the place in the source.
#[derive(Debug, thiserror::Error)]
#[error("shader {module}: {message}")]
pub struct ShaderError {
    /// The module that was composed.
    pub module: String,
    /// What is wrong, with an excerpt.
    pub message: String,
}

/// A SPEC that cannot be read.
#[derive(Debug, PartialEq, thiserror::Error)]
pub enum SpecError {
    /// No such technique.
    #[error("unknown technique `{asked}`{}; `antumbra techniques` lists them", did_you_mean(.nearest))]
    UnknownTechnique {
        /// As given.
        asked: String,
        /// The most similar name.
        nearest: Option<&'static str>,
    },
    /// No such setting.
    #[error("technique `{technique}` has no setting `{key}`{}; its settings are: {}", did_you_mean(.nearest), .known.join(", "))]
    UnknownKey {
        /// The technique.
        technique: String,
        /// As given.
        key: String,
        /// The most similar key.
        nearest: Option<&'static str>,
        /// All keys.
        known: Vec<&'static str>,
    },
    /// A key given twice.
    #[error("technique `{technique}`: `{key}` is set twice")]
    Twice {
        /// The technique.
        technique: String,
        /// The key.
        key: String,
    },
    /// Not `key=value`.
    #[error("technique `{technique}`: `{part}` is not of the form key=value")]
    Form {
        /// The technique.
        technique: String,
        /// As given.
        part: String,
    },
    /// A value that the setting does not take.
    #[error("technique `{technique}`: `{key}={value}`: {expected}")]
    Value {
        /// The technique.
        technique: String,
        /// The key.
        key: String,
        /// As given.
        value: String,
        /// What it takes.
        expected: String,
    },
}

fn did_you_mean(nearest: &Option<&'static str>) -> String {
    nearest.map_or(String::new(), |n| format!(" (did you mean `{n}`?)"))
}
