//! Settings go to the board and come back; in contact it refuses what would disturb it.

use crate::{HELD, device, world};
use estimator_core::board::link::BYTES_PER_MS;
use estimator_core::board::link::{Answer, Command, Refusal};
use estimator_core::board::settings::{Key, Settings};
use palpate::link::world::Hand;

#[test]
fn settings_go_to_the_board_are_saved_and_come_back() {
    let mut device = device(&world(HELD), BYTES_PER_MS);
    assert_eq!(device.identity().unwrap().board.as_str(), "simulated");
    assert_eq!(device.settings().unwrap(), Settings::default());
    device.set(Key::EstimatorDepthM, 0.002).unwrap();
    device.order(Command::Save).unwrap();
    device.set(Key::EstimatorDepthM, 0.005).unwrap();
    assert!(device.identity().unwrap().unsaved);
    device.order(Command::Reload).unwrap();
    assert_eq!(device.get(Key::EstimatorDepthM).unwrap(), 0.002);
    let error = device
        .set(Key::EstimatorDepthM, -1.0)
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("estimator.depth_m") && error.contains("-1"),
        "{error}"
    );
    assert_eq!(device.get(Key::EstimatorDepthM).unwrap(), 0.002);
}

#[test]
fn in_contact_the_board_refuses_what_would_disturb_it_and_takes_the_rest() {
    let mut device = device(&world(Hand::Palpating), BYTES_PER_MS);
    let (mut refused, mut done) = (0, 0);
    // A question is answered 10 ms later: three seconds, of them two strokes.
    for _ in 0..300 {
        match device.ask(Command::Save).unwrap() {
            Answer::Done => done += 1,
            Answer::Refused(Refusal::InContact, 0) => refused += 1,
            other => panic!("{other:?}"),
        }
        device.set(Key::TelemetryEvery, 1.0).unwrap();
    }
    assert!(done > 10 && refused > 10, "{done} done, {refused} refused");
}
