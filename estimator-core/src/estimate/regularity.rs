//! Whether the positions follow each other as evenly as their time stamps say.
//!
//! Where rows are missing and the stamps hide it, the probe seems to hop, and to be faster than it is: a
//! share p of missing rows makes every speed 1/(1 − p) times too large, and the damping as much too small.
//! With e, by how much an increment d₁ exceeds the mean v = ½(d₀ + d₂) of its neighbours, one missing row
//! leaves Σe³ = ¾v³ (e = v, and −½v on either side), while counts, jitter and noise leave none on the mean,
//! since they take from one increment what they give to the next.

use crate::maths::scalar::Real;

/// Memory of what is said about rows (samples), of the usual e, and of the speed.
const MEMORY: f64 = 8192.0;
const USUAL: f64 = 2048.0;
const SPEED: f64 = 16.0;
/// What one missing row leaves of v³.
const LEFT: f64 = 0.75;
/// Largest e over v that enters: one hole must not fill the memory.
const LARGEST: f64 = 4.0;
/// A speed whose cube is more times the usual one says nothing: a second of an encoder that jumps by metres
/// would otherwise be remembered for good. Of a sine it is 2.4 at most.
const UNUSUAL: f64 = 8.0;
/// Slowest speed that says something (counts a sample): below, each count is a hop of its own.
const SLOWEST: f64 = 2.0;
/// A hop that the filter must forget exceeds this many times the speed, so many standard deviations of the
/// usual e, and so many counts: a hole of three rows.
const HOP: f64 = 1.5;
const HOP_SIGMAS: f64 = 6.0;
const HOP_COUNTS: f64 = 4.0;

/// Watches the positions.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Regularity<T> {
    last_m: Option<T>,
    /// The two increments before the newest one (m).
    before: [T; 2],
    /// Number of increments since the last gap, up to 2.
    known: u32,
    /// Mean increment (m).
    speed: T,
    /// Mean of e² (m²), sums of e³ and |v|³ (m³).
    mean_square: T,
    third: T,
    speeds: T,
    /// Number of increments in them.
    rows: T,
}

impl<T: Real> Regularity<T> {
    /// Takes a position (m), right after the last one unless there is a gap; `count_m` is a count of the
    /// sensor. Says whether the probe has hopped.
    pub(crate) fn update(&mut self, position_m: T, gap: bool, count_m: T) -> bool {
        let last_m = self.last_m.replace(position_m);
        let Some(last_m) = last_m.filter(|_| !gap) else {
            self.known = 0;
            return false;
        };
        let newest = position_m - last_m;
        let [first, middle] = self.before;
        self.before = [middle, newest];
        if self.known < 2 {
            self.known += 1;
            return false;
        }
        // One spike is no speed.
        let most = T::from_f64(LARGEST) * (self.speed.abs() + count_m);
        let change = (middle - self.speed).max_of(-most).min_of(most);
        self.speed += T::from_f64(1.0 / SPEED) * change;
        let around = T::from_f64(0.5) * (first + newest);
        self.count_missing(middle - around, count_m);
        self.hops(middle - around, around.abs(), count_m)
    }

    fn count_missing(&mut self, excess: T, count_m: T) {
        let size = self.speed.abs();
        if size <= T::from_f64(SLOWEST) * count_m {
            return;
        }
        let kept = T::from_f64(1.0 - 1.0 / MEMORY);
        let cube_of_speed = size * size * size;
        let most = T::from_f64(UNUSUAL) * self.speeds;
        let is_unusual = self.rows > T::one() && cube_of_speed * self.rows > most;
        self.rows = kept * self.rows + T::one();
        if is_unusual {
            // The usual speed follows, by so much a row.
            self.speeds = kept * self.speeds + most / self.rows;
            return;
        }
        let largest = T::from_f64(LARGEST) * size;
        let along = if self.speed < T::zero() {
            -excess
        } else {
            excess
        };
        let along = along.max_of(-largest).min_of(largest);
        self.third = kept * self.third + along * along * along;
        self.speeds = kept * self.speeds + cube_of_speed;
    }

    fn hops(&mut self, excess: T, speed: T, count_m: T) -> bool {
        let square = excess * excess;
        let usual = T::from_f64(HOP_SIGMAS * HOP_SIGMAS) * self.mean_square;
        let counts = T::from_f64(HOP_COUNTS) * count_m;
        let hops = square > usual + counts * counts && excess.abs() > T::from_f64(HOP) * speed;
        let bounded = if hops { usual } else { square };
        self.mean_square += T::from_f64(1.0 / USUAL) * (bounded - self.mean_square);
        hops
    }

    /// Share of the rows that seem to be missing, by which every speed may be too large. What chance may have left of
    /// Σe³, √Σe⁶, is not taken off it: of presses at two counts a sample that miss 30 % of their rows it hid half for
    /// two seconds, with a damping that was a third too small at a claimed 2 to 7 %.
    pub(crate) fn missing_share(&self) -> T {
        if self.third <= T::zero() || self.speeds <= T::zero() {
            return T::zero();
        }
        self.third / (T::from_f64(LEFT) * self.speeds)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Strokes of 1 mm at 1.2 Hz in counts of 1 µm; `keeps` says which of the rows are kept.
    fn watch(keeps: impl Fn(u32) -> bool) -> (Regularity<f64>, u32) {
        let mut regularity = Regularity::default();
        let mut hops = 0;
        for i in (0..6000).filter(|i| keeps(*i)) {
            let millimetres = 1.0 - libm::cos(7.5e-3 * f64::from(i));
            let position_m = libm::round(millimetres * 1e3) * 1e-6;
            hops += u32::from(regularity.update(position_m, false, 1e-6));
        }
        (regularity, hops)
    }

    #[test]
    fn even_strokes_miss_nothing() {
        let (regularity, hops) = watch(|_| true);
        assert_eq!(hops, 0);
        assert!(regularity.missing_share() < 1e-3);
    }

    #[test]
    fn one_row_in_twenty_that_is_missing_shows_as_such() {
        // Every 20th on the mean, at no fixed distance.
        let (regularity, _) = watch(|i| i.wrapping_mul(2_654_435_761) % 1000 >= 50);
        let share = regularity.missing_share();
        assert!((0.03..0.08).contains(&share), "{share}");
    }

    #[test]
    fn a_hole_is_a_hop_and_a_gap_that_is_known_is_none() {
        let (_, hops) = watch(|i| !(3200..3220).contains(&i));
        assert_eq!(hops, 1);
        let mut regularity = Regularity::default();
        for i in 0..100 {
            let jump = if i < 50 { 0.0 } else { 1e-3 };
            let position_m = 1e-6 * f64::from(i) + jump;
            assert!(!regularity.update(position_m, i == 50, 1e-6));
        }
    }
}
