//! Promises that every built-in scene keeps.
