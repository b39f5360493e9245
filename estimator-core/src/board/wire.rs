//! The body of a frame: its writer and its reader, number by number.

use crate::estimate::record::PARAMETER_SLOTS;

/// The version of the layout; a reader refuses any other.
pub const VERSION: u8 = 2;
/// The version of a record's layout, which came later.
pub const RECORD_VERSION: u8 = 3;
/// The length of the longest frame before COBS (bytes): that of a record whose law has all slots.
/// A record carries the slots of its law only: 111 bytes on the wire for Hunt–Crossley.
pub(crate) const MAX_BODY: usize = 4 + 13 + 12 + 12 + 4 + 8 * PARAMETER_SLOTS + 4 * 7 + 4;

/// Why bytes between two zeros are not a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum FrameError {
    /// The bytes are not COBS, or more or fewer than any frame has.
    Framing,
    /// The check sum does not fit the content.
    Checksum,
    /// The frame has another version.
    Version(u8),
    /// The check sum fits, but this version does not know the content.
    Content,
}

impl core::fmt::Display for FrameError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            FrameError::Framing => f.write_str("not a frame"),
            FrameError::Checksum => f.write_str("check sum does not fit"),
            FrameError::Version(v) => {
                write!(f, "frame version {v}, this is version {RECORD_VERSION}")
            }
            FrameError::Content => f.write_str("content unknown to this version"),
        }
    }
}

impl core::error::Error for FrameError {}

/// Writes the body of a frame, number by number, little-endian.
pub(crate) struct Writer {
    bytes: [u8; MAX_BODY],
    length: usize,
}

impl Writer {
    pub(crate) fn new() -> Self {
        Writer {
            bytes: [0; MAX_BODY],
            length: 0,
        }
    }

    pub(crate) fn put<const N: usize>(&mut self, bytes: [u8; N]) {
        if let Some(room) = self.bytes.get_mut(self.length..self.length + N) {
            room.copy_from_slice(&bytes);
            self.length += N;
        }
    }

    pub(crate) fn written(&self) -> &[u8] {
        self.bytes.get(..self.length).unwrap_or(&[])
    }
}

/// Reads the body of a frame, number by number; a number that is missing is an error.
pub(crate) struct Reader<'a> {
    bytes: &'a [u8],
}

impl<'a> Reader<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Reader { bytes }
    }

    pub(crate) fn take<const N: usize>(&mut self) -> Result<[u8; N], FrameError> {
        let (head, tail) = self
            .bytes
            .split_first_chunk::<N>()
            .ok_or(FrameError::Content)?;
        self.bytes = tail;
        Ok(*head)
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.bytes.is_empty()
    }

    /// Skips everything that is left.
    pub(crate) fn skip(&mut self) {
        self.bytes = &[];
    }

    pub(crate) fn number(&mut self) -> Result<f32, FrameError> {
        Ok(f32::from_le_bytes(self.take()?))
    }
}
