//! How a rig moves, and with that the units of all that is said of it: the one place where they come from.

/// Whether a rig moves along a line or turns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MotionKind {
    /// Positions in m, forces in N.
    #[default]
    Linear,
    /// Positions in rad, forces in N m.
    Rotary,
}

/// The units of a rig that moves along a line, each with what stands in its place where it turns. Other units, of
/// time, frequency, energy and shares, are the same for both.
const UNITS: [(&str, &str); 12] = [
    ("m", "rad"),
    ("m/s", "rad/s"),
    ("m/s²", "rad/s²"),
    ("1/m", "1/rad"),
    ("N", "N m"),
    ("N/s", "N m/s"),
    ("N/√Hz", "N m/√Hz"),
    ("N/m", "N m/rad"),
    ("N s/m", "N m s/rad"),
    ("N/m²", "N m/rad²"),
    ("N s/m²", "N m s/rad²"),
    ("kg", "kg m²"),
];

impl MotionKind {
    /// The unit of a quantity whose unit is `linear` on a rig that moves along a line.
    ///
    /// ```
    /// use palpate::motion_kind::MotionKind;
    /// assert_eq!(MotionKind::Rotary.unit("N s/m"), "N m s/rad");
    /// assert_eq!(MotionKind::Rotary.unit("Hz"), "Hz");
    /// assert_eq!(MotionKind::Linear.unit("N s/m"), "N s/m");
    /// ```
    pub fn unit(self, linear: &str) -> &str {
        let row = UNITS.iter().find(|(unit, _)| *unit == linear);
        match (self, row) {
            (MotionKind::Rotary, Some((_, rotary))) => rotary,
            _ => linear,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_unit_of_a_turning_rig_stays_what_it_is() {
        for (linear, rotary) in UNITS {
            assert_eq!(MotionKind::Rotary.unit(linear), rotary);
            assert_eq!(MotionKind::Rotary.unit(rotary), rotary);
            assert_eq!(MotionKind::Linear.unit(linear), linear);
        }
    }
}
