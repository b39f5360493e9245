//! What is inside a datagram: a frame of a board, or a question about the clock and its answer.

/// The longest content (bytes).
pub const LONGEST: usize = 256;

/// What is inside a datagram.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Payload {
    /// A frame of a board, which left its end at a time (µs, by that end's clock).
    Frame(u64, Vec<u8>),
    /// A question at a time (µs).
    Ping(u64),
    /// The answer to a question from a time (µs), given at another (µs).
    Pong(u64, u64),
}

impl Payload {
    /// As bytes.
    pub fn encode(&self) -> Vec<u8> {
        let (kind, numbers, rest): (u8, Vec<u64>, &[u8]) = match self {
            Payload::Frame(sent_us, bytes) => (1, vec![*sent_us], bytes),
            Payload::Ping(at_us) => (2, vec![*at_us], &[]),
            Payload::Pong(asked_us, at_us) => (3, vec![*asked_us, *at_us], &[]),
        };
        let mut bytes = vec![kind];
        for number in numbers {
            bytes.extend(number.to_le_bytes());
        }
        bytes.extend(rest);
        bytes
    }

    /// From bytes; `None` if they are none of these.
    pub fn decode(bytes: &[u8]) -> Option<Payload> {
        let (kind, rest) = bytes.split_first()?;
        let number = |at: usize| {
            let bytes = rest.get(8 * at..8 * at + 8)?;
            Some(u64::from_le_bytes(bytes.try_into().ok()?))
        };
        match (kind, rest.len()) {
            (1, 9..) => Some(Payload::Frame(number(0)?, rest.get(8..)?.to_vec())),
            (2, 8) => Some(Payload::Ping(number(0)?)),
            (3, 16) => Some(Payload::Pong(number(0)?, number(1)?)),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_payload_comes_back_and_nothing_else_is_one() {
        for payload in [
            Payload::Frame(7, vec![1, 2, 0]),
            Payload::Ping(u64::MAX),
            Payload::Pong(1, 2),
        ] {
            assert_eq!(Payload::decode(&payload.encode()), Some(payload));
        }
        for bytes in [&[][..], &[1; 8], &[2; 8], &[2; 10], &[3; 9], &[4; 17]] {
            assert_eq!(Payload::decode(bytes), None, "{bytes:?}");
        }
    }
}
