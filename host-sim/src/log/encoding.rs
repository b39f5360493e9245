//! Text as machines write it: UTF-16, Latin-1, line ends of old Macintoshes, columns of blanks.

use std::io::{self, Read};

use encoding_rs::{Encoding, UTF_16BE, UTF_16LE, WINDOWS_1252};
use encoding_rs_io::DecodeReaderBytesBuilder;

/// The encoding of a text by its first bytes, with its name; `None` for UTF-8.
pub(super) fn of(head: &[u8]) -> Option<(&'static Encoding, &'static str)> {
    match head {
        [0xff, 0xfe, ..] => return Some((UTF_16LE, "UTF-16")),
        [0xfe, 0xff, ..] => return Some((UTF_16BE, "UTF-16")),
        _ => {}
    }
    // Numbers in UTF-16 without a mark: every other byte is nothing, and no other is.
    let pairs = || head.chunks_exact(2).take(512);
    let all = |low: usize| {
        pairs().count() > 4 && pairs().all(|pair| pair[low] == 0 && pair[1 - low] != 0)
    };
    if all(1) {
        return Some((UTF_16LE, "UTF-16"));
    }
    if all(0) {
        return Some((UTF_16BE, "UTF-16"));
    }
    match std::str::from_utf8(head) {
        // The head may end within a character.
        Err(error) if error.error_len().is_some() && !has_controls(head) => {
            Some((WINDOWS_1252, "Latin-1"))
        }
        _ => None,
    }
}

/// Bytes that no text holds: left as they are, they tell what the file is.
fn has_controls(head: &[u8]) -> bool {
    let control = |byte: &u8| *byte < b'\t' || (0x0e..0x20).contains(byte);
    head.iter().any(control)
}

/// The text as UTF-8.
pub(super) fn decoded(text: impl Read + 'static, encoding: &'static Encoding) -> Box<dyn Read> {
    let mut builder = DecodeReaderBytesBuilder::new();
    Box::new(builder.encoding(Some(encoding)).build(text))
}

/// Ends a line with \n where it ends with \r.
pub(super) fn end_line(byte: &mut u8) {
    if *byte == b'\r' {
        *byte = b'\n';
    }
}

/// A text whose lines end with \r alone.
pub(super) struct LineEnds<R>(pub(super) R);

impl<R: Read> Read for LineEnds<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.0.read(buffer)?;
        buffer[..count].iter_mut().for_each(end_line);
        Ok(count)
    }
}

/// A text with one blank where there are several or tabs, and none at the ends of its lines.
pub(super) struct SingleBlanks<R> {
    text: R,
    /// Whether blanks wait for something that stands behind them in the same line.
    pending: bool,
    at_start: bool,
    ready: Vec<u8>,
    from: usize,
}

impl<R: Read> SingleBlanks<R> {
    pub(super) fn new(text: R) -> Self {
        SingleBlanks {
            text,
            pending: false,
            at_start: true,
            ready: Vec::new(),
            from: 0,
        }
    }

    fn take(&mut self, byte: u8) {
        match byte {
            b' ' | b'\t' => self.pending = !self.at_start,
            b'\r' | b'\n' => {
                self.pending = false;
                self.at_start = true;
                self.ready.push(byte);
            }
            byte => {
                if std::mem::take(&mut self.pending) {
                    self.ready.push(b' ');
                }
                self.at_start = false;
                self.ready.push(byte);
            }
        }
    }
}

impl<R: Read> Read for SingleBlanks<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let mut chunk = [0; 1 << 13];
        while self.from == self.ready.len() {
            let count = self.text.read(&mut chunk)?;
            if count == 0 {
                return Ok(0);
            }
            self.ready.clear();
            self.from = 0;
            chunk[..count].iter().for_each(|byte| self.take(*byte));
        }
        let count = buffer.len().min(self.ready.len() - self.from);
        buffer[..count].copy_from_slice(&self.ready[self.from..self.from + count]);
        self.from += count;
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_encoding_is_told_by_the_first_bytes() {
        let utf_16: Vec<u8> = "t_s,x_m,f_n\n"
            .encode_utf16()
            .flat_map(u16::to_le_bytes)
            .collect();
        assert_eq!(of(&utf_16).unwrap().0, UTF_16LE);
        let marked = [&[0xff, 0xfe], utf_16.as_slice()].concat();
        assert_eq!(of(&marked).unwrap().0, UTF_16LE);
        let mut text = String::new();
        decoded(io::Cursor::new(marked), UTF_16LE)
            .read_to_string(&mut text)
            .unwrap();
        assert_eq!(text, "t_s,x_m,f_n\n");
        assert_eq!(of(b"Weg [\xb5m]").unwrap().0, WINDOWS_1252);
        assert_eq!(of("Weg [µm]".as_bytes()), None);
        assert_eq!(of(&"µ".as_bytes()[..1]), None);
        assert_eq!(of(b"\x00\xff\xfe\x07"), None);
    }

    #[test]
    fn blanks_between_cells_become_one() {
        let mut text = String::new();
        let given = "  0.1   2 \t 3  \n\n  4 5 6".as_bytes();
        SingleBlanks::new(given).read_to_string(&mut text).unwrap();
        assert_eq!(text, "0.1 2 3\n\n4 5 6");
    }
}
