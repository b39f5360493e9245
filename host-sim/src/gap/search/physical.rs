//! Fits whose numbers do not mean what the names of their effects say.

use crate::gap::model::{fit::Fit, shape::Term, start::repeats};

/// Whether the numbers of a fit mean what the names of its effects say.
pub(crate) fn is_physical(fit: &Fit) -> bool {
    let terms = fit.shape.terms_at(&fit.numbers);
    let is_physical = |term: &Term| (term.id.info().is_physical)(&term.row);
    terms.iter().all(|term| term.given || is_physical(term))
}

/// Whether a fit has three waves of a kind and none that is `prominent` times as large as the next: a Fourier series of something that
/// is no wave. A true line may have a harmonic, or sidebands of a modulation.
pub(crate) fn is_fourier_series(fit: &Fit, prominent: f64) -> bool {
    let terms = fit.shape.terms_at(&fit.numbers);
    let waves = terms.iter().filter(|term| !term.given && repeats(term.id));
    waves.clone().any(|wave| {
        let alike = waves.clone().filter(|other| other.id == wave.id);
        let mut sizes: Vec<f64> = alike.map(|other| other.row[0].abs()).collect();
        sizes.sort_by(|a, b| b.total_cmp(a));
        sizes.len() > 2 && sizes[0] < prominent * sizes[1]
    })
}
