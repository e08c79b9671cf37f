//! Morph targets and skins at rest.

use super::accessor::Elements;
use super::{File, label};
use crate::{Place, SceneError};
use glam::{DAffine3, DMat4, DVec3};
use gltf_json::accessor::ComponentType;
use gltf_json::mesh::{Mesh, Primitive, Semantic};
use gltf_json::validation::Checked;
use gltf_json::{Node, skin};

/// How a node poses its mesh.
pub(super) struct Pose<'f> {
    /// Weights of the morph targets.
    pub weights: &'f [f32],
    /// A skin's transforms from its mesh to the world; `None` without a skin.
    pub joints: Option<Vec<DAffine3>>,
}

impl<'f> Pose<'f> {
    pub fn new(
        file: &'f File,
        node: &'f Node,
        mesh: &'f Mesh,
        world_from_node: &[Option<DAffine3>],
        place: &str,
    ) -> Result<Pose<'f>, SceneError> {
        let weights = node.weights.as_ref().or(mesh.weights.as_ref()).map_or(&[][..], |w| w);
        let Some(index) = node.skin else { return Ok(Pose { weights, joints: None }) };
        let skin = file.get(&file.root.skins, index, "skins", place)?;
        let place = format!("{place}, {}", label("skin", index.value(), &skin.name));
        let has_joints = |p: &Primitive| p.attributes.contains_key(&Checked::Valid(Semantic::Joints(0)));
        if skin.joints.is_empty() || !mesh.primitives.iter().any(has_joints) {
            file.warnings.add(place, "it has no joints; the mesh stays where its node is");
            return Ok(Pose { weights, joints: None });
        }
        Ok(Pose { weights, joints: joints(file, skin, world_from_node, &place)? })
    }

    /// The positions of a primitive's vertices, in the coordinates of its node, or of the world with a skin.
    pub fn positions(
        &self,
        file: &File,
        primitive: &Primitive,
        base: &Elements,
        used: &[u32],
        place: &str,
    ) -> Result<Vec<DVec3>, SceneError> {
        let at = |elements: &Elements, i: u32| DVec3::from(elements.floats(i as usize).map(f64::from));
        let mut positions: Vec<DVec3> = used.iter().map(|&i| at(base, i)).collect();
        let targets = primitive.targets.iter().flatten().zip(self.weights).enumerate();
        for (number, (target, &weight)) in targets.filter(|(_, (_, weight))| **weight != 0.0) {
            let Some(accessor) = target.positions else { continue };
            let place = format!("{place}, target {number}");
            let offsets = file.elements::<3>(accessor, |c| c != ComponentType::U32, &place)?;
            file.check_count(&offsets, base.count, &place)?;
            for (position, &i) in positions.iter_mut().zip(used) {
                *position += f64::from(weight) * at(&offsets, i);
            }
        }
        if let Some(joints) = &self.joints {
            let skinning = Skinning::new(file, primitive, base.count, place)?;
            for (position, &i) in positions.iter_mut().zip(used) {
                *position = skinning.transform(file, joints, i as usize, place)?.transform_point3(*position);
            }
        }
        Ok(positions)
    }
}

/// The joints' transforms from the mesh at rest; `None`, with a warning, where a joint is in no place.
fn joints(
    file: &File,
    skin: &skin::Skin,
    world_from_node: &[Option<DAffine3>],
    place: &str,
) -> Result<Option<Vec<DAffine3>>, SceneError> {
    let inverse_bind = match skin.inverse_bind_matrices {
        None => None,
        Some(accessor) => Some(file.elements::<16>(accessor, |c| c == ComponentType::F32, place)?),
    };
    if let Some(matrices) = &inverse_bind {
        file.check_count(matrices, skin.joints.len(), place)?;
    }
    let mut joints = Vec::new();
    for (i, &joint) in skin.joints.iter().enumerate() {
        file.get(&file.root.nodes, joint, "nodes", place)?;
        let Some(world_from_joint) = world_from_node[joint.value()] else {
            file.warnings.add(place, "one of its joints is not in the scene; the mesh stays where its node is");
            return Ok(None);
        };
        let matrix = |m: &Elements| DAffine3::from_mat4(DMat4::from_cols_array(&m.floats(i).map(f64::from)));
        joints.push(world_from_joint * inverse_bind.as_ref().map_or(DAffine3::IDENTITY, matrix));
    }
    if joints.iter().all(|j| j.is_finite()) {
        Ok(Some(joints))
    } else {
        Err(file.malformed(place, "its inverseBindMatrices are not finite"))
    }
}

/// Joints and weights of vertices, by fours.
struct Skinning<'a>(Vec<(Elements<'a>, Elements<'a>)>);

impl<'a> Skinning<'a> {
    fn new(file: &File<'a>, primitive: &Primitive, count: usize, place: &str) -> Result<Skinning<'a>, SceneError> {
        let mut sets = Vec::new();
        let attribute = |semantic| primitive.attributes.get(&Checked::Valid(semantic)).copied();
        while let (set, Some(joints)) = (sets.len() as u32, attribute(Semantic::Joints(sets.len() as u32))) {
            let Some(weights) = attribute(Semantic::Weights(set)) else { break };
            let is_joint = |c| matches!(c, ComponentType::U8 | ComponentType::U16);
            let is_weight = |c| matches!(c, ComponentType::U8 | ComponentType::U16 | ComponentType::F32);
            let (joint_place, weight_place) = (format!("{place}, JOINTS_{set}"), format!("{place}, WEIGHTS_{set}"));
            let joints = file.elements::<4>(joints, is_joint, &joint_place)?;
            let weights = file.elements::<4>(weights, is_weight, &weight_place)?;
            file.check_count(&joints, count, &joint_place)?;
            file.check_count(&weights, count, &weight_place)?;
            sets.push((joints, weights));
        }
        Ok(Skinning(sets))
    }

    /// The mean of the joints' transforms. Where the weights are all zero it is the first joint's.
    fn transform(&self, file: &File, joints: &[DAffine3], i: usize, place: &str) -> Result<DAffine3, SceneError> {
        let (mut sum, mut total) = (DAffine3::ZERO, 0.0);
        for (indices, weights) in &self.0 {
            for (joint, weight) in indices.floats::<4>(i).into_iter().zip(weights.floats::<4>(i)) {
                if weight == 0.0 {
                    continue;
                }
                let Some(transform) = joints.get(joint as usize) else {
                    return Err(SceneError::IndexOutOfRange {
                        file: file.name.to_string(),
                        place: Place::Part(format!("{place}, vertex {i}")),
                        index: joint as i64,
                        count: joints.len(),
                        what: "joints",
                    });
                };
                let weight = f64::from(weight);
                sum.matrix3 += transform.matrix3 * weight;
                sum.translation += transform.translation * weight;
                total += weight;
            }
        }
        if total == 0.0 {
            return Ok(joints[0]);
        }
        Ok(DAffine3 { matrix3: sum.matrix3 * (1.0 / total), translation: sum.translation / total })
    }
}

impl File<'_> {
    /// Refuses an accessor with fewer elements than there are vertices, or other things to describe.
    pub fn check_count(&self, elements: &Elements, count: usize, place: &str) -> Result<(), SceneError> {
        if elements.count >= count {
            return Ok(());
        }
        Err(self.malformed(place, format!("there are {} elements, and {count} are needed", elements.count)))
    }
}
