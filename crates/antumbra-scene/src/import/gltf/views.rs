//! Cameras and lights.

use super::{File, label};
use crate::{Aabb, Camera, RectLight, SceneError};
use glam::{Affine3A, DAffine3, Vec2, Vec3};
use gltf_json::extensions::scene::khr_lights_punctual::Type as LightType;
use gltf_json::validation::Checked;
use gltf_json::{Index, Node};

/// Edge of a light as a fraction of its distance: glTF's lights have no size and would cast hard shadows.
const EDGE_OF_DISTANCE: f32 = 1.0 / 20.0;

/// A directional light stands this many radii of the scene from its centre.
const DIRECTIONAL_DISTANCE: f32 = 4.0;

/// The first camera and the first light, with the transforms of their nodes to the world.
#[derive(Default)]
pub(super) struct Views {
    pub camera: Option<(Camera, DAffine3)>,
    pub light: Option<(LightType, DAffine3)>,
}

impl Views {
    pub fn visit_camera(&mut self, file: &File, node: &Node, world: &DAffine3, place: &str) -> Result<(), SceneError> {
        if let Some(index) = node.camera {
            let camera = lens(file, index, world, place)?;
            self.camera = self.camera.or(camera.map(|c| (c, *world)));
        }
        Ok(())
    }

    pub fn visit_light(&mut self, file: &File, node: &Node, world: &DAffine3, place: &str) -> Result<(), SceneError> {
        let extension = node.extensions.as_ref().and_then(|e| e.khr_lights_punctual.as_ref());
        let Some(reference) = extension else { return Ok(()) };
        let lights = file.root.extensions.as_ref().and_then(|e| e.khr_lights_punctual.as_ref());
        let lights = lights.map_or(&[][..], |l| &l.lights);
        let Checked::Valid(kind) = file.get(lights, reference.light, "lights", place)?.type_ else {
            return Err(file.malformed(place, "its light's type is not directional, point or spot"));
        };
        match self.light {
            None => self.light = Some((kind, *world)),
            Some(_) => file.warnings.add(place, "only the first light casts shadows"),
        }
        Ok(())
    }
}

/// A camera's lens, at no place yet; `None` for one that cannot be used.
fn lens(
    file: &File,
    index: Index<gltf_json::Camera>,
    world_from_node: &DAffine3,
    place: &str,
) -> Result<Option<Camera>, SceneError> {
    let source = file.get(&file.root.cameras, index, "cameras", place)?;
    let place = format!("{place}, {}", label("camera", index.value(), &source.name));
    let Some(lens) = &source.perspective else {
        file.warnings.add(place, "only perspective cameras are read; it is left out");
        return Ok(None);
    };
    if axes(&world_from_node.as_affine3a()).is_none() {
        file.warnings.add(place, "its node is flattened by a scale of 0; the camera is left out");
        return Ok(None);
    }
    let (fov_y_deg, near, far) = (lens.yfov.to_degrees(), lens.znear, lens.zfar.unwrap_or(f32::INFINITY));
    if !(fov_y_deg > 0.0 && fov_y_deg < 180.0 && near > 0.0 && near.is_finite() && far > near) {
        return Err(file.malformed(place, "it needs 0 < yfov < pi and 0 < znear < zfar"));
    }
    Ok(Some(Camera { eye: Vec3::ZERO, target: Vec3::NEG_Z, up: Vec3::Y, fov_y_deg, near, far }))
}

/// Position, viewing direction and up direction of a node's camera or light; `None` where a scale of 0 leaves none.
fn axes(world_from_node: &Affine3A) -> Option<(Vec3, Vec3, Vec3)> {
    let forward = world_from_node.transform_vector3(Vec3::NEG_Z).try_normalize()?;
    let up = world_from_node.transform_vector3(Vec3::Y).try_normalize()?;
    (forward.cross(up).length() > 1e-4).then_some((world_from_node.translation.into(), forward, up))
}

/// The camera at its node. Its target lies along the view where the scene is, which orbiting it wants.
pub(super) fn aimed(lens: Camera, world_from_node: &Affine3A, bounds: &Aabb) -> Option<Camera> {
    let (eye, forward, up) = axes(world_from_node)?;
    let distance = (bounds.center() - eye).dot(forward).max(2.0 * lens.near);
    let target = eye + forward * if distance.is_finite() { distance } else { 1.0 };
    Some(Camera { eye, target, up, ..lens })
}

/// A rectangle in place of a light without size; `None` if its node has no direction left.
pub(super) fn rect_light(kind: LightType, world_from_node: &Affine3A, bounds: &Aabb) -> Option<RectLight> {
    let middle = bounds.center();
    let radius = (0.5 * bounds.size().length()).max(1e-3);
    let (position, forward, up) = match kind {
        LightType::Point => {
            let position = Vec3::from(world_from_node.translation);
            let forward = (middle - position).try_normalize().unwrap_or(Vec3::NEG_Y);
            (position, forward, crate::framing::up_for(forward))
        }
        LightType::Spot => axes(world_from_node)?,
        LightType::Directional => {
            let (_, forward, up) = axes(world_from_node)?;
            (middle - forward * (DIRECTIONAL_DISTANCE * radius), forward, up)
        }
    };
    let distance = Some(position.distance(middle)).filter(|d| *d > 1e-3 * radius && d.is_finite()).unwrap_or(radius);
    Some(RectLight {
        center: position,
        target: position + forward * distance,
        up,
        size: Vec2::splat(EDGE_OF_DISTANCE * distance),
        shadow_fov_deg: None,
    })
}
