//! Fits whose numbers do not mean what the names of their effects say.

use estimator_core::physics::effect::EffectId;

use crate::gap::model::fit::Fit;
use crate::gap::model::start::repeats;

/// A wave stands out if it is this many times as large as the next.
const PROMINENT: f64 = 3.0;

/// Whether the numbers of a fit mean what the names of its effects say. A friction that is smaller at
/// rest than sliding is not Stribeck's, but imitates a drag. Where an encoder's reading falls with the
/// position, its error is any curve at all (70 nm that repeat every 140 nm). A layer that sets in over a
/// quarter of its depth pushes from the touch on, with 2 % of its stiffness: it is no layer, but any
/// stiffening.
pub(crate) fn is_physical(fit: &Fit) -> bool {
    let terms = fit.shape.terms_at(&fit.numbers);
    terms.iter().all(|term| {
        let [first, second, third, ..] = term.row;
        term.given
            || match term.id {
                EffectId::StribeckFriction => second >= first,
                EffectId::EncoderPeriodicError => std::f64::consts::TAU * first < second,
                EffectId::BuriedLayer => third <= 0.25 * second,
                _ => true,
            }
    })
}

/// Whether a fit has three waves of a kind and none that stands out: a Fourier series of something that
/// is no wave. A true line may have a harmonic, or sidebands of a modulation.
pub(crate) fn is_fourier_series(fit: &Fit) -> bool {
    let terms = fit.shape.terms_at(&fit.numbers);
    let waves = terms.iter().filter(|term| !term.given && repeats(term.id));
    waves.clone().any(|wave| {
        let alike = waves.clone().filter(|other| other.id == wave.id);
        let mut sizes: Vec<f64> = alike.map(|other| other.row[0].abs()).collect();
        sizes.sort_by(|a, b| b.total_cmp(a));
        sizes.len() > 2 && sizes[0] < PROMINENT * sizes[1]
    })
}
