//! How far a visibility image is from the truth: error metrics and heat maps. Pure functions, no files.
//!
//! Visibility is the fraction of the light's area that a pixel sees: 1 lit, 0 umbra. Only *valid* pixels count;
//! background and receivers whose geometric normal turns away from the light are left out by the caller's mask.
//!
//! ```
//! use antumbra_metrics::{Image, metrics};
//!
//! let truth = [1.0, 0.5, 0.0, 1.0];
//! let test = [1.0, 0.7, 0.0, 1.0];
//! let f = metrics(Image::new(2, 2, &test)?, Image::new(2, 2, &truth)?, &[true; 4])?;
//! assert!((f.average_error - 0.1).abs() < 1e-6); // 0.2 over the two shadowed pixels
//! # Ok::<(), antumbra_metrics::MetricsError>(())
//! ```

mod heat;
mod image;
mod metrics;
#[cfg(feature = "perceptual")]
mod perceptual;

pub use heat::{HEAT_SCALE, INVALID_COLOR, color_bar, heat_color, heat_map};
pub use image::{Image, MetricsError, RgbImage, Role};
pub use metrics::{Counts, ErrorMetrics, LIT_ABOVE, UMBRA_BELOW, error_metrics};
#[cfg(feature = "perceptual")]
pub use metrics::{Metrics, metrics};
