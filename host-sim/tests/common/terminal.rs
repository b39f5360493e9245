//! A simulated board at one end of a pseudo-terminal.

use palpate::link::SimulatedBoard;
use serialport::{SerialPort, TTYPort};
use std::io::{self, Read, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

/// Runs a board at the master's end in real time until `stop` is set, then gives it back.
pub(crate) fn serve(
    mut line: TTYPort,
    mut board: SimulatedBoard,
    stop: Arc<AtomicBool>,
) -> thread::JoinHandle<SimulatedBoard> {
    line.set_timeout(Duration::from_millis(1)).unwrap();
    thread::spawn(move || {
        let (start, mut ticks) = (Instant::now(), 0);
        let mut bytes = [0; 4096];
        while !stop.load(Ordering::Relaxed) {
            if let Ok(count) = line.read(&mut bytes) {
                board.receive(&bytes[..count]);
            }
            while ticks < start.elapsed().as_millis() {
                board.tick();
                ticks += 1;
            }
            let count = board.take(&mut bytes);
            send(&mut line, &bytes[..count], &stop);
        }
        board
    })
}

/// Sends all bytes, however slow the reader is, and none where there is no reader.
fn send(line: &mut TTYPort, mut bytes: &[u8], stop: &AtomicBool) {
    while !bytes.is_empty() && !stop.load(Ordering::Relaxed) {
        match line.write(bytes) {
            Ok(count) => bytes = &bytes[count..],
            Err(error) if error.kind() == io::ErrorKind::TimedOut => {}
            Err(_) => return,
        }
    }
}
