//! From an argument to a scene, with files.

use crate::assert_says;
use crate::glb::Builder;
use antumbra_scene::{SceneError, load};
use std::path::Path;

const OBJ: &[u8] = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
const PLY: &[u8] = b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
    element face 1\nproperty list uchar int vertex_index\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

fn path(folder: &Path, name: &str) -> String {
    folder.join(name).to_str().unwrap().to_string()
}

#[test]
fn the_extension_picks_the_importer() {
    let folder = tempfile::tempdir().unwrap();
    let put = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).unwrap();
    let triangle = Builder::triangle();
    put("a.OBJ", OBJ);
    put("b.ply", PLY);
    put("c.glb", &triangle.glb());
    put("d.gltf", &triangle.gltf("d%20d.bin"));
    put("d d.bin", &triangle.bytes);
    for (file, name) in [("a.OBJ", "a"), ("b.ply", "b"), ("c.glb", "c"), ("d.gltf", "d")] {
        let scene = load(&path(folder.path(), file)).unwrap();
        assert_eq!((scene.name.as_str(), scene.triangle_count()), (name, 3), "a triangle and the ground");
    }
    put("s.toml", b"[[meshes]]\npath = \"a.OBJ\"\n[[meshes]]\nbuiltin = \"plane\"\n");
    put("s.json", b"{\"meshes\": [{\"path\": \"b.ply\"}]}");
    assert_eq!(load(&path(folder.path(), "s.toml")).unwrap().triangle_count(), 3);
    assert_eq!(load(&path(folder.path(), "s.json")).unwrap().triangle_count(), 1);
}

#[test]
fn built_in_scenes_are_built() {
    let name = antumbra_scene::builtin::list()[0].name;
    assert_eq!(load(&format!("builtin:{name}")).unwrap().name, format!("builtin:{name}"));
    assert!(matches!(load("builtin:nowhere"), Err(SceneError::Builtin { .. })));
    assert_says(load(name), &["no such file", &format!("did you mean `builtin:{name}`?")]);
}

#[test]
fn what_is_no_scene_is_refused_with_the_way_out() {
    let folder = tempfile::tempdir().unwrap();
    let put = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).unwrap();
    put("a.fbx", b"");
    put("plain", b"");
    put("s.toml", b"[[meshes]]\npath = \"gone.obj\"\n");
    put("t.toml", b"[[meshes]]\npath = \"s.toml\"\n");
    std::fs::create_dir(folder.path().join("dir.glb")).unwrap();
    assert_says(load(&path(folder.path(), "a.fbx")), &["a.fbx", ".glb, .gltf, .obj or .ply"]);
    assert_says(load(&path(folder.path(), "plain")), &["plain", ".glb"]);
    assert_says(load(&path(folder.path(), "gone.obj")), &["cannot read", "gone.obj"]);
    assert_says(load(&path(folder.path(), "gone.xyz")), &["gone.xyz", "no such file"]);
    assert_says(load(&path(folder.path(), "dir.glb")), &["dir.glb", "folder"]);
    assert_says(load(folder.path().to_str().unwrap()), &["folder"]);
    assert_says(load(&path(folder.path(), "s.toml")), &["cannot read", "gone.obj"]);
    assert_says(load(&path(folder.path(), "t.toml")), &["s.toml", "scene file cannot be used here"]);
    assert_says(load(""), &["no such file"]);
}

#[cfg(unix)]
#[test]
fn names_need_not_be_utf8() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &[u8]| folder.path().join(OsStr::from_bytes(name));
    std::fs::create_dir(at(b"m\xff")).unwrap();
    let obj: Vec<u8> = [b"mtllib a\xff.mtl\nusemtl red\n", OBJ].concat();
    std::fs::write(at(b"m\xff/a\xff.obj"), obj).unwrap();
    std::fs::write(at(b"m\xff/a\xff.mtl"), "newmtl red\nKd 1 0 0\n").unwrap();
    std::fs::write(at(b"m\xff/s.toml"), "[[meshes]]\npath = \"a\u{fffd}.obj\"\n").unwrap();
    for file in [&b"m\xff/a\xff.obj"[..], b"m\xff/s.toml"] {
        let scene = load(&at(file)).unwrap();
        let color = scene.materials[scene.meshes[0].material].base_color;
        assert_eq!(color.to_array(), [1.0, 0.0, 0.0, 1.0], "{} has its library", scene.name);
    }
    // As messages show it, if no other is shown the same.
    let shown = at(b"m\xff/a\xff.obj").display().to_string();
    assert_eq!(load(&shown).unwrap().name, "a\u{fffd}");
    std::fs::write(at(b"m\xff/a\xfe.obj"), OBJ).unwrap();
    assert_says(load(&shown), &["cannot read", "a\u{fffd}.obj"]);
}
