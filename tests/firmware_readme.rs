//! What firmware/README.md says in numbers and names is what the code has.

use estimator_core::Fault;
use estimator_core::board::frame::{Frame, Instant, MAX_ENCODED, encode};
use estimator_core::board::link::{BAUD, BYTES_PER_MS};
use estimator_core::board::sampling::{FULL, QUEUE};
use estimator_core::board::sensing::{CODES_PER_COUNT, Codes};
use estimator_core::board::settings::compensation::Parameter;
use estimator_core::board::settings::store::SLOT;
use estimator_core::board::settings::{Key, Settings};
use estimator_core::physics::effect::EffectId;
use estimator_core::physics::law::LawKind;
use estimator_core::{Config, Sample, State, step};
use palpate::link::backup;
use std::fs;
use std::path::Path;

fn of_the_firmware(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../firmware")
        .join(name);
    fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

#[test]
fn its_table_of_faults_has_every_fault_with_its_number_and_its_setting() {
    let readme = of_the_firmware("README.md");
    let (_, table) = readme.split_once("## Faults").expect("a section");
    let rows: Vec<&str> = table
        .lines()
        .take_while(|line| !line.starts_with("## "))
        .filter(|line| line.starts_with("| ") && !line.starts_with("| number"))
        .collect();
    assert_eq!(rows.len(), Fault::ALL.len());
    for (fault, row) in Fault::ALL.into_iter().zip(rows) {
        assert!(row.starts_with(&format!("| {} |", fault.code())), "{row}");
        // What is said in the code up to the comma says what it is; after it, what follows.
        let what = fault.describe().split(',').next().unwrap_or_default();
        assert!(row.contains(what), "{row}: {what}");
        match Key::deciding(fault) {
            Some(key) => assert!(row.contains(key.info().name), "{row}"),
            None => assert!(
                !row.contains("_code`") && !row.contains("position."),
                "{row}"
            ),
        }
    }
}

#[test]
fn its_table_of_compensations_has_every_effect_with_its_numbers() {
    let readme = of_the_firmware("README.md");
    let (_, table) = readme.split_once("## Compensation").expect("a section");
    let (table, _) = table.split_once("\n## ").expect("another section");
    let rows: Vec<&str> = table.lines().filter(|row| row.starts_with("| `")).collect();
    for id in EffectId::ALL.iter().copied() {
        let name = format!("`{}`", id.name());
        let row = rows.iter().find(|row| row.contains(&name));
        let keys = (0..id.info().parameters.len()).filter_map(|place| Parameter::of(id, place));
        let numbers: Vec<u8> = keys.map(|own| Key::Compensation(own).id()).collect();
        assert_eq!(row.is_some(), !numbers.is_empty(), "{name}");
        for (row, number) in row
            .iter()
            .flat_map(|row| [(row, numbers[0]), (row, numbers[numbers.len() - 1])])
        {
            let cell = row.split('|').nth(2).expect("numbers");
            let mut listed = cell.split([',', '–']).map(|word| word.trim().parse::<u8>());
            assert!(listed.any(|own| own == Ok(number)), "{row}: {number}");
        }
    }
    let late = {
        let mut settings = Settings::default();
        let mass = Key::from_name("compensation.tool_inertia.mass").expect("a setting");
        settings.put(mass, 0.1);
        settings.setup().expect("valid").late_us
    };
    assert!(table.contains(&format!("estimates {} ms later", late / 1000)));
}

/// Bytes of codes, sample and estimate on the wire, in one frame.
fn record_of(law: LawKind) -> usize {
    let params = Config::default()
        .validate::<f32>()
        .expect("the default is valid");
    let mut estimate = step(&params, &mut State::new(&params), Sample::default());
    estimate.law = law;
    let instant = Instant {
        // Many conversions are summed.
        codes: Codes {
            force_high: 1,
            ..Codes::default()
        },
        sample: Sample::default(),
        estimate,
    };
    assert!(instant.fits());
    encode(&Frame::Record(instant), 0, &mut [0; MAX_ENCODED])
}

#[test]
fn its_bytes_and_counts_are_those_of_the_frames_and_the_store() {
    let readme = of_the_firmware("README.md");
    let longest = LawKind::ALL.into_iter().map(record_of).max().expect("laws");
    assert!(
        readme.contains(&format!("\n{longest} bytes, of {BYTES_PER_MS}")),
        "{longest}"
    );
    let default = record_of(LawKind::HuntCrossley);
    assert!(
        readme.contains(&format!("Hunt–Crossley's {default}")),
        "{default}"
    );
    for counted in [
        format!("{} Mbaud", BAUD / 1_000_000),
        format!("{FULL} steps"),
        format!("queue of {QUEUE} records"),
    ] {
        assert!(readme.contains(&counted), "{counted}");
    }
    let saves = 128 * 1024 / SLOT;
    assert!(readme.contains(&format!("{saves}th erases")), "{saves}");
}

#[test]
fn the_settings_for_spi_sensors_can_be_restored() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../firmware/settings-spi.toml");
    let settings = backup::read(&path, Settings::default()).expect("settings");
    assert_eq!(settings.get(Key::ForceHighestCode), 8_300_000.0);
    // 5 mm a turn of 16 384 counts.
    let count_m = f64::from(settings.get(Key::PositionPerCode)) * f64::from(CODES_PER_COUNT);
    let turn_m = count_m * 16_384.0;
    assert!((turn_m - 5e-3).abs() < 1e-9, "{turn_m}");
}

/// The files of a folder of the firmware, each with its name and its text.
fn sources(folder: &Path) -> Vec<(String, String)> {
    let entries = fs::read_dir(folder).expect("a folder");
    let paths = entries.map(|entry| entry.expect("an entry").path());
    paths
        .flat_map(|path| match path.is_dir() {
            true => sources(&path),
            false => {
                let text = fs::read_to_string(&path).expect("text");
                vec![(path.display().to_string(), text)]
            }
        })
        .collect()
}

#[test]
fn only_the_folder_of_its_board_names_the_crate_of_a_chip() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("../firmware/src");
    let naming: Vec<String> = sources(&source)
        .into_iter()
        .filter(|(_, text)| text.contains("stm32f4xx"))
        .map(|(name, _)| name)
        .collect();
    assert!(!naming.is_empty());
    let below = naming.iter().filter(|name| name.contains("board/f405/"));
    assert_eq!(below.count(), naming.len(), "{naming:?}");
    // And the emulator is built without it.
    let manifest = of_the_firmware("Cargo.toml");
    let features = |board: &str| {
        let feature = manifest.lines().find(|line| line.starts_with(board));
        feature.expect("a feature").contains("dep:stm32f4xx-hal")
    };
    assert!(features("f405 =") && !features("qemu ="));
    let hal = manifest
        .lines()
        .find(|line| line.starts_with("stm32f4xx-hal ="));
    assert!(hal.expect("the HAL").contains("optional = true"));
}
