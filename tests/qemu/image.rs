//! The images of the firmware: their size, and the board's image where no clock starts.

use crate::budget::contains;
use std::env;
use std::path::PathBuf;
use tests::emulator::{Emulator, footprint};

#[test]
fn the_images_take_the_flash_and_ram_that_the_budget_says() {
    for (variable, key) in [("PALPATE_QEMU_ELF", "qemu"), ("PALPATE_F405_ELF", "f405")] {
        let elf = PathBuf::from(env::var_os(variable).expect(variable));
        let (flash, ram) = footprint(&elf).expect("footprint");
        println!("{key}: {flash} bytes of flash, {ram} bytes of RAM");
        contains(&format!("{key}.flash"), flash);
        contains(&format!("{key}.ram"), ram);
    }
}

/// The emulator's clocks never become ready. WHEN the board's image starts there, THEN it says so, instead
/// of waiting for ever.
#[test]
fn a_board_whose_clocks_do_not_start_says_so() {
    let elf = PathBuf::from(env::var_os("PALPATE_F405_ELF").expect("PALPATE_F405_ELF"));
    let emulator = Emulator {
        elf,
        ..Emulator::from_env("no-clock").expect("set-up")
    };
    let log = emulator.log_in_memory("PLL").expect("log");
    assert_eq!(log.len(), 2, "{log:?}");
    assert!(log[0].contains("on f405"), "{log:?}");
    assert!(log[1].contains("the PLL does not lock"), "{log:?}");
}
