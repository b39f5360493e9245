//! The bridge of `palpate teleop` as two processes on a network, each with a board at a pseudo-terminal, and one of
//! them killed: the master's board fades out by itself, says so, and comes back.
use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Child, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard};
use std::thread;
use std::time::{Duration, Instant};

use crate::common::Folder;
use estimator_core::Fault;
use estimator_core::board::frame::{Frame, MAX_ENCODED, encode};
use estimator_core::board::link::{BYTES_PER_MS, Command};
use estimator_core::board::sampling::FULL;
use estimator_core::board::settings::Key as Setting;
use estimator_core::physics::law::{ContactLaw, HuntCrossley};
use palpate::link::SimulatedBoard;
use palpate::link::world::{Hand, World};
use serialport::{SerialPort, TTYPort};

const TIMEOUT_S: f32 = 0.5;
const FADE_S: f32 = 0.1;
const FULL_N: f32 = 15.0;
const DEEP_M: f64 = 3e-3;
/// What a busy machine may hold a datagram up by, on top of timeout and fade (ms of the board).
const HELD_UP_MS: u32 = 1000;
/// A test that waits longer has failed; on an idle machine it takes five seconds.
const PATIENCE: Duration = Duration::from_secs(120);

/// A board that runs in real time at the other end of a pseudo-terminal.
struct Rig {
    port: String,
    board: Arc<Mutex<SimulatedBoard>>,
    stop: Arc<AtomicBool>,
}

impl Rig {
    fn start(hand: Hand, settings: &[(Setting, f32)], arm: bool) -> Rig {
        let mut world = World::default();
        // A calibrated cell.
        world.n_per_code /= 1.03;
        world.zero_code = 65_536.0;
        world.hand = hand;
        let mut board = SimulatedBoard::new(Arc::new(Mutex::new(world)), BYTES_PER_MS);
        let prepare = |(key, value): &(Setting, f32)| Command::Prepare(key.id(), *value);
        let commands = settings.iter().map(prepare).chain([Command::Commit]);
        for command in commands.chain(arm.then_some(Command::Arm)) {
            tell(&mut board, command);
        }
        let (line, end) = TTYPort::pair().unwrap();
        let rig = Rig {
            port: end.name().unwrap(),
            board: Arc::new(Mutex::new(board)),
            stop: Arc::default(),
        };
        // It holds a lock on the port.
        drop(end);
        let (board, stop) = (Arc::clone(&rig.board), Arc::clone(&rig.stop));
        thread::spawn(move || serve(line, &board, &stop));
        rig
    }

    fn board(&self) -> MutexGuard<'_, SimulatedBoard> {
        self.board.lock().unwrap()
    }

    /// The force that is put out (N).
    fn force_n(&self) -> f32 {
        f32::from(self.board().force_code()) / f32::from(FULL) * FULL_N
    }

    /// Milliseconds of the board so far.
    fn now_ms(&self) -> u32 {
        self.board().counts().0
    }

    fn has_faded_out(&self) -> bool {
        let flagged = self.board().faults().has(Fault::RenderStopped);
        flagged && self.force_n() == 0.0
    }
}

impl Drop for Rig {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
    }
}

/// Gives a board a command, and time for it.
fn tell(board: &mut SimulatedBoard, command: Command) {
    let mut bytes = [0; MAX_ENCODED];
    let length = encode(&Frame::Command(command), 0, &mut bytes);
    board.receive(&bytes[..length]);
    for _ in 0..5 {
        board.tick();
        board.take(&mut [0; 4096]);
    }
}

/// Runs a board in real time. As on a wire, bytes that nobody takes are lost.
fn serve(mut line: TTYPort, board: &Mutex<SimulatedBoard>, stop: &AtomicBool) {
    line.set_timeout(Duration::from_millis(1)).unwrap();
    let (start, mut ticks) = (Instant::now(), 0);
    let mut bytes = [0; 4096];
    while !stop.load(Ordering::Relaxed) {
        let read = line.read(&mut bytes).unwrap_or_else(|_| {
            thread::sleep(Duration::from_millis(1));
            0
        });
        let mut board = board.lock().unwrap();
        board.receive(&bytes[..read]);
        while ticks < start.elapsed().as_millis() {
            board.tick();
            ticks += 1;
        }
        let count = board.take(&mut bytes);
        drop(board);
        let _ = line.write(&bytes[..count]);
    }
}

/// A process of the bridge, with the lines that it has printed.
struct End {
    child: Child,
    lines: Arc<Mutex<Vec<String>>>,
}

impl End {
    fn start(folder: &Folder, arguments: &[&str]) -> End {
        let mut child = folder
            .command(&[&["teleop", "--key", "bridge.key"], arguments].concat())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let said = BufReader::new(child.stdout.take().unwrap());
        let lines = Arc::new(Mutex::new(Vec::new()));
        let kept = Arc::clone(&lines);
        thread::spawn(move || {
            for line in said.lines().map_while(Result::ok) {
                kept.lock().unwrap().push(line);
            }
        });
        End { child, lines }
    }

    fn lines(&self) -> Vec<String> {
        self.lines.lock().unwrap().clone()
    }

    /// Waits for a line with a text.
    fn says(&self, text: &str) -> String {
        until(text, || {
            self.lines().into_iter().find(|line| line.contains(text))
        })
    }

    /// Ends the process as an out-of-memory killer does.
    fn kill(&mut self) {
        self.child.kill().unwrap();
        self.child.wait().unwrap();
    }
}

impl Drop for End {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Waits until something is there.
fn until<T>(what: &str, mut is: impl FnMut() -> Option<T>) -> T {
    let start = Instant::now();
    while start.elapsed() < PATIENCE {
        if let Some(found) = is() {
            return found;
        }
        thread::sleep(Duration::from_millis(5));
    }
    panic!("waited in vain for: {what}");
}

fn slave() -> Rig {
    let settings = [
        (Setting::ReflectionEvery, 10.0),
        (Setting::TelemetryEvery, 50.0),
    ];
    Rig::start(Hand::Palpating, &settings, false)
}

/// A master whose handle is held 3 mm deep.
fn master() -> Rig {
    let settings = [
        (Setting::RenderForceN, 12.0),
        (Setting::RenderFullN, FULL_N),
        (Setting::RenderDeviceNsPerM, 100.0),
        (Setting::RenderTimeoutS, TIMEOUT_S),
        (Setting::RenderFadeS, FADE_S),
        (Setting::TelemetryEvery, 10.0),
    ];
    let hand = Hand::Holding {
        position_m: DEEP_M,
        force_n: 0.0,
    };
    Rig::start(hand, &settings, true)
}

fn key_for_its_owner(folder: &Folder) {
    use std::os::unix::fs::PermissionsExt;
    folder.write("bridge.key", "9f".repeat(32));
    let permissions = std::fs::Permissions::from_mode(0o600);
    std::fs::set_permissions(folder.path("bridge.key"), permissions).unwrap();
}

/// Waits until the master puts out what the gel does at its depth, within the bar of the simulated system.
fn renders_the_gel(master: &Rig) {
    let real_n = HuntCrossley::new(1350.0_f64, 36.0, 1.35, 1e-3).force_n(DEEP_M, 0.0);
    until("the gel's force", || {
        let share = f64::from(master.force_n()) / real_n - 1.0;
        (share.abs() < 0.05).then_some(())
    });
}

/// Ends a process and checks that the board's force fades out in time, by the board's own clock, and is flagged.
fn fades_out_after_the_end_of(end: &mut End, master: &Rig) {
    let killed_ms = master.now_ms();
    end.kill();
    until("a force of 0 N, flagged", || {
        master.has_faded_out().then_some(())
    });
    let faded_ms = master.now_ms() - killed_ms;
    let in_time_ms = (1e3 * (TIMEOUT_S + FADE_S)) as u32 + HELD_UP_MS;
    assert!(faded_ms <= in_time_ms, "{faded_ms} ms");
    // And it stays so.
    let later_ms = master.now_ms() + 300;
    until("some time", || (master.now_ms() > later_ms).then_some(()));
    assert!(master.has_faded_out());
}

#[test]
fn whichever_process_is_killed_the_master_fades_out_flagged_and_comes_back() {
    let folder = Folder::new();
    key_for_its_owner(&folder);
    let (slave, master) = (slave(), master());
    let listening = ["--slave", &slave.port, "--listen", "127.0.0.1:0"];
    let mut at_slave = End::start(&folder, &listening);
    let line = at_slave.says("listening at ");
    let address = line.rsplit(' ').next().unwrap().to_string();
    let connecting = ["--master", &master.port, "--connect", &address];
    let mut at_master = End::start(&folder, &connecting);
    renders_the_gel(&master);
    // WHEN the slave's process is killed, THEN the force fades out, and the other process says so.
    fades_out_after_the_end_of(&mut at_slave, &master);
    at_master.says("faded out");
    // WHEN it is started again, THEN the force comes back by itself.
    let again = ["--slave", &slave.port, "--listen", &address];
    let at_slave = End::start(&folder, &again);
    renders_the_gel(&master);
    // WHEN the master's process is killed, THEN its board does the same alone, and the slave's misses the other end.
    fades_out_after_the_end_of(&mut at_master, &master);
    at_slave.says("no other end");
    let _again = End::start(&folder, &connecting);
    renders_the_gel(&master);
}
