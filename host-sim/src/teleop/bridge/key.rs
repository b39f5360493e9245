//! The key that both ends of a bridge share, from a file that nobody else can read.

use std::fs;
use std::path::Path;

use crate::diagnostic::Diagnostic;

/// The length of a key (bytes).
pub const LENGTH: usize = 32;

/// A key of 256 bits. It is never printed.
#[derive(Clone, PartialEq, Eq)]
pub struct Key([u8; LENGTH]);

impl std::fmt::Debug for Key {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Key(…)")
    }
}

/// How a key is made, for remedies.
const MAKE: &str = "make one with: (umask 077; head -c 32 /dev/urandom | od -An -v -tx1 | tr -d ' \\n' > FILE), \
                    and copy it to the other host by a way that you trust";

impl Key {
    /// A key of these bytes.
    pub const fn new(bytes: [u8; LENGTH]) -> Key {
        Key(bytes)
    }

    /// The bytes.
    pub(super) const fn bytes(&self) -> &[u8; LENGTH] {
        &self.0
    }

    /// Reads a key: 64 hexadecimal digits in a file that only its owner can read.
    ///
    /// # Errors
    /// A file that cannot be read, that others can read, or that holds no key. What it holds is not shown.
    pub fn read(path: &Path) -> Result<Key, Diagnostic> {
        let wrong = |what: &str| Diagnostic::new(what.to_string()).in_file(path);
        let text = fs::read_to_string(path).map_err(|error| {
            wrong(&format!("cannot read the key: {error}")).remedy(MAKE.to_string())
        })?;
        private(path)?;
        let digits: Vec<u8> = text.trim().bytes().collect();
        let mut bytes = [0; LENGTH];
        let pairs = digits.chunks(2).map(|pair| {
            let pair = std::str::from_utf8(pair).ok()?;
            u8::from_str_radix(pair, 16).ok()
        });
        let read: Option<Vec<u8>> = pairs.collect();
        match read.filter(|read| read.len() == LENGTH && digits.len() == 2 * LENGTH) {
            Some(read) => bytes.copy_from_slice(&read),
            None => {
                return Err(wrong("the file holds no key of 64 hexadecimal digits")
                    .note(format!("it holds {} characters", digits.len()))
                    .remedy(MAKE.to_string()));
            }
        }
        match bytes == [0; LENGTH] {
            true => Err(wrong("the key is all zeros").remedy(MAKE.to_string())),
            false => Ok(Key(bytes)),
        }
    }
}

/// Refuses a file that others than its owner can read or write.
#[cfg(unix)]
fn private(path: &Path) -> Result<(), Diagnostic> {
    use std::os::unix::fs::PermissionsExt;
    let mode = fs::metadata(path).map_or(0o777, |facts| facts.permissions().mode() & 0o777);
    if mode & 0o077 == 0 {
        return Ok(());
    }
    Err(Diagnostic::new("others can read the key")
        .in_file(path)
        .value(format!("{mode:o}"))
        .remedy(format!(
            "run `chmod 600 {}`; if somebody may have read it, make another",
            path.display()
        )))
}

/// Where files have no such permissions, their folder's have to do.
#[cfg(not(unix))]
fn private(_path: &Path) -> Result<(), Diagnostic> {
    Ok(())
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::os::unix::fs::PermissionsExt;

    /// What is said of a key in a file of this text and mode.
    fn read(text: &str, mode: u32) -> Result<Key, Diagnostic> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("key");
        fs::write(&path, text).unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(mode)).unwrap();
        Key::read(&path)
    }

    #[test]
    fn a_key_that_others_can_read_is_refused_and_no_error_shows_what_it_holds() {
        let digits = "8f".repeat(32);
        let good = read(&format!("{digits}\n"), 0o600);
        assert_eq!(good.unwrap(), Key::new([0x8f; 32]));
        for mode in [0o640, 0o604, 0o620, 0o666] {
            let error = read(&digits, mode).unwrap_err().to_string();
            assert!(
                error.contains("others can read") && error.contains("chmod 600"),
                "{error}"
            );
        }
        for text in ["8f8f", &"00".repeat(32), &"x8".repeat(32)] {
            let error = read(text, 0o600).unwrap_err().to_string();
            assert!(
                !error.contains(text) && error.contains("urandom"),
                "{error}"
            );
        }
        let missing = Key::read(Path::new("no-such-key")).unwrap_err().to_string();
        assert!(
            missing.contains("no-such-key") && missing.contains("urandom"),
            "{missing}"
        );
        assert!(!format!("{:?}", Key::new([0x8f; 32])).contains("8f"));
    }
}
