//! One way of the channel: delay, jitter, loss, bursts, a limited rate. Time and seed are arguments.
//!
//! A message arrives after its delay, or never. What was overtaken is dropped when it arrives, as the
//! bridge between two boards does it: nobody needs an older position or an older impedance.

use std::collections::VecDeque;

use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, Gamma};
use rand_pcg::Pcg64;

/// How the delay varies about its mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Jitter {
    /// Evenly, by the share of the jitter either way.
    #[default]
    Uniform,
    /// By a gamma distribution, whose standard deviation is the share of the jitter: few, long delays.
    Gamma,
}

/// One way of the channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChannelConfig {
    /// Mean delay, one way (s).
    pub delay_s: f64,
    /// How far the delay varies, as a share of its mean.
    pub jitter: f64,
    /// How it varies.
    pub distribution: Jitter,
    /// The share of the messages that is lost.
    pub loss: f64,
    /// How many messages are lost in a row, on average; 1 for losses that know nothing of each other.
    pub burst: f64,
    /// The most that the channel carries (bytes/s); infinite without a limit.
    pub bytes_per_s: f64,
    /// The time from which on nothing arrives any more (s), and until when.
    pub outage_s: Option<(f64, f64)>,
}

impl Default for ChannelConfig {
    fn default() -> Self {
        ChannelConfig {
            delay_s: 0.0,
            jitter: 0.0,
            distribution: Jitter::Uniform,
            loss: 0.0,
            burst: 1.0,
            bytes_per_s: f64::INFINITY,
            outage_s: None,
        }
    }
}

/// The longest queue in front of a limited rate (s): what would wait longer is lost.
const LONGEST_QUEUE_S: f64 = 0.5;

/// What has gone over one way of a channel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Messages sent.
    pub sent: u64,
    /// Messages that never arrived.
    pub lost: u64,
    /// Of these, those that a limited rate could not carry.
    pub lost_to_rate: u64,
    /// Messages that arrived after a newer one, and were dropped.
    pub overtaken: u64,
    /// Bytes sent.
    pub bytes: u64,
}

#[derive(Clone, Debug)]
struct Underway<T> {
    sent_s: f64,
    arrives_s: f64,
    number: u64,
    message: T,
}

/// One way of a channel in use.
#[derive(Clone, Debug)]
pub struct Channel<T> {
    config: ChannelConfig,
    random: Pcg64,
    gamma: Option<Gamma<f64>>,
    underway: VecDeque<Underway<T>>,
    /// Number of the newest message that was taken.
    newest: Option<u64>,
    /// When that one was sent (s).
    newest_sent_s: Option<f64>,
    in_burst: bool,
    /// When the limited rate is free again (s).
    free_s: f64,
    counts: Counts,
}

impl<T> Channel<T> {
    /// An empty channel.
    pub fn new(config: ChannelConfig, seed: u64) -> Channel<T> {
        // Shape 1/c² and scale c² have the mean 1 and the standard deviation c.
        let square = config.jitter * config.jitter;
        let gamma = match config.distribution {
            Jitter::Gamma if square > 0.0 => Gamma::new(1.0 / square, square).ok(),
            _ => None,
        };
        Channel {
            config,
            random: Pcg64::seed_from_u64(seed),
            gamma,
            underway: VecDeque::new(),
            newest: None,
            newest_sent_s: None,
            in_burst: false,
            free_s: 0.0,
            counts: Counts::default(),
        }
    }

    /// What has gone over it.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// Sends a message of a length (bytes) now (s).
    pub fn send(&mut self, now_s: f64, message: T, bytes: usize) {
        let number = self.counts.sent;
        self.counts.sent += 1;
        self.counts.bytes += bytes as u64;
        let delay_s = self.delay_s();
        let lost = self.loses() | self.is_out(now_s);
        let starts_s = self.free_s.max(now_s);
        let is_full = starts_s - now_s > LONGEST_QUEUE_S;
        if lost || is_full {
            self.counts.lost += 1;
            self.counts.lost_to_rate += u64::from(!lost);
            return;
        }
        self.free_s = starts_s + bytes as f64 / self.config.bytes_per_s;
        let arrives_s = self.free_s + delay_s;
        let behind = |other: &Underway<T>| other.arrives_s <= arrives_s;
        let at = self
            .underway
            .iter()
            .rposition(behind)
            .map_or(0, |at| at + 1);
        self.underway.insert(
            at,
            Underway {
                sent_s: now_s,
                arrives_s,
                number,
                message,
            },
        );
    }

    /// Takes the next message that has arrived by now (s) and was not overtaken.
    pub fn receive(&mut self, now_s: f64) -> Option<T> {
        // Half a nanosecond: a delay of whole ticks must not miss its tick by a rounding.
        while self.underway.front()?.arrives_s <= now_s + 5e-10 {
            let next = self.underway.pop_front()?;
            if self.newest.is_none_or(|newest| newest < next.number) {
                self.newest = Some(next.number);
                self.newest_sent_s = Some(next.sent_s);
                return Some(next.message);
            }
            self.counts.overtaken += 1;
        }
        None
    }

    /// How old the newest message that was taken is now (s). Each message has a delay of its own and the newest one
    /// counts, so that of many messages it is less than the mean delay: the fast ones are applied.
    pub fn age_s(&self, now_s: f64) -> Option<f64> {
        self.newest_sent_s.map(|sent_s| now_s - sent_s)
    }

    fn delay_s(&mut self) -> f64 {
        let ChannelConfig {
            delay_s, jitter, ..
        } = self.config;
        if jitter == 0.0 || delay_s == 0.0 {
            return delay_s;
        }
        let factor = match &self.gamma {
            Some(gamma) => gamma.sample(&mut self.random),
            None => 1.0 + jitter * (2.0 * self.random.random::<f64>() - 1.0),
        };
        delay_s * factor
    }

    /// Gilbert's model: a burst ends with probability 1/burst, and begins so often that the share of all
    /// messages is the loss.
    fn loses(&mut self) -> bool {
        let ChannelConfig { loss, burst, .. } = self.config;
        if loss == 0.0 {
            return false;
        }
        let ends = 1.0 / burst.max(1.0);
        let drawn: f64 = self.random.random();
        self.in_burst = match (burst > 1.0, self.in_burst) {
            (false, _) => drawn < loss,
            (true, true) => drawn >= ends,
            (true, false) => drawn < ends * loss / (1.0 - loss).max(1e-9),
        };
        self.in_burst
    }

    fn is_out(&self, now_s: f64) -> bool {
        let outage = self.config.outage_s;
        outage.is_some_and(|(from_s, to_s)| (from_s..to_s).contains(&now_s))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SEED: u64 = 20_261_122;

    /// A message a millisecond for a minute, and when each arrived (ms).
    fn arrivals(config: ChannelConfig, seed: u64) -> (Vec<(u32, u32)>, Counts) {
        let mut channel = Channel::new(config, seed);
        let mut arrived = Vec::new();
        for ms in 0..60_000 {
            let now_s = f64::from(ms) * 1e-3;
            channel.send(now_s, ms, 72);
            while let Some(sent) = channel.receive(now_s) {
                arrived.push((sent, ms));
            }
        }
        (arrived, channel.counts())
    }

    #[test]
    fn a_constant_delay_delays_every_message_by_it() {
        let config = ChannelConfig {
            delay_s: 0.25,
            ..ChannelConfig::default()
        };
        let (arrived, counts) = arrivals(config, SEED);
        assert_eq!(arrived.len(), 60_000 - 250);
        assert!(arrived.iter().all(|(sent, at)| at - sent == 250));
        assert_eq!((counts.lost, counts.overtaken), (0, 0));
    }

    #[test]
    fn jitter_has_its_width_and_nothing_arrives_after_a_newer_message() {
        for distribution in [Jitter::Uniform, Jitter::Gamma] {
            let config = ChannelConfig {
                delay_s: 0.1,
                jitter: 0.3,
                distribution,
                ..ChannelConfig::default()
            };
            let (arrived, counts) = arrivals(config, SEED);
            assert!(arrived.is_sorted_by(|a, b| a.0 < b.0));
            let delays = arrived.iter().map(|(sent, at)| at - sent);
            let (least, most) = (delays.clone().min().unwrap(), delays.max().unwrap());
            // Newer messages overtake the slow ones: only fast ones are seen. The shortest of 60 000 gamma
            // delays is a seventh of the mean.
            let shortest = match distribution {
                Jitter::Uniform => 70,
                Jitter::Gamma => 5,
            };
            assert!(
                least >= shortest && least < 75 && most <= 130,
                "{least} {most}"
            );
            assert!(counts.overtaken > 30_000, "{counts:?}");
        }
    }

    /// A message a millisecond with a delay of 150 ms that varies by all of it is applied at an age of 21 ms; 100 a
    /// second at one of 50 to 80 ms. Where it varies by 30 % these are 0.78 and 0.93 of the mean.
    #[test]
    fn what_is_applied_is_younger_than_the_mean_delay_and_its_age_is_known() {
        let age_s = |jitter: f64, every_ms: u32| {
            let config = ChannelConfig {
                delay_s: 0.15,
                jitter,
                ..ChannelConfig::default()
            };
            let mut channel = Channel::new(config, SEED);
            let mut ages = Vec::new();
            for ms in 0..60_000 {
                let now_s = f64::from(ms) * 1e-3;
                if ms % every_ms == 0 {
                    channel.send(now_s, ms, 72);
                }
                while channel.receive(now_s).is_some() {}
                ages.extend(channel.age_s(now_s));
            }
            ages.iter().sum::<f64>() / ages.len() as f64
        };
        let (thousand, hundred) = (age_s(1.0, 1), age_s(1.0, 10));
        assert!((0.018..0.024).contains(&thousand), "{thousand}");
        assert!((0.05..0.08).contains(&hundred), "{hundred}");
        let (thousand, hundred) = (age_s(0.3, 1) / 0.15, age_s(0.3, 10) / 0.15);
        assert!((0.76..0.8).contains(&thousand), "{thousand}");
        assert!((0.91..0.95).contains(&hundred), "{hundred}");
    }

    #[test]
    fn losses_have_their_share_and_bursts_their_length() {
        for burst in [1.0, 8.0] {
            let config = ChannelConfig {
                loss: 0.2,
                burst,
                ..ChannelConfig::default()
            };
            let (arrived, counts) = arrivals(config, SEED);
            let share = counts.lost as f64 / counts.sent as f64;
            // Five standard errors of 60 000 messages in bursts of eight.
            assert!((share - 0.2).abs() < 0.025, "{burst}: {share}");
            let gaps: Vec<u32> = arrived
                .windows(2)
                .map(|pair| pair[1].0 - pair[0].0 - 1)
                .collect();
            let bursts = gaps.iter().filter(|gap| **gap > 0).count();
            let mean = f64::from(gaps.iter().sum::<u32>()) / bursts as f64;
            let expected = if burst > 1.0 { burst } else { 1.25 };
            assert!((mean / expected - 1.0).abs() < 0.1, "{burst}: {mean}");
        }
    }

    #[test]
    fn a_limited_rate_and_an_outage_lose_what_they_cannot_carry() {
        let slow = ChannelConfig {
            bytes_per_s: 7200.0,
            ..ChannelConfig::default()
        };
        let (arrived, counts) = arrivals(slow, SEED);
        // 100 messages a second of the thousand.
        assert!((5_900..6_100).contains(&arrived.len()), "{}", arrived.len());
        assert!(counts.lost > 50_000 && counts.lost_to_rate == counts.lost);
        let cut = ChannelConfig {
            outage_s: Some((10.0, 12.0)),
            ..ChannelConfig::default()
        };
        assert_eq!(arrivals(cut, SEED).1.lost, 2000);
    }

    #[test]
    fn one_seed_is_one_channel() {
        let config = ChannelConfig {
            delay_s: 0.05,
            jitter: 0.5,
            loss: 0.1,
            ..ChannelConfig::default()
        };
        assert_eq!(arrivals(config, SEED), arrivals(config, SEED));
        assert_ne!(arrivals(config, SEED), arrivals(config, SEED + 1));
    }
}
