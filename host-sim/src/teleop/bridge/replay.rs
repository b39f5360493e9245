//! The replay window: which numbers of datagrams have been seen.

/// Numbers below the newest one that are remembered.
const WIDTH: u64 = 128;

/// The window of a session, as in RFC 6479: a bit for each of the last numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ReplayWindow {
    /// One above the newest number; 0 before the first.
    end: u64,
    seen: u128,
}

impl ReplayWindow {
    /// Whether a number is new; it is then remembered. A number below the window counts as seen.
    pub fn accept(&mut self, number: u64) -> bool {
        let Some(after) = number.checked_add(1) else {
            return false;
        };
        if after > self.end {
            let shift = after - self.end;
            self.seen = if shift < WIDTH { self.seen << shift } else { 0 };
            self.seen |= 1;
            self.end = after;
            return true;
        }
        let back = self.end - after;
        if back >= WIDTH {
            return false;
        }
        let bit = 1_u128 << back;
        let fresh = self.seen & bit == 0;
        self.seen |= bit;
        fresh
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_passes_once_in_any_order_within_the_window_and_never_below() {
        let mut window = ReplayWindow::default();
        for number in [0, 3, 1, 2, 130, 129, 4] {
            assert!(window.accept(number), "{number}");
            assert!(!window.accept(number), "{number} again");
        }
        assert!(!window.accept(2), "below the window");
        assert!(window.accept(1_000_000));
        assert!(!window.accept(130));
        assert!(window.accept(1_000_000 - 127) && !window.accept(1_000_000 - 128));
        assert!(!window.accept(u64::MAX));
    }
}
