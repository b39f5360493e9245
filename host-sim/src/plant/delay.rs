//! A channel that is late: what it was some time ago, between the steps along a straight line.

use std::collections::VecDeque;

/// A delay of a fixed number of steps, not necessarily a whole one.
#[derive(Clone, Debug, PartialEq)]
pub struct Delay {
    whole: usize,
    part: f64,
    /// The last `whole` + 2 values, the oldest first.
    past: VecDeque<f64>,
}

impl Delay {
    /// A delay of `steps` ≥ 0 steps.
    pub fn new(steps: f64) -> Delay {
        let whole = steps.max(0.0).floor();
        Delay {
            whole: whole as usize,
            part: steps.max(0.0) - whole,
            past: VecDeque::new(),
        }
    }

    /// Takes the value of this step and gives the late one; before the first value there was that.
    pub fn push(&mut self, value: f64) -> f64 {
        let kept = self.whole + 2;
        if self.past.is_empty() {
            self.past.resize(kept - 1, value);
        }
        self.past.push_back(value);
        if self.past.len() > kept {
            self.past.pop_front();
        }
        // The newest is at whole + 1, so that `whole` steps ago is at 1 and one more at 0.
        (1.0 - self.part) * self.past[1] + self.part * self.past[0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_comes_late_by_the_delay_and_starts_where_it_was() {
        for steps in [0.0, 0.3, 1.0, 7.25] {
            let mut delay = Delay::new(steps);
            for index in 0..40 {
                let time = f64::from(index);
                let late = delay.push(5.0 + 2.0 * time);
                if time >= steps.ceil() {
                    assert!(
                        (late - (5.0 + 2.0 * (time - steps))).abs() < 1e-12,
                        "{steps}"
                    );
                } else {
                    assert!((5.0..=5.0 + 2.0 * time).contains(&late), "{steps}: {late}");
                }
            }
        }
    }
}
