//! Where the probe is, and what happened to it.

/// Where the probe is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum Phase {
    /// Measuring the noise and the resting force; the probe should be in free air.
    #[default]
    Settling = 0,
    /// In free air.
    Free = 1,
    /// In contact.
    Contact = 2,
}

impl Phase {
    /// The phase with a number.
    pub const fn from_code(code: u8) -> Option<Phase> {
        match code {
            0 => Some(Phase::Settling),
            1 => Some(Phase::Free),
            2 => Some(Phase::Contact),
            _ => None,
        }
    }
}

/// Something that happened at this sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Event {
    /// The probe touched.
    Contact = 1,
    /// The probe lifted off.
    Release = 2,
    /// The material is another one.
    MaterialChange = 3,
}

impl Event {
    /// The event with a number.
    pub const fn from_code(code: u8) -> Option<Event> {
        match code {
            1 => Some(Event::Contact),
            2 => Some(Event::Release),
            3 => Some(Event::MaterialChange),
            _ => None,
        }
    }

    /// The name in `estimate.json`.
    pub const fn name(self) -> &'static str {
        match self {
            Event::Contact => "contact",
            Event::Release => "release",
            Event::MaterialChange => "material_change",
        }
    }
}
