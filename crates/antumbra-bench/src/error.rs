//! Failures of a measurement.

use crate::page::files::ReportError;
use antumbra::error::SpecError;
use antumbra_metrics::MetricsError;
use antumbra_reference::ReferenceError;
use antumbra_scene::SceneError;

/// Why a measurement or its report failed.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The scene cannot be loaded or built.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The rendering library refused or failed.
    #[error(transparent)]
    Gpu(#[from] antumbra::Error),
    /// The reference cannot be traced.
    #[error(transparent)]
    Reference(#[from] ReferenceError),
    /// A technique's result cannot be compared.
    #[error("{spec}: {source}")]
    Metrics {
        /// The technique's SPEC.
        spec: String,
        /// The reason.
        source: MetricsError,
    },
    /// The report cannot be written.
    #[error(transparent)]
    Report(#[from] ReportError),
    /// The user has asked for a stop.
    #[error("stopped; nothing unfinished was written")]
    Stopped,
}

impl From<SpecError> for Error {
    fn from(error: SpecError) -> Error {
        Error::Gpu(error.into())
    }
}
