//! Scene files: meshes from other files placed in the world, a camera and a light, in TOML or JSON.

use crate::framing::{ground_material, up_for};
use crate::import::Model;
use crate::import::far::Placed;
use crate::{Camera, Instance, Mesh, Place, RectLight, Scene, SceneError, builtin};
use entries::{CameraEntry, LightEntry, MeshEntry, Scale, SceneEntry};
use glam::{Affine3A, DAffine3, DQuat, DVec3, Vec2, Vec3};
use std::collections::HashMap;
use std::collections::hash_map::Entry;

mod entries;
mod syntax;

/// How a scene file is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// TOML.
    Toml,
    /// JSON.
    Json,
}

/// Reads a scene file. `name` is for messages; `load` gives the model behind a path as the file writes it.
///
/// Where the file has no camera or no light, it takes that of the first mesh which brings one (a glTF file or a
/// built-in scene), or else one is chosen from the bounds. No ground is added: write `builtin = "plane"`, a square in
/// the plane y = 0 from -1 to 1 along x and z.
///
/// Everything is placed in double precision. A scene that lies so far from the origin that single precision would lose
/// its shape is moved to a local origin as a whole, with its camera and its light.
pub fn parse(
    bytes: &[u8],
    format: Format,
    name: &str,
    load: &mut dyn FnMut(&str) -> Result<Model, SceneError>,
) -> Result<Scene, SceneError> {
    Ok(read(bytes, format, name, load)?.0)
}

/// The scene, and where its origin lies in the file's coordinates.
pub(crate) fn read(
    bytes: &[u8],
    format: Format,
    name: &str,
    load: &mut dyn FnMut(&str) -> Result<Model, SceneError>,
) -> Result<(Scene, DVec3), SceneError> {
    let entry: SceneEntry = syntax::read(bytes, format, name)?;
    let check = Check { file: name };
    let size = check.size(&entry)?;
    let camera = entry.camera.as_ref().map(|c| check.camera(c)).transpose()?;
    let light = entry.light.as_ref().map(|l| check.light(l)).transpose()?;
    let mut model = assemble(&entry.meshes, &check, load)?.checked(name)?;
    model.warn_of_distance(name);
    model.camera = camera.map(|of| of(model.origin)).or(model.camera);
    model.light = light.map(|of| of(model.origin)).or(model.light);
    check.apart("camera", "eye", model.camera.map(|c| [c.eye, c.target]))?;
    check.apart("light", "center", model.light.map(|l| [l.center, l.target]))?;
    let origin = model.origin;
    Ok((Scene { size, ..model.framed(false) }, origin))
}

/// A model of the file: its instances, and the camera and light that it brings, in its own coordinates.
struct Loaded {
    instances: Vec<Placed>,
    camera: Option<Camera>,
    light: Option<RectLight>,
    origin: DVec3,
}

/// All meshes in one model; a file that is named many times is loaded once.
fn assemble(
    entries: &[MeshEntry],
    check: &Check,
    load: &mut dyn FnMut(&str) -> Result<Model, SceneError>,
) -> Result<Model, SceneError> {
    let mut all = Model { name: check.file.to_string(), ..Model::default() };
    let mut loaded: HashMap<(bool, &str), Loaded> = HashMap::new();
    let (mut placed, mut camera, mut light) = (Vec::new(), None, None);
    for (i, entry) in entries.iter().enumerate() {
        let place = check.placement(entry, i)?;
        let key = match (&entry.path, &entry.builtin) {
            (Some(path), None) => (false, path.as_str()),
            (None, Some(spec)) => (true, spec.as_str()),
            _ => return Err(check.fail(format!("meshes[{i}]"), "it needs either `path` or `builtin`")),
        };
        let model = match loaded.entry(key) {
            Entry::Occupied(known) => known.into_mut(),
            Entry::Vacant(new) => {
                let model = match key {
                    (false, path) => load(path)?,
                    (true, "plane") => plane(),
                    (true, spec) => of_scene(builtin::build(spec)?),
                };
                let (camera, light, origin) = (model.camera, model.light, model.origin);
                new.insert(Loaded { instances: all.absorb(model), camera, light, origin })
            }
        };
        let world_from_model = place * DAffine3::from_translation(model.origin);
        camera = camera.or(model.camera.map(|c| (c, world_from_model)));
        light = light.or(model.light.map(|l| (l, world_from_model)));
        placed.extend(model.instances.iter().map(|p| Placed {
            world_from_object: place * p.world_from_object,
            receiver_only: p.receiver_only || entry.receiver_only,
            ..*p
        }));
    }
    all.place(&placed);
    all.camera = camera.map(|(camera, place)| {
        let [eye, target] = [camera.eye, camera.target].map(|p| all.local_point(place.transform_point3(p.as_dvec3())));
        Camera { eye, target, up: place.transform_vector3(camera.up.as_dvec3()).as_vec3(), ..camera }
    });
    all.light = light.map(|(light, place)| {
        let [center, target] =
            [light.center, light.target].map(|p| all.local_point(place.transform_point3(p.as_dvec3())));
        RectLight { center, target, up: place.transform_vector3(light.up.as_dvec3()).as_vec3(), ..light }
    });
    Ok(all)
}

/// A square from -1 to 1 in the plane y = 0, facing up.
fn plane() -> Model {
    let corner = |x, z| Vec3::new(x, 0.0, z);
    let mesh = Mesh {
        name: "plane".to_string(),
        positions: vec![corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0), corner(-1.0, -1.0)],
        uvs: Vec::new(),
        indices: vec![0, 1, 2, 0, 2, 3],
        material: 0,
    };
    let instance = Instance { mesh: 0, world_from_object: Affine3A::IDENTITY, receiver_only: false };
    Model { meshes: vec![mesh], materials: vec![ground_material()], instances: vec![instance], ..Model::default() }
}

fn of_scene(scene: Scene) -> Model {
    let Scene { name, meshes, materials, instances, camera, light, .. } = scene;
    Model { name, meshes, materials, instances, camera: Some(camera), light: Some(light), origin: DVec3::ZERO }
}

/// Converts entries; errors name the key.
struct Check<'a> {
    file: &'a str,
}

impl Check<'_> {
    fn fail(&self, key: impl Into<String>, problem: impl Into<String>) -> SceneError {
        let (file, place) = (self.file.to_string(), Place::Part(key.into()));
        SceneError::Malformed { file, place, problem: problem.into() }
    }

    fn require(&self, holds: bool, key: impl Into<String>, problem: &str) -> Result<(), SceneError> {
        if holds { Ok(()) } else { Err(self.fail(key, problem)) }
    }

    /// Numbers beyond single precision count as infinite.
    fn finite(&self, vector: DVec3, key: String) -> Result<DVec3, SceneError> {
        self.require(vector.as_vec3().is_finite(), key, "its numbers must be finite")?;
        Ok(vector)
    }

    fn size(&self, entry: &SceneEntry) -> Result<Option<(u32, u32)>, SceneError> {
        match (entry.width, entry.height) {
            (None, None) => Ok(None),
            (Some(width), Some(height)) => {
                self.require(width > 0, "width", "it must be at least 1")?;
                self.require(height > 0, "height", "it must be at least 1")?;
                Ok(Some((width, height)))
            }
            (Some(_), None) => Err(self.fail("height", "it is missing; width and height go together")),
            (None, Some(_)) => Err(self.fail("width", "it is missing; width and height go together")),
        }
    }

    /// Scale, then the rotations about x, y and z, then the translation.
    fn placement(&self, entry: &MeshEntry, i: usize) -> Result<DAffine3, SceneError> {
        let key = |name: &str| format!("meshes[{i}].{name}");
        let translate = self.finite(entry.translate.into(), key("translate"))?;
        let turns = self.finite(entry.rotate_deg.into(), key("rotate_deg"))?;
        let scale = match entry.scale {
            Scale::Uniform(s) => DVec3::splat(s),
            Scale::Axes(axes) => axes.into(),
        };
        self.finite(scale, key("scale"))?;
        self.require(scale.abs().min_element() > 0.0, key("scale"), "it must not be 0")?;
        let [x, y, z] = turns.to_array().map(f64::to_radians);
        let rotation = DQuat::from_rotation_z(z) * DQuat::from_rotation_y(y) * DQuat::from_rotation_x(x);
        Ok(DAffine3::from_scale_rotation_translation(scale, rotation, translate))
    }

    /// Checks that a view from one point to another has a direction, and an up direction that is not along it.
    fn view(&self, table: &str, from: (&str, DVec3), target: DVec3, up: Option<[f32; 3]>) -> Result<Vec3, SceneError> {
        let (from_key, from) = from;
        let key = |name: &str| format!("{table}.{name}");
        self.finite(from, key(from_key))?;
        self.finite(target, key("target"))?;
        let direction = (target - from).as_vec3().try_normalize();
        let forward =
            direction.ok_or_else(|| self.fail(key("target"), format!("it is the same point as {from_key}")))?;
        let Some(up) = up else { return Ok(up_for(forward)) };
        let up = self.finite(Vec3::from(up).as_dvec3(), key("up"))?.as_vec3();
        let across = up.try_normalize().map_or(0.0, |u| forward.cross(u).length());
        let problem = format!("it must not be zero or parallel to the direction from {from_key} to target");
        self.require(across > 1e-4, key("up"), &problem)?;
        Ok(up)
    }

    /// Checks that a view still has a direction in single precision.
    fn apart(&self, table: &str, from_key: &str, view: Option<[Vec3; 2]>) -> Result<(), SceneError> {
        let problem = format!("it is the same point as {from_key} in single precision");
        self.require(view.is_none_or(|[from, target]| from != target), format!("{table}.target"), &problem)
    }

    /// The camera for an origin of the scene.
    fn camera(&self, entry: &CameraEntry) -> Result<impl Fn(DVec3) -> Camera + use<>, SceneError> {
        let (eye, target) = (DVec3::from(entry.eye), DVec3::from(entry.target));
        let up = self.view("camera", ("eye", eye), target, entry.up)?;
        self.require(is_opening(entry.fov_y_deg), "camera.fov_y_deg", "it must be above 0 and below 180 degrees")?;
        if let Some(near) = entry.near {
            self.require(near > 0.0 && near.is_finite(), "camera.near", "it must be above 0 and finite")?;
        }
        if let Some(far) = entry.far {
            let least = entry.near.unwrap_or(0.0);
            self.require(far > least && far.is_finite(), "camera.far", "it must be above near and finite")?;
        }
        // 0 and infinity are fitted to the scene.
        let (near, far) = (entry.near.unwrap_or(0.0), entry.far.unwrap_or(f32::INFINITY));
        let fov_y_deg = entry.fov_y_deg;
        Ok(move |origin: DVec3| {
            let [eye, target] = [eye, target].map(|p| (p - origin).as_vec3());
            Camera { eye, target, up, fov_y_deg, near, far }
        })
    }

    /// The light for an origin of the scene.
    fn light(&self, entry: &LightEntry) -> Result<impl Fn(DVec3) -> RectLight + use<>, SceneError> {
        let (center, target) = (DVec3::from(entry.center), DVec3::from(entry.target));
        let up = self.view("light", ("center", center), target, entry.up)?;
        let size = Vec2::from(entry.size);
        self.require(size.is_finite() && size.min_element() >= 0.0, "light.size", "it must be finite and not below 0")?;
        if let Some(opening) = entry.shadow_fov_deg {
            self.require(is_opening(opening), "light.shadow_fov_deg", "it must be above 0 and below 180 degrees")?;
        }
        let shadow_fov_deg = entry.shadow_fov_deg;
        Ok(move |origin: DVec3| {
            let [center, target] = [center, target].map(|p| (p - origin).as_vec3());
            RectLight { center, target, up, size, shadow_fov_deg }
        })
    }
}

fn is_opening(degrees: f32) -> bool {
    degrees > 0.0 && degrees < 180.0
}
