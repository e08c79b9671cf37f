//! Outputs that are not plain files: links, pipes, devices, names that are not UTF-8.
#![cfg(unix)]

use crate::{Place, Run, check_refusal, finish, is_png};
use std::ffi::OsStr;
use std::fs::{self, File};
use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::{FileTypeExt, PermissionsExt, symlink};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

const RENDER: &str = "render builtin:square -t hard --size 32x24 --frames 1";
const TRACE: &str = "reference builtin:square --size 32x24 --light-samples 1 --pixel-samples 1 --no-cache";

fn is_npy(bytes: &[u8]) -> bool {
    bytes.starts_with(b"\x93NUMPY")
}

fn is_link(path: &Path) -> bool {
    path.is_symlink()
}

/// The program in a shell, which redirects as users do: `$A` is the program.
fn shell(place: &Place, script: &str) -> Command {
    let mut command = Command::new("sh");
    command.args(["-c", script]).current_dir(place.0.path());
    command.env("A", env!("CARGO_BIN_EXE_antumbra")).env("XDG_RUNTIME_DIR", place.0.path());
    command
}

/// Runs a script that succeeds and returns its raw output.
fn piped(place: &Place, script: &str) -> (Vec<u8>, String) {
    let output = shell(place, script).output().expect("a shell");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{script}: {said}");
    (output.stdout, said)
}

/// A place with links `out` and `err` to the standard streams. A program that replaced what it is given would, as root,
/// destroy `/dev/stdout` itself for the whole machine; so it gets its own.
fn with_streams() -> Place {
    let place = Place::new();
    symlink("/dev/stdout", place.path("out")).expect("a link");
    symlink("/dev/stderr", place.path("err")).expect("a link");
    place
}

fn mkfifo(place: &Place, name: &str) {
    assert!(Command::new("mkfifo").arg(place.path(name)).status().is_ok_and(|s| s.success()));
}

#[test]
fn a_link_stays_and_its_file_is_written() {
    let place = Place::new();
    fs::create_dir(place.path("kept")).expect("a folder");
    fs::write(place.path("kept/v.npy"), "old").expect("a file");
    symlink("kept/v.npy", place.path("v.npy")).expect("a link");
    symlink("v.npy", place.path("again.npy")).expect("a link to a link");
    symlink(place.path("kept/new.npy"), place.path("dangling.npy")).expect("a dangling link");
    place.succeeds(&format!("{TRACE} --visibility again.npy --valid dangling.npy"));
    assert!(["v.npy", "again.npy", "dangling.npy"].iter().all(|n| is_link(&place.path(n))));
    assert!(is_npy(&place.bytes("kept/v.npy")) && is_npy(&place.bytes("kept/new.npy")));
    assert_eq!(fs::read_dir(place.path("kept")).expect("a folder").count(), 2, "no temporary file");
}

#[test]
fn a_link_without_an_extension_gets_the_format_of_its_file() {
    let place = Place::new();
    symlink("v.exr", place.path("latest")).expect("a link");
    place.succeeds(&format!("{TRACE} --visibility latest"));
    assert!(place.bytes("v.exr").starts_with(b"\x76\x2f\x31\x01"));
    symlink("v.tiff", place.path("odd")).expect("a link");
    place.refuses(&format!("{TRACE} --visibility odd"), 2, &["odd", ".npy, .exr or .png"]);
}

#[test]
fn links_that_lead_nowhere_are_refused_before_the_work() {
    let place = Place::new();
    symlink("round.png", place.path("round.png")).expect("a link");
    symlink("missing/out.png", place.path("lost.png")).expect("a link");
    symlink("round", place.path("round")).expect("a link");
    place.refuses(&format!("{RENDER} -o round.png"), 2, &["round.png", "leads back to itself"]);
    place.refuses(&format!("{RENDER} -o lost.png"), 2, &["lost.png", "mkdir -p missing"]);
    place.refuses("compare builtin:square -t hard --size 32x24 -o round", 2, &["round", "leads back to itself"]);
    symlink("out.png", place.path("also.png")).expect("a link");
    place.refuses(&format!("{RENDER} -o out.png --visibility also.png"), 2, &["also.png", "its own"]);
    place.refuses(&format!("{RENDER} -o out.png --visibility ./out.png"), 2, &["out.png", "its own"]);
}

#[test]
fn a_replaced_file_keeps_its_permissions() {
    let place = Place::new();
    place.file("v.npy", "old");
    fs::set_permissions(place.path("v.npy"), fs::Permissions::from_mode(0o604)).expect("permissions");
    place.succeeds(&format!("{TRACE} --visibility v.npy"));
    assert!(is_npy(&place.bytes("v.npy")));
    assert_eq!(fs::metadata(place.path("v.npy")).expect("a file").permissions().mode() & 0o7777, 0o604);
}

#[test]
fn standard_output_takes_each_kind_alone() {
    let place = with_streams();
    let (image, said) = piped(&place, &format!("$A {RENDER} -o out | cat"));
    assert!(image::load_from_memory_with_format(&image, image::ImageFormat::Png).is_ok(), "{said}");
    let (stats, _) = piped(&place, &format!("$A {RENDER} --stats out | cat"));
    let stats: serde_json::Value = serde_json::from_slice(&stats).expect("JSON and nothing else");
    assert_eq!(stats["width"], 32);
    let (values, said) = piped(&place, &format!("$A {TRACE} --visibility out | cat"));
    let whole = npyz::NpyFile::new(&values[..]).expect("NPY").into_vec::<f32>().expect("float32");
    assert_eq!((whole.len(), values.len() % 64), (32 * 24, (32 * 24 * 4) % 64), "nothing behind the values");
    assert!(said.contains("estimated error"), "the summary is told elsewhere: {said}");
}

#[test]
fn standard_output_into_a_file_goes_on_where_the_shell_is() {
    let place = with_streams();
    piped(&place, &format!("(echo before; $A {RENDER} --stats out; echo behind) > all.txt"));
    let all = String::from_utf8(place.bytes("all.txt")).expect("text");
    let inside = all.strip_prefix("before\n").and_then(|t| t.strip_suffix("behind\n")).expect("both lines");
    assert!(serde_json::from_str::<serde_json::Value>(inside).is_ok(), "{all}");
}

#[test]
fn descriptors_and_devices_are_written_into() {
    let place = with_streams();
    let outputs = "-o /dev/fd/4 --visibility /dev/fd/4 --stats /dev/fd/3";
    let (stats, _) = piped(&place, &format!("$A {RENDER} {outputs} 3>&1 4>/dev/null >/dev/null | cat"));
    assert!(serde_json::from_slice::<serde_json::Value>(&stats).is_ok());
    let (_, said) = piped(&place, &format!("$A {RENDER} --stats err"));
    assert!(serde_json::from_str::<serde_json::Value>(&said).is_ok(), "{said}");
    place.refuses(&format!("{RENDER} --stats /dev/fd/99"), 2, &["/dev/fd/99", "nothing is open there"]);
    place.refuses(&format!("{RENDER} -o out --stats /dev/fd/1"), 2, &["/dev/fd/1", "its own"]);
    place.refuses(&format!("{RENDER} -o /dev/full"), 1, &["cannot write /dev/full"]);
}

#[test]
fn an_output_beside_its_own_standard_output_is_refused() {
    let place = with_streams();
    let run = finish(shell(&place, &format!("$A {RENDER} -o image.png --stats out > image.png")));
    assert_eq!(run.code, Some(2), "{run:?}");
    assert!(run.stderr.contains("two outputs go there"), "{run:?}");
    // The same pipe by two names: the summary must not end up in it.
    let (values, said) = piped(&place, &format!("$A {TRACE} --visibility /dev/fd/3 3>&1 | cat"));
    assert!(is_npy(&values) && said.contains("estimated error"), "{said}");
}

#[test]
fn pipes_with_names_are_written_into() {
    let place = Place::new();
    mkfifo(&place, "pipe");
    mkfifo(&place, "v.exr");
    // The reader takes them in another order than the command line's.
    let read = "timeout 60 cat v.exr > v; timeout 60 cat pipe > image";
    let script = format!("$A {RENDER} -o pipe --visibility v.exr --stats s.json & {read}; wait $!");
    piped(&place, &script);
    assert!(is_png(&place.path("image")));
    assert!(place.bytes("v").starts_with(b"\x76\x2f\x31\x01"), "the format of the extension");
    assert_eq!(place.names(), ["image", "pipe", "s.json", "v", "v.exr"]);
    assert!(fs::symlink_metadata(place.path("pipe")).expect("the pipe").file_type().is_fifo());
}

#[test]
fn a_reader_that_is_gone_is_an_error_and_leaves_no_file() {
    let place = with_streams();
    let arguments = format!("{RENDER} -o out --stats s.json");
    let mut command = place.command(&arguments);
    let (reader, writer) = std::io::pipe().expect("a pipe");
    command.stdout(writer);
    drop(reader);
    let output = {
        let child = command.stderr(Stdio::piped()).spawn().expect("the program");
        drop(command);
        child.wait_with_output().expect("an end")
    };
    let stderr = String::from_utf8(output.stderr).expect("UTF-8");
    let run = Run { code: output.status.code(), stdout: String::new(), stderr };
    check_refusal(&arguments, &run, 1, &["cannot write out", "its reader is gone"]);
    assert_eq!(place.names(), ["err", "out"]);
}

#[test]
fn a_closed_stderr_is_no_panic() {
    let place = Place::new();
    let mut command = place.command(&format!("{RENDER} -o missing/out.png"));
    let (reader, writer) = std::io::pipe().expect("a pipe");
    command.stderr(writer);
    drop(reader);
    assert_eq!(command.status().expect("an end").code(), Some(2));
}

/// Waits for the end, but not for ever.
fn ends(child: &mut Child) -> Option<i32> {
    let started = Instant::now();
    while started.elapsed() < Duration::from_secs(60) {
        if let Some(status) = child.try_wait().expect("a child") {
            return status.code();
        }
        std::thread::sleep(Duration::from_millis(50));
    }
    let _ = child.kill();
    None
}

#[test]
fn waiting_for_a_reader_ends_by_an_interrupt() {
    let place = Place::new();
    mkfifo(&place, "pipe");
    let mut child = place
        .command(&format!("{TRACE} --visibility pipe --valid m.npy"))
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the program");
    std::thread::sleep(Duration::from_secs(3));
    assert!(child.try_wait().expect("a child").is_none(), "it waits");
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().is_ok_and(|s| s.success()));
    assert_eq!(ends(&mut child), Some(130));
    assert_eq!(place.names(), ["pipe"]);
}

#[test]
fn disks_and_sockets_are_refused() {
    let place = Place::new();
    let _socket = std::os::unix::net::UnixListener::bind(place.path("s.json")).expect("a socket");
    place.refuses(&format!("{RENDER} --stats s.json"), 2, &["s.json", "socket"]);
}

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

/// A name with a byte that is not UTF-8 in the place of `~`.
fn raw(name: &str) -> &OsStr {
    let bytes: Vec<u8> = name.bytes().map(|b| if b == b'~' { 0xff } else { b }).collect();
    OsStr::from_bytes(bytes.leak())
}

/// Runs with arguments whose `~` is not UTF-8.
fn run_raw(place: &Place, arguments: &str) -> Run {
    let mut command = place.command("");
    finish({
        command.args(arguments.split_whitespace().map(raw));
        command
    })
}

#[test]
fn names_need_not_be_utf8() {
    let place = Place::new();
    let at = |name: &str| place.0.path().join(raw(name));
    fs::create_dir(at("m~")).expect("a folder");
    fs::write(at("m~/a~.obj"), format!("mtllib a~.mtl\nusemtl red\n{TRIANGLE}").as_bytes()).expect("a model");
    let model: Vec<u8> = [&b"mtllib a\xff.mtl\nusemtl red\n"[..], TRIANGLE.as_bytes()].concat();
    fs::write(at("m~/a~.obj"), model).expect("a model");
    fs::write(at("m~/a~.mtl"), "newmtl red\nKd 1 0 0\n").expect("a library");
    fs::write(at("m~/b.obj"), TRIANGLE).expect("a model");
    fs::write(at("m~/s~.toml"), "[[meshes]]\npath = \"b.obj\"\n[[meshes]]\npath = \"a\u{fffd}.obj\"\n")
        .expect("a scene");
    let sizes = "--size 32x24 --frames 1 -t hard";
    for scene in ["m~/a~.obj", "m~/s~.toml"] {
        let run = run_raw(&place, &format!("render {scene} {sizes} -o o~.png --visibility v~.npy --stats s~.json"));
        assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""), "{scene}");
        assert!(is_png(&at("o~.png")) && is_npy(&fs::read(at("v~.npy")).expect("a file")));
        let stats: serde_json::Value = serde_json::from_slice(&fs::read(at("s~.json")).expect("a file")).expect("JSON");
        assert_eq!(stats["scene"], scene.replace('~', "\u{fffd}"));
        for output in ["o~.png", "v~.npy", "s~.json"] {
            fs::remove_file(at(output)).expect("was written");
        }
    }
    let run = run_raw(&place, "reference m~/a~.obj --size 32x24 --light-samples 1 --visibility v~.exr");
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    fs::write(at("p~.txt"), "0.5 0.5\n").expect("points");
    let points = "-t subpixel:points=@p~.txt";
    let quick = "--size 32x24 --light-samples 16 --pixel-samples 1 --frames 1";
    let run = run_raw(&place, &format!("compare m~/a~.obj {points} -o r~ {quick}"));
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    assert!(run.stdout.contains("r\u{fffd}/index.html") && at("r~/index.html").exists(), "{}", run.stdout);
}

#[test]
fn missing_names_that_are_not_utf8_are_told() {
    let place = Place::new();
    let outputs = "-t hard -o o~.png";
    let run = run_raw(&place, &format!("render gone~.obj {outputs}"));
    check_refusal("render gone~.obj", &run, 2, &["cannot read gone\u{fffd}.obj"]);
    // Two names that are shown alike are not guessed between.
    for name in [&b"x\xfe.obj"[..], b"x\xff.obj"] {
        fs::write(place.0.path().join(OsStr::from_bytes(name)), TRIANGLE).expect("a model");
    }
    place.refuses("render x\u{fffd}.obj -t hard -o o.png", 2, &["cannot read x\u{fffd}.obj"]);
    let run = run_raw(&place, "bench backprojection -o results --scene gone~.obj");
    check_refusal("bench", &run, 2, &["gone\u{fffd}.obj"]);
}

#[test]
fn reports_go_into_folders_behind_links() {
    let place = Place::new();
    fs::create_dir(place.path("kept")).expect("a folder");
    symlink("kept", place.path("report")).expect("a link");
    symlink("kept/new", place.path("dangling")).expect("a dangling link");
    let compare = "compare builtin:square -t hard --size 32x24 --light-samples 16 --pixel-samples 1 --frames 1 -o";
    for folder in ["report", "dangling"] {
        let run = place.succeeds(&format!("{compare} {folder}"));
        assert!(run.stdout.contains(&format!("{folder}/index.html")), "{}", run.stdout);
        assert!(is_link(&place.path(folder)) && place.path(folder).join("pictures").is_dir());
    }
    assert!(File::open(place.path("kept/index.html")).is_ok() && File::open(place.path("kept/new/index.html")).is_ok());
    symlink("kept/study", place.path("study")).expect("a dangling link");
    place.succeeds("study rho -o study --most 8");
    assert!(place.path("kept/study/rho.html").exists());
}
