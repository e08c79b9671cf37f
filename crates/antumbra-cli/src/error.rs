//! What can go wrong, and with which exit code the program then ends.

use crate::report::ReportError;
use antumbra_metrics::MetricsError;
use antumbra_reference::ReferenceError;
use antumbra_scene::SceneError;
use std::io;
use std::path::PathBuf;

/// Why a command did not do what it was asked to.
#[derive(Debug, thiserror::Error)]
pub enum CliError {
    /// An output that could not be written even if the work were done.
    #[error("cannot write {}: {why}", path.display())]
    Unwritable {
        /// The file or folder.
        path: PathBuf,
        /// What is in the way, and the way out.
        why: String,
    },
    /// No scene.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The library refused or failed.
    #[error(transparent)]
    Gpu(#[from] antumbra::Error),
    /// No window.
    #[cfg(feature = "viewer")]
    #[error(transparent)]
    Window(#[from] antumbra_viewer::WindowError),
    /// No truth.
    #[error(transparent)]
    Reference(#[from] ReferenceError),
    /// A technique's result that cannot be compared.
    #[error("{spec}: {source}")]
    Metrics {
        /// The technique as it was given.
        spec: String,
        /// Why.
        source: MetricsError,
    },
    /// No report.
    #[error(transparent)]
    Report(#[from] ReportError),
    /// The work is done and its result is lost: the disk is full, the folder has gone.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// Ctrl-C.
    #[error("stopped; nothing unfinished was written")]
    Stopped,
}

impl CliError {
    /// 2 for bad input, 1 for a failure, 130 for Ctrl-C as shells have it.
    pub fn exit_code(&self) -> u8 {
        use antumbra::Error as E;
        match self {
            CliError::Stopped | CliError::Reference(ReferenceError::Cancelled) => 130,
            CliError::Unwritable { .. } | CliError::Scene(_) | CliError::Reference(_) => 2,
            CliError::Gpu(
                E::UnknownAdapter { .. } | E::Size { .. } | E::Spec(_) | E::Casters { .. } | E::Pattern { .. },
            ) => 2,
            CliError::Metrics { source: MetricsError::NothingValid, .. } => 2,
            #[cfg(feature = "viewer")]
            CliError::Window(_) => 1,
            CliError::Gpu(_) | CliError::Metrics { .. } | CliError::Report(_) | CliError::Write { .. } => 1,
        }
    }
}
