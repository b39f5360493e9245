//! What happened in a run, a row per tick.

use super::channel::Counts;
use super::options::{Options, SchemeId};

/// Three parameters with their standard errors: stiffness, damping and exponent of a material, or stiffness,
/// damping and mass of a hand.
pub type Parameters = [Option<(f64, f64)>; 3];

/// One tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Row {
    /// Time (s).
    pub time_s: f64,
    /// Position of the master (m).
    pub master_m: f64,
    /// Speed of the master (m/s).
    pub master_mps: f64,
    /// Force that the coupling puts on the operator (N), pushing out.
    pub felt_n: f64,
    /// Force that the scheme wants to put on the operator (N).
    pub command_n: f64,
    /// The hand's push on the handle (N).
    pub hand_n: f64,
    /// Position of the slave (m).
    pub slave_m: f64,
    /// Speed of the slave (m/s).
    pub slave_mps: f64,
    /// Force of the material on the slave (N).
    pub contact_n: f64,
    /// Force that the material would have at the master's position (N).
    pub true_n: f64,
    /// Work of the hand so far (J).
    pub hand_j: f64,
    /// Work against the felt force so far (J).
    pub felt_j: f64,
    /// What the master's own damping and friction have lost so far (J).
    pub lost_j: f64,
    /// Work on the material so far (J).
    pub material_j: f64,
    /// Work of the slave's actuator so far (J).
    pub slave_j: f64,
    /// What the slave's own damping and friction have lost so far (J).
    pub slave_lost_j: f64,
    /// ΣV_new − V_old of exchanged impedances so far (J).
    pub exchanged_j: f64,
    /// Bits of the renderer's limits at work.
    pub limits: u8,
    /// Whether a converged impedance of the material that is there now has arrived.
    pub heard: bool,
    /// What the slave has identified.
    pub identified: Option<Parameters>,
    /// What the master has identified of the hand.
    pub hand: Option<Parameters>,
    /// Whether nothing has crossed yet that the slave's guard would let pass.
    pub guarded: bool,
    /// Bits of the renderer's faults.
    pub faults: u16,
    /// Packets refused so far.
    pub refused: u64,
}

/// A run.
#[derive(Clone, Debug)]
pub struct Trace {
    /// The scheme that ran.
    pub scheme: SchemeId,
    /// Its ticks.
    pub rows: Vec<Row>,
    /// Time between two ticks (s).
    pub period_s: f64,
    /// Delay each way, from master to slave and back (s).
    pub delays_s: [f64; 2],
    /// When the material changed (s).
    pub changed_s: Option<f64>,
    /// From master to slave, and back.
    pub counts: [Counts; 2],
    /// The factors that the scheme puts on the impedances of the first and the second material on purpose.
    pub shaping: [f64; 2],
    /// Whether the run went to its end.
    pub ended: bool,
    /// How old what each end applies is on average, on the way from master to slave and back (s): what was overtaken
    /// is not applied, and the rest waits for the tick. `None`: nothing arrived.
    pub ages_s: [Option<f64>; 2],
    intends: Intention,
    expected: usize,
}

/// What measures have to know of the intended motion.
#[derive(Clone, Copy, Debug)]
struct Intention {
    /// How long the hand means to stay where it is at the end (s).
    still_s: f64,
    /// Whether it means to be inside the material then.
    inside: bool,
    /// The middle time between two reversals (s); `None`: it does not palpate.
    reversal_s: Option<f64>,
}

impl Intention {
    /// Slower than this is still (m/s): a ten-thousandth of a palpation.
    const STILL_MPS: f64 = 1e-5;

    fn of(options: &Options) -> Intention {
        let motion = &options.operator.intention;
        let period_s = options.period_s();
        let ticks = (motion.duration_s() / period_s).round() as usize;
        let (mut moved_s, mut turned_s, mut last) = (0.0, None::<f64>, 0.0);
        let mut between = Vec::new();
        for tick in 0..ticks {
            let time_s = tick as f64 * period_s;
            let speed_mps = motion.position(time_s).1;
            if speed_mps.abs() < Intention::STILL_MPS {
                continue;
            }
            moved_s = time_s;
            if speed_mps * last < 0.0 {
                between.extend(turned_s.map(|turned_s| time_s - turned_s));
                turned_s = Some(time_s);
            }
            last = speed_mps;
        }
        let duration_s = motion.duration_s();
        Intention {
            still_s: duration_s - moved_s,
            inside: motion.position(duration_s).0 > 0.0,
            reversal_s: (!between.is_empty()).then(|| crate::stats::median(between)),
        }
    }
}

impl Trace {
    /// A trace without ticks.
    pub fn with_capacity(ticks: usize, options: &Options) -> Trace {
        Trace {
            scheme: options.scheme,
            rows: Vec::with_capacity(ticks),
            period_s: options.period_s(),
            delays_s: options.channels.map(|channel| channel.delay_s),
            changed_s: None,
            counts: [Counts::default(); 2],
            shaping: options.shaping(),
            ended: false,
            ages_s: [None; 2],
            intends: Intention::of(options),
            expected: ticks,
        }
    }

    /// Adds a tick.
    pub fn push(&mut self, row: Row) {
        self.rows.push(row);
    }

    /// The run is over.
    #[must_use]
    pub fn finish(mut self, changed_s: Option<f64>, counts: [Counts; 2]) -> Trace {
        self.ended = self.rows.len() == self.expected;
        (self.changed_s, self.counts) = (changed_s, counts);
        self
    }

    /// A column.
    pub fn column(&self, of: impl Fn(&Row) -> f64) -> Vec<f64> {
        self.rows.iter().map(of).collect()
    }

    /// The rows from a time on (s), until another.
    pub fn between(&self, from_s: f64, to_s: f64) -> &[Row] {
        let at = |time_s: f64| self.rows.partition_point(|row| row.time_s < time_s);
        let (from, to) = (at(from_s), at(to_s));
        &self.rows[from.min(to)..to]
    }

    /// How long the run ends in a press into the material that the hand means to hold (s); 0 without one.
    pub fn press_s(&self) -> f64 {
        if self.intends.inside {
            self.intends.still_s
        } else {
            0.0
        }
    }

    /// The middle time between two reversals of the intended motion (s), half a palpation; `None`: it has none.
    pub fn reversal_s(&self) -> Option<f64> {
        self.intends.reversal_s
    }

    /// The round trip (s).
    pub fn round_trip_s(&self) -> f64 {
        self.delays_s[0] + self.delays_s[1]
    }
}
