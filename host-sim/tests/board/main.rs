//! The host's verbs against a simulated board: the core's sampling, settings and protocol code behind
//! a line in memory or a pseudo-terminal.

mod calibration;
#[path = "../common/mod.rs"]
mod common;
mod line;
mod recording;
mod settings;
#[cfg(unix)]
mod terminal;
mod verbs;

use palpate::link::port::Simulated;
use palpate::link::world::{Hand, World};
use palpate::link::{Device, SimulatedBoard};
use std::sync::{Arc, Mutex};

type Shared = Arc<Mutex<World>>;

fn world(hand: Hand) -> Shared {
    let mut world = World::default();
    world.hand = hand;
    Arc::new(Mutex::new(world))
}

const HELD: Hand = Hand::Holding {
    position_m: 0.0,
    force_n: 0.0,
};

fn device(world: &Shared, bytes_per_ms: usize) -> Device<Simulated> {
    let board = SimulatedBoard::new(Arc::clone(world), bytes_per_ms);
    Device::new(Simulated::at_once(board))
}
