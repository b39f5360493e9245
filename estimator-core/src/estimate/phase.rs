//! Phases and events of a contact.

/// Phase of a contact: where the probe is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum Phase {
    /// Noise and resting force are being measured; the probe should be in free air.
    #[default]
    Settling = 0,
    /// The probe is in free air.
    Free = 1,
    /// The probe is in contact.
    Contact = 2,
}

impl Phase {
    /// The phase with this code.
    pub fn from_code(code: u8) -> Option<Phase> {
        [Phase::Settling, Phase::Free, Phase::Contact]
            .into_iter()
            .find(|phase| *phase as u8 == code)
    }
}

/// Event at one sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Event {
    /// The probe touched.
    Contact = 1,
    /// The probe lifted off.
    Release = 2,
    /// The material has changed.
    MaterialChange = 3,
}

impl Event {
    /// The event with this code.
    pub fn from_code(code: u8) -> Option<Event> {
        [Event::Contact, Event::Release, Event::MaterialChange]
            .into_iter()
            .find(|event| *event as u8 == code)
    }

    /// The name of the event in `estimate.json`.
    pub const fn name(self) -> &'static str {
        match self {
            Event::Contact => "contact",
            Event::Release => "release",
            Event::MaterialChange => "material_change",
        }
    }
}
