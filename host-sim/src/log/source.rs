//! Opening a file: unzipped when it is zipped, refused when it is no table.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Cursor, Read};
use std::path::Path;
use std::sync::OnceLock;

use flate2::bufread::MultiGzDecoder;

use super::fields::{decoded, is_comment};
use super::{encoding, mcap};
use crate::diagnostic::Diagnostic;

/// How much of a file is looked at before it is read (bytes): a header of a thousand columns fits.
const HEAD_BYTES: u64 = 1 << 16;

/// The path that stands for standard input.
pub const STANDARD_INPUT: &str = "-";

/// An open file and its beginning, as UTF-8 with lines that end in \n.
pub(super) struct Source {
    pub(super) head: Vec<u8>,
    /// What its text is written in, where that is not UTF-8.
    pub(super) encoding: Option<&'static str>,
    rest: Box<dyn Read>,
}

impl Source {
    /// Opens `path`, through gzip and other encodings if its first bytes say so.
    pub(super) fn open(path: &Path) -> Result<Source, Diagnostic> {
        let failed = |error: io::Error| unreadable(path, &error);
        let mut raw = unzipped(path).map_err(failed)?;
        let mut head = beginning(&mut raw).map_err(failed)?;
        if head.starts_with(mcap::MAGIC) {
            raw.read_to_end(&mut head).map_err(failed)?;
            let table = mcap::table(&head).map_err(|mcap::Unusable(what, remedy)| {
                Diagnostic::new(what).in_file(path).remedy(remedy)
            })?;
            raw = Box::new(Cursor::new(table));
            head = beginning(&mut raw).map_err(failed)?;
        }
        let encoding = encoding::of(&head);
        let raw = Cursor::new(head).chain(raw);
        let (mut rest, encoding) = match encoding {
            Some((encoding, name)) => (encoding::decoded(raw, encoding), Some(name)),
            None => (Box::new(raw) as Box<dyn Read>, None),
        };
        let mut head = beginning(&mut rest).map_err(failed)?;
        if head.contains(&b'\r') && !head.contains(&b'\n') {
            head.iter_mut().for_each(encoding::end_line);
            rest = Box::new(encoding::LineEnds(rest));
        }
        match not_a_table(&head) {
            None => Ok(Source {
                head,
                encoding,
                rest,
            }),
            Some((what, remedy)) => Err(Diagnostic::new(what).in_file(path).remedy(remedy)),
        }
    }

    /// Everything from byte `offset` of the head on, with runs of blanks as one where blanks separate cells.
    pub(super) fn starting_at(self, offset: usize, delimiter: u8) -> Box<dyn Read> {
        let mut head = Cursor::new(self.head);
        head.set_position(offset as u64);
        let whole = head.chain(self.rest);
        match delimiter {
            b' ' => Box::new(encoding::SingleBlanks::new(whole)),
            _ => Box::new(whole),
        }
    }
}

/// The bytes of a file or of standard input, through gzip if they begin so.
fn unzipped(path: &Path) -> io::Result<Box<dyn Read>> {
    let mut file = bytes(path)?;
    let is_zipped = file.fill_buf()?.starts_with(&[0x1f, 0x8b]);
    Ok(match is_zipped {
        true => Box::new(BufReader::with_capacity(1 << 18, MultiGzDecoder::new(file))),
        false => Box::new(file),
    })
}

/// The bytes of a file or of standard input, as they are.
pub(crate) fn bytes(path: &Path) -> io::Result<Box<dyn BufRead>> {
    Ok(match path == Path::new(STANDARD_INPUT) {
        true => Box::new(Cursor::new(standard_input()?)),
        false => Box::new(BufReader::with_capacity(1 << 18, File::open(path)?)),
    })
}

/// All of standard input, which can be read only once: an error looks its line up again, and a report its hash.
fn standard_input() -> io::Result<&'static [u8]> {
    static INPUT: OnceLock<Vec<u8>> = OnceLock::new();
    if INPUT.get().is_none() {
        let mut input = Vec::new();
        io::stdin().lock().read_to_end(&mut input)?;
        let _ = INPUT.set(input);
    }
    Ok(INPUT.get().map_or(&[], Vec::as_slice))
}

fn beginning(source: &mut dyn Read) -> io::Result<Vec<u8>> {
    let mut head = Vec::new();
    source.take(HEAD_BYTES).read_to_end(&mut head)?;
    Ok(head)
}

/// What the operating system says about a file.
pub(super) fn unreadable(path: &Path, error: &io::Error) -> Diagnostic {
    let remedy = match error.kind() {
        io::ErrorKind::NotFound => "check the path",
        io::ErrorKind::PermissionDenied => "check the file's permissions",
        io::ErrorKind::IsADirectory => "give the log in the folder, not the folder",
        io::ErrorKind::UnexpectedEof | io::ErrorKind::InvalidData | io::ErrorKind::InvalidInput => {
            "the compressed file is damaged or cut off: copy it again"
        }
        _ => "make sure that it is a file that can be read to its end",
    };
    Diagnostic::new(format!("cannot read the file: {error}"))
        .in_file(path)
        .remedy(remedy)
}

const WRITE_CSV: &str =
    "give a CSV file whose first line is t_s,x_m,f_n (or name its columns with --columns)";

/// The kinds of files that end up here by mistake, by their first bytes.
const OTHER_FILES: [(&[u8], &str); 10] = [
    (b"PK\x03\x04", "a zip archive or a spreadsheet (xlsx)"),
    (b"PAR1", "a Parquet file"),
    (b"\x89HDF", "an HDF5 or MATLAB 7.3 file"),
    (b"MATLAB 5.0", "a MATLAB file"),
    (b"\xd0\xcf\x11\xe0", "an old Excel or Word file"),
    (b"%PDF", "a PDF"),
    (b"\x89PNG", "a picture"),
    (b"BZh", "a bzip2 file"),
    (b"\xfd7zXZ", "an xz file"),
    (b"\x28\xb5\x2f\xfd", "a zstd file"),
];

fn not_a_table(head: &[u8]) -> Option<(String, String)> {
    let text = head
        .strip_prefix(b"\xef\xbb\xbf")
        .unwrap_or(head)
        .trim_ascii_start();
    if text.is_empty() {
        return Some(("the file is empty".into(), WRITE_CSV.into()));
    }
    let known = OTHER_FILES
        .iter()
        .find(|(magic, _)| head.starts_with(magic));
    if let Some((_, kind)) = known {
        return Some((format!("this is {kind}, not a log"), WRITE_CSV.into()));
    }
    if head
        .iter()
        .any(|byte| *byte < b'\t' || (0x0e..0x20).contains(byte))
    {
        return Some(("this is a binary file, not a log".into(), WRITE_CSV.into()));
    }
    wrong_text(text).map(|kind| (format!("this is {kind}, not a log"), WRITE_CSV.into()))
}

fn wrong_text(text: &[u8]) -> Option<&'static str> {
    let line = text
        .split(|byte| *byte == b'\n')
        .next()
        .unwrap_or(text)
        .trim_ascii();
    match text[0] {
        b'{' => Some("a JSON file"),
        b'[' if line.ends_with(b"]") && line.len() > 2 && line[1..].iter().all(is_table_name) => {
            Some("a TOML file (a model or a motion?)")
        }
        b'[' => Some("a JSON file"),
        b'<' if is_page(line) => Some("an HTML or XML page"),
        _ if line.starts_with(b"version https://git-lfs") => Some("a pointer of git-lfs"),
        _ => None,
    }
}

/// Whether a line begins a page; `<INFO>` alone is a title of some testing machines.
fn is_page(line: &[u8]) -> bool {
    const BEGINNINGS: [&[u8]; 6] = [b"<!", b"<?", b"<html", b"<head", b"<body", b"<table"];
    let line = line.to_ascii_lowercase();
    BEGINNINGS.iter().any(|own| line.starts_with(own))
}

fn is_table_name(byte: &u8) -> bool {
    byte.is_ascii_alphabetic() || matches!(byte, b'_' | b'.' | b'[' | b']')
}

/// Number and text of the line that holds byte `offset` of the table or, when only a line end or a comment
/// follows there, of the next row. The table begins at byte `start` of the file, with line `first`. Reads
/// the file again: only for errors.
pub(super) fn line_at(
    path: &Path,
    (start, first): (usize, usize),
    delimiter: u8,
    offset: u64,
) -> Option<(usize, String)> {
    let table = Source::open(path).ok()?.starting_at(start, delimiter);
    let mut reader = BufReader::new(table);
    let (mut number, mut end) = (first - 1, 0);
    let mut line = Vec::new();
    loop {
        line.clear();
        let length = reader.read_until(b'\n', &mut line).ok()?;
        if length == 0 {
            return None;
        }
        number += 1;
        end += length as u64;
        // The byte may be the \n of the line before: csv stops a row at \r.
        let remainder = &line[line.len() - (end.saturating_sub(offset) as usize).min(length)..];
        let content = remainder.trim_ascii();
        if end > offset && !content.is_empty() && !is_comment(content) {
            let text = decoded(&line);
            return Some((number, text.trim_end_matches(['\r', '\n']).to_string()));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_wrong_file_is_called_by_its_name() {
        for (head, name) in [
            (&b""[..], "empty"),
            (b"\xef\xbb\xbf \n\n ", "empty"),
            (b"{\"a\": 1}", "JSON"),
            (b"[1, 2]", "JSON"),
            (b"<!DOCTYPE html>", "HTML"),
            (b"<?xml version=\"1.0\"?>", "XML"),
            (b"[environment]\nlaw = 1", "TOML"),
            (b"[[segment]]\n", "TOML"),
            (b"PK\x03\x04....", "xlsx"),
            (b"t_s,x_m\0\0", "binary"),
        ] {
            let (what, _) = not_a_table(head).unwrap();
            assert!(what.contains(name), "{what}");
        }
        assert_eq!(not_a_table(b"t_s,x_m,f_n\n"), None);
        assert_eq!(not_a_table(b"<INFO>\nDate:\t1\n<DATA>\n"), None);
    }
}
