//! The input of every technique: view, light, casters, geometry buffer; and its output, the visibility.

use super::casters::Casters;
use super::frustum::ShadowFrustum;
use crate::error::Error;
use crate::gpu::bindings::Binding;
use crate::gpu::device::Gpu;
use crate::gpu::recorder::Recorder;
use crate::{binding_array, gpu_struct};
use antumbra_scene::{Camera, RectLight};
use glam::{DMat4, DVec4, Mat3, Mat4, UVec2, Vec2, Vec3};
use std::ops::Deref;
use std::sync::{Arc, Weak};

/// The camera as matrices.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// View to clip space; reversed depth in [0, 1].
    pub clip_from_view: Mat4,
    /// World to view space: a rotation and a translation.
    pub view_from_world: Mat4,
}

impl View {
    /// The view of a camera for an image of `width` x `height` pixels.
    pub fn of_camera(camera: &Camera, size: [u32; 2]) -> View {
        let aspect = size[0] as f32 / size[1] as f32;
        View { clip_from_view: camera.clip_from_view(aspect), view_from_world: camera.view_from_world() }
    }

    /// World to clip space.
    pub fn clip_from_world(&self) -> Mat4 {
        (self.clip_from_view.as_dmat4() * self.view_from_world.as_dmat4()).as_mat4()
    }

    /// Position of the eye in world space.
    pub fn eye(&self) -> Vec3 {
        self.view_from_world.as_dmat4().inverse().w_axis.truncate().as_vec3()
    }
}

gpu_struct! {
    /// The uniform of `shaders/frame.wesl`.
    pub(crate) struct FrameUniform {
        light_from_clip: Mat4,
        light_from_world: Mat3,
        /// Eye in light space.
        eye_ls: Vec3,
        /// Depth range of the map's frustum starts here, metres.
        map_near: f32,
        /// Half the light's edges, metres.
        half_light: Vec2,
        /// Half the opening of the map's frustum, as tangents.
        tan_half: Vec2,
        /// Pixels.
        size: UVec2,
        /// How far a reconstructed position may be off, metres.
        position_error: f32,
        /// The same for each metre of distance from the eye.
        position_error_per_metre: f32,
        /// How far a normal may be off, radians.
        normal_error: f32,
    }
}

/// The input of a [`Frame`] and the texture that it fills. Sizes and formats are found from the textures.
#[derive(Clone, Copy)]
pub struct FrameDescriptor<'a> {
    /// Camera.
    pub view: View,
    /// Light.
    pub light: RectLight,
    /// Shadow casters.
    pub casters: &'a Arc<Casters>,
    /// Reversed depth in a depth format; 0 where there is nothing.
    pub depth: &'a wgpu::TextureView,
    /// Geometric normals in world space, turned to the camera, in xyz of any float format; the size of `depth`.
    pub normals: &'a wgpu::TextureView,
    /// The result, visible fraction of the light: `R32Float` with `STORAGE_BINDING`, the size of `depth`.
    pub visibility: &'a wgpu::TextureView,
}

impl FrameDescriptor<'_> {
    /// Size of the image in pixels, if the textures go together.
    fn size(&self, gpu: &Gpu) -> Result<[u32; 2], Error> {
        let size = size_of(self.depth);
        gpu.check_size("image", size[0], size[1])?;
        for (name, view) in [("normals", self.normals), ("visibility", self.visibility)] {
            if size_of(view) != size {
                let [width, height] = size_of(view);
                let message = format!("`{name}` is {width} x {height}, `depth` is {} x {}", size[0], size[1]);
                return Err(Error::Frame(message));
            }
        }
        let checks = [
            ("depth", self.depth, self.depth.texture().format().has_depth_aspect(), "a format with depth"),
            (
                "visibility",
                self.visibility,
                self.visibility.texture().format() == wgpu::TextureFormat::R32Float,
                "R32Float",
            ),
        ];
        if let Some((name, view, _, wanted)) = checks.into_iter().find(|(_, _, fits, _)| !fits) {
            return Err(Error::Frame(format!("`{name}` is {:?} where {wanted} is needed", view.texture().format())));
        }
        Ok(size)
    }
}

fn size_of(view: &wgpu::TextureView) -> [u32; 2] {
    [view.texture().width(), view.texture().height()]
}

/// The angle in radians by which rounding to a texture format may turn a normal.
pub fn normal_error(format: wgpu::TextureFormat) -> f32 {
    use wgpu::TextureFormat as F;
    match format {
        F::Rgba32Float => 2.4e-7,
        F::Rgba16Float => 9.8e-4,
        F::Rgba16Snorm => 6.1e-5,
        F::Rgb10a2Unorm => 2.0e-3,
        _ => 1.4e-2,
    }
}

/// The input of a frame. Kept from frame to frame; [`Frame::update`] moves camera and light.
#[derive(Clone)]
pub struct Frame {
    /// Camera.
    pub view: View,
    /// Light.
    pub light: RectLight,
    /// The frustum of shadow maps from the light's centre.
    pub frustum: ShadowFrustum,
    /// Geometry.
    pub casters: Arc<Casters>,
    /// True if no caster has moved since the last frame: techniques may then keep maps that they have drawn. False, the
    /// default, is always safe. The light and the camera may still move.
    pub static_casters: bool,
    /// Pixels along x and y.
    pub size: [u32; 2],
    depth: wgpu::TextureView,
    normals: wgpu::TextureView,
    visibility: wgpu::TextureView,
}

/// A frame with the buffer that shaders read it from, for the recording of one frame.
#[derive(Clone)]
pub struct BoundFrame {
    frame: Frame,
    uniform: wgpu::Buffer,
}

impl Deref for BoundFrame {
    type Target = Frame;

    fn deref(&self) -> &Frame {
        &self.frame
    }
}

impl Frame {
    /// A frame with a frustum around all casters.
    pub fn new(gpu: &Gpu, descriptor: &FrameDescriptor) -> Result<Frame, Error> {
        let FrameDescriptor { view, light, casters, depth, normals, visibility } = *descriptor;
        Ok(Frame {
            size: descriptor.size(gpu)?,
            view,
            light,
            frustum: ShadowFrustum::around(&light, &casters.bounds()),
            casters: casters.clone(),
            static_casters: false,
            depth: depth.clone(),
            normals: normals.clone(),
            visibility: visibility.clone(),
        })
    }

    /// Moves camera and light. The new values count for what is recorded after this call.
    pub fn update(&mut self, view: View, light: RectLight, frustum: ShadowFrustum) {
        (self.view, self.light, self.frustum) = (view, light, frustum);
    }

    /// The frame as shaders read it, in a buffer of the recorder's pool.
    ///
    /// # Errors
    /// If view, light or frustum hold what no shadow follows from: NaN, an infinity, a light without a direction.
    pub fn bind(&self, recorder: &mut Recorder) -> Result<BoundFrame, Error> {
        self.check()?;
        Ok(BoundFrame { uniform: recorder.uniform("frame", &self.uniform_value()), frame: self.clone() })
    }

    fn check(&self) -> Result<(), Error> {
        let Frame { view, light, frustum, .. } = self;
        let inverse = (view.clip_from_view.as_dmat4() * view.view_from_world.as_dmat4()).inverse();
        let checks = [
            (inverse.is_finite(), "`view` cannot be inverted: its matrices hold NaN, or an axis of length 0"),
            (light.center.is_finite() && light.target.is_finite(), "`light.center` or `light.target` is not finite"),
            (light.center != light.target, "`light.target` is `light.center`: the light faces nowhere"),
            (light.size.is_finite() && light.size.min_element() >= 0.0, "`light.size` must be finite and not below 0"),
            (
                frustum.tan_half.is_finite() && frustum.tan_half.min_element() > 0.0,
                "`frustum.tan_half` must be finite and above 0",
            ),
            (frustum.near.is_finite() && frustum.near > 0.0, "`frustum.near` must be finite and above 0"),
        ];
        match checks.into_iter().find(|(fits, _)| !fits) {
            Some((_, message)) => Err(Error::Frame(message.to_owned())),
            None => Ok(()),
        }
    }

    fn uniform_value(&self) -> FrameUniform {
        let light_from_world = light_from_world(&self.light);
        let world_from_clip = (self.view.clip_from_view.as_dmat4() * self.view.view_from_world.as_dmat4()).inverse();
        let eye = world_from_clip * DVec4::new(0.0, 0.0, 1.0, 0.0);
        let eye_ls = light_from_world * (eye / eye.w);
        let reach = self.light.center.abs().max_element().max((eye / eye.w).truncate().abs().max_element() as f32);
        FrameUniform {
            light_from_clip: (light_from_world * world_from_clip).as_mat4(),
            light_from_world: Mat3::from_mat4(light_from_world.as_mat4()),
            eye_ls: eye_ls.truncate().as_vec3(),
            map_near: self.frustum.near,
            half_light: self.light.size * 0.5,
            tan_half: self.frustum.tan_half,
            size: UVec2::from(self.size),
            position_error: reach * ULP,
            position_error_per_metre: 4.0 * ULP,
            normal_error: normal_error(self.normals.texture().format()),
        }
    }

    /// World to the clip space of a map from the light's centre: `w` is the distance z along the light's normal and the
    /// depth is `near / z`.
    pub fn map_clip_from_world(&self) -> Mat4 {
        let f = &self.frustum;
        let clip_from_light = DMat4::from_cols(
            DVec4::new(1.0 / f64::from(f.tan_half.x), 0.0, 0.0, 0.0),
            // Row 0 of a texture is at the top of clip space; rows of the map go along +y of light space.
            DVec4::new(0.0, -1.0 / f64::from(f.tan_half.y), 0.0, 0.0),
            DVec4::new(0.0, 0.0, 0.0, 1.0),
            DVec4::new(0.0, 0.0, f64::from(f.near), 0.0),
        );
        (clip_from_light * light_from_world(&self.light)).as_mat4()
    }
}

impl BoundFrame {
    /// The same frame with a point at the light's centre, for techniques of hard shadows that share the code of soft
    /// ones.
    pub(crate) fn with_point_light(&self, recorder: &mut Recorder) -> BoundFrame {
        let mut frame = self.frame.clone();
        frame.light.size = Vec2::ZERO;
        BoundFrame { uniform: recorder.uniform("changed frame", &frame.uniform_value()), frame }
    }

    /// The same frame seen by another view, with its depth and normals.
    pub(crate) fn with_view(
        &self,
        recorder: &mut Recorder,
        view: View,
        [depth, normals]: [&wgpu::TextureView; 2],
    ) -> BoundFrame {
        let frame = Frame { view, depth: depth.clone(), normals: normals.clone(), ..self.frame.clone() };
        BoundFrame { uniform: recorder.uniform("changed frame", &frame.uniform_value()), frame }
    }

    /// The resources of `shaders/frame.wesl`.
    pub fn bindings(&self) -> [Binding<'_>; 4] {
        binding_array! {
            frame: &self.uniform,
            geometry_depth: &self.depth,
            geometry_normal: &self.normals,
            visibility: &self.visibility,
        }
    }
}

/// The input that a map from the light depends on. Equal ones give equal maps while no caster moves.
#[derive(Clone, Debug)]
pub struct MapInput {
    light: RectLight,
    frustum: ShadowFrustum,
    casters: Weak<Casters>,
}

impl MapInput {
    /// The input of the maps of this frame.
    pub fn of(frame: &Frame) -> MapInput {
        MapInput { light: frame.light, frustum: frame.frustum, casters: Arc::downgrade(&frame.casters) }
    }
}

impl PartialEq for MapInput {
    fn eq(&self, other: &MapInput) -> bool {
        self.light == other.light && self.frustum == other.frustum && self.casters.ptr_eq(&other.casters)
    }
}

/// A unit in the last place of a 32-bit float near 1, doubled for the rounding of the arithmetic after it.
const ULP: f32 = 2.4e-7;

/// World to light space in double precision: far from the origin the rounding of single precision would be visible.
pub(crate) fn light_from_world(light: &RectLight) -> DMat4 {
    let (right, up, forward) = light.basis();
    let (right, up, forward) = (right.as_dvec3(), up.as_dvec3(), forward.as_dvec3());
    let center = light.center.as_dvec3();
    DMat4::from_cols(
        DVec4::new(right.x, up.x, forward.x, 0.0),
        DVec4::new(right.y, up.y, forward.y, 0.0),
        DVec4::new(right.z, up.z, forward.z, 0.0),
        DVec4::new(-right.dot(center), -up.dot(center), -forward.dot(center), 1.0),
    )
}
