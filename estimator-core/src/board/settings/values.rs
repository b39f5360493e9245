//! A value for every setting.

use super::key::{COUNT, Key};
use core::fmt;

/// A value for every setting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    values: [f32; COUNT],
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            values: Key::table().map(|key| key.info().default),
        }
    }
}

/// A value that cannot be used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Invalid {
    /// The setting.
    pub key: Key,
    /// The value.
    pub value: f32,
    /// What would be right, where that is not [`super::Info::bounds`].
    pub expected: Option<&'static str>,
}

impl fmt::Display for Invalid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let info = self.key.info();
        write!(f, "{} = {}: must be ", info.name, self.value)?;
        match self.expected {
            // The estimator's own errors begin with it.
            Some(expected) => f.write_str(expected.strip_prefix("must be ").unwrap_or(expected)),
            None => write!(f, "{}", info.bounds),
        }
    }
}

impl core::error::Error for Invalid {}

impl Settings {
    /// The value of a setting. Never inlined, as everything that runs rarely: the image has 128 KiB.
    #[inline(never)]
    pub fn get(&self, key: Key) -> f32 {
        self.values
            .get(key.slot())
            .copied()
            .unwrap_or(key.info().default)
    }

    /// Gives a setting any value; [`Settings::check`] says whether it can be used.
    pub fn put(&mut self, key: Key, value: f32) {
        if let Some(slot) = self.values.get_mut(key.slot()) {
            *slot = value;
        }
    }

    /// The first value that its own bounds do not allow.
    pub(super) fn out_of_bounds(&self) -> Option<Invalid> {
        let each = Key::table().iter().map(|key| (*key, self.get(*key)));
        let mut outside = each.filter(|(key, value)| !key.info().bounds.hold(*value));
        outside.next().map(|(key, value)| Invalid {
            key,
            value,
            expected: None,
        })
    }
}
