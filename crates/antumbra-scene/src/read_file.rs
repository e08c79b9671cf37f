//! Access to files, for importers that run where there is no disk.

/// Gives the bytes of a file by its path, or by the name of a file where there is no disk.
pub type ReadFile<'a> = dyn FnMut(&str) -> std::io::Result<Vec<u8>> + 'a;
