//! The node hierarchy. Transforms are multiplied in double precision, since a scene may lie far from the origin.

use super::material::Materials;
use super::pose::Pose;
use super::views::{Views, aimed, rect_light};
use super::{File, label};
use crate::SceneError;
use crate::import::far::Placed;
use crate::import::{Model, ReadFile};
use glam::{DAffine3, DMat4, DQuat, DVec3};
use gltf_json::accessor::ComponentType;
use gltf_json::{Index, Node, Value};
use std::collections::HashMap;

/// Everything that hangs on the scene's nodes.
pub(super) fn import(file: &File, read_file: &mut ReadFile) -> Result<Model, SceneError> {
    let mut read = |path: &str| read_file(path);
    let mut walk = Walk {
        file,
        materials: Materials::new(file, &mut read),
        model: Model { name: file.name.to_string(), ..Model::default() },
        world_from_node: vec![None; file.root.nodes.len()],
        meshes: HashMap::new(),
        placed: Vec::new(),
        views: Views::default(),
    };
    for (index, visible) in walk.hierarchy()? {
        walk.visit(index, visible)?;
    }
    let Walk { materials, mut model, placed, views, .. } = walk;
    model.materials = materials.list;
    model.place(&placed);
    let bounds = model.bounds();
    model.camera = views.camera.and_then(|(lens, place)| aimed(lens, &model.local(&place), &bounds));
    model.light = views.light.and_then(|(kind, place)| rect_light(kind, &model.local(&place), &bounds));
    Ok(model)
}

struct Walk<'f, 'a> {
    file: &'f File<'a>,
    materials: Materials<'f, 'a>,
    model: Model,
    /// Transforms of the nodes in the scene.
    world_from_node: Vec<Option<DAffine3>>,
    /// The model's meshes for each shape that was met, each with the point that is its origin.
    meshes: HashMap<Shape, Vec<(usize, DVec3)>>,
    placed: Vec<Placed>,
    views: Views,
}

/// What makes one mesh of the file look different at two nodes.
#[derive(PartialEq, Eq, Hash)]
struct Shape {
    mesh: usize,
    skin: Option<usize>,
    /// Bits of the morph targets' weights.
    weights: Vec<u32>,
}

impl Walk<'_, '_> {
    /// The scene's nodes, parents first, each with false if it is hidden. Fills in the nodes' transforms.
    fn hierarchy(&mut self) -> Result<Vec<(usize, bool)>, SceneError> {
        let nodes = &self.file.root.nodes;
        let mut order = Vec::new();
        let mut stack: Vec<_> = self.roots()?.into_iter().rev().map(|n| (n, DAffine3::IDENTITY, true)).collect();
        while let Some((index, parent, visible)) = stack.pop() {
            let node = self.file.get(nodes, index, "nodes", "the node hierarchy")?;
            let index = index.value();
            let place = label("node", index, &node.name);
            let world_from_node = parent * self.transform(node, index, &place)?;
            if self.world_from_node[index].replace(world_from_node).is_some() {
                return Err(self
                    .file
                    .malformed(place, "it has two parents or is its own ancestor; nodes must form a tree"));
            }
            let hides = |v: &Value| v.get("visible").and_then(Value::as_bool) == Some(false);
            let visible = visible && !extension(node, "KHR_node_visibility").is_some_and(hides);
            order.push((index, visible));
            let children = node.children.iter().flatten().rev();
            stack.extend(children.map(|&child| (child, world_from_node, visible)));
        }
        Ok(order)
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

    fn transform(&self, node: &Node, index: usize, place: &str) -> Result<DAffine3, SceneError> {
        let transform = match node.matrix {
            Some(matrix) => DAffine3::from_mat4(DMat4::from_cols_array(&self.file.exact(index, "matrix", matrix))),
            None => {
                let rotation = rotation(node.rotation.unwrap_or_default().0);
                let scale = node.scale.map_or(DVec3::ONE, |s| s.map(f64::from).into());
                let exact = |t| DVec3::from(self.file.exact(index, "translation", t));
                let translation = node.translation.map_or(DVec3::ZERO, exact);
                DAffine3::from_scale_rotation_translation(scale, rotation, translation)
            }
        };
        if transform.as_affine3a().is_finite() {
            Ok(transform)
        } else {
            Err(self.file.malformed(place, "its transform is not finite"))
        }
    }

    fn visit(&mut self, index: usize, visible: bool) -> Result<(), SceneError> {
        let node = &self.file.root.nodes[index];
        let place = label("node", index, &node.name);
        let Some(world_from_node) = self.world_from_node[index] else { return Ok(()) };
        if visible {
            self.show(node, world_from_node, &place)?;
            self.views.visit_light(self.file, node, &world_from_node, &place)?;
        }
        // A camera shows nothing itself.
        self.views.visit_camera(self.file, node, &world_from_node, &place)
    }

    /// Places a node's mesh.
    fn show(&mut self, node: &Node, world_from_node: DAffine3, place: &str) -> Result<(), SceneError> {
        let Some(index) = node.mesh else { return Ok(()) };
        let mesh = self.file.get(&self.file.root.meshes, index, "meshes", place)?;
        let pose = Pose::new(self.file, node, mesh, &self.world_from_node, place)?;
        // Joints take a skin to the world, wherever its node is.
        let places = match pose.joints {
            Some(_) => vec![DAffine3::IDENTITY],
            None => self.copies(node, place)?.into_iter().map(|copy| world_from_node * copy).collect(),
        };
        let skin = node.skin.filter(|_| pose.joints.is_some()).map(|s| s.value());
        let weights = pose.weights.iter().map(|w| w.to_bits()).collect();
        let meshes = self.meshes_of(Shape { mesh: index.value(), skin, weights }, &pose)?;
        for world_from_node in places {
            self.placed.extend(meshes.iter().map(|&(mesh, origin)| Placed {
                mesh,
                world_from_object: world_from_node * DAffine3::from_translation(origin),
                receiver_only: false,
            }));
        }
        Ok(())
    }

    /// The model's meshes for a shape, which is read when it is first met.
    fn meshes_of(&mut self, shape: Shape, pose: &Pose) -> Result<Vec<(usize, DVec3)>, SceneError> {
        if let Some(known) = self.meshes.get(&shape) {
            return Ok(known.clone());
        }
        let mut meshes = Vec::new();
        for (mesh, origin) in self.file.meshes(shape.mesh, pose, &mut self.materials)? {
            meshes.push((self.model.meshes.len(), origin));
            self.model.meshes.push(mesh);
        }
        self.meshes.insert(shape, meshes.clone());
        Ok(meshes)
    }

    /// The transforms of `EXT_mesh_gpu_instancing` to the node, or the node alone.
    fn copies(&self, node: &Node, place: &str) -> Result<Vec<DAffine3>, SceneError> {
        let Some(instancing) = extension(node, "EXT_mesh_gpu_instancing") else { return Ok(vec![DAffine3::IDENTITY]) };
        let place = format!("{place}, EXT_mesh_gpu_instancing");
        let accessor = |name: &str| {
            let index = instancing.get("attributes")?.get(name)?.as_u64()?;
            Some(Index::new(u32::try_from(index).unwrap_or(u32::MAX)))
        };
        let (is_float, is_signed) = (|c| c == ComponentType::F32, |c| !is_unsigned(c));
        let translations = accessor("TRANSLATION").map(|a| self.file.elements::<3>(a, is_float, &place)).transpose()?;
        let rotations = accessor("ROTATION").map(|a| self.file.elements::<4>(a, is_signed, &place)).transpose()?;
        let scales = accessor("SCALE").map(|a| self.file.elements::<3>(a, is_float, &place)).transpose()?;
        let mut counts = [&translations, &rotations, &scales].into_iter().flatten().map(|e| e.count);
        let Some(count) = counts.next() else { return Ok(vec![DAffine3::IDENTITY]) };
        if counts.any(|c| c != count) {
            return Err(self.file.malformed(place, "its attributes have different counts"));
        }
        let transform = |i: usize| {
            DAffine3::from_scale_rotation_translation(
                scales.as_ref().map_or(DVec3::ONE, |e| e.floats(i).map(f64::from).into()),
                rotations.as_ref().map_or(DQuat::IDENTITY, |e| rotation(e.floats(i))),
                translations.as_ref().map_or(DVec3::ZERO, |e| e.floats(i).map(f64::from).into()),
            )
        };
        let transforms: Vec<_> = (0..count).map(transform).collect();
        match transforms.iter().position(|t| !t.is_finite()) {
            None => Ok(transforms),
            Some(i) => Err(self.file.malformed(format!("{place}, instance {i}"), "its transform is not finite")),
        }
    }
}

impl File<'_> {
    /// Numbers of a node: large ones, as of a georeferenced model, in double precision.
    fn exact<const N: usize>(&self, node: usize, key: &str, rounded: [f32; N]) -> [f64; N] {
        const SMALL: f32 = 8192.0; // Rounding is below a millimetre.
        let exact = || {
            let written = self.values().get("nodes")?.get(node)?.get(key)?.as_array()?;
            let numbers: Vec<f64> = written.iter().map_while(Value::as_f64).collect();
            numbers.try_into().ok()
        };
        let is_small = rounded.iter().all(|x| x.abs() < SMALL);
        if is_small { None } else { exact() }.unwrap_or(rounded.map(f64::from))
    }
}

/// An extension that the library of glTF's types does not know.
fn extension<'n>(node: &'n Node, name: &str) -> Option<&'n Value> {
    node.extensions.as_ref()?.others.get(name)
}

fn rotation(quaternion: [f32; 4]) -> DQuat {
    let rotation = DQuat::from_array(quaternion.map(f64::from));
    if rotation.length_squared() > 0.0 { rotation.normalize() } else { DQuat::IDENTITY }
}

fn is_unsigned(component: ComponentType) -> bool {
    matches!(component, ComponentType::U8 | ComponentType::U16 | ComponentType::U32)
}
