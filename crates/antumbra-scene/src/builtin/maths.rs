//! Placement, trigonometry and chance that give the same scene on every machine.

use glam::{Affine3A, Mat3, Vec2, Vec3};

/// Full turn in radians.
pub(super) const TURN: f32 = std::f32::consts::TAU;

/// Sine by way of double precision: math libraries disagree in the last bit, which rounding then removes.
pub(super) fn sin(angle: f32) -> f32 {
    f64::from(angle).sin() as f32
}

/// Cosine, rounded as [`sin`] is.
pub(super) fn cos(angle: f32) -> f32 {
    f64::from(angle).cos() as f32
}

/// Point on the unit circle.
pub(super) fn on_circle(angle: f32) -> Vec2 {
    Vec2::new(cos(angle), sin(angle))
}

/// `x` to the power of `exponent`, rounded as [`sin`] is.
pub(super) fn power(x: f32, exponent: f32) -> f32 {
    f64::from(x).powf(f64::from(exponent)) as f32
}

/// From `a` to `b` as `t` goes from 0 to 1.
pub(super) fn mix(a: f32, b: f32, t: f32) -> f32 {
    a + (b - a) * t
}

/// 0 below `a`, 1 above `b`, smooth between.
pub(super) fn smoothstep(a: f32, b: f32, x: f32) -> f32 {
    let t = ((x - a) / (b - a)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// `count` numbers from `a` to `b`, both included.
pub(super) fn steps(a: f32, b: f32, count: usize) -> impl ExactSizeIterator<Item = f32> + Clone {
    (0..count).map(move |i| mix(a, b, i as f32 / (count - 1).max(1) as f32))
}

/// Where a shape is placed: axes (columns) and origin, in plain scalar arithmetic.
#[derive(Clone, Copy)]
pub(super) struct Frame {
    pub axes: Mat3,
    pub origin: Vec3,
}

impl Frame {
    pub const IDENTITY: Frame = Frame { axes: Mat3::IDENTITY, origin: Vec3::ZERO };

    /// Moved to a point.
    pub fn at(x: f32, y: f32, z: f32) -> Frame {
        Frame { axes: Mat3::IDENTITY, origin: Vec3::new(x, y, z) }
    }

    /// At `origin` with +Y along `direction`, turned about it in whatever way.
    pub fn along(origin: Vec3, direction: Vec3) -> Frame {
        let y = direction.normalize();
        let (x, z) = across(y);
        Frame { axes: Mat3::from_cols(x, y, z), origin }
    }

    /// Turned about its own Y axis, counter-clockwise seen from above.
    pub fn yaw(self, angle: f32) -> Frame {
        let (c, s) = (cos(angle), sin(angle));
        let turn = Mat3::from_cols(Vec3::new(c, 0.0, -s), Vec3::Y, Vec3::new(s, 0.0, c));
        Frame { axes: self.axes * turn, ..self }
    }

    /// Turned about its own X axis: +Y goes towards +Z.
    pub fn pitch(self, angle: f32) -> Frame {
        let (c, s) = (cos(angle), sin(angle));
        let turn = Mat3::from_cols(Vec3::X, Vec3::new(0.0, c, s), Vec3::new(0.0, -s, c));
        Frame { axes: self.axes * turn, ..self }
    }

    /// Turned about its own Z axis: +X goes towards +Y.
    pub fn roll(self, angle: f32) -> Frame {
        let (c, s) = (cos(angle), sin(angle));
        let turn = Mat3::from_cols(Vec3::new(c, s, 0.0), Vec3::new(-s, c, 0.0), Vec3::Z);
        Frame { axes: self.axes * turn, ..self }
    }

    /// Scaled alike in every direction.
    pub fn scale(self, factor: f32) -> Frame {
        Frame { axes: self.axes * factor, ..self }
    }

    /// Moved along its own axes.
    pub fn shift(self, x: f32, y: f32, z: f32) -> Frame {
        Frame { origin: self.point(Vec3::new(x, y, z)), ..self }
    }

    /// A point of this frame in the frame that it stands in.
    pub fn point(&self, p: Vec3) -> Vec3 {
        self.origin + self.axes.x_axis * p.x + self.axes.y_axis * p.y + self.axes.z_axis * p.z
    }

    /// As an instance's transform.
    pub fn affine(&self) -> Affine3A {
        Affine3A::from_mat3_translation(self.axes, self.origin)
    }
}

/// Two unit vectors that make a right-handed frame (first, `unit`, second).
pub(super) fn across(unit: Vec3) -> (Vec3, Vec3) {
    let helper = if unit.y.abs() < 0.9 { Vec3::Y } else { Vec3::X };
    let z = helper.cross(unit).normalize();
    (unit.cross(z).normalize(), z)
}

/// A small random number generator (splitmix64) whose sequence never changes.
pub(super) struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Random {
        Random(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ 0x5851_f42d_4c95_7f2d)
    }

    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in [0, 1).
    pub fn unit(&mut self) -> f32 {
        (self.bits() >> 40) as f32 / (1u64 << 24) as f32
    }

    /// Uniform in [a, b).
    pub fn between(&mut self, a: f32, b: f32) -> f32 {
        mix(a, b, self.unit())
    }

    /// Uniform in 0..n.
    pub fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }

    /// Uniform in the cube [-1, 1)³.
    pub fn cube(&mut self) -> Vec3 {
        Vec3::new(self.between(-1.0, 1.0), self.between(-1.0, 1.0), self.between(-1.0, 1.0))
    }

    /// Uniform direction.
    pub fn direction(&mut self) -> Vec3 {
        let y = self.between(-1.0, 1.0);
        let c = on_circle(self.between(0.0, TURN)) * (1.0 - y * y).max(0.0).sqrt();
        Vec3::new(c.x, y, c.y)
    }
}
