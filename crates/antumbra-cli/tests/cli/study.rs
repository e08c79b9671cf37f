//! `study`: what it refuses, and one small study.

use crate::Place;

#[test]
fn studies_are_listed() {
    let help = Place::new().succeeds("study --help").stdout;
    assert!(help.contains("rho") && help.contains("Shen 2011, figure 9"), "{help}");
}

#[test]
fn wrong_values_are_refused_before_the_work() {
    let place = Place::new();
    place.file("taken", "a file");
    place.refuses("study roh -o results", 2, &["roh"]);
    place.refuses("study rho", 2, &["--output"]);
    place.refuses("study rho -o taken", 2, &["taken", "not a folder"]);
    place.refuses("study rho -o results --threshold 0", 2, &["threshold"]);
    place.refuses("study rho -o results --threshold many", 2, &["threshold"]);
    place.refuses("study rho -o results --most 513", 2, &["most"]);
}

#[test]
fn narrow_penumbrae_are_studied() {
    let place = Place::new();
    let seen = place.succeeds("study rho -o results --most 8");
    assert!(seen.stdout.contains("moving") && seen.stdout.contains("pvssm:rho=own"), "{}", seen.stdout);
    assert_eq!(place.names(), ["results"]);
    let curves = String::from_utf8(place.bytes("results/rho.curves.csv")).expect("UTF-8");
    let still = curves.lines().filter(|line| line.contains("still, by FLIP")).count();
    assert_eq!(still, 4, "penumbrae of 1, 2, 4 and 8 pixels: {curves}");
}
