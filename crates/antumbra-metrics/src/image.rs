//! Images, and their errors.

use std::fmt;

/// Rounding that a half-precision texture or a sum of weights may leave outside of [0, 1]; clamped, not refused.
const RANGE_SLACK: f32 = 1e-3;

/// A borrowed visibility image: row-major, row 0 on top, one value in [0, 1] a pixel.
#[derive(Clone, Copy, Debug)]
pub struct Image<'a> {
    width: u32,
    height: u32,
    data: &'a [f32],
}

impl<'a> Image<'a> {
    /// Borrows `width * height` values; both sizes are at least 1.
    pub fn new(width: u32, height: u32, data: &'a [f32]) -> Result<Self, MetricsError> {
        let expected = width as usize * height as usize;
        match expected {
            0 => Err(MetricsError::Empty { width, height }),
            _ if data.len() != expected => Err(MetricsError::Length { width, height, len: data.len() }),
            _ => Ok(Self { width, height, data }),
        }
    }

    /// Width in pixels.
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height in pixels.
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The values, row by row from the top.
    pub fn data(&self) -> &'a [f32] {
        self.data
    }
}

/// An owned image of 8-bit sRGB triples: row-major, row 0 on top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RgbImage {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// `width * height * 3` bytes.
    pub data: Vec<u8>,
}

/// Which of the two images an error is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// The image that is judged.
    Test,
    /// The image that it is judged by.
    Truth,
}

impl fmt::Display for Role {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Role::Test => "tested visibility",
            Role::Truth => "true visibility",
        })
    }
}

/// Why two images cannot be compared.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MetricsError {
    /// An image without pixels.
    #[error("an image of {width} x {height} has no pixels to compare")]
    Empty {
        /// Width in pixels.
        width: u32,
        /// Height in pixels.
        height: u32,
    },
    /// The values do not fill the size.
    #[error("an image of {width} x {height} needs {} values, but {len} were given", *width as u64 * *height as u64)]
    Length {
        /// Width in pixels.
        width: u32,
        /// Height in pixels.
        height: u32,
        /// Values given.
        len: usize,
    },
    /// Two images of different sizes.
    #[error(
        "the tested visibility is {} x {}, the true one {} x {}: render both at the same size",
        test.0, test.1, truth.0, truth.1
    )]
    SizeMismatch {
        /// Width and height of the tested image, pixels.
        test: (u32, u32),
        /// Width and height of the truth, pixels.
        truth: (u32, u32),
    },
    /// The mask has another size than the images.
    #[error("the mask of valid pixels has {len} entries, the images have {expected} pixels")]
    MaskLength {
        /// Entries of the mask.
        len: usize,
        /// Pixels of the images.
        expected: usize,
    },
    /// No pixel may be compared.
    #[error("no pixel is valid: nothing in view faces the light, so move the camera or the light")]
    NothingValid,
    /// NaN, infinite or outside of [0, 1].
    #[error("the {role} at pixel ({x}, {y}) is {value}, not a number in [0, 1]")]
    Value {
        /// The image at fault.
        role: Role,
        /// Column, from the left.
        x: u32,
        /// Row, from the top.
        y: u32,
        /// Number of values.
        value: f32,
    },
}

/// Checked copies of both images, clamped to [0, 1], the truth put in where `valid` is false in *both*, so that
/// filters which look at neighbours find no difference there.
pub(crate) struct Pair {
    pub width: u32,
    pub height: u32,
    pub test: Vec<f32>,
    pub truth: Vec<f32>,
}

impl Pair {
    pub fn new(test: Image, truth: Image, valid: &[bool]) -> Result<Self, MetricsError> {
        let (width, height) = (truth.width, truth.height);
        if (test.width, test.height) != (width, height) {
            return Err(MetricsError::SizeMismatch { test: (test.width, test.height), truth: (width, height) });
        }
        if valid.len() != truth.data.len() {
            return Err(MetricsError::MaskLength { len: valid.len(), expected: truth.data.len() });
        }
        if !valid.contains(&true) {
            return Err(MetricsError::NothingValid);
        }
        let truth = checked(truth, valid, Role::Truth)?;
        let mut test = checked(test, valid, Role::Test)?;
        for ((test, truth), _) in test.iter_mut().zip(&truth).zip(valid).filter(|(_, valid)| !**valid) {
            *test = *truth;
        }
        Ok(Self { width, height, test, truth })
    }
}

/// Clamped values; invalid pixels may hold anything; NaN becomes lit.
fn checked(image: Image, valid: &[bool], role: Role) -> Result<Vec<f32>, MetricsError> {
    let check = |(i, (&value, &valid)): (usize, (&f32, &bool))| {
        if (-RANGE_SLACK..=1.0 + RANGE_SLACK).contains(&value) {
            Ok(value.clamp(0.0, 1.0))
        } else if valid {
            let (x, y) = (i as u32 % image.width, i as u32 / image.width);
            Err(MetricsError::Value { role, x, y, value })
        } else {
            Ok(1.0)
        }
    };
    image.data.iter().zip(valid).enumerate().map(check).collect()
}
