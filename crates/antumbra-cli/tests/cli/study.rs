//! `study`: what it refuses, and a small one.

use crate::Place;

#[test]
fn studies_are_listed() {
    let help = Place::new().succeeds("study --help").stdout;
    assert!(help.contains("Studies:") && help.contains("rho") && help.contains("Shen 2011, figure 9"), "{help}");
}

#[test]
fn wrong_values_are_refused_before_the_work() {
    let place = Place::new();
    place.refuses("study roh -o results", 2, &["roh", "unknown study", "rho"]);
    place.refuses("study rho", 2, &["--output"]);
    place.refuses("study rho -o results --threshold 0", 2, &["threshold"]);
    place.refuses("study rho -o results --threshold many", 2, &["threshold"]);
    place.refuses("study rho -o results --largest 513", 2, &["largest"]);
}

#[test]
fn the_narrowest_penumbra_is_studied() {
    let place = Place::new();
    let seen = place.succeeds("study rho -o results --largest 1 --threshold 0.2");
    assert!(seen.stdout.contains("still") && seen.stdout.contains("moving"), "{}", seen.stdout);
    assert_eq!(place.names(), ["results"]);
    let curves = String::from_utf8(place.bytes("results/rho.curves.csv")).expect("UTF-8");
    let points = curves.lines().filter_map(|line| line.split_once("by FLIP\",").map(|(_, point)| point));
    let texels = |point: &str| point.split(',').nth(1).and_then(|y| y.parse::<f64>().ok());
    let found: Vec<f64> = points.map(|point| texels(point).unwrap_or_else(|| panic!("{point}"))).collect();
    // Of a hard edge, a map of two texels a pixel is fine enough.
    assert!(found.len() == 2 && found.iter().all(|texels| (0.5..=2.0).contains(texels)), "{curves}");
}
