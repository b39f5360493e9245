//! Two boards joined: one touches gel and identifies it, the other renders that to a hand.

use crate::common::within_the_model;
use estimator_core::board::frame::Frame;
use estimator_core::board::link::Command;
use estimator_core::board::settings::Key;
use f405::bench::{Bench, analog};
use f405::chip::{Drive, MICROSECOND, MILLISECOND, Part, UNITS_PER_SECOND};
use f405::report::Report;
use f405::world::{M_PER_COUNT, Material, Random, World, code};
use std::collections::VecDeque;
use std::sync::{Arc, Mutex};

/// A handle (kg, N s/m) and a hand (N/m, N s/m) that wants it somewhere.
const HANDLE: (f64, f64) = (0.15, 8.0);
const HAND: (f64, f64) = (600.0, 4.0);
/// Force of the full output (N).
const FULL_N: f64 = 20.0;
const STEP: u64 = 20 * MICROSECOND;

/// The mechanics of the master, which both boards see: the slave's probe follows the handle.
struct Mechanics {
    at: u64,
    position: f64,
    speed: f64,
    force: f64,
    /// Time, position, speed and force of the last milliseconds.
    past: VecDeque<(u64, f64, f64)>,
}

impl Mechanics {
    fn new() -> Self {
        Mechanics {
            at: 0,
            position: -1e-3,
            speed: 0.0,
            force: 0.0,
            past: VecDeque::from([(0, -1e-3, 0.0)]),
        }
    }

    /// Where the hand wants the handle: presses of 3 mm, once a second and a bit.
    fn wanted(t: f64) -> f64 {
        match t < 1.0 {
            true => -1e-3,
            false => 1.5e-3 - 2.5e-3 * (2.0 * std::f64::consts::PI * 0.8 * (t - 1.0)).cos(),
        }
    }

    fn go_to(&mut self, at: u64) {
        while self.at + STEP <= at {
            let h = STEP as f64 / UNITS_PER_SECOND as f64;
            let t = self.at as f64 / UNITS_PER_SECOND as f64;
            let hand = HAND.0 * (Self::wanted(t) - self.position) - HAND.1 * self.speed;
            let acceleration = (hand - HANDLE.1 * self.speed - self.force) / HANDLE.0;
            self.speed += h * acceleration;
            self.position += h * self.speed;
            self.at += STEP;
            self.past.push_back((self.at, self.position, self.speed));
            if self.past.len() > 1000 {
                self.past.pop_front();
            }
        }
    }

    fn state(&mut self, at: u64) -> (f64, f64) {
        if at > self.at {
            self.go_to(at);
        }
        let next = self.past.partition_point(|(when, _, _)| *when <= at);
        let (when, x, v) = self.past[next.saturating_sub(1)];
        let since = at.saturating_sub(when) as f64 / UNITS_PER_SECOND as f64;
        (x + v * since, v)
    }
}

type Shared = Arc<Mutex<Mechanics>>;

struct Master(Shared, Random);

impl World for Master {
    fn counts(&mut self, at: u64) -> i64 {
        let (x, _) = self.0.lock().expect("one thread").state(at);
        (x / M_PER_COUNT).floor() as i64
    }

    fn force_code(&mut self, _: u64) -> u32 {
        code(0.0, 2.0 * self.1.normal())
    }

    fn bridge(&mut self, _: u64, _: u64) -> i32 {
        0
    }

    fn driven(&mut self, at: u64, drive: Drive) {
        let mut mechanics = self.0.lock().expect("one thread");
        let force = match drive {
            Drive::Floating => 0.0,
            Drive::Share(share) => share * FULL_N,
        };
        if force != mechanics.force {
            mechanics.go_to(at);
            mechanics.force = force;
        }
    }
}

struct Slave(Shared, Random);

impl Slave {
    fn state(&mut self, at: u64) -> (f64, f64) {
        self.0.lock().expect("one thread").state(at)
    }
}

impl World for Slave {
    fn counts(&mut self, at: u64) -> i64 {
        (self.state(at).0 / M_PER_COUNT).floor() as i64
    }

    fn force_code(&mut self, at: u64) -> u32 {
        let (x, v) = self.state(at);
        code(Material::GEL.force_n(x, v), 2.0 * self.1.normal())
    }

    fn bridge(&mut self, _: u64, _: u64) -> i32 {
        0
    }
}

/// The frames of the slave that are for the master, each with the time at which it leaves a channel that is
/// late by `delay_ms`.
fn packets(slave: &Bench, seen: &mut usize, delay_ms: u64) -> Vec<(u64, Command)> {
    let new = &slave.host.frames[*seen..];
    *seen = slave.host.frames.len();
    let packet = |r: &f405::host::Received| match r.frame {
        Frame::Reflection(packet) => {
            Some((r.at + delay_ms * MILLISECOND, Command::Reflect(packet)))
        }
        _ => None,
    };
    new.iter().filter_map(packet).collect()
}

#[test]
fn a_hand_feels_through_two_boards_what_the_probe_touches() {
    let mut report = Report::new("two boards joined, 10 ms of delay");
    let shared: Shared = Arc::new(Mutex::new(Mechanics::new()));
    let part = Part::default();
    let master = Box::new(Master(shared.clone(), Random(1)));
    let slave = Box::new(Slave(shared.clone(), Random(2)));
    let mut master = Bench::new(analog(), part, master);
    let mut slave = Bench::new(analog(), part, slave);
    let both = |master: &mut Bench, slave: &mut Bench, seconds: f64| {
        master.run(seconds);
        slave.run(seconds);
    };
    for _ in 0..300 {
        both(&mut master, &mut slave, 1e-3);
    }
    // Each command goes to a board while the other one stands still: bring them to the same time after it.
    master.set(&[
        (Key::RenderDeviceNsPerM, HANDLE.1 as f32),
        (Key::RenderFullN, FULL_N as f32),
        (Key::TelemetryEvery, 10.0),
        (Key::RenderForceN, FULL_N as f32),
    ]);
    master.arm();
    slave.set(&[(Key::ReflectionEvery, 5.0), (Key::TelemetryEvery, 4.0)]);
    let (mut seen, mut channel) = (slave.host.frames.len(), VecDeque::new());
    let (mut square, mut felt, mut count, mut most) = (0.0, 0.0, 0, 0.0_f64);
    // The commands have brought the two clocks apart.
    let mut now = master.machine.chip.now.max(slave.machine.chip.now);
    while now < 8 * UNITS_PER_SECOND {
        now += MILLISECOND;
        for board in [&mut master, &mut slave] {
            let behind = now.saturating_sub(board.machine.chip.now);
            board.run(behind as f64 / UNITS_PER_SECOND as f64);
        }
        channel.extend(packets(&slave, &mut seen, 10));
        while let Some((at, command)) = channel.front().copied()
            && at <= now
        {
            channel.pop_front();
            master.host.send(&mut master.machine, command);
        }
        if now > 5 * UNITS_PER_SECOND {
            let (x, v) = shared.lock().expect("one thread").state(now);
            let touched = Material::GEL.force_n(x, v);
            let rendered = master.share() * FULL_N;
            square += (rendered - touched).powi(2);
            felt += touched.powi(2);
            most = most.max((rendered - touched).abs());
            count += 1;
        }
    }
    within_the_model(&master);
    within_the_model(&slave);
    let (error, size) = (
        (square / f64::from(count)).sqrt(),
        (felt / f64::from(count)).sqrt(),
    );
    report.row("force that is touched", format!("{size:.2} N rms"));
    report.row(
        "force that is rendered, less that",
        format!("{error:.3} N rms, {most:.2} N at most"),
    );
    assert!(size > 1.0, "the probe touches: {size} N rms");
    assert!(error < 0.05 * size, "{error} N rms of {size} N");
}
