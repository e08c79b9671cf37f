//! Ctrl-C.
#![cfg(unix)]

use crate::Place;
use std::process::{Command, Stdio};
use std::time::Duration;

/// Interrupts the program while it works; asserts the exit code and that no file is left.
fn check_interrupted(place: &Place, arguments: &str) {
    let mut child =
        place.command(arguments).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("the program starts");
    std::thread::sleep(Duration::from_millis(1500));
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(sent.is_ok_and(|s| s.success()));
    let status = child.wait().expect("an end");
    assert_eq!(status.code(), Some(130), "{arguments}");
    assert_eq!(place.names(), [""; 0], "{arguments}");
}

#[test]
fn an_interrupted_reference_leaves_nothing() {
    let place = Place::new();
    check_interrupted(
        &place,
        "reference builtin:spheres --size 4096x4096 --light-samples 65536 --visibility v.npy --valid m.npy",
    );
    let kept = std::fs::read_dir(place.path("cache")).map_or(0, Iterator::count);
    assert_eq!(kept, 0, "no partly traced image is cached");
}

#[test]
fn an_interrupted_bench_leaves_nothing() {
    check_interrupted(&Place::new(), "bench adaptive -o results --size 32x24 --frames 100000");
}
