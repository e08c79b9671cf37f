//! Building blocks of the HTML pages: frame, plots, images, number formats, files.

mod axes;
pub mod files;
pub mod frame;
pub mod images;
pub mod lines;
pub mod scatter;
pub mod text;
