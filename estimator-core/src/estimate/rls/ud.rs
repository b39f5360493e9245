//! The covariance P = U·D·Uᵀ in factors (Bierman 1977): U is unit upper triangular, D is diagonal and
//! positive by construction.
//!
//! The textbook's P ← (I − Qφᵀ)P/β is no longer positive after less than 100 000 samples in f32, and
//! becomes NaN.

use nalgebra::{SMatrix, SVector};

use crate::maths::scalar::Real;

/// Smallest element of D over its start value, which is also its largest: forgetting cannot let P grow
/// without bound, and 10⁸ samples cannot make it vanish.
const FLOOR: f64 = 1e-12;

/// Covariance of `N` parameters in factors.
#[derive(Clone, Debug)]
pub struct Ud<T: Real, const N: usize> {
    upper: SMatrix<T, N, N>,
    diagonal: SVector<T, N>,
    ceiling: T,
}

/// Gain and prior variance of one update.
#[derive(Clone, Copy, Debug)]
pub struct UdUpdate<T: Real, const N: usize> {
    /// The gain Q(h), (22).
    pub gain: SVector<T, N>,
    /// Variance of the prediction before the update, φᵀ(h)P(h−1)φ(h).
    pub prior_variance: T,
}

impl<T: Real, const N: usize> Ud<T, N> {
    /// Starts from P(0) = `covariance`·I.
    pub fn new(covariance: T) -> Self {
        let upper = SMatrix::identity();
        Ud {
            upper,
            diagonal: SVector::repeat(covariance),
            ceiling: covariance,
        }
    }

    /// The factor c of P(0) = c·I.
    pub fn start(&self) -> T {
        self.ceiling
    }

    /// Variance φᵀPφ of a prediction.
    pub fn variance(&self, phi: &SVector<T, N>) -> T {
        variance(&self.upper, &self.diagonal, phi)
    }

    /// The diagonal of P.
    pub fn variances(&self) -> SVector<T, N> {
        variances(&self.upper, &self.diagonal)
    }

    /// P as it is once the last parameter has been measured with a variance, or as it is if it has not. The last
    /// column of U is the direction of Pe, so that one element of D changes.
    pub fn last_known(&self, variance: Option<T>) -> LastKnown<'_, T, N> {
        let mut diagonal = self.diagonal;
        let mut share = T::zero();
        if let (Some(variance), Some(last)) = (variance, diagonal.iter_mut().last()) {
            share = *last / (*last + variance);
            *last = share * variance;
        }
        LastKnown {
            upper: &self.upper,
            diagonal,
            share,
        }
    }

    /// Updates P ← (P − PφφᵀP/(β/w + φᵀPφ))/β with forgetting factor β and a sample of weight w,
    /// (22)–(23).
    pub fn update(&mut self, phi: &SVector<T, N>, beta: T, weight: T) -> UdUpdate<T, N> {
        let start = beta / weight;
        let mut alpha = start;
        let mut scaled_gain = SVector::<T, N>::repeat(T::zero());
        // Uᵀφ with the factors as they were: column j is used before it is changed.
        for j in 0..N {
            let f = project(&self.upper, phi, j);
            if f == T::zero() {
                // The sample does not depend on this direction.
                self.diagonal[j] = self.bounded(self.diagonal[j] / beta);
                continue;
            }
            let v = self.diagonal[j] * f;
            let before = alpha;
            alpha += f * v;
            self.diagonal[j] = self.bounded(self.diagonal[j] * before / (alpha * beta));
            let factor = f / before;
            for i in 0..j {
                let old = self.upper[(i, j)];
                self.upper[(i, j)] = old - factor * scaled_gain[i];
                scaled_gain[i] += old * v;
            }
            scaled_gain[j] = v;
        }
        UdUpdate {
            gain: scaled_gain / alpha,
            prior_variance: alpha - start,
        }
    }

    /// P ← P + `variance`·eₖeₖᵀ: parameter k may have moved by so much (Agee and Turner 1972).
    pub fn widen(&mut self, k: usize, variance: T) {
        let mut along = SVector::<T, N>::repeat(T::zero());
        if let Some(own) = along.get_mut(k) {
            *own = T::one();
        }
        let mut left = variance;
        for j in (0..N).rev() {
            let own = along[j];
            let (before, after) = (self.diagonal[j], self.diagonal[j] + left * own * own);
            self.diagonal[j] = self.bounded(after);
            let gain = left * own / after;
            for i in 0..j {
                along[i] -= own * self.upper[(i, j)];
                self.upper[(i, j)] += gain * along[i];
            }
            left *= before / after;
        }
    }

    fn bounded(&self, value: T) -> T {
        let floor = self.ceiling * T::from_f64(FLOOR);
        floor.max_of(value).min_of(self.ceiling)
    }

    /// The matrix P.
    pub fn matrix(&self) -> SMatrix<T, N, N> {
        let mut scaled = self.upper;
        for j in 0..N {
            for i in 0..N {
                scaled[(i, j)] *= self.diagonal[j];
            }
        }
        scaled * self.upper.transpose()
    }
}

/// A covariance with its last parameter known.
pub struct LastKnown<'a, T: Real, const N: usize> {
    upper: &'a SMatrix<T, N, N>,
    diagonal: SVector<T, N>,
    share: T,
}

impl<T: Real, const N: usize> LastKnown<'_, T, N> {
    /// Variance φᵀPφ of a prediction.
    pub fn variance(&self, phi: &SVector<T, N>) -> T {
        variance(self.upper, &self.diagonal, phi)
    }

    /// The diagonal of P.
    pub fn variances(&self) -> SVector<T, N> {
        variances(self.upper, &self.diagonal)
    }

    /// The product Pφ.
    pub fn times(&self, phi: &SVector<T, N>) -> SVector<T, N> {
        let mut out = SVector::repeat(T::zero());
        for j in 0..N {
            let scaled = self.diagonal[j] * project(self.upper, phi, j);
            for i in 0..j {
                out[i] += self.upper[(i, j)] * scaled;
            }
            out[j] += scaled;
        }
        out
    }

    /// By how much the parameters move per unit by which the last one was off when it was measured.
    pub fn moved_by_last(&self) -> SVector<T, N> {
        match N {
            0 => SVector::repeat(T::zero()),
            _ => self.upper.column(N - 1) * self.share,
        }
    }

    /// The parameters x once the last of them, which they have with them, is known to be 0.
    pub fn held(&self, x: &SVector<T, N>) -> SVector<T, N> {
        match x.iter().last() {
            Some(last) => x - self.moved_by_last() * *last,
            None => *x,
        }
    }
}

/// Component j of Uᵀφ.
fn project<T: Real, const N: usize>(upper: &SMatrix<T, N, N>, phi: &SVector<T, N>, j: usize) -> T {
    let mut f = phi[j];
    for i in 0..j {
        f += upper[(i, j)] * phi[i];
    }
    f
}

fn variance<T: Real, const N: usize>(
    upper: &SMatrix<T, N, N>,
    diagonal: &SVector<T, N>,
    phi: &SVector<T, N>,
) -> T {
    let mut sum = T::zero();
    for j in 0..N {
        let f = project(upper, phi, j);
        sum += diagonal[j] * f * f;
    }
    sum
}

fn variances<T: Real, const N: usize>(
    upper: &SMatrix<T, N, N>,
    diagonal: &SVector<T, N>,
) -> SVector<T, N> {
    let mut out = *diagonal;
    for i in 0..N {
        for j in i + 1..N {
            let u = upper[(i, j)];
            out[i] += diagonal[j] * u * u;
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Vector2, Vector3};

    #[test]
    fn the_variances_are_the_diagonal_of_the_matrix() {
        let mut ud = Ud::<f64, 3>::new(10.0);
        for i in 0..20 {
            let t = f64::from(i);
            ud.update(&Vector3::new(1.0, libm::sin(t), t / 7.0), 0.98, 1.0);
        }
        assert!((ud.matrix().diagonal() - ud.variances()).norm() < 1e-14);
        let phi = Vector3::new(0.3, -2.0, 0.9);
        let direct = (phi.transpose() * ud.matrix() * phi)[0];
        assert!((ud.variance(&phi) - direct).abs() < 1e-12 * direct);
        assert!((ud.last_known(None).times(&phi) - ud.matrix() * phi).norm() < 1e-12);
    }

    #[test]
    fn what_may_have_moved_has_its_variance_and_nothing_else_changes() {
        let mut ud = Ud::<f64, 3>::new(10.0);
        for i in 0..20 {
            let t = f64::from(i);
            ud.update(&Vector3::new(1.0, libm::sin(t), t / 7.0), 0.98, 1.0);
        }
        for k in 0..3 {
            let mut wider = ud.clone();
            wider.widen(k, 0.3);
            let mut expected = ud.matrix();
            expected[(k, k)] += 0.3;
            assert!((wider.matrix() - expected).norm() < 1e-12, "{k}");
        }
    }

    #[test]
    fn a_weight_of_two_counts_like_two_samples() {
        let phi = Vector2::new(0.7, -1.2);
        let (mut once, mut twice) = (Ud::<f64, 2>::new(5.0), Ud::<f64, 2>::new(5.0));
        once.update(&phi, 1.0, 2.0);
        twice.update(&phi, 1.0, 1.0);
        twice.update(&phi, 1.0, 1.0);
        assert!((once.matrix() - twice.matrix()).norm() < 1e-14);
    }

    #[test]
    fn a_hundred_million_samples_of_a_hold_leave_it_sound() {
        // In single precision, with the fastest forgetting and one direction that is never excited. The
        // state reaches its fixed point after ≈ 10⁵ updates, and each further update repeats it.
        let mut ud = Ud::<f32, 2>::new(1e4);
        let phi = Vector2::new(1.7_f32, 0.0);
        for _ in 0..300_000 {
            ud.update(&phi, 0.95, 1.0);
        }
        let settled = ud.clone();
        for _ in 0..1000 {
            ud.update(&phi, 0.95, 1.0);
        }
        assert!(ud.diagonal.iter().all(|d| d.is_finite() && *d > 0.0));
        assert!(ud.upper.iter().all(|u| u.is_finite()));
        assert_eq!(ud.matrix(), settled.matrix());
        assert!(ud.variances().iter().all(|v| *v <= 1e4));
    }
}
