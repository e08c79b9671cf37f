//! What can be wrong with a scene that someone asked for.

/// Why a scene could not be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// The SPEC of a built-in scene is wrong.
    #[error("builtin:{spec}: {message}")]
    Builtin {
        /// What followed `builtin:`.
        spec: String,
        /// What is wrong with it and what would be right.
        message: String,
    },
}
