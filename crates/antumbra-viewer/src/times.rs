//! Milliseconds of each pass over the last frames.

use antumbra::gpu::timer::PassTime;
use std::collections::VecDeque;

/// Number of kept frames.
const KEPT: usize = 160;

/// The times of one technique.
#[derive(Default)]
pub struct Times {
    /// Labels in order of first appearance.
    pub passes: Vec<String>,
    /// For each frame the milliseconds of each pass.
    pub frames: VecDeque<Vec<f64>>,
    /// True where the adapter has no timestamps.
    pub untimed: bool,
}

impl Times {
    /// Adds a frame.
    pub fn push(&mut self, times: &[PassTime]) {
        self.untimed = times.iter().any(|(_, ms)| ms.is_none());
        for (name, _) in times {
            if !self.passes.contains(name) {
                self.passes.push(name.clone());
            }
        }
        let of = |name: &String| times.iter().find(|(n, _)| n == name).and_then(|(_, ms)| *ms).unwrap_or(0.0);
        self.frames.push_back(self.passes.iter().map(of).collect());
        if self.frames.len() > KEPT {
            self.frames.pop_front();
        }
    }

    /// Median milliseconds of a pass.
    pub fn median(&self, pass: usize) -> f64 {
        median(self.frames.iter().map(|f| f.get(pass).copied().unwrap_or(0.0)))
    }

    /// Median of the milliseconds of all passes together.
    pub fn median_total(&self) -> f64 {
        median(self.frames.iter().map(|f| f.iter().sum()))
    }

    /// The longest frame's milliseconds.
    pub fn longest(&self) -> f64 {
        self.frames.iter().map(|f| f.iter().sum()).fold(0.0, f64::max)
    }
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    let middle = values.len() / 2;
    if values.is_empty() { 0.0 } else { *values.select_nth_unstable_by(middle, f64::total_cmp).1 }
}

/// Sum of the milliseconds of all passes; none if one has none.
pub fn total(times: &[PassTime]) -> Option<f64> {
    times.iter().map(|(_, ms)| *ms).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passes_keep_their_place_when_others_come() {
        let mut times = Times::default();
        times.push(&[("map".into(), Some(2.0))]);
        times.push(&[("map".into(), Some(4.0)), ("list".into(), Some(1.0))]);
        times.push(&[("list".into(), Some(3.0)), ("map".into(), Some(6.0))]);
        assert_eq!(times.passes, ["map", "list"]);
        assert_eq!([times.median(0), times.median(1), times.median_total(), times.longest()], [4.0, 1.0, 5.0, 9.0]);
        for _ in 0..500 {
            times.push(&[("map".into(), None)]);
        }
        assert!(times.frames.len() == KEPT && times.untimed);
    }
}
