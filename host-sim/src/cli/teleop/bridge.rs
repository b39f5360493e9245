//! `palpate teleop --slave PORT --master PORT`, and its ends on two hosts.

use std::error::Error;
use std::net::{SocketAddr, ToSocketAddrs};
use std::path::Path;
use std::time::{Duration, Instant};

use super::args::TeleopArgs;
use estimator_core::board::link::Command;
use estimator_core::board::settings::Key;

use crate::diagnostic::Diagnostic;
use crate::interrupt::{is_interrupted, watch};
use crate::json::write_json;
use crate::link::{Device, Port, port};
use crate::number::quantity;
use crate::output::{result, say};
use crate::teleop::bridge::run::{
    MasterView, Wire, check_master, check_slave, framed, give, local, look, packets,
};
use crate::teleop::bridge::{Counts, Endpoint, Key as Secret, Role, Summary};
use crate::teleop::channel::Channel;
use crate::teleop::held::Held;
use crate::teleop::json;

/// How often a line is printed.
const TELLS: Duration = Duration::from_secs(1);

/// Whether the arguments ask for a bridge: with one of its own.
pub(super) fn is_asked(args: &TeleopArgs) -> bool {
    let ends = [&args.slave, &args.master, &args.listen, &args.connect];
    ends.into_iter().any(Option::is_some) || args.key.is_some() || args.seconds.is_some()
}

/// Runs the bridge until it is ended, and says what has gone over it.
pub(super) fn run(args: &TeleopArgs) -> Result<(), Box<dyn Error>> {
    let summary = ends(args)?;
    let value = json::bridge(&summary);
    result(&value)?;
    say(told(&summary))?;
    if let Some(folder) = &args.out {
        write_json(&folder.join("teleop.json"), &value)?;
    }
    Ok(())
}

fn ends(args: &TeleopArgs) -> Result<Summary, Box<dyn Error>> {
    match (&args.slave, &args.master, &args.listen, &args.connect) {
        (Some(slave), Some(master), None, None) => on_one_host(args, slave, master),
        (Some(slave), None, Some(_), None) | (Some(slave), None, None, Some(_)) => {
            slave_end(args, slave)
        }
        (None, Some(master), Some(_), None) | (None, Some(master), None, Some(_)) => {
            master_end(args, master)
        }
        _ => Err(Diagnostic::new("the ends of the bridge do not fit together")
            .remedy(
                "give --slave PORT --master PORT on one host, or --slave PORT --listen ADDR on one and \
                 --master PORT --connect ADDR on the other",
            )
            .into()),
    }
}

/// The time since the start, and when to print and to end.
struct Clock<'a> {
    args: &'a TeleopArgs,
    start: Instant,
    told: Instant,
}

impl Clock<'_> {
    fn new(args: &TeleopArgs) -> Clock<'_> {
        let start = Instant::now();
        // Ctrl-C ends the loop: the master's board then fades out.
        watch();
        Clock {
            args,
            start,
            told: start,
        }
    }

    fn now_s(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }

    fn goes_on(&self) -> bool {
        let in_time = self
            .args
            .seconds
            .is_none_or(|seconds| self.now_s() < seconds);
        in_time && !is_interrupted()
    }

    fn tell(&mut self, line: impl FnOnce() -> String) -> Result<(), Box<dyn Error>> {
        if self.told.elapsed() >= TELLS {
            self.told = Instant::now();
            say(line() + "\n")?;
        }
        Ok(())
    }
}

/// What a simulated board is told before, so that nobody has to; its hand presses into gel once a second.
const SIMULATED_SLAVE: [(Key, f32); 2] =
    [(Key::ReflectionEvery, 10.0), (Key::TelemetryEvery, 50.0)];
const SIMULATED_MASTER: [(Key, f32); 4] = [
    (Key::RenderDeviceNsPerM, 100.0),
    (Key::RenderFullN, 15.0),
    (Key::RenderForceN, 12.0),
    (Key::TelemetryEvery, 10.0),
];

fn device(name: &str, simulated: &[(Key, f32)]) -> Result<Device<Box<dyn Port>>, Box<dyn Error>> {
    let mut device = Device::new(port::open(name)?);
    if name == port::SIMULATED {
        for (key, value) in simulated {
            device.prepare(*key, *value)?;
        }
        device.order(Command::Commit)?;
    }
    Ok(device)
}

fn slave_at(name: &str) -> Result<Device<Box<dyn Port>>, Box<dyn Error>> {
    let mut slave = device(name, &SIMULATED_SLAVE)?;
    check_slave(&mut slave)?;
    Ok(slave)
}

fn master_at(name: &str) -> Result<Device<Box<dyn Port>>, Box<dyn Error>> {
    let mut master = device(name, &SIMULATED_MASTER)?;
    check_master(&mut master)?;
    // A real one is armed by a person.
    if name == port::SIMULATED {
        master.order(Command::Arm)?;
    }
    Ok(master)
}

fn on_one_host(args: &TeleopArgs, slave: &str, master: &str) -> Result<Summary, Box<dyn Error>> {
    let (mut slave, mut master) = (slave_at(slave)?, master_at(master)?);
    let (mut channel, mut view) = (between(args)?, MasterView::default());
    let (mut clock, mut held) = (Clock::new(args), Held::default());
    while clock.goes_on() {
        local(
            &mut slave,
            &mut master,
            &mut channel,
            (&mut held, &mut view),
            clock.now_s(),
        )?;
        clock.tell(|| {
            let counts = channel.counts();
            format!(
                "sent {}  lost {}  overtaken {}  given {}  {}",
                counts.sent,
                counts.lost,
                counts.overtaken,
                view.given,
                force(&view)
            )
        })?;
    }
    let counts = channel.counts();
    Ok(Summary {
        role: "one_host",
        duration_s: clock.now_s(),
        clock: None,
        counts: Counts {
            sent: counts.sent,
            passed: view.given,
            lost: counts.lost,
            overtaken: counts.overtaken,
            ..Counts::default()
        },
        master: Some(view),
    })
}

/// What the network has lost and rejected, and the channel that was put in between.
fn with_channel(of: Counts, channel: &Channel<Vec<u8>>) -> Counts {
    let own = channel.counts();
    Counts {
        lost: of.lost + own.lost,
        overtaken: of.overtaken + own.overtaken,
        ..of
    }
}

/// The simulator's channel, which `--delay-ms`, `--jitter`, `--loss` and `--channel` put in between.
fn between(args: &TeleopArgs) -> Result<Channel<Vec<u8>>, Diagnostic> {
    let [_, back] = super::setup::channels(args)?;
    Ok(Channel::new(back, args.seed))
}

/// What has gone over the bridge, in a line.
fn told(summary: &Summary) -> String {
    let Summary {
        counts, duration_s, ..
    } = summary;
    let rejected = counts.overtaken + counts.late + counts.replayed + counts.strangers;
    let force = summary.master.as_ref().map(force);
    let force = force.map_or(String::new(), |force| format!("  {force}"));
    format!(
        "ended after {}: sent {}, passed on {}, lost {}, rejected {rejected}{force}\n",
        quantity(*duration_s, 3, "s"),
        counts.sent,
        counts.passed,
        counts.lost
    )
}

fn force(view: &MasterView) -> String {
    let Some(rendered) = &view.rendered else {
        return "the master has put out nothing".into();
    };
    let stopped = if view.has_stopped() {
        ", faded out"
    } else {
        ""
    };
    format!(
        "force {}{stopped}",
        quantity(f64::from(rendered.force_n), 3, "N")
    )
}

/// Socket and session of one end.
fn end(args: &TeleopArgs) -> Result<(Wire, Endpoint), Box<dyn Error>> {
    let Some(path) = &args.key else {
        return Err(Diagnostic::new("there is no key")
            .remedy("give --key FILE: what comes over the network moves somebody's hand")
            .into());
    };
    let key = Secret::read(Path::new(path))?;
    let resolve = |name: &Option<String>| name.as_deref().map(resolve).transpose();
    let (listen, connect) = (resolve(&args.listen)?, resolve(&args.connect)?);
    let role = if listen.is_some() {
        Role::Listen
    } else {
        Role::Connect
    };
    let wire = Wire::open(listen, connect)?;
    let at = wire.address()?;
    say(match connect {
        Some(other) => format!("connecting to {other} from {at}\n"),
        None => format!("listening at {at}\n"),
    })?;
    Ok((wire, Endpoint::new(role, key)))
}

fn resolve(name: &str) -> Result<SocketAddr, Diagnostic> {
    let wrong = |what: String| {
        Diagnostic::new(what)
            .value(name)
            .remedy("write HOST:PORT, such as 192.0.2.7:4700")
    };
    let mut addresses = name
        .to_socket_addrs()
        .map_err(|error| wrong(format!("no address: {error}")))?;
    addresses
        .next()
        .ok_or_else(|| wrong("the name has no address".into()))
}

fn slave_end(args: &TeleopArgs, name: &str) -> Result<Summary, Box<dyn Error>> {
    let (mut wire, mut end) = end(args)?;
    let (mut slave, mut held) = (slave_at(name)?, Held::default());
    let (mut clock, mut channel) = (Clock::new(args), between(args)?);
    while clock.goes_on() {
        let now_s = clock.now_s();
        for packet in &packets(&mut slave, &mut held)? {
            let frame = framed(packet);
            let length = frame.len();
            channel.send(now_s, frame, length);
        }
        let now_us = (1e6 * now_s) as u64;
        while let Some(frame) = channel.receive(now_s) {
            end.send(now_us, &frame);
        }
        wire.exchange(&mut end, now_us);
        clock.tell(|| line(&end, now_us))?;
    }
    Ok(Summary {
        role: "slave",
        duration_s: clock.now_s(),
        clock: end.clock(),
        counts: with_channel(end.counts(), &channel),
        master: None,
    })
}

fn master_end(args: &TeleopArgs, name: &str) -> Result<Summary, Box<dyn Error>> {
    let (mut wire, mut end) = end(args)?;
    let mut master = master_at(name)?;
    let (mut clock, mut view) = (Clock::new(args), MasterView::default());
    let mut channel = between(args)?;
    while clock.goes_on() {
        look(&mut master, &mut view)?;
        let now_s = clock.now_s();
        let now_us = (1e6 * now_s) as u64;
        for frame in wire.exchange(&mut end, now_us) {
            let length = frame.len();
            channel.send(now_s, frame, length);
        }
        while let Some(frame) = channel.receive(now_s) {
            give(&mut master, &mut view, &frame)?;
        }
        clock.tell(|| format!("{}  {}", line(&end, now_us), force(&view)))?;
    }
    Ok(Summary {
        role: "master",
        duration_s: clock.now_s(),
        clock: end.clock(),
        counts: Counts {
            passed: view.given,
            ..with_channel(end.counts(), &channel)
        },
        master: Some(view),
    })
}

fn line(end: &Endpoint, now_us: u64) -> String {
    let counts = end.counts();
    let clock = match end.clock() {
        Some(clock) if end.is_alive(now_us) => format!(
            "round trip {}, clock {}",
            quantity(1e-6 * clock.round_trip_us, 3, "s"),
            quantity(1e-6 * clock.offset_us, 3, "s")
        ),
        _ => "no other end".into(),
    };
    format!(
        "{clock}  sent {}  passed {}  lost {}  overtaken {}  late {}  replayed {}  strangers {}",
        counts.sent,
        counts.passed,
        counts.lost,
        counts.overtaken,
        counts.late,
        counts.replayed,
        counts.strangers
    )
}
