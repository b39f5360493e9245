//! A secant stiffness that grows from touch to touch with their depth, beside a law whose stiffness is one number.

use estimator_core::physics::law::LawId;

use crate::number::quantity;
use crate::replay::Touch;

/// Fewest touches that tell.
const FEWEST: usize = 4;
/// The deepest is so many times as deep as the shallowest.
const DEEPER: f64 = 1.3;
/// And so many times as stiff. A spring and a damper are less stiff at depth at the same speed; of a gel with an exponent of
/// 1.35 it is 1.10 at that depth.
const STIFFER: f64 = 1.08;
/// Pairs of touches of which the deeper one is the stiffer: at random a half.
const MOST_PAIRS: f64 = 0.85;

/// What is to be said of it, in words; `None` of a law with an exponent, and where no trend is.
pub(crate) fn stiffening(touches: &[Touch], law: LawId) -> Option<String> {
    if !matches!(law, LawId::KelvinVoigt | LawId::Zener) {
        return None;
    }
    let both = |touch: &Touch| Some((touch.peak_depth_m, touch.secant_stiffness?));
    let mut each: Vec<(f64, f64)> = touches.iter().filter_map(both).collect();
    each.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (shallowest, deepest) = (each.first()?, each.last()?);
    let pairs = each
        .iter()
        .enumerate()
        .flat_map(|(at, a)| each[at + 1..].iter().map(move |b| b.1 > a.1));
    let (stiffer, all) = pairs.fold((0, 0), |(stiffer, all), is| {
        (stiffer + usize::from(is), all + 1)
    });
    let is_trend = each.len() >= FEWEST
        && deepest.0 > DEEPER * shallowest.0
        && deepest.1 > STIFFER * shallowest.1
        && f64::from(stiffer as u32) >= MOST_PAIRS * f64::from(all as u32);
    is_trend.then(|| {
        format!(
            "the stiffness rises from {} to {} between touches of {} and {}: the material stiffens, and one number holds at \
             one depth only; try --law hunt_crossley, or --law quasi_linear if it relaxes",
            quantity(shallowest.1, 3, "N/m"),
            quantity(deepest.1, 3, "N/m"),
            quantity(shallowest.0, 2, "m"),
            quantity(deepest.0, 2, "m"),
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn touches(exponent: f64) -> Vec<Touch> {
        let touch = |depth_m: f64| Touch {
            from_s: 0.0,
            to_s: 1.0,
            peak_force_n: 1.0,
            peak_depth_m: depth_m,
            secant_stiffness: Some(1000.0 * (depth_m / 1e-3).powf(exponent - 1.0)),
            dissipated_j: None,
            relaxation_ratio: None,
        };
        [2e-3, 3e-3, 2.5e-3, 4e-3].map(touch).into()
    }

    #[test]
    fn a_secant_that_rises_with_depth_is_said_of_a_law_with_one_stiffness() {
        let said = stiffening(&touches(1.5), LawId::KelvinVoigt).expect("it stiffens");
        assert!(said.contains("the material stiffens"), "{said}");
        assert_eq!(stiffening(&touches(1.5), LawId::HuntCrossley), None);
        assert_eq!(stiffening(&touches(1.0), LawId::KelvinVoigt), None);
        assert_eq!(stiffening(&touches(1.5)[..3], LawId::KelvinVoigt), None);
    }
}
