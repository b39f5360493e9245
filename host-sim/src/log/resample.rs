//! Samples on an even grid of time.

use super::sampling::{EVEN_PERIODS, Line, Stamps, is_pause, is_rounding, slower, step_of_stamps};
use super::uniform::{Compensated, Taken, UniformLog};
use super::{record::Log, timing::GAP_PERIODS, timing::Timing, timing::snapped};
use crate::diagnostic::Diagnostic;
use crate::number::{counted, quantity, setting};
use crate::signal;
use crate::stats::rms;

/// Most places of a grid for each row that is there, where rows are dense: with more, most samples would be invented,
/// and a speed between rows that crowd and pauses is none. Derived: half of the places. Of 1000 rows a second that were
/// stamped 1 µs apart in bunches a grid of 1 MHz had 1000 places a row.
const MOST_PLACES: f64 = 2.0;
/// Largest grid (samples): 2.8 h at 5 kHz, 1.2 GB. Beyond it a stamp is wrong rather than a log long.
const LARGEST_GRID: f64 = 5e7;

impl Log {
    /// The log on an even grid of its own rate. Where samples are missing, those that are there stay as they
    /// were measured, and the others are invented between them; where only the stamps scatter, the line
    /// through them takes their place (see [`super::sampling`]); a log that was sampled unevenly is
    /// interpolated as by [`Log::resample`].
    ///
    /// # Errors
    /// Those of [`Log::resample`].
    pub fn uniform(&self) -> Result<UniformLog, Diagnostic> {
        let timing = self.timing();
        let rate_hz = timing.rate_hz();
        match self.is_even_at_all(rate_hz) {
            true => Ok(self.clone().untouched(rate_hz)),
            false => self.on_even_grid(),
        }
    }

    /// The same of a log that is not needed any more: an even one gives its samples away.
    ///
    /// # Errors
    /// Those of [`Log::resample`].
    pub fn into_uniform(self) -> Result<UniformLog, Diagnostic> {
        let rate_hz = self.timing().rate_hz();
        match self.is_even_at_all(rate_hz) {
            true => Ok(self.untouched(rate_hz)),
            false => self.on_even_grid(),
        }
    }

    fn is_even_at_all(&self, rate_hz: f64) -> bool {
        self.len() >= 2 && rate_hz > 0.0 && self.is_even_at(rate_hz)
    }

    fn on_even_grid(&self) -> Result<UniformLog, Diagnostic> {
        let timing = self.timing();
        let rate_hz = timing.rate_hz();
        if self.len() < 2 {
            return self.on_grid(rate_hz, &timing);
        }
        if let Some(sparse) = self.too_sparse(rate_hz, &timing) {
            return Err(sparse);
        }
        let line = Line::through(&self.time_s, &timing);
        match (self.stamps(line.as_ref()), line) {
            (Stamps::Even | Stamps::Jittered, Some(line))
                if self.duration_s() <= LARGEST_GRID * line.period_s =>
            {
                Ok(self.placed(&line, &timing))
            }
            _ => {
                let mut grid = self.on_grid(rate_hz, &timing)?;
                // Of a rest that was sampled at another rate differences say nothing about the noise of this one.
                grid.taken = grid.slower.is_empty().then(|| Taken {
                    time_s: self.time_s.clone(),
                    position_m: self.position_m.clone(),
                    force_n: self.force_n.clone(),
                });
                Ok(grid)
            }
        }
    }

    /// The log on an even grid of `rate_hz` (Hz) from its first stamp on, by linear interpolation.
    ///
    /// A log that has this rate within 0.1 % and is even within 1 % of a period passes untouched.
    ///
    /// # Errors
    /// Fewer than two samples, a rate that is not a positive number, or a grid of more than fifty
    /// million samples (one wrong time stamp is enough for that).
    pub fn resample(&self, rate_hz: f64) -> Result<UniformLog, Diagnostic> {
        self.on_grid(rate_hz, &self.timing())
    }

    fn on_grid(&self, rate_hz: f64, timing: &Timing) -> Result<UniformLog, Diagnostic> {
        if self.len() < 2 {
            return Err(Diagnostic::new("the log has no duration")
                .in_file(&self.path)
                .remedy("record at least two samples"));
        }
        if !(rate_hz.is_finite() && rate_hz > 0.0) {
            return Err(Diagnostic::new("a rate must be a positive number")
                .value(rate_hz)
                .remedy("give samples per second, such as 1000"));
        }
        if self.is_even_at(rate_hz) {
            return Ok(self.clone().untouched(rate_hz));
        }
        if self.duration_s() * rate_hz > LARGEST_GRID {
            return Err(self.grid_too_large(rate_hz, timing));
        }
        Ok(self.interpolated(rate_hz, timing))
    }

    fn is_even_at(&self, rate_hz: f64) -> bool {
        let own_period_s = self.duration_s() / (self.len() - 1) as f64;
        let start_s = self.time_s[0];
        (own_period_s * rate_hz - 1.0).abs() <= 1.001e-3
            && self.time_s.iter().enumerate().all(|(index, stamp)| {
                let even_s = start_s + index as f64 * own_period_s;
                (stamp - even_s).abs() < EVEN_PERIODS * own_period_s
            })
    }

    fn untouched(self, rate_hz: f64) -> UniformLog {
        UniformLog {
            low_pass_hz: None,
            path: self.path,
            kind: self.kind,
            rate_hz,
            in_gap: vec![false; self.time_s.len()],
            time_s: self.time_s,
            position_m: self.position_m,
            force_n: self.force_n,
            slower: Vec::new(),
            position_step_m: None,
            recognised: Vec::new(),
            untouched: true,
            taken: None,
            compensated: Compensated::default(),
            source: self.source,
            notes: self.notes,
        }
    }

    /// The samples in their places on the line, and straight lines in between.
    fn placed(&self, line: &Line, timing: &Timing) -> UniformLog {
        let jittered = self.stamps(Some(line)) == Stamps::Jittered;
        let mut grid = self.empty_grid(snapped(1.0 / line.period_s), line.numbers.len());
        let stamp_s = |at: usize| match jittered {
            true => line.time_s(line.numbers[at]),
            false => self.time_s[at],
        };
        for at in 0..self.len() {
            let numbers = match at {
                0 => line.numbers[0]..line.numbers[0],
                _ => line.numbers[at - 1] + 1..line.numbers[at],
            };
            for number in numbers {
                let (left, right) = (line.numbers[at - 1], line.numbers[at]);
                let share = (number - left) as f64 / (right - left) as f64;
                let between = |a: f64, b: f64| a + share * (b - a);
                grid.push(
                    between(stamp_s(at - 1), stamp_s(at)),
                    between(self.position_m[at - 1], self.position_m[at]),
                    between(self.force_n[at - 1], self.force_n[at]),
                    true,
                );
            }
            grid.push(stamp_s(at), self.position_m[at], self.force_n[at], false);
        }
        grid.slower = slower(&line.gaps(&self.time_s)).0;
        let notes = match jittered {
            true => self.what_the_line_did(line, &grid),
            false => self.what_interpolation_did(&grid, timing),
        };
        grid.notes.extend(notes);
        grid
    }

    fn what_the_line_did(&self, line: &Line, grid: &UniformLog) -> Vec<String> {
        let jitter_s = rms(line.residuals(&self.time_s));
        let scatter = match is_rounding(jitter_s, step_of_stamps(&self.time_s)) {
            true => "are rounded".into(),
            false => format!(
                "scatter by {} rms about an even clock, and force and position do not follow them",
                quantity(jitter_s, 2, "s")
            ),
        };
        let rate_hz = snapped(1.0 / line.period_s);
        let mut notes = vec![format!(
            "the time stamps {scatter}: the samples are taken as even, {rate_hz} a second"
        )];
        let is_missing = |at: &usize| grid.in_gap[*at] && !grid.is_slower(*at);
        let missing = (0..grid.len()).filter(is_missing).count();
        if missing > 0 {
            notes.push(format!(
                "{missing} of {} samples {} missing and interpolated between {} neighbours",
                grid.len(),
                if missing == 1 { "is" } else { "are" },
                if missing == 1 { "its" } else { "their" }
            ));
        }
        notes
    }

    fn empty_grid(&self, rate_hz: f64, count: usize) -> UniformLog {
        UniformLog {
            low_pass_hz: None,
            path: self.path.clone(),
            kind: self.kind,
            rate_hz,
            time_s: Vec::with_capacity(count),
            position_m: Vec::with_capacity(count),
            force_n: Vec::with_capacity(count),
            in_gap: Vec::with_capacity(count),
            slower: Vec::new(),
            position_step_m: signal::step(&self.position_m),
            recognised: Vec::new(),
            untouched: false,
            taken: None,
            compensated: Compensated::default(),
            source: self.source.clone(),
            notes: self.notes.clone(),
        }
    }

    fn interpolated(&self, rate_hz: f64, timing: &Timing) -> UniformLog {
        // A thousandth of a period: the last stamp belongs to the grid whatever its rounding.
        let count = (self.duration_s() * rate_hz + 1e-3).floor() as usize + 1;
        let mut grid = self.empty_grid(rate_hz, count);
        let mut left = 0;
        for index in 0..count {
            let time_s = self.time_s[0] + index as f64 / rate_hz;
            while left + 2 < self.len() && self.time_s[left + 1] <= time_s {
                left += 1;
            }
            self.push_between(&mut grid, left, time_s, timing);
        }
        grid.slower = slower(&timing.gaps).0;
        grid.notes
            .extend(self.what_interpolation_did(&grid, timing));
        grid
    }

    fn push_between(&self, grid: &mut UniformLog, left: usize, time_s: f64, timing: &Timing) {
        let (from_s, to_s) = (self.time_s[left], self.time_s[left + 1]);
        let share = ((time_s - from_s) / (to_s - from_s)).clamp(0.0, 1.0);
        let between = |channel: &[f64]| channel[left] + share * (channel[left + 1] - channel[left]);
        // On a stamp, to a thousandth of a period, the sample is the log's own.
        let off_stamps_s = (time_s - from_s).min(to_s - time_s);
        grid.push(
            time_s,
            between(&self.position_m),
            between(&self.force_n),
            to_s - from_s > GAP_PERIODS * timing.base_period_s
                && off_stamps_s > 1e-3 * timing.base_period_s,
        );
    }

    fn what_interpolation_did(&self, grid: &UniformLog, timing: &Timing) -> Vec<String> {
        let mut notes = vec![format!(
            "interpolated to {} Hz: intervals range from {} to {}",
            setting(grid.rate_hz, ""),
            quantity(timing.shortest_s, 4, "s"),
            quantity(timing.longest_s, 4, "s")
        )];
        let invented = grid.in_gap.iter().filter(|in_gap| **in_gap).count();
        if invented > 0 {
            notes.push(format!(
                "{}: {invented} of {} samples {} interpolated between {}",
                counted(timing.gaps.len(), "gap"),
                grid.len(),
                if invented == 1 { "is" } else { "are" },
                if timing.gaps.len() == 1 {
                    "its ends"
                } else {
                    "their ends"
                }
            ));
        }
        let denser = self
            .time_s
            .windows(2)
            .filter(|p| (p[1] - p[0]) * grid.rate_hz < 0.7)
            .count();
        if denser as f64 > 0.01 * self.len() as f64 {
            notes.push(format!(
                "{} closer than the grid: a higher rate would keep what they show",
                match denser {
                    1 => "1 sample lies".to_string(),
                    _ => format!("{denser} samples lie"),
                }
            ));
        }
        notes
    }

    /// What to say where a grid of that rate would be invented for the most part, beside stretches that were sampled more
    /// slowly and the pauses of the measurement.
    fn too_sparse(&self, rate_hz: f64, timing: &Timing) -> Option<Diagnostic> {
        let (slower, gaps) = slower(&timing.gaps);
        let is_slow = |at: &f64| {
            slower
                .iter()
                .any(|(from_s, to_s)| (from_s..to_s).contains(&at))
        };
        let slow_rows = self.time_s.iter().filter(|at| is_slow(at)).count();
        let slow_s: f64 = slower.iter().map(|(from_s, to_s)| to_s - from_s).sum();
        let lengths = gaps.iter().map(|gap| gap.to_s - gap.from_s);
        let paused_s: f64 = lengths.filter(|length_s| is_pause(*length_s, timing)).sum();
        let rows = (self.len() - slow_rows) as f64;
        let dense_s = self.duration_s() - slow_s - paused_s;
        let places = dense_s * rate_hz;
        let mean_hz = (rows / dense_s * 10.0).round() / 10.0;
        (places > MOST_PLACES * rows).then(|| {
            Diagnostic::new(format!(
                "{rows} rows in {} lie so unevenly that most samples of an even grid would be invented: many are {} \
                 apart, the longest interval is {}",
                quantity(dense_s, 3, "s"),
                quantity(timing.base_period_s, 2, "s"),
                quantity(timing.longest_s, 3, "s")
            ))
            .in_file(&self.path)
            .note(format!("a grid as fine as the dense ones has {places:.0} samples"))
            .remedy(format!(
                "if the samples were taken evenly and only stamped unevenly, give their rate: --rate {mean_hz} is what \
                 the rows over the time make; else record at even times"
            ))
        })
    }

    fn grid_too_large(&self, rate_hz: f64, timing: &Timing) -> Diagnostic {
        let longest = timing
            .gaps
            .iter()
            .max_by(|a, b| (a.to_s - a.from_s).total_cmp(&(b.to_s - b.from_s)));
        let diagnostic = Diagnostic::new(format!(
            "{:.3e} s at {rate_hz} Hz are too many samples to interpolate",
            self.duration_s()
        ))
        .in_file(&self.path);
        match longest {
            None => diagnostic.remedy("ask for a lower rate, or split the log"),
            Some(gap) => diagnostic
                .value(gap.to_s)
                .note(format!(
                    "the longest gap reaches from {} to {} s",
                    gap.from_s, gap.to_s
                ))
                .remedy("split the log at the gap, or correct its time stamps"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn straight_line(time_s: Vec<f64>) -> Log {
        let position = time_s.iter().map(|t| 2e-3 * t).collect();
        let force = time_s.iter().map(|t| 1.0 - 3.0 * t).collect();
        Log::from_channels(time_s, position, force)
    }

    #[test]
    fn an_even_log_passes_untouched() {
        // GIVEN stamps that are off by up to 0.6 % of a period, WHEN resampled to its own rate
        let stamps = (0..500).map(|i| f64::from(i) * 1e-3 + f64::from(i % 3) * 3e-6);
        let log = straight_line(stamps.collect());
        let grid = log.uniform().unwrap();
        // THEN nothing has changed, and nothing is claimed.
        assert!(grid.untouched);
        assert_eq!(grid.rate_hz, 1000.0);
        assert_eq!(grid.time_s, log.time_s);
        assert_eq!(grid.force_n, log.force_n);
        assert!(grid.notes.is_empty() && !grid.in_gap.contains(&true));
    }

    #[test]
    fn a_straight_line_stays_one_however_uneven_the_stamps() {
        let stamps = (0..500).map(|i| f64::from(i) * 1e-3 + f64::from(i * 7 % 5) * 1e-4);
        let log = straight_line(stamps.collect());
        let grid = log.resample(1000.0).unwrap();
        assert!(!grid.untouched);
        assert!(grid.notes[0].contains("interpolated to 1000 Hz"));
        for (time, force) in grid.time_s.iter().zip(&grid.force_n) {
            // Rounding of a product and a sum of numbers near one.
            assert!((force - (1.0 - 3.0 * time)).abs() < 1e-12);
        }
    }

    #[test]
    fn samples_inside_a_gap_are_flagged_and_those_at_its_ends_are_not() {
        let stamps = (0..100)
            .filter(|i| !(40..45).contains(i))
            .map(|i| f64::from(i) * 1e-3);
        let grid = straight_line(stamps.collect()).uniform().unwrap();
        assert_eq!(grid.len(), 100);
        let flagged: Vec<usize> = (0..100).filter(|i| grid.in_gap[*i]).collect();
        assert_eq!(flagged, [40, 41, 42, 43, 44]);
        assert!(
            grid.notes[1].contains("1 gap: 5 of 100"),
            "{:?}",
            grid.notes
        );
    }

    #[test]
    fn the_last_sample_stays_on_the_grid() {
        let log = straight_line((0..101).map(|i| f64::from(i) * 0.1).collect());
        assert_eq!(log.resample(20.0).unwrap().len(), 201);
    }

    #[test]
    fn a_grid_of_which_most_would_be_invented_is_refused_and_a_thinned_hold_is_none() {
        // GIVEN 16 rows 1 µs apart every 16 ms, which are samples of those instants
        let bunches = (0..3200).map(|i: u32| f64::from(i / 16) * 0.016 + f64::from(i % 16) * 1e-6);
        let error = straight_line(bunches.collect()).uniform().unwrap_err();
        assert!(error.to_string().contains("1005 is what"), "{error}");
        // WHEN 40 % are missing, or a hold of 100 s is sampled at 2 Hz, THEN the grid is made.
        let kept = (0..5000).filter(|i| i * 7919 % 5 < 3);
        let dropped = kept.map(|i: u32| f64::from(i) * 1e-3).collect();
        assert_eq!(straight_line(dropped).uniform().unwrap().rate_hz, 1000.0);
        let fast = (0..2000).map(|i: u32| f64::from(i) * 1e-3);
        let hold = (0..200).map(|i: u32| 2.0 + 0.5 * f64::from(i));
        let thinned = fast.clone().chain(hold).chain(fast.map(|t| 102.0 + t));
        let grid = straight_line(thinned.collect()).uniform().unwrap();
        assert_eq!(grid.len(), 104_000);
    }

    #[test]
    fn one_wrong_stamp_does_not_fill_the_memory() {
        let mut stamps: Vec<f64> = (0..100).map(|i| f64::from(i) * 1e-3).collect();
        stamps[99] = 1.7e9;
        let error = straight_line(stamps).uniform().unwrap_err();
        assert!(error.notes[0].contains("0.098"), "{error}");
    }
}
