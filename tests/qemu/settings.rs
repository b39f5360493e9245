//! Settings in the flash of the emulated board.

use estimator_core::board::ram_flash::{RamFlash, SECTOR};
use estimator_core::board::settings::store::Store;
use estimator_core::board::settings::{Key, Settings};
use std::fs;
use tests::emulator::Emulator;

/// The default settings with some of them changed.
pub(crate) fn changed(values: impl IntoIterator<Item = (Key, f32)>) -> Settings {
    let mut settings = Settings::default();
    for (key, value) in values {
        settings.put(key, value);
    }
    settings
}

/// Saves settings where the firmware of the next run finds them.
pub(crate) fn save(emulator: &Emulator, settings: &Settings) {
    let mut store = Store::new(RamFlash::default(), 0, SECTOR);
    store.save(settings).expect("memory");
    let flash = emulator.directory.join("settings.flash");
    fs::write(flash, store.release().bytes()).expect("settings.flash");
}
