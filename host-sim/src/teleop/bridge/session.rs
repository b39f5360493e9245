//! Noise sessions: the handshake of both ends, and the datagrams of a session.
//!
//! A datagram is a kind, and for those of a session their number (8 bytes, little-endian) and the cipher
//! text. The connecting end begins; the listening end answers every handshake that knows the key, and goes
//! over to its session only when a datagram of it has come: a handshake that is replayed ends nothing.

use snow::{Builder, HandshakeState, StatelessTransportState};

use super::key::Key;
use super::replay::ReplayWindow;

const NOISE: &str = "Noise_NNpsk0_25519_ChaChaPoly_BLAKE2s";
const HELLO: u8 = 1;
const WELCOME: u8 = 2;
const DATA: u8 = 3;
/// The longest datagram (bytes).
pub const LONGEST: usize = super::payload::LONGEST + 64;

/// Why a datagram goes no further.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rejected {
    /// It is no datagram of this protocol, was changed on its way, or was made without the key.
    Stranger,
    /// It was seen before, or is older than the window.
    Replayed,
}

/// What a datagram was.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Received {
    /// Content, and its number.
    Content(u64, Vec<u8>),
    /// A handshake that has to be answered with this datagram.
    Answer(Vec<u8>),
    /// The end of a handshake: from now on there is a session.
    Connected,
}

/// A session.
struct Session {
    transport: StatelessTransportState,
    window: ReplayWindow,
    next: u64,
}

impl Session {
    fn of(handshake: HandshakeState) -> Option<Session> {
        Some(Session {
            transport: handshake.into_stateless_transport_mode().ok()?,
            window: ReplayWindow::default(),
            next: 0,
        })
    }

    fn open(&mut self, number: u64, cipher: &[u8]) -> Result<Vec<u8>, Rejected> {
        let mut plain = [0; LONGEST];
        let read = self.transport.read_message(number, cipher, &mut plain);
        let length = read.map_err(|_| Rejected::Stranger)?;
        // Only a number whose datagram is genuine is remembered.
        match self.window.accept(number) {
            true => Ok(plain.get(..length).unwrap_or(&[]).to_vec()),
            false => Err(Rejected::Replayed),
        }
    }
}

/// The sessions of one end.
pub struct Sessions {
    key: Key,
    /// Whether this end begins. It then answers nobody, not even itself.
    begins: bool,
    current: Option<Session>,
    /// The listening end's next session, until its first datagram.
    pending: Option<Session>,
    /// The connecting end's handshake that is under way.
    asked: Option<HandshakeState>,
}

fn builder() -> Option<Builder<'static>> {
    Some(Builder::new(NOISE.parse().ok()?))
}

impl Sessions {
    /// No session yet.
    pub fn new(key: Key, begins: bool) -> Sessions {
        Sessions {
            key,
            begins,
            current: None,
            pending: None,
            asked: None,
        }
    }

    /// Whether there is a session.
    pub fn is_open(&self) -> bool {
        self.current.is_some()
    }

    /// Begins a handshake; gives its datagram.
    pub fn hello(&mut self) -> Option<Vec<u8>> {
        let mut handshake = builder()?
            .psk(0, self.key.bytes())
            .ok()?
            .build_initiator()
            .ok()?;
        let message = written(HELLO, &mut handshake)?;
        self.asked = Some(handshake);
        Some(message)
    }

    /// Puts content into a datagram; `None` without a session.
    pub fn seal(&mut self, content: &[u8]) -> Option<Vec<u8>> {
        let session = self.current.as_mut()?;
        let mut cipher = [0; LONGEST];
        let number = session.next;
        let length = session
            .transport
            .write_message(number, content, &mut cipher)
            .ok()?;
        session.next += 1;
        let mut datagram = vec![DATA];
        datagram.extend(number.to_le_bytes());
        datagram.extend(cipher.get(..length)?);
        Some(datagram)
    }

    /// Takes a datagram.
    ///
    /// # Errors
    /// Why it goes no further.
    pub fn receive(&mut self, datagram: &[u8]) -> Result<Received, Rejected> {
        let (kind, rest) = datagram.split_first().ok_or(Rejected::Stranger)?;
        match *kind {
            HELLO if !self.begins => self.answer(rest).ok_or(Rejected::Stranger),
            WELCOME => self.connect(rest).ok_or(Rejected::Stranger),
            DATA => self.open(rest),
            _ => Err(Rejected::Stranger),
        }
    }

    fn answer(&mut self, message: &[u8]) -> Option<Received> {
        let mut handshake = builder()?
            .psk(0, self.key.bytes())
            .ok()?
            .build_responder()
            .ok()?;
        handshake.read_message(message, &mut [0; LONGEST]).ok()?;
        let answer = written(WELCOME, &mut handshake)?;
        self.pending = Session::of(handshake);
        Some(Received::Answer(answer))
    }

    fn connect(&mut self, message: &[u8]) -> Option<Received> {
        let mut handshake = self.asked.take()?;
        if handshake.read_message(message, &mut [0; LONGEST]).is_err() {
            // Anybody can send that; the real answer may still come.
            self.asked = None;
            return None;
        }
        self.current = Session::of(handshake);
        Some(Received::Connected)
    }

    fn open(&mut self, rest: &[u8]) -> Result<Received, Rejected> {
        let (number, cipher) = rest.split_at_checked(8).ok_or(Rejected::Stranger)?;
        let number = number.try_into().map_or(u64::MAX, u64::from_le_bytes);
        let current = match &mut self.current {
            Some(session) => session.open(number, cipher),
            None => Err(Rejected::Stranger),
        };
        if current != Err(Rejected::Stranger) {
            return current.map(|content| Received::Content(number, content));
        }
        let pending = self.pending.as_mut().ok_or(Rejected::Stranger)?;
        let content = pending.open(number, cipher)?;
        self.current = self.pending.take();
        Ok(Received::Content(number, content))
    }
}

fn written(kind: u8, handshake: &mut HandshakeState) -> Option<Vec<u8>> {
    let mut message = [0; LONGEST];
    let length = handshake.write_message(&[], &mut message).ok()?;
    let mut datagram = vec![kind];
    datagram.extend(message.get(..length)?);
    Some(datagram)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn connected() -> (Sessions, Sessions) {
        let key = || Key::new([7; 32]);
        let (mut here, mut there) = (Sessions::new(key(), true), Sessions::new(key(), false));
        let hello = here.hello().unwrap();
        assert_eq!(here.receive(&hello), Err(Rejected::Stranger), "its own");
        let Ok(Received::Answer(welcome)) = there.receive(&hello) else {
            panic!("no answer")
        };
        assert_eq!(here.receive(&welcome), Ok(Received::Connected));
        let first = here.seal(b"first").unwrap();
        assert_eq!(
            there.receive(&first),
            Ok(Received::Content(0, b"first".to_vec()))
        );
        (here, there)
    }

    #[test]
    fn any_bit_that_is_flipped_and_anything_replayed_goes_no_further() {
        let (mut here, mut there) = connected();
        let datagram = here.seal(b"an impedance").unwrap();
        for bit in 0..8 * datagram.len() {
            let mut changed = datagram.clone();
            changed[bit / 8] ^= 1 << (bit % 8);
            assert_eq!(
                there.receive(&changed),
                Err(Rejected::Stranger),
                "bit {bit}"
            );
        }
        assert!(matches!(
            there.receive(&datagram),
            Ok(Received::Content(1, _))
        ));
        assert_eq!(there.receive(&datagram), Err(Rejected::Replayed));
    }

    #[test]
    fn without_the_key_there_is_no_session() {
        let mut stranger = Sessions::new(Key::new([8; 32]), true);
        let mut there = Sessions::new(Key::new([7; 32]), false);
        let hello = stranger.hello().unwrap();
        assert_eq!(there.receive(&hello), Err(Rejected::Stranger));
        assert!(!there.is_open());
    }

    #[test]
    fn a_replayed_handshake_ends_no_session_and_an_old_session_does_not_come_back() {
        let key = || Key::new([7; 32]);
        let (mut here, mut there) = (Sessions::new(key(), true), Sessions::new(key(), false));
        let hello = here.hello().unwrap();
        let Ok(Received::Answer(welcome)) = there.receive(&hello) else {
            panic!("no answer")
        };
        here.receive(&welcome).unwrap();
        let old = here.seal(b"old").unwrap();
        there.receive(&old).unwrap();
        // The same handshake again: it is answered, and the session goes on.
        assert!(matches!(there.receive(&hello), Ok(Received::Answer(_))));
        let next = here.seal(b"next").unwrap();
        assert!(matches!(there.receive(&next), Ok(Received::Content(1, _))));
        // A new session of the same ends: datagrams of the old one are a stranger's.
        let hello = here.hello().unwrap();
        let Ok(Received::Answer(welcome)) = there.receive(&hello) else {
            panic!("no answer")
        };
        here.receive(&welcome).unwrap();
        let new = here.seal(b"new").unwrap();
        assert!(matches!(there.receive(&new), Ok(Received::Content(0, _))));
        assert_eq!(there.receive(&old), Err(Rejected::Stranger));
    }
}
