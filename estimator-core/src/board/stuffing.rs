//! Consistent overhead byte stuffing (Cheshire & Baker 1999): bytes in which zero does not occur, so that a zero
//! can stand between two frames. Each zero is replaced by the way to the next one.

/// The longest content that takes one byte more and no other (bytes).
pub(crate) const LONGEST: usize = 253;

/// Encodes at most [`LONGEST`] bytes, ends with a zero byte, and gives the length of all. From the end to the
/// start, since then the way to the next zero is known: half of what the crate `cobs` takes, byte for byte.
pub(crate) fn encode<const N: usize>(bytes: &[u8], out: &mut [u8; N]) -> usize {
    let Some((first, rest)) = out.split_first_mut() else {
        return 0;
    };
    let mut way: u8 = 1;
    for (slot, byte) in rest.iter_mut().zip(bytes).rev() {
        if *byte == 0 {
            *slot = way;
            way = 1;
        } else {
            *slot = *byte;
            way = way.wrapping_add(1);
        }
    }
    *first = way;
    if let Some(end) = rest.get_mut(bytes.len()) {
        *end = 0;
    }
    bytes.len() + 2
}

/// Decodes in place, without the zero at the end, and gives the decoded length; `None` if the bytes are no such
/// code. The decoder of the crate `cobs` has a panic path that firmware/src/bin/panic_free.rs would not let pass.
pub(crate) fn decode(bytes: &mut [u8]) -> Option<usize> {
    let (mut read, mut write) = (0_usize, 0_usize);
    while let Some(&code) = bytes.get(read) {
        let run = usize::from(code).checked_sub(1)?;
        read += 1;
        for _ in 0..run {
            let byte = *bytes.get(read)?;
            *bytes.get_mut(write)? = byte;
            (read, write) = (read + 1, write + 1);
        }
        // A zero was taken out here, unless the run is a full one or the last.
        if code != 0xff && read < bytes.len() {
            *bytes.get_mut(write)? = 0;
            write += 1;
        }
    }
    Some(write)
}

#[cfg(test)]
mod tests {
    use super::*;
    extern crate std;
    use std::vec::Vec;

    fn contents(length: usize) -> [Vec<u8>; 3] {
        let of = |byte: fn(usize) -> usize| (0..length).map(|i| byte(i) as u8).collect();
        [
            of(|i| i * 7 % 11 * (i % 13)),
            of(|i| i % 255 + 1),
            of(|_| 0),
        ]
    }

    #[test]
    fn the_encoder_gives_what_the_crate_gives_and_a_zero() {
        for length in 0..=LONGEST {
            for bytes in contents(length) {
                let (mut out, mut expected) = ([7; LONGEST + 2], [7; LONGEST + 2]);
                let of_crate = cobs::encode(&bytes, &mut expected);
                expected[of_crate] = 0;
                assert_eq!(encode(&bytes, &mut out), of_crate + 1);
                assert_eq!(out, expected);
            }
        }
    }

    #[test]
    fn the_decoder_undoes_what_the_encoder_does_at_every_length_and_takes_no_other() {
        for length in 0..600_usize {
            for bytes in contents(length) {
                let mut coded = std::vec![0; cobs::max_encoding_length(length)];
                let coded_length = cobs::encode(&bytes, &mut coded);
                let coded = &mut coded[..coded_length];
                let decoded = decode(coded).unwrap();
                assert_eq!(&coded[..decoded], bytes);
            }
        }
        // A run that points past the end, and a zero.
        assert_eq!(decode(&mut [5, 1, 2]), None);
        assert_eq!(decode(&mut [2, 1, 0]), None);
    }
}
