//! What `bench` refuses. A whole suite takes too long for a test; tests of `antumbra-bench` check its files.

use crate::{Place, check_refusal, finish};

#[test]
fn suites_are_listed() {
    let help = Place::new().succeeds("bench --help").stdout;
    assert!(help.contains("Suites:") && help.contains("adaptive") && help.contains("Schwärzler 2009"), "{help}");
    assert!(help.contains("backprojection") && help.contains("--scene <SCENE>"), "{help}");
}

#[test]
fn unknown_suites_are_refused_with_the_nearest() {
    let place = Place::new();
    place.refuses("bench adaptve -o results", 2, &["adaptve", "unknown suite", "did you mean `adaptive`"]);
    place.refuses("bench adaptive windows -o results", 2, &["windows", "the suites are: adaptive"]);
}

#[test]
fn wrong_values_are_refused_before_the_work() {
    let place = Place::new();
    place.file("taken", "a file");
    place.refuses("bench adaptive", 2, &["--output"]);
    place.refuses("bench adaptive -o taken", 2, &["taken", "not a folder"]);
    place.refuses("bench adaptive -o taken/results", 2, &["taken", "not a folder"]);
    place.refuses("bench adaptive -o results --size 0x5", 2, &["at least one pixel"]);
    place.refuses("bench adaptive -o results --size 1000000x64", 2, &["1000000 x 64"]);
    place.refuses("bench adaptive -o results --adapter no-such-adapter", 2, &["no-such-adapter"]);
    place.refuses("bench adaptive -o results --frames 0", 2, &["frames"]);
    place.refuses("bench backprojection -o results --scene bunny.obj", 2, &["bunny.obj"]);
    place.refuses("bench backprojection -o results --scene builtin:fnce", 2, &["fnce"]);
}

#[test]
fn a_missing_adapter_is_an_error() {
    let place = Place::new();
    let arguments = "bench adaptive -o results";
    let mut command = place.command(arguments);
    command.env("VK_DRIVER_FILES", "/no/driver.json").env("VK_ICD_FILENAMES", "/no/driver.json");
    command.env("WGPU_BACKEND", "vulkan");
    check_refusal(arguments, &finish(command), 1, &["no graphics adapter"]);
    assert_eq!(place.names(), [""; 0]);
}
