use super::*;

fn encoded(frame: &Frame, sequence: u16) -> Vec<u8> {
    let mut out = [0; MAX_ENCODED];
    let length = encode(frame, sequence, &mut out);
    out[..length].to_vec()
}

fn frames(bytes: &[u8]) -> Vec<Result<(u16, Frame), FrameError>> {
    let mut decoder = Decoder::new();
    bytes
        .iter()
        .filter_map(|byte| decoder.push(*byte))
        .collect()
}

/// Any law, any finite values, any of them observable.
fn any_packet(random: &mut Random) -> Packet {
    let law = LawKind::ALL[random.below(6) as usize];
    let mut of = estimate(law, &[]);
    for slot in of.parameters.iter_mut().take(law.parameters().len()) {
        let mut finite = || {
            let any = f32::from_bits(random.bits());
            if any.is_finite() { any } else { 1.0 }
        };
        let (value, std_error) = (finite(), finite().abs());
        *slot = (random.below(4) > 0).then_some(Estimated { value, std_error });
    }
    of.time_us = u64::from(random.bits()) << random.below(33);
    of.faults = Faults::from_bits(random.bits() as u16);
    Packet::of(&of, random.between(1e-4, 1.0), random.bits() as u16)
}

#[test]
fn what_goes_in_comes_out_in_as_many_bytes_whatever_it_is() {
    let mut random = Random(20_261_122);
    for _ in 0..20_000 {
        let packet = any_packet(&mut random);
        let sequence = random.bits() as u16;
        let bytes = encoded(&Frame::Reflection(packet), sequence);
        assert_eq!(bytes.len(), PACKET_ENCODED);
        assert_eq!(frames(&bytes), [Ok((sequence, Frame::Reflection(packet)))]);
    }
}

#[test]
fn values_cross_to_the_bit_and_standard_errors_never_grow_smaller() {
    let mut random = Random(3);
    for law in LawKind::ALL {
        let of = estimate(law, usual(law));
        let crossed = Packet::of(&of, 1e-3, 7).parameters();
        for (own, crossed) in of.parameters.iter().zip(crossed) {
            assert_eq!(own.map(|p| p.value), crossed.map(|p| p.value));
        }
        assert_eq!(crossed.iter().flatten().count(), law.parameters().len());
    }
    for _ in 0..100_000 {
        let std_error = f32::from_bits(random.bits()).abs();
        let mut of = estimate(LawKind::KelvinVoigt, &[1.0]);
        of.parameters[0] = Some(Estimated {
            value: 1.0,
            std_error,
        });
        let crossed = Packet::of(&of, 1e-3, 7).parameters()[0].unwrap().std_error;
        // Below the normal numbers a step is more than 0.8 %; beyond the largest half there is no more.
        if (f32::MIN_POSITIVE..3.3e38).contains(&std_error) {
            let grown = f64::from(crossed) / f64::from(std_error);
            assert!((1.0..1.0079).contains(&grown), "{std_error} {crossed}");
        }
    }
}

#[test]
fn no_flipped_bits_make_another_packet_and_the_next_frame_is_read() {
    let good = encoded(
        &Frame::Reflection(packet(LawKind::HuntCrossley, &GEL, 7)),
        8,
    );
    let next = Frame::Reflection(packet(LawKind::Zener, usual(LawKind::Zener), 9));
    let after = encoded(&next, 9);
    let bits = 8 * good.len();
    for first in 0..bits {
        for second in first..bits {
            let mut stream = good.clone();
            stream[first / 8] ^= 1 << (first % 8);
            if second != first {
                stream[second / 8] ^= 1 << (second % 8);
            }
            stream.push(0);
            stream.extend_from_slice(&after);
            let found = frames(&stream);
            let (last, before) = found.split_last().unwrap();
            assert_eq!(*last, Ok((9, next)), "bits {first}, {second}");
            assert!(before.iter().all(Result::is_err), "bits {first}, {second}");
        }
    }
}

#[test]
fn no_cut_no_lost_byte_and_no_garbage_makes_a_packet() {
    let good = encoded(
        &Frame::Reflection(packet(LawKind::HuntCrossley, &GEL, 7)),
        8,
    );
    for at in 0..good.len() - 1 {
        let cut = [&good[..at], &[0]].concat();
        let lost = [&good[..at], &good[at + 1..]].concat();
        let doubled = [&good[..at], &good[at..=at], &good[at..]].concat();
        for stream in [cut, lost, doubled] {
            assert!(frames(&stream).iter().all(Result::is_err), "{at}");
        }
    }
    let mut random = Random(4);
    let garbage: Vec<u8> = (0..2_000_000).map(|_| random.bits() as u8 & 0x7f).collect();
    let found = frames(&garbage);
    assert!(found.len() > 10_000 && found.iter().all(Result::is_err));
}

/// With a right check sum: what a broken sender might send.
#[test]
fn nothing_that_is_no_number_is_taken() {
    let refused = |of: &Estimate<f32>, depth_m| {
        let bytes = encoded(&Frame::Reflection(Packet::of(of, depth_m, 1)), 1);
        assert_eq!(frames(&bytes), [Err(FrameError::Content)]);
    };
    for law in LawKind::ALL {
        let good = estimate(law, usual(law));
        for depth_m in [f32::NAN, f32::INFINITY, 0.0, -1e-3, 1.5] {
            refused(&good, depth_m);
        }
        for slot in 0..law.parameters().len() {
            for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
                let mut of = good;
                let known = of.parameters[slot].as_mut().unwrap();
                known.value = bad;
                refused(&of, 1e-3);
                *of.parameters[slot].as_mut().unwrap() = Estimated {
                    value: 1.0,
                    std_error: bad,
                };
                refused(&of, 1e-3);
            }
        }
        // A parameter that the law has not.
        let mut of = good;
        if law.parameters().len() < PACKET_SLOTS {
            of.parameters[law.parameters().len()] = good.parameters[0];
            refused(&of, 1e-3);
        }
    }
}

#[test]
fn a_law_that_is_not_known_in_full_is_nothing_to_render_and_no_error() {
    for law in LawKind::ALL {
        assert!(packet(law, usual(law), 1).reflected().unwrap().is_some());
        for known in 0..law.parameters().len() {
            let partly = packet(law, &usual(law)[..known], 1);
            assert_eq!(partly.reflected(), Ok(None));
        }
    }
}

/// Law, place, value that no material has.
#[test]
fn what_no_material_has_is_refused_by_its_name() {
    use LawKind::{HuntCrossley, KelvinVoigt, QuasiLinear, Zener};
    for (law, name, bad) in [
        (KelvinVoigt, "stiffness", -1.0),
        (KelvinVoigt, "surface", 1e10),
        (HuntCrossley, "exponent", 0.2),
        (HuntCrossley, "exponent", 5.5),
        (HuntCrossley, "damping", 2e9),
        (Zener, "damping", 0.0),
        (QuasiLinear, "relaxation_fraction_1", 1.5),
        (QuasiLinear, "relaxation_rate_1", -1.0),
    ] {
        let slot = law.parameters().iter().position(|p| p.name == name);
        let mut values = usual(law).to_vec();
        values[slot.unwrap()] = bad;
        let error = packet(law, &values, 1).reflected().unwrap_err();
        assert_eq!(
            std::format!("{error}"),
            std::format!("{name} = {bad} cannot be rendered")
        );
    }
    // A damping that is estimated a little below none is none.
    let elastic = packet(HuntCrossley, &[1350.0, -0.3, 1.35, 0.0], 1);
    let Impedance::HuntCrossley(law) = elastic.reflected().unwrap().unwrap().impedance else {
        panic!("another law");
    };
    assert_eq!(law.damping_ns_per_m, 0.0);
}

#[test]
fn a_packet_is_overtaken_by_a_later_one_unless_the_sender_has_started_anew() {
    let at = |time_us| {
        let mut packet = packet(LawKind::HuntCrossley, &GEL, 1);
        packet.time_us = time_us;
        packet
    };
    let last = at(5_000_000);
    for (time_us, older) in [
        (5_001_000, false),
        (5_000_000, false),
        (4_999_999, true),
        (4_000_001, true),
        (4_000_000, false),
        (3000, false),
    ] {
        assert_eq!(at(time_us).is_older_than(&last), older, "{time_us}");
    }
}

#[test]
fn a_report_takes_over_the_parameters_of_another_one_and_a_material_that_is_larger_keeps_its_shape()
{
    let known = packet(LawKind::HuntCrossley, &GEL, 1);
    let mut open = packet(LawKind::KelvinVoigt, &[], 2);
    (open.time_us, open.status) = (7, Status::Changed);
    assert!(known.is_complete() && !open.is_complete());
    let held = open.with_parameters_of(&known);
    assert_eq!(held.parameters(), known.parameters());
    let report = (held.law, held.time_us, held.sequence, held.status);
    assert_eq!(report, (known.law, 7, 2, Status::Changed));
    let twice = known
        .scaled(2.0)
        .parameters()
        .map(|slot| slot.map(|known| known.value));
    assert_eq!(twice[..4], [2700.0, 72.0, 1.35, 2e-4].map(Some));
    for (slot, law) in [(1, LawKind::Zener), (2, LawKind::QuasiLinear)] {
        let usual = packet(law, usual(law), 1);
        let (before, after) = (
            usual.parameters()[slot],
            usual.scaled(3.0).parameters()[slot],
        );
        let grows = if law == LawKind::Zener { 3.0 } else { 1.0 };
        assert_eq!(after.unwrap().value, grows * before.unwrap().value);
    }
}
