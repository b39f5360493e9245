//! The one quantile of the tables.

use std::borrow::Borrow;

/// The smallest of the values that at least a `share` of them does not exceed (nearest rank); NaN of none.
///
/// What is no number counts as the largest: a run that never settles is no fast one.
pub fn quantile(values: impl IntoIterator<Item = impl Borrow<f64>>, share: f64) -> f64 {
    let own = values.into_iter().map(|value| *value.borrow());
    let mut sorted: Vec<f64> = own.map(|v| if v.is_nan() { f64::NAN } else { v }).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    let rank = (share * sorted.len() as f64).ceil() as usize;
    let at = rank.saturating_sub(1);
    sorted.get(at).copied().unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quantile_is_a_value_by_its_rank() {
        let values = [3.0, 1.0, 2.0, 4.0];
        let of = |share| quantile(values, share);
        assert_eq!([of(0.0), of(0.5), of(0.51), of(1.0)], [1.0, 2.0, 3.0, 4.0]);
    }

    #[test]
    fn what_is_no_number_is_the_largest_and_none_have_none() {
        assert_eq!(quantile([-f64::NAN, 1.0, 2.0], 0.5), 2.0);
        assert!(quantile([1.0, f64::NAN], 1.0).is_nan());
        assert!(quantile([0.0; 0], 0.5).is_nan());
    }
}
