//! Settings in flash, such that a power cut at any instant leaves the old ones or the new ones.
//!
//! There are two sectors, of which one is written at a time. A record fills a slot of [`SLOT`] bytes:
//! magic, layout, number of values, sequence, the values as (number, f32) pairs, the number of counts, these as
//! (number, u16) pairs, CRC-32; effects that are off are left out. Layout 1 had no counts apart. A save appends the next slot, and the valid record with the highest sequence
//! counts. When a sector is full, the other one is erased, always just before it is written to:
//! whatever an erase that was cut short left there is older than what the full sector holds, or no
//! record at all.
//!
//! A cut within a write leaves a slot that is neither blank nor valid; it is passed over. Nothing
//! ever rewrites or erases the sector with the newest valid record.

use super::compensation;
use super::info::Bounds;
use super::{key::Key, values::Invalid, values::Settings};
use embedded_storage::nor_flash::NorFlash;

/// The length of a record's slot (bytes): 512 saves between two erases of a 128 KiB sector.
pub const SLOT: usize = 256;
/// The layout of a record, raised when a value changes its meaning. A record of an older firmware is
/// taken over: a setting that it lacks has its default, and a number that is no setting of this
/// firmware is left out. A record of a newer layout is refused.
pub const LAYOUT: u8 = 2;
const MAGIC: [u8; 2] = [0x50, 0xa1];
const HEAD: usize = 8;
/// A (number, f32) pair, and a (number, u16) pair.
const PAIR: usize = 5;
const COUNT_PAIR: usize = 3;
/// A record has room for all settings of the board and for the eight largest effects.
const _: () = {
    let wide = Key::BESIDES - counts() + compensation::MOST_AT_ONCE;
    assert!(HEAD + PAIR * wide + 1 + COUNT_PAIR * counts() + 4 <= SLOT);
};

/// How many settings are counts, which a u16 holds.
const fn counts() -> usize {
    let (mut at, mut number) = (0, 0);
    while at < Key::ALL.len() {
        number += is_count(Key::ALL[at]) as usize;
        at += 1;
    }
    number
}

const fn is_count(key: Key) -> bool {
    matches!(key.info().bounds, Bounds::Whole(low, high) if low >= 0.0 && high <= 65_535.0)
}
const CRC: crc::Crc<u32> = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);

/// What a load has found in flash.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(
    clippy::large_enum_variant,
    reason = "settings of 252 bytes, once at a start, and nothing to allocate a box from"
)]
pub enum Loaded {
    /// The flash of a new board holds no record.
    Nothing,
    /// The settings of the newest record can be used.
    Good(Settings),
    /// The newest record has a value that cannot be used.
    Bad(Invalid),
    /// A newer firmware wrote the newest record, with this layout.
    Newer(u8),
}

/// The reason why a save failed. The old settings are still there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StoreError<E> {
    /// The flash reports an error.
    Flash(E),
    /// The flash reads other than what was written.
    Verify,
}

impl<E> From<E> for StoreError<E> {
    fn from(error: E) -> Self {
        StoreError::Flash(error)
    }
}

/// Where a record is.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Found {
    offset: u32,
    sequence: u32,
}

/// Two sectors of a flash.
#[derive(Debug)]
pub struct Store<F> {
    flash: F,
    base: u32,
    sector: u32,
}

impl<F: NorFlash> Store<F> {
    /// The store in the sectors at `base` and `base + sector`. A sector has `sector` bytes, a multiple
    /// of the flash's erase size and of [`SLOT`].
    pub const fn new(flash: F, base: u32, sector: u32) -> Self {
        Store {
            flash,
            base,
            sector,
        }
    }

    /// Gives the flash back.
    pub fn release(self) -> F {
        self.flash
    }

    /// The settings that were saved last.
    ///
    /// # Errors
    /// The error that the flash reports.
    pub fn load(&mut self) -> Result<Loaded, F::Error> {
        let Some(found) = self.newest()? else {
            return Ok(Loaded::Nothing);
        };
        Ok(decode(&self.read(found.offset)?))
    }

    /// Whether the next save must erase a sector first: seconds during which the core stands still.
    ///
    /// # Errors
    /// The error that the flash reports.
    pub fn must_erase(&mut self) -> Result<bool, F::Error> {
        let newest = self.newest()?;
        Ok(self.free_after(newest)?.is_none())
    }

    /// Saves settings. A power cut at any instant leaves the old ones or these.
    ///
    /// # Errors
    /// The error that the flash reports, or that it reads other than what was written; the old
    /// settings stay.
    pub fn save(&mut self, settings: &Settings) -> Result<(), StoreError<F::Error>> {
        let newest = self.newest()?;
        let offset = match self.free_after(newest)? {
            Some(offset) => offset,
            None => self.erase_other(newest)?,
        };
        let sequence = newest.map_or(0, |found| found.sequence.wrapping_add(1));
        let record = encode(settings, sequence);
        self.flash.write(offset, &record)?;
        match self.read(offset)? == record {
            true => Ok(()),
            false => Err(StoreError::Verify),
        }
    }

    /// The valid record with the highest sequence.
    fn newest(&mut self) -> Result<Option<Found>, F::Error> {
        let mut newest: Option<Found> = None;
        let mut offset = self.base;
        while offset < self.base + 2 * self.sector {
            let record = self.read(offset)?;
            if let Some(sequence) = sequence_of(&record)
                && newest.is_none_or(|found| sequence > found.sequence)
            {
                newest = Some(Found { offset, sequence });
            }
            offset += SLOT as u32;
        }
        Ok(newest)
    }

    /// The first blank slot behind the newest record, in its sector.
    fn free_after(&mut self, newest: Option<Found>) -> Result<Option<u32>, F::Error> {
        let Some(newest) = newest else {
            return Ok(None);
        };
        let end = self.sector_of(newest.offset) + self.sector;
        let mut offset = newest.offset + SLOT as u32;
        while offset < end {
            if self.read(offset)?.iter().all(|byte| *byte == 0xff) {
                return Ok(Some(offset));
            }
            offset += SLOT as u32;
        }
        Ok(None)
    }

    /// Erases the sector that does not hold the newest record, and gives its first slot.
    fn erase_other(&mut self, newest: Option<Found>) -> Result<u32, F::Error> {
        let second = self.base + self.sector;
        let start = match newest {
            Some(found) if found.offset < second => second,
            _ => self.base,
        };
        self.flash.erase(start, start + self.sector)?;
        Ok(start)
    }

    fn sector_of(&self, offset: u32) -> u32 {
        let second = self.base + self.sector;
        if offset < second { self.base } else { second }
    }

    fn read(&mut self, offset: u32) -> Result<[u8; SLOT], F::Error> {
        let mut record = [0; SLOT];
        self.flash.read(offset, &mut record)?;
        Ok(record)
    }
}

/// The content of a slot, which the check sum is over, and the check sum.
fn split(record: &[u8; SLOT]) -> Option<(&[u8], u32)> {
    let (content, sum) = record.split_last_chunk::<4>()?;
    Some((content, u32::from_le_bytes(*sum)))
}

/// The sequence of a record, if it is valid.
fn sequence_of(record: &[u8; SLOT]) -> Option<u32> {
    let (content, sum) = split(record)?;
    let (head, _) = content.split_first_chunk::<HEAD>()?;
    let [magic_1, magic_2, _, _, a, b, c, d] = *head;
    ([magic_1, magic_2] == MAGIC && CRC.checksum(content) == sum)
        .then_some(u32::from_le_bytes([a, b, c, d]))
}

fn encode(settings: &Settings, sequence: u32) -> [u8; SLOT] {
    let mut record = [0; SLOT];
    let [magic_1, magic_2] = MAGIC;
    let [a, b, c, d] = sequence.to_le_bytes();
    let wide = || stored(settings).filter(|key| !is_count(*key));
    let counts = || stored(settings).filter(|key| is_count(*key));
    let head = [magic_1, magic_2, LAYOUT, wide().count() as u8, a, b, c, d];
    let pairs = wide().flat_map(|key| {
        let [a, b, c, d] = settings.get(key).to_le_bytes();
        [key.id(), a, b, c, d]
    });
    let count_pairs = counts().flat_map(|key| {
        let [a, b] = (settings.get(key) as u16).to_le_bytes();
        [key.id(), a, b]
    });
    let content = head.into_iter().chain(pairs);
    let content = content.chain([counts().count() as u8]).chain(count_pairs);
    for (slot, byte) in record.iter_mut().zip(content) {
        *slot = byte;
    }
    let sum = split(&record).map_or(0, |(content, _)| CRC.checksum(content));
    if let Some(place) = record.last_chunk_mut::<4>() {
        *place = sum.to_le_bytes();
    }
    record
}

/// The settings that a record holds. An effect that is off is left out: its parameters are 0, which is
/// what a record without them means, and not all of them would fit.
fn stored(settings: &Settings) -> impl Iterator<Item = Key> {
    let kept = |key: &Key| !matches!(key, Key::Compensation(_)) || settings.get(*key) != 0.0;
    Key::table().iter().copied().filter(kept)
}

/// The settings of a valid record.
fn decode(record: &[u8; SLOT]) -> Loaded {
    let Some((head, body)) = record.split_first_chunk::<HEAD>() else {
        return Loaded::Nothing;
    };
    let [_, _, layout, count, ..] = *head;
    if layout > LAYOUT {
        return Loaded::Newer(layout);
    }
    let mut settings = Settings::default();
    let mut put = |id: u8, value: f32| {
        if let Some(key) = Key::from_id(id) {
            settings.put(key, value);
        }
    };
    let (pairs, rest) = body
        .split_at_checked(PAIR * usize::from(count))
        .unwrap_or((body, &[]));
    for pair in pairs.chunks_exact(PAIR) {
        if let [id, a, b, c, d] = *pair {
            put(id, f32::from_le_bytes([a, b, c, d]));
        }
    }
    if let [number, rest @ ..] = rest
        && layout > 1
    {
        for pair in rest.chunks_exact(COUNT_PAIR).take(usize::from(*number)) {
            if let [id, a, b] = *pair {
                put(id, f32::from(u16::from_le_bytes([a, b])));
            }
        }
    }
    match settings.check() {
        Ok(()) => Loaded::Good(settings),
        Err(invalid) => Loaded::Bad(invalid),
    }
}

#[cfg(test)]
mod tests;
