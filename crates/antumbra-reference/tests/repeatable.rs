//! The same bytes on any number of threads; stopping; and the cache.

mod common;

use antumbra_reference::cache::{key, trace_cached};
use antumbra_reference::{ReferenceError, Settings, trace};
use antumbra_scene::{Material, Scene, Texture, Wrap};
use common::{camera, icosphere, light_above, quad, scene};
use glam::{Vec2, Vec3};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

static NEVER: AtomicBool = AtomicBool::new(false);

fn sphere_on_floor() -> Scene {
    let rgba = (0..16u8).flat_map(|i| [0, 0, 0, i * 16]).collect();
    let texture = Texture { width: 4, height: 4, rgba, wrap: [Wrap::Repeat; 2], nearest: false };
    let mut leaf = quad(Vec3::new(0.5, 2.5, 0.0), Vec2::splat(0.5));
    leaf.uvs = vec![Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
    leaf.material = 1;
    let meshes = vec![quad(Vec3::ZERO, Vec2::splat(9.0)), icosphere(3, Vec3::Y), leaf];
    let mut s = scene(meshes, camera(Vec3::new(0.0, 2.0, 4.0), Vec3::Y), light_above(5.0, Vec2::splat(1.5)));
    s.materials.push(Material { texture: Some(Arc::new(texture)), alpha_cutoff: Some(0.5), ..Material::default() });
    s
}

fn settings() -> Settings {
    Settings { light_samples: 64, ..Settings::of_size(40, 30) }
}

/// A folder of the test's own, removed in the end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Folder {
        let path = std::env::temp_dir().join(format!("antumbra-reference-{}-{name}", std::process::id()));
        let _ = std::fs::remove_dir_all(&path);
        Folder(path)
    }

    fn files(&self) -> Vec<PathBuf> {
        std::fs::read_dir(&self.0).map(|d| d.map(|e| e.unwrap().path()).collect()).unwrap_or_default()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

#[test]
fn threads_do_not_matter_and_seeds_do() {
    let s = sphere_on_floor();
    let on = |threads, seed| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| trace(&s, &Settings { seed, ..settings() }, &|_| (), &NEVER).unwrap())
    };
    assert_eq!(on(1, 5), on(2, 5));
    assert_ne!(on(1, 5).visibility, on(1, 6).visibility);
}

#[test]
fn progress_ends_at_one() {
    let seen = std::sync::Mutex::new(Vec::new());
    trace(&sphere_on_floor(), &settings(), &|f| seen.lock().unwrap().push(f), &NEVER).unwrap();
    let mut seen = seen.into_inner().unwrap();
    seen.sort_by(f32::total_cmp);
    assert_eq!((seen.len(), seen[0] > 0.0, seen[29]), (30, true, 1.0));
}

#[test]
fn cancelling_ends_early_and_leaves_no_file() {
    let folder = Folder::new("cancel");
    let cancel = AtomicBool::new(false);
    let stop_at_once = |_| cancel.store(true, Ordering::Relaxed);
    let e = trace_cached(&sphere_on_floor(), &settings(), &folder.0, &stop_at_once, &cancel).unwrap_err();
    assert_eq!(e, ReferenceError::Cancelled);
    assert!(folder.files().is_empty());
}

#[test]
fn unusable_input_is_refused() {
    let s = sphere_on_floor();
    let refused = |s: &Scene, settings: &Settings| trace(s, settings, &|_| (), &NEVER).unwrap_err();
    assert_eq!(refused(&s, &Settings { width: 0, ..settings() }), ReferenceError::Zero("width"));
    assert_eq!(refused(&s, &Settings { pixel_samples: 0, ..settings() }), ReferenceError::Zero("pixel_samples"));
    let mut blind = s.clone();
    blind.camera.target = blind.camera.eye;
    assert_eq!(refused(&blind, &settings()), ReferenceError::Degenerate("camera"));
    let mut odd = s;
    odd.light.size.x = -1.0;
    assert_eq!(refused(&odd, &settings()), ReferenceError::Degenerate("light"));
}

#[test]
fn a_stored_picture_comes_back_the_same() {
    let folder = Folder::new("hit");
    let s = sphere_on_floor();
    let get = || trace_cached(&s, &settings(), &folder.0, &|_| (), &NEVER).unwrap();
    let first = get();
    let second = get();
    assert_eq!((first.was_stored, second.was_stored), (false, true));
    assert_eq!(first.reference, second.reference);
    assert_eq!(folder.files().len(), 1, "one file, no temporary ones");
}

#[test]
fn a_damaged_file_is_replaced() {
    let folder = Folder::new("damage");
    let s = sphere_on_floor();
    let get = || trace_cached(&s, &settings(), &folder.0, &|_| (), &NEVER).unwrap();
    let good = get();
    let path = good.stored.unwrap();
    let bytes = std::fs::read(&path).unwrap();
    let mut flipped = bytes.clone();
    flipped[bytes.len() / 2] ^= 1;
    for damaged in [&bytes[..bytes.len() / 2], &bytes[..10], &[], &flipped] {
        std::fs::write(&path, damaged).unwrap();
        let again = get();
        assert!(!again.was_stored);
        assert_eq!(again.reference, good.reference);
        assert_eq!(std::fs::read(&path).unwrap(), bytes);
    }
}

#[test]
fn a_folder_that_cannot_be_written_costs_only_the_file() {
    let folder = Folder::new("file");
    std::fs::write(&folder.0, "not a folder").unwrap();
    let cached = trace_cached(&sphere_on_floor(), &settings(), &folder.0, &|_| (), &NEVER).unwrap();
    assert!(cached.stored.is_err() && cached.reference.visibility.len() == 1200);
    std::fs::remove_file(&folder.0).unwrap();
}

#[test]
fn the_key_knows_all_that_the_picture_depends_on() {
    let base = sphere_on_floor();
    let mut keys = vec![key(&base, &settings())];
    let mut changed = |change: &dyn Fn(&mut Scene)| {
        let mut s = base.clone();
        change(&mut s);
        keys.push(key(&s, &settings()));
    };
    let texture = |s: &mut Scene, change: &dyn Fn(&mut Texture)| {
        change(Arc::make_mut(s.materials[1].texture.as_mut().unwrap()));
    };
    changed(&|s| s.light.size.x += 0.1);
    changed(&|s| s.light.size.y += 0.1);
    changed(&|s| s.light.center.x += 0.1);
    changed(&|s| s.light.target.x += 0.1);
    changed(&|s| s.light.up.x += 0.1);
    changed(&|s| s.camera.eye.x += 0.1);
    changed(&|s| s.camera.fov_y_deg += 1.0);
    changed(&|s| s.camera.near += 0.1);
    changed(&|s| s.camera.far += 1.0);
    changed(&|s| s.meshes[1].positions[3].x += 0.1);
    changed(&|s| s.meshes[1].indices.truncate(30));
    changed(&|s| s.meshes[2].uvs[1].x += 0.1);
    changed(&|s| s.instances[1].world_from_object.translation.x += 0.1);
    changed(&|s| s.instances[1].receiver_only = true);
    changed(&|s| s.instances[1].mesh = 0);
    changed(&|s| s.instances.truncate(2));
    changed(&|s| s.materials[1].alpha_cutoff = Some(0.4));
    changed(&|s| s.materials[1].alpha_cutoff = None);
    changed(&|s| s.materials[1].base_color.w = 0.9);
    changed(&|s| s.materials[1].texture = None);
    changed(&|s| s.materials[0].alpha_cutoff = Some(0.4));
    changed(&|s| texture(s, &|t| t.rgba[7] ^= 1));
    changed(&|s| texture(s, &|t| t.wrap[1] = Wrap::Clamp));
    changed(&|s| texture(s, &|t| t.nearest = true));
    changed(&|s| texture(s, &|t| (t.width, t.height) = (2, 8)));
    for other in [
        Settings { width: 41, ..settings() },
        Settings { height: 31, ..settings() },
        Settings { light_samples: 65, ..settings() },
        Settings { pixel_samples: 9, ..settings() },
        Settings { seed: 1, ..settings() },
    ] {
        keys.push(key(&base, &other));
    }
    let different: std::collections::HashSet<_> = keys.iter().map(|k| k.to_hex()).collect();
    assert_eq!(different.len(), keys.len());

    let mut renamed = base.clone();
    renamed.name = "other".into();
    renamed.meshes[0].name = "floor".into();
    renamed.light.shadow_fov_deg = Some(50.0);
    renamed.materials[1].base_color.x = 0.1;
    texture(&mut renamed, &|t| t.rgba[0] ^= 1);
    assert_eq!(key(&renamed, &settings()), key(&base, &settings()), "what is not traced does not count");
}
