//! One end of a bridge over the network: datagrams and time in, frames and datagrams out, everything
//! counted.

use super::key::Key;
use super::payload::Payload;
use super::session::{Received, Rejected, Sessions};

/// Which end it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// It waits for the other end.
    Listen,
    /// It begins.
    Connect,
}

/// What has gone over the link, at one end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Frames sent.
    pub sent: u64,
    /// Frames that arrived and went on.
    pub passed: u64,
    /// Datagrams without the key, changed on their way, or none of ours.
    pub strangers: u64,
    /// Datagrams that were seen before.
    pub replayed: u64,
    /// Frames that a newer one had overtaken.
    pub overtaken: u64,
    /// Frames that were too old when they arrived.
    pub late: u64,
    /// Frames that did not arrive, as far as the numbers of later ones show.
    pub lost: u64,
}

/// What is known of the other end's clock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clock {
    /// The round trip (µs), smoothed.
    pub round_trip_us: f64,
    /// How far the other clock is ahead (µs), of the fastest round trip so far.
    pub offset_us: f64,
    fastest_us: f64,
}

/// How often the connecting end begins anew, without an answer (µs), and how often both ask for the clock.
const HELLO_EVERY_US: u64 = 250_000;
const PING_EVERY_US: u64 = 100_000;
/// A session from which nothing has come for so long is over for the connecting end (µs).
const SILENCE_US: u64 = 2_000_000;
/// A frame that is older than a round trip and this is late (µs).
const LATE_US: f64 = 250_000.0;

/// One end.
pub struct Endpoint {
    role: Role,
    sessions: Sessions,
    counts: Counts,
    clock: Option<Clock>,
    hello_us: Option<u64>,
    ping_us: u64,
    heard_us: Option<u64>,
    /// Number of the newest datagram with content.
    newest: Option<u64>,
    out: Vec<Vec<u8>>,
}

impl Endpoint {
    /// An end without a session.
    pub fn new(role: Role, key: Key) -> Endpoint {
        Endpoint {
            role,
            sessions: Sessions::new(key, role == Role::Connect),
            counts: Counts::default(),
            clock: None,
            hello_us: None,
            ping_us: 0,
            heard_us: None,
            newest: None,
            out: Vec::new(),
        }
    }

    /// What has gone over the link.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// What is known of the other end's clock.
    pub fn clock(&self) -> Option<Clock> {
        self.clock
    }

    /// Whether the other end has been heard within two seconds (now in µs).
    pub fn is_alive(&self, now_us: u64) -> bool {
        let heard = |heard_us: u64| now_us.saturating_sub(heard_us) < SILENCE_US;
        self.sessions.is_open() && self.heard_us.is_some_and(heard)
    }

    /// Sends a frame of a board; without a session it is gone.
    pub fn send(&mut self, now_us: u64, frame: &[u8]) {
        let content = Payload::Frame(now_us, frame.to_vec()).encode();
        if let Some(datagram) = self.sessions.seal(&content) {
            self.counts.sent += 1;
            self.out.push(datagram);
        }
    }

    /// Does what time asks for, and gives the datagrams to be sent.
    pub fn poll(&mut self, now_us: u64) -> Vec<Vec<u8>> {
        let asks = self.role == Role::Connect && !self.is_alive(now_us);
        let due = |last: Option<u64>, every: u64| {
            last.is_none_or(|last| now_us.saturating_sub(last) >= every)
        };
        if asks && due(self.hello_us, HELLO_EVERY_US) {
            self.hello_us = Some(now_us);
            self.out.extend(self.sessions.hello());
        }
        if self.sessions.is_open() && due(Some(self.ping_us), PING_EVERY_US) {
            self.ping_us = now_us;
            self.out
                .extend(self.sessions.seal(&Payload::Ping(now_us).encode()));
        }
        std::mem::take(&mut self.out)
    }

    /// Takes a datagram; gives the frame in it, if it is one that may go on to a board.
    pub fn receive(&mut self, now_us: u64, datagram: &[u8]) -> Option<Vec<u8>> {
        match self.sessions.receive(datagram) {
            Err(Rejected::Stranger) => self.counts.strangers += 1,
            Err(Rejected::Replayed) => self.counts.replayed += 1,
            Ok(Received::Answer(answer)) => self.out.push(answer),
            Ok(Received::Connected) => {
                (self.heard_us, self.newest, self.clock) = (Some(now_us), None, None);
                // The other end's session begins with the first datagram.
                self.out
                    .extend(self.sessions.seal(&Payload::Ping(now_us).encode()));
            }
            Ok(Received::Content(number, content)) => {
                return self.content(now_us, number, &content);
            }
        }
        None
    }

    fn content(&mut self, now_us: u64, number: u64, content: &[u8]) -> Option<Vec<u8>> {
        self.heard_us = Some(now_us);
        if number == 0 {
            self.newest = None;
        }
        let overtaken = self.newest.is_some_and(|newest| number < newest);
        if !overtaken {
            let expected = self.newest.map_or(0, |newest| newest + 1);
            self.counts.lost += number.saturating_sub(expected);
            self.newest = Some(number);
        }
        match Payload::decode(content)? {
            Payload::Ping(asked_us) => {
                let answer = Payload::Pong(asked_us, now_us).encode();
                self.out.extend(self.sessions.seal(&answer));
                None
            }
            Payload::Pong(asked_us, at_us) => {
                self.learn(now_us, asked_us, at_us);
                None
            }
            Payload::Frame(..) if overtaken => {
                self.counts.overtaken += 1;
                None
            }
            Payload::Frame(sent_us, frame) => match self.is_late(now_us, sent_us) {
                true => {
                    self.counts.late += 1;
                    None
                }
                false => {
                    self.counts.passed += 1;
                    Some(frame)
                }
            },
        }
    }

    fn learn(&mut self, now_us: u64, asked_us: u64, at_us: u64) {
        let round_trip_us = now_us.saturating_sub(asked_us) as f64;
        let offset_us = at_us as f64 - 0.5 * (now_us as f64 + asked_us as f64);
        let clock = self.clock.get_or_insert(Clock {
            round_trip_us,
            offset_us,
            fastest_us: round_trip_us,
        });
        clock.round_trip_us += 0.2 * (round_trip_us - clock.round_trip_us);
        // A round trip that was held up on one way says little of the clocks.
        if round_trip_us <= clock.fastest_us {
            (clock.fastest_us, clock.offset_us) = (round_trip_us, offset_us);
        }
    }

    /// Whether a frame is older than the link explains. Before the clocks are known none goes on.
    fn is_late(&self, now_us: u64, sent_us: u64) -> bool {
        let Some(clock) = &self.clock else {
            return true;
        };
        let age_us = now_us as f64 - (sent_us as f64 - clock.offset_us);
        age_us > clock.round_trip_us + LATE_US
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DELAY_US: u64 = 20_000;
    /// How far the listening end's clock is ahead (µs).
    const AHEAD_US: u64 = 5_000_000;

    /// Two ends on a wire with a delay, and what an attacker keeps of it.
    struct Wire {
        ends: [Endpoint; 2],
        underway: Vec<(u64, usize, Vec<u8>)>,
        now_us: u64,
        passed: Vec<Vec<u8>>,
        kept: Vec<Vec<u8>>,
    }

    impl Wire {
        fn new() -> Wire {
            let key = || Key::new([3; 32]);
            Wire {
                ends: [
                    Endpoint::new(Role::Listen, key()),
                    Endpoint::new(Role::Connect, key()),
                ],
                underway: Vec::new(),
                now_us: 0,
                passed: Vec::new(),
                kept: Vec::new(),
            }
        }

        fn clock_us(&self, end: usize) -> u64 {
            self.now_us + if end == 0 { AHEAD_US } else { 0 }
        }

        /// Runs for a time (ms); the listening end sends a frame every ten.
        fn run(&mut self, ms: u64) {
            for _ in 0..ms {
                self.now_us += 1000;
                for end in 0..2 {
                    let clock_us = self.clock_us(end);
                    if end == 0 && self.now_us.is_multiple_of(10_000) {
                        let frame = self.now_us.to_le_bytes();
                        self.ends[0].send(clock_us, &frame);
                    }
                    for datagram in self.ends[end].poll(clock_us) {
                        self.kept.push(datagram.clone());
                        self.underway
                            .push((self.now_us + DELAY_US, 1 - end, datagram));
                    }
                }
                let now_us = self.now_us;
                let (arrived, underway) = std::mem::take(&mut self.underway)
                    .into_iter()
                    .partition(|(at, ..)| *at <= now_us);
                self.underway = underway;
                for (_, end, datagram) in Vec::from_iter(arrived as Vec<(u64, usize, Vec<u8>)>) {
                    let clock_us = self.clock_us(end);
                    self.passed
                        .extend(self.ends[end].receive(clock_us, &datagram));
                }
            }
        }
    }

    #[test]
    fn two_ends_connect_learn_their_clocks_and_pass_every_frame_once() {
        let mut wire = Wire::new();
        wire.run(2000);
        let clock = wire.ends[1].clock().unwrap();
        assert!((clock.round_trip_us - 40_000.0).abs() < 3000.0, "{clock:?}");
        assert!(
            (clock.offset_us - AHEAD_US as f64).abs() < 2000.0,
            "{clock:?}"
        );
        assert!(wire.passed.len() > 170, "{}", wire.passed.len());
        assert!(
            wire.passed
                .is_sorted_by_key(|frame| u64::from_le_bytes(frame[..].try_into().unwrap()))
        );
        let counts = wire.ends[1].counts();
        assert_eq!(
            (counts.strangers, counts.replayed, counts.overtaken),
            (0, 0, 0)
        );
    }

    #[test]
    fn what_is_replayed_changed_or_a_strangers_is_counted_and_passes_nothing() {
        let mut wire = Wire::new();
        wire.run(1500);
        // What is still under way has not been seen.
        let underway = std::mem::take(&mut wire.underway);
        let seen = |datagram: &&Vec<u8>| !underway.iter().any(|(.., own)| own == *datagram);
        let kept: Vec<Vec<u8>> = wire.kept.iter().filter(seen).cloned().collect();
        let before = wire.ends[1].counts();
        let now_us = wire.clock_us(1);
        for datagram in &kept {
            assert_eq!(wire.ends[1].receive(now_us, datagram), None);
            for bit in [0, 11, 8 * datagram.len() - 1] {
                let mut changed = datagram.clone();
                changed[bit / 8] ^= 1 << (bit % 8);
                assert_eq!(wire.ends[1].receive(now_us, &changed), None);
            }
        }
        let after = wire.ends[1].counts();
        assert_eq!(after.passed, before.passed);
        assert!(after.replayed >= 100 && after.strangers > 300, "{after:?}");
        // And the session goes on.
        wire.run(100);
        assert!(wire.ends[1].counts().passed > after.passed);
    }

    #[test]
    fn a_frame_that_was_held_back_is_late_and_one_that_was_overtaken_is_not_passed() {
        let mut wire = Wire::new();
        wire.run(1000);
        let passed = wire.ends[1].counts().passed;
        // The frames of 100 ms are held back for 400 ms.
        for (at, end, _) in &mut wire.underway {
            *at += if *end == 1 { 400_000 } else { 0 };
        }
        let held = wire.underway.iter().filter(|(_, end, _)| *end == 1).count() as u64;
        wire.run(10);
        let before = wire.ends[1].counts();
        wire.run(500);
        let counts = wire.ends[1].counts();
        assert!(
            held > 0 && counts.overtaken > before.overtaken,
            "{counts:?}"
        );
        assert!(counts.passed > passed);
        // All at once late: nothing newer has overtaken it.
        let now_us = wire.clock_us(0);
        wire.ends[0].send(now_us, b"late");
        let datagram = wire.ends[0].poll(now_us).pop().unwrap();
        let later_us = wire.clock_us(1) + 900_000;
        assert_eq!(wire.ends[1].receive(later_us, &datagram), None);
        assert_eq!(wire.ends[1].counts().late, counts.late + 1);
    }

    #[test]
    fn an_end_that_falls_silent_is_not_alive_and_comes_back_by_itself() {
        let mut wire = Wire::new();
        wire.run(1000);
        assert!(wire.ends[1].is_alive(wire.clock_us(1)));
        // The listening process is killed and started again.
        wire.now_us += 3_000_000;
        wire.underway.clear();
        wire.ends[0] = Endpoint::new(Role::Listen, Key::new([3; 32]));
        assert!(!wire.ends[1].is_alive(wire.clock_us(1)));
        let passed = wire.ends[1].counts().passed;
        wire.run(1000);
        assert!(wire.ends[1].counts().passed > passed + 50);
    }
}
