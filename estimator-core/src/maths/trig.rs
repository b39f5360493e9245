//! Sine and cosine in single precision, for the angles of a rig.
//!
//! The functions of libm take 6.6 KiB of flash, most of it to reduce angles beyond 10⁵ rad exactly. Here
//! multiples of π are subtracted in three parts (Cody & Waite), and the remainder r within ±π/2 goes
//! into the series up to r¹¹: the error stays below 2·10⁻⁷ up to 100 rad, and then grows with the
//! resolution of the angle in f32.

/// Largest number of half turns: beyond it f32 resolves an angle to no better than 0.01 rad, and both
/// functions give 0.
const MAX_HALF_TURNS: f32 = 32_768.0;
/// π in three parts, of which the first two are exact when multiplied by a number of half turns.
const PI: [f32; 3] = [3.140_625, 9.675_026e-4, 1.509_958e-7];

/// The sine and the cosine of an angle (rad).
pub(super) fn sin_cos(angle: f32) -> (f32, f32) {
    (sine(angle), cosine(angle))
}

/// The sine of an angle (rad).
fn sine(angle: f32) -> f32 {
    let half_turns = libm::floorf(angle * core::f32::consts::FRAC_1_PI + 0.5);
    reduced(angle, half_turns, half_turns)
}

/// The cosine of an angle (rad).
fn cosine(angle: f32) -> f32 {
    let half_turns = libm::floorf(angle * core::f32::consts::FRAC_1_PI);
    -reduced(angle, half_turns + 0.5, half_turns)
}

/// Computes (−1)^`half_turns` sin(`angle` − `middle`·π).
fn reduced(angle: f32, middle: f32, half_turns: f32) -> f32 {
    if angle.is_nan() {
        return angle;
    }
    if half_turns.abs() > MAX_HALF_TURNS {
        return 0.0;
    }
    let remainder = PI.iter().fold(angle, |left, part| left - middle * part);
    match half_turns as i32 & 1 {
        0 => series(remainder),
        _ => -series(remainder),
    }
}

/// The series r − r³/3! + … − r¹¹/11! of the sine.
fn series(r: f32) -> f32 {
    const OVER_FACTORIAL: [f32; 5] = [
        -1.0 / 39_916_800.0,
        1.0 / 362_880.0,
        -1.0 / 5_040.0,
        1.0 / 120.0,
        -1.0 / 6.0,
    ];
    let square = r * r;
    let tail = OVER_FACTORIAL
        .iter()
        .fold(0.0, |sum, term| sum * square + term);
    r + r * square * tail
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sine_and_cosine_are_right_to_single_precision() {
        for at in -200_000..=200_000_i32 {
            let angle = at as f32 * 5e-4;
            let exact = f64::from(angle);
            let error = (f64::from(sine(angle)) - libm::sin(exact)).abs();
            assert!(error < 2e-7, "sin {angle}: {error:e}");
            let error = (f64::from(cosine(angle)) - libm::cos(exact)).abs();
            assert!(error < 2e-7, "cos {angle}: {error:e}");
        }
    }

    #[test]
    fn far_out_they_are_as_right_as_the_angle_and_never_beyond_one() {
        for turns in [1e3_f32, 1e4, 1.6e4, 1e5, 1e9, 3e38, -1e4, -1e30] {
            for part in 0..1000 {
                let angle = turns * (1.0 + part as f32 * 1e-6) * core::f32::consts::TAU;
                for value in [sine(angle), cosine(angle)] {
                    assert!(value.abs() <= 1.0 + 1e-6, "{angle}: {value}");
                }
                if angle.abs() < MAX_HALF_TURNS * 3.0 {
                    let error = (f64::from(sine(angle)) - libm::sin(f64::from(angle))).abs();
                    assert!(error < 1e-6, "sin {angle}: {error:e}");
                }
            }
        }
        assert!(sine(f32::NAN).is_nan() && cosine(f32::NAN).is_nan());
        assert_eq!((sine(f32::INFINITY), cosine(f32::INFINITY)), (0.0, -0.0));
    }
}
