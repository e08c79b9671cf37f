//! The node hierarchy, with its cameras and lights.

use super::material::Materials;
use super::{File, label};
use crate::import::{Model, ReadFile};
use crate::{Aabb, Camera, Instance, RectLight, SceneError};
use glam::{Affine3A, Mat4, Quat, Vec2, Vec3};
use gltf_json::extensions::scene::khr_lights_punctual::Type as LightType;
use gltf_json::validation::Checked;
use gltf_json::{Index, Node};

/// Edge of a light as a fraction of its distance: glTF's lights have no size and would cast hard shadows.
const EDGE_OF_DISTANCE: f32 = 1.0 / 20.0;

/// A directional light stands this many radii of the scene from its centre.
const DIRECTIONAL_DISTANCE: f32 = 4.0;

/// Everything that hangs on the scene's nodes.
pub(super) fn import(file: &File, read_file: &mut ReadFile) -> Result<Model, SceneError> {
    let mut read = |path: &str| read_file(path);
    let mut walk = Walk {
        file,
        materials: Materials::new(file, &mut read),
        model: Model { name: file.name.to_string(), ..Model::default() },
        meshes: vec![None; file.root.meshes.len()],
        camera: None,
        light: None,
    };
    walk.nodes()?;
    let Walk { materials, mut model, camera, light, .. } = walk;
    model.materials = materials.list;
    let bounds = model.bounds();
    model.camera = camera.map(|c| aimed(c, &bounds));
    model.light = light.and_then(|(kind, place)| rect_light(kind, &place, &bounds));
    Ok(model)
}

struct Walk<'f, 'a> {
    file: &'f File<'a>,
    materials: Materials<'f, 'a>,
    model: Model,
    /// The model's meshes for each of the file's meshes that was met.
    meshes: Vec<Option<std::ops::Range<usize>>>,
    camera: Option<Camera>,
    light: Option<(LightType, Affine3A)>,
}

impl Walk<'_, '_> {
    fn nodes(&mut self) -> Result<(), SceneError> {
        let nodes = &self.file.root.nodes;
        let mut visited = vec![false; nodes.len()];
        let mut stack: Vec<_> = self.roots()?.into_iter().rev().map(|n| (n, Affine3A::IDENTITY)).collect();
        while let Some((index, parent)) = stack.pop() {
            let node = self.file.get(nodes, index, "nodes", "the node hierarchy")?;
            let place = label("node", index.value(), &node.name);
            if std::mem::replace(&mut visited[index.value()], true) {
                return Err(self
                    .file
                    .malformed(place, "it has two parents or is its own ancestor; nodes must form a tree"));
            }
            let world_from_node = parent * self.transform(node, &place)?;
            self.visit(node, world_from_node, &place)?;
            let children = node.children.iter().flatten().rev();
            stack.extend(children.map(|&child| (child, world_from_node)));
        }
        Ok(())
    }

    /// The default scene's nodes; the first scene's where there is no default; all that have no parent where there is
    /// no scene.
    fn roots(&self) -> Result<Vec<Index<Node>>, SceneError> {
        let root = self.file.root;
        if let Some(index) = root.scene {
            return Ok(self.file.get(&root.scenes, index, "scenes", "the default scene")?.nodes.clone());
        }
        if let Some(scene) = root.scenes.first() {
            return Ok(scene.nodes.clone());
        }
        let mut has_parent = vec![false; root.nodes.len()];
        for child in root.nodes.iter().flat_map(|n| n.children.iter().flatten()) {
            if let Some(flag) = has_parent.get_mut(child.value()) {
                *flag = true;
            }
        }
        let is_root = |&i: &u32| !has_parent[i as usize];
        Ok((0..root.nodes.len() as u32).filter(is_root).map(Index::new).collect())
    }

    fn transform(&self, node: &Node, place: &str) -> Result<Affine3A, SceneError> {
        let transform = match node.matrix {
            Some(matrix) => Affine3A::from_mat4(Mat4::from_cols_array(&matrix)),
            None => {
                let rotation = Quat::from_array(node.rotation.unwrap_or_default().0);
                let rotation = if rotation.length_squared() > 0.0 { rotation.normalize() } else { Quat::IDENTITY };
                let scale = node.scale.map_or(Vec3::ONE, Vec3::from);
                let translation = node.translation.map_or(Vec3::ZERO, Vec3::from);
                Affine3A::from_scale_rotation_translation(scale, rotation, translation)
            }
        };
        if transform.is_finite() {
            Ok(transform)
        } else {
            Err(self.file.malformed(place, "its transform is not finite"))
        }
    }

    fn visit(&mut self, node: &Node, world_from_node: Affine3A, place: &str) -> Result<(), SceneError> {
        if let Some(index) = node.mesh {
            self.file.get(&self.file.root.meshes, index, "meshes", place)?;
            if node.skin.is_some() {
                tracing::warn!("{}, {place}: skins are not applied, the mesh stays in its rest pose", self.file.name);
            }
            for mesh in self.meshes_of(index.value())? {
                self.model.instances.push(Instance { mesh, world_from_object: world_from_node, receiver_only: false });
            }
        }
        if let Some(index) = node.camera {
            let camera = self.camera(index, &world_from_node, place)?;
            self.camera = self.camera.or(camera);
        }
        let extension = node.extensions.as_ref().and_then(|e| e.khr_lights_punctual.as_ref());
        if let Some(reference) = extension {
            let lights = self.file.root.extensions.as_ref().and_then(|e| e.khr_lights_punctual.as_ref());
            let lights = lights.map_or(&[][..], |l| &l.lights);
            let Checked::Valid(kind) = self.file.get(lights, reference.light, "lights", place)?.type_ else {
                return Err(self.file.malformed(place, "its light's type is not directional, point or spot"));
            };
            match self.light {
                None => self.light = Some((kind, world_from_node)),
                Some(_) => tracing::warn!("{}, {place}: only the first light casts shadows", self.file.name),
            }
        }
        Ok(())
    }

    /// The model's meshes for one of the file's, which is read when it is first met.
    fn meshes_of(&mut self, index: usize) -> Result<std::ops::Range<usize>, SceneError> {
        if let Some(range) = &self.meshes[index] {
            return Ok(range.clone());
        }
        let start = self.model.meshes.len();
        self.model.meshes.extend(self.file.meshes(index, &mut self.materials)?);
        let range = start..self.model.meshes.len();
        self.meshes[index] = Some(range.clone());
        Ok(range)
    }

    fn camera(
        &self,
        index: Index<gltf_json::Camera>,
        world_from_node: &Affine3A,
        place: &str,
    ) -> Result<Option<Camera>, SceneError> {
        let file = self.file;
        let source = file.get(&file.root.cameras, index, "cameras", place)?;
        let place = format!("{place}, {}", label("camera", index.value(), &source.name));
        let Some(lens) = &source.perspective else {
            tracing::warn!("{}, {place}: only perspective cameras are read; this one is left out", file.name);
            return Ok(None);
        };
        let Some((eye, forward, up)) = axes(world_from_node) else {
            tracing::warn!("{}, {place}: its node is flattened by a scale of 0; the camera is left out", file.name);
            return Ok(None);
        };
        let (fov_y_deg, near, far) = (lens.yfov.to_degrees(), lens.znear, lens.zfar.unwrap_or(f32::INFINITY));
        if !(fov_y_deg > 0.0 && fov_y_deg < 180.0 && near > 0.0 && near.is_finite() && far > near) {
            return Err(file.malformed(place, "it needs 0 < yfov < pi and 0 < znear < zfar"));
        }
        Ok(Some(Camera { eye, target: eye + forward, up, fov_y_deg, near, far }))
    }
}

/// Position, viewing direction and up direction of a node's camera or light; `None` where a scale of 0 leaves none.
fn axes(world_from_node: &Affine3A) -> Option<(Vec3, Vec3, Vec3)> {
    let forward = world_from_node.transform_vector3(Vec3::NEG_Z).try_normalize()?;
    let up = world_from_node.transform_vector3(Vec3::Y).try_normalize()?;
    (forward.cross(up).length() > 1e-4).then_some((world_from_node.translation.into(), forward, up))
}

/// The camera with its target moved along the view to where the scene is, which orbiting it wants.
fn aimed(camera: Camera, bounds: &Aabb) -> Camera {
    let forward = (camera.target - camera.eye).normalize();
    let distance = (bounds.center() - camera.eye).dot(forward).max(2.0 * camera.near);
    let target = camera.eye + forward * if distance.is_finite() { distance } else { 1.0 };
    Camera { target, ..camera }
}

/// A rectangle in place of a light without size; `None` if its node has no direction left.
fn rect_light(kind: LightType, world_from_node: &Affine3A, bounds: &Aabb) -> Option<RectLight> {
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
