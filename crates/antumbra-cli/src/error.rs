//! Failures of a command and the exit codes of the program.

use antumbra_bench::Error;
use antumbra_metrics::MetricsError;
use antumbra_reference::ReferenceError;
use std::io;
use std::path::PathBuf;

/// Why a command failed.
#[derive(Debug, thiserror::Error)]
pub enum CliError {
    /// An output cannot be written, as a check before the work found.
    #[error("cannot write {}: {why}", path.display())]
    Unwritable {
        /// The file or folder.
        path: PathBuf,
        /// The reason and the remedy.
        why: String,
    },
    /// Loading, rendering, tracing or measuring failed.
    #[error(transparent)]
    Bench(#[from] Error),
    /// The window failed.
    #[cfg(feature = "viewer")]
    #[error(transparent)]
    Window(#[from] antumbra_viewer::WindowError),
    /// The result of the work cannot be written: the disk is full, the folder was removed.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
}

impl CliError {
    /// 2 for bad input, 1 for a failure, 130 for Ctrl-C as in shells.
    pub fn exit_code(&self) -> u8 {
        use antumbra::Error as E;
        match self {
            CliError::Bench(Error::Stopped | Error::Reference(ReferenceError::Cancelled)) => 130,
            CliError::Unwritable { .. } | CliError::Bench(Error::Scene(_) | Error::Reference(_)) => 2,
            CliError::Bench(Error::Gpu(
                E::UnknownAdapter { .. } | E::Size { .. } | E::Spec(_) | E::Casters { .. } | E::Pattern { .. },
            )) => 2,
            CliError::Bench(Error::Metrics { source: MetricsError::NothingValid, .. }) => 2,
            #[cfg(feature = "viewer")]
            CliError::Window(_) => 1,
            CliError::Bench(_) | CliError::Write { .. } => 1,
        }
    }
}
