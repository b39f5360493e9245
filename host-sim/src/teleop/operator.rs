//! The operator: an intended motion, and the hand's impedance between it and the master.
//!
//! F_h = sat(k(x_i − x) + b(v_i − v)) − m·v̇: the hand pulls the handle towards where it wants to be, with
//! a stiffness and a damping that change with the grip, a largest force, and a mass that moves along. The
//! intention x_i is the operator's own; no identification can see it.

use crate::motion::{Motion, Segment};

/// A grip: the hand's impedance from an instant on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grip {
    /// When the grip is taken (s).
    pub from_s: f64,
    /// m (kg)
    pub mass_kg: f64,
    /// b (N s/m)
    pub damping_ns_per_m: f64,
    /// k (N/m)
    pub stiffness_n_per_m: f64,
}

/// Who moves the master.
#[derive(Clone, Debug, PartialEq)]
pub struct Operator {
    /// The intended motion x_i (m).
    pub intention: Motion,
    /// The grips in the order of time; the first holds from the start.
    pub grips: Vec<Grip>,
    /// The largest force of the hand, either way (N).
    pub force_limit_n: f64,
}

/// A hand that holds a handle lightly between the fingers.
pub const HAND: Grip = Grip {
    from_s: 0.0,
    mass_kg: 0.35,
    damping_ns_per_m: 9.0,
    stiffness_n_per_m: 700.0,
};

/// What the intended motion of the built-in operator is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Task {
    /// Where the hand rests, outside the material (m).
    pub outside_m: f64,
    /// How deep the hand means to go (m); the material keeps it from getting there.
    pub inside_m: f64,
    /// How many times a second it palpates (Hz).
    pub frequency_hz: f64,
    /// How long it palpates before it slides off (s), and after it has come back.
    pub palpates_s: (f64, f64),
    /// How long it presses at the end (s).
    pub presses_s: f64,
    /// When the second material takes the place of the first, touched or not (s); `None`: when the hand has slid off.
    pub changes_s: Option<f64>,
}

/// How long the hand rests at first (s): the estimator's settling, three times over.
const RESTS_S: f64 = 0.6;

impl Default for Task {
    /// 20 s: rest, reach, palpate, slide off, palpate, press.
    fn default() -> Self {
        Task {
            outside_m: -6e-3,
            inside_m: 14e-3,
            frequency_hz: 0.8,
            palpates_s: (8.75, 6.25),
            presses_s: 3.4,
            changes_s: None,
        }
    }
}

impl Task {
    /// The same, with each palpation so much longer (s) that news can go round, in whole cycles, and with a
    /// press that lasts long enough for a stable system to come to rest.
    #[must_use]
    pub fn with_round_trip(self, round_trip_s: f64) -> Task {
        let cycle_s = 1.0 / self.frequency_hz;
        let longer = |seconds: f64| seconds + cycle_s * (round_trip_s / cycle_s).ceil();
        Task {
            palpates_s: (longer(self.palpates_s.0), longer(self.palpates_s.1)),
            presses_s: self.presses_s + 2.0 * round_trip_s,
            ..self
        }
    }

    /// When the hand has slid off, and the material may change (s).
    pub fn slides_off_s(&self) -> f64 {
        RESTS_S + self.palpates_s.0 + 0.05
    }

    /// The intended motion.
    pub fn motion(&self) -> Motion {
        let Task {
            outside_m,
            inside_m,
            frequency_hz,
            ..
        } = *self;
        let palpates = |seconds| Segment::Sine {
            mean_m: 0.5 * (outside_m + inside_m),
            amplitude_m: 0.5 * (inside_m - outside_m),
            frequency_hz,
            seconds,
        };
        let press = Segment::Ramp {
            to_m: 0.7 * inside_m,
            speed_mps: 0.06,
        };
        let segments = vec![
            Segment::Hold { seconds: RESTS_S },
            palpates(self.palpates_s.0),
            Segment::Hold { seconds: 0.7 },
            palpates(self.palpates_s.1),
            press,
            Segment::Hold {
                seconds: self.presses_s,
            },
        ];
        // Every segment has a duration and finite numbers; a task from a file was checked.
        Motion::new(outside_m, segments).expect("the built-in task is a motion")
    }
}

impl Default for Operator {
    fn default() -> Self {
        Operator {
            intention: Task::default().motion(),
            grips: vec![HAND],
            force_limit_n: 30.0,
        }
    }
}

impl Operator {
    /// The grip at a time (s).
    pub fn grip(&self, time_s: f64) -> Grip {
        let taken = self.grips.iter().rev().find(|grip| grip.from_s <= time_s);
        *taken.or(self.grips.first()).unwrap_or(&HAND)
    }

    /// What the hand's spring and damper put on the handle (N), at a position (m) and a speed (m/s). The
    /// hand's mass is carried by the device.
    pub fn force_n(
        &self,
        grip: &Grip,
        intended: (f64, f64),
        position_m: f64,
        speed_mps: f64,
    ) -> f64 {
        let pulls_n = grip.stiffness_n_per_m * (intended.0 - position_m)
            + grip.damping_ns_per_m * (intended.1 - speed_mps);
        pulls_n.clamp(-self.force_limit_n, self.force_limit_n)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_built_in_task_lasts_twenty_seconds_and_leaves_the_material_in_between() {
        let motion = Task::default().motion();
        assert!(
            (19.8..20.2).contains(&motion.duration_s()),
            "{}",
            motion.duration_s()
        );
        let inside = |from_s: f64, to_s: f64| {
            let times = (0..200).map(|i| from_s + f64::from(i) / 200.0 * (to_s - from_s));
            times.filter(|at_s| motion.position(*at_s).0 > 0.0).count()
        };
        assert_eq!(inside(0.0, 0.6), 0);
        assert_eq!(inside(9.4, 10.0), 0);
        assert!(inside(1.0, 9.0) > 80);
        assert_eq!(inside(17.5, 20.0), 200);
    }

    #[test]
    fn a_hand_has_the_grip_that_it_took_last_and_a_largest_force() {
        let mut operator = Operator::default();
        operator.grips.push(Grip {
            from_s: 3.0,
            stiffness_n_per_m: 1500.0,
            ..HAND
        });
        assert_eq!(operator.grip(2.9).stiffness_n_per_m, 700.0);
        assert_eq!(operator.grip(3.0).stiffness_n_per_m, 1500.0);
        assert_eq!(operator.force_n(&HAND, (1.0, 0.0), 0.0, 0.0), 30.0);
        let pulls_n = operator.force_n(&HAND, (2e-3, 0.01), 1e-3, 0.0);
        assert!((pulls_n - 0.79).abs() < 1e-12, "{pulls_n}");
    }
}
