//! A bridge at work: boards, channel and sockets, a look at a time.
//!
//! The slave's packets go to the master as they are; boards command no motion, so nothing else crosses. If
//! the bridge or a link dies, the master hears nothing any more and fades its force out by itself.

use std::io;
use std::net::{SocketAddr, UdpSocket};

use estimator_core::Fault;
use estimator_core::board::frame::{Decoder, Frame, MAX_ENCODED, encode};
use estimator_core::board::reflection::{Packet, Rendered};
use estimator_core::board::settings::Key as Setting;

use super::endpoint::Endpoint;
use crate::diagnostic::Diagnostic;
use crate::link::{Device, Port};
use crate::teleop::channel::Channel;
use crate::teleop::held::{Held, Touch};

/// What a master does.
#[derive(Clone, Copy, Debug, Default)]
pub struct MasterView {
    /// The last force that was put out.
    pub rendered: Option<Rendered>,
    /// Packets that were given to the board.
    pub given: u64,
}

impl MasterView {
    /// Whether the board has faded out.
    pub fn has_stopped(&self) -> bool {
        let rendered = self.rendered.as_ref();
        rendered.is_some_and(|rendered| rendered.faults.has(Fault::RenderStopped))
    }
}

/// Refuses a slave that sends no impedance.
///
/// # Errors
/// The setting, or what the port says.
pub fn check_slave<P: Port>(slave: &mut Device<P>) -> Result<(), Box<dyn std::error::Error>> {
    check(
        slave,
        Setting::ReflectionEvery,
        "the slave's board sends no impedance",
        "set it to 10: 100 packets a second",
    )
}

/// Refuses a master that renders nothing.
///
/// # Errors
/// The setting, or what the port says.
pub fn check_master<P: Port>(master: &mut Device<P>) -> Result<(), Box<dyn std::error::Error>> {
    check(
        master,
        Setting::RenderForceN,
        "the master's board renders nothing",
        "set render.device_ns_per_m, render.full_n and then render.force_n: palpate config --port PORT set KEY VALUE",
    )
}

fn check<P: Port>(
    device: &mut Device<P>,
    key: Setting,
    what: &str,
    remedy: &str,
) -> Result<(), Box<dyn std::error::Error>> {
    match device.get(key)? > 0.0 {
        true => Ok(()),
        false => Err(Diagnostic::new(what)
            .at_key(key.info().name)
            .value(0)
            .remedy(remedy)
            .into()),
    }
}

/// The packets that have come from a slave, and are to go to its master: without a parameter that is not
/// observable, with the last complete ones.
///
/// # Errors
/// The port fails.
pub fn packets<P: Port>(slave: &mut Device<P>, held: &mut Held) -> io::Result<Vec<Packet>> {
    let mut packets = Vec::new();
    while let Some(frame) = slave.next_frame()? {
        match frame {
            Frame::Reflection(packet) => packets.push(held.complete(packet)),
            Frame::Record(instant) => held.observe(Touch {
                position_m: instant.sample.position_m,
                speed_mps: instant.estimate.speed_mps,
                force_n: instant.sample.force_n,
            }),
            _ => {}
        }
        // A port that always has more must not keep the rest waiting.
        if packets.len() >= 16 {
            break;
        }
    }
    Ok(packets)
}

/// A packet as a board sends it.
pub fn framed(packet: &Packet) -> Vec<u8> {
    let mut bytes = [0; MAX_ENCODED];
    let length = encode(&Frame::Reflection(*packet), packet.sequence, &mut bytes);
    bytes.get(..length).unwrap_or(&[]).to_vec()
}

/// Whether bytes are one whole packet.
fn is_packet(bytes: &[u8]) -> bool {
    let mut decoder = Decoder::new();
    let mut frames = bytes.iter().filter_map(|byte| decoder.push(*byte));
    matches!(
        (frames.next(), frames.next()),
        (Some(Ok((_, Frame::Reflection(_)))), None)
    )
}

/// Gives a packet to a master's board. Only whole packets pass: a board takes other commands as well.
///
/// # Errors
/// The port fails.
pub fn give<P: Port>(
    master: &mut Device<P>,
    view: &mut MasterView,
    frame: &[u8],
) -> io::Result<()> {
    if is_packet(frame) {
        view.given += 1;
        master.port().write(frame)?;
    }
    Ok(())
}

/// Looks at what a master's board says.
///
/// # Errors
/// The port fails.
pub fn look<P: Port>(master: &mut Device<P>, view: &mut MasterView) -> io::Result<()> {
    for _ in 0..64 {
        match master.next_frame()? {
            Some(Frame::Rendered(rendered)) => view.rendered = Some(rendered),
            Some(_) => {}
            None => break,
        }
    }
    Ok(())
}

/// Both boards on one host, with a channel of the simulator in between. One look at a time (s).
///
/// # Errors
/// A port fails.
pub fn local<S: Port, M: Port>(
    slave: &mut Device<S>,
    master: &mut Device<M>,
    channel: &mut Channel<Vec<u8>>,
    (held, view): (&mut Held, &mut MasterView),
    now_s: f64,
) -> io::Result<()> {
    for packet in packets(slave, held)? {
        let frame = framed(&packet);
        let length = frame.len();
        channel.send(now_s, frame, length);
    }
    while let Some(frame) = channel.receive(now_s) {
        give(master, view, &frame)?;
    }
    look(master, view)
}

/// A socket of a bridge, and where the other end is.
pub struct Wire {
    socket: UdpSocket,
    peer: Option<SocketAddr>,
}

impl Wire {
    /// Listens at an address, or sends to one.
    ///
    /// # Errors
    /// The address cannot be used.
    pub fn open(listen: Option<SocketAddr>, connect: Option<SocketAddr>) -> io::Result<Wire> {
        let any = match connect {
            Some(SocketAddr::V6(_)) => "[::]:0",
            _ => "0.0.0.0:0",
        };
        let socket = match listen {
            Some(address) => UdpSocket::bind(address)?,
            None => UdpSocket::bind(any)?,
        };
        socket.set_nonblocking(true)?;
        Ok(Wire {
            socket,
            peer: connect,
        })
    }

    /// Where it listens.
    ///
    /// # Errors
    /// What the system says.
    pub fn address(&self) -> io::Result<SocketAddr> {
        self.socket.local_addr()
    }

    /// Takes all datagrams that have come, gives the frames that may go on to a board, and sends what the
    /// end has to say. The other end is where its last genuine datagram came from.
    pub fn exchange(&mut self, end: &mut Endpoint, now_us: u64) -> Vec<Vec<u8>> {
        let mut frames = Vec::new();
        let mut datagram = [0; 1024];
        // At most a thousand at a time: a flood of strangers must not keep the board waiting.
        for _ in 0..1000 {
            let Ok((length, from)) = self.socket.recv_from(&mut datagram) else {
                break;
            };
            let before = end.counts();
            frames.extend(end.receive(now_us, datagram.get(..length).unwrap_or(&[])));
            let after = end.counts();
            if (before.strangers, before.replayed) == (after.strangers, after.replayed) {
                self.peer = Some(from);
            }
        }
        for datagram in end.poll(now_us) {
            if let Some(peer) = self.peer {
                // A datagram that cannot be sent is a lost one.
                let _ = self.socket.send_to(&datagram, peer);
            }
        }
        frames
    }
}
