//! The fault table: what the estimator claims of logs with one fault each.
//!
//! [`rig`] makes the logs. It shares no code with the project, which a test reads from its sources: a probe
//! that follows a sine, ramps or the presses of a hand through four Hunt–Crossley materials, integrated at
//! 20 kHz, with 20 mN of noise in steps of 5 mN and an encoder of 1 µm. A log has one fault at one of three
//! severities (`faults list` says which), and the same index of another fault is the same palpation.
//!
//! [`score`] hands the rows to `palpate::estimate::estimate` with the default method for Hunt–Crossley, as
//! `palpate estimate --law hunt_crossley` does, and judges every sample:
//!
//! - **Wrong and converged**: K, λ or n is more than 5 % and more than three of its claimed standard errors
//!   from the truth while the status is `converged`, for longer than 50 ms without a break.
//! - **The truth** is the material as it is at the moment that a record describes. Where a fault changes what
//!   the probe meets (a swap, creep, a moving surface, yielding, adhesion, compliance, play, friction,
//!   inertia), it is the law that would fit without the fault, and nothing counts from the fault's begin
//!   until the forces with and without it differ by three standard deviations of the noise.
//! - **Not to be seen**: a log leaves the count when an offline fit of the law to all its rows leaves a
//!   residual that is neither larger (by three standard deviations of a variance) nor less white
//!   (portmanteau over 20 lags) than that of the same palpation without the fault, and yet is another law: K,
//!   λ or n differs by more than 2.5 %. Then the data themselves say what is not true. Where both fits are
//!   the same law, an estimate has no excuse, and the log stays. The table ends with what left and why.
//! - **First remark**: the first `model_suspect`, material change or fault event after the fault began, and how
//!   long after it (where the force has to show the fault first, after that), median.
//! - **Recovered**: after a fault that passes, the seconds in contact until all three are within 5 % for good,
//!   of the logs that were within 5 % before it: how many took a second at most, of how many, and the median.
//! - **Ends**: the status in `estimate.json`, and the share within 1 and 5 % at the end.
//!
//! A cell may have two wrong logs in a hundred. The whole table, twelve kinds of log in turn in each cell:
//! `cargo run --release -p tests --example faults -- table --logs 100`. One log as files:
//! `… --example faults -- write DIR --fault skew --severity 1 --log 7`. The small table is a snapshot,
//! `faults/snapshot.txt`; `FAULTS_ACCEPT=1 cargo test -p tests --test faults` accepts another one.

pub mod rig;
pub mod score;
