//! What a packet has to hold so that its law can be rendered.

use crate::physics::law::LawKind;
use core::fmt;

/// The largest number of parameters of a law, the surface included.
pub const PACKET_SLOTS: usize = 7;
const _: () = {
    let mut at = 0;
    while at < LawKind::ALL.len() {
        assert!(LawKind::ALL[at].parameters().len() <= PACKET_SLOTS);
        at += 1;
    }
};

/// A parameter with whose value a law cannot be rendered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NotRenderable {
    /// The law.
    pub law: LawKind,
    /// The index among the law's parameters.
    pub slot: usize,
    /// The value.
    pub value: f32,
}

impl fmt::Display for NotRenderable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let parameter = self.law.parameters().get(self.slot);
        let name = parameter.map_or("?", |parameter| parameter.name);
        write!(f, "{name} = {} cannot be rendered", self.value)
    }
}

impl core::error::Error for NotRenderable {}
