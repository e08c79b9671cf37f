//! Ctrl-C.
#![cfg(unix)]

use crate::Place;
use std::process::{Command, Stdio};
use std::time::Duration;

#[test]
fn an_interrupted_reference_leaves_nothing() {
    let place = Place::new();
    let mut child = place
        .command("reference builtin:spheres --size 4096x4096 --light-samples 65536 --visibility v.npy --valid m.npy")
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    std::thread::sleep(Duration::from_millis(1500));
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(sent.is_ok_and(|s| s.success()));
    let status = child.wait().expect("an end");
    assert_eq!(status.code(), Some(130));
    assert_eq!(place.names(), [""; 0]);
    let kept = std::fs::read_dir(place.path("cache")).map_or(0, Iterator::count);
    assert_eq!(kept, 0, "nothing half traced is kept");
}
