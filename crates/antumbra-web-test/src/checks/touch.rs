//! Touch on the image.

use super::{QUERY, camera, difference, length};
use crate::Outcome;
use crate::page::Page;
use serde_json::{Value, json};
use std::time::Duration;

/// Moves fingers in a few steps from their first to their last places.
fn fingers(page: &mut Page, from: &[[f64; 2]], to: &[[f64; 2]]) -> Outcome<()> {
    const STEPS: u32 = 6;
    for step in 0..=STEPS {
        let part = f64::from(step) / f64::from(STEPS);
        let places = from.iter().zip(to).enumerate();
        let points: Vec<Value> = places
            .map(|(id, (a, b))| json!({ "id": id, "x": a[0] + (b[0] - a[0]) * part, "y": a[1] + (b[1] - a[1]) * part }))
            .collect();
        let kind = if step == 0 { "touchStart" } else { "touchMove" };
        page.browser.call("Input.dispatchTouchEvent", json!({ "type": kind, "touchPoints": points }))?;
        std::thread::sleep(Duration::from_millis(80));
    }
    page.browser.call("Input.dispatchTouchEvent", json!({ "type": "touchEnd", "touchPoints": [] }))?;
    std::thread::sleep(Duration::from_millis(200));
    Ok(())
}

/// One finger moves the eye around the target.
pub fn one_finger_turns(page: &mut Page) -> Outcome<String> {
    page.open(QUERY)?;
    let [eye, target] = camera(&page.settled()?)?;
    fingers(page, &[[140.0, 420.0]], &[[260.0, 400.0]])?;
    let [later, aim] = camera(&page.settled()?)?;
    page.shot("touch-turned")?;
    let away = [length(difference(eye, target)), length(difference(later, aim))];
    let seen = format!(
        "the eye went {:.2} m, {:.3} m and then {:.3} m from its target",
        length(difference(eye, later)),
        away[0],
        away[1]
    );
    let is_round = (away[0] - away[1]).abs() < 1e-3 * away[0] && length(difference(target, aim)) < 1e-4;
    match is_round && length(difference(eye, later)) > 0.1 * away[0] {
        true => Ok(seen),
        false => Err(format!("a finger that moves by 120 pixels does not turn the scene: {seen}")),
    }
}

/// Two fingers that go apart bring the target nearer, and two that go together take it away.
pub fn two_fingers_zoom(page: &mut Page) -> Outcome<String> {
    page.open(QUERY)?;
    let distance = |page: &mut Page| -> Outcome<f64> {
        let [eye, target] = camera(&page.settled()?)?;
        Ok(length(difference(eye, target)))
    };
    let [near, wide] = [[[180.0, 400.0], [240.0, 400.0]], [[120.0, 400.0], [300.0, 400.0]]];
    let first = distance(page)?;
    fingers(page, &near, &wide)?;
    let apart = distance(page)?;
    page.shot("touch-zoomed")?;
    fingers(page, &wide, &near)?;
    let together = distance(page)?;
    let seen = format!(
        "{first:.3} m from the target, {apart:.3} m after fingers went apart, {together:.3} m after they came together"
    );
    match apart < 0.7 * first && together > 1.4 * apart {
        true => Ok(seen),
        false => Err(seen),
    }
}
