//! What decides in a fit of a whole log. The head of [`crate::threshold`] says how one is changed.

use crate::threshold::thresholds;

thresholds! {
    /// All of them.
    Thresholds {
        /// Which samples a law has to explain.
        samples: Samples {
            /// On the way out of a touch, samples are left out from where the force has fallen below this share
            /// of its peak: a surface that sticks or recovers slowly does there what no law says. It holds for
            /// the whole log, for the fit of the touch alone and for the scan of starts. Not measured.
            released_force: 0.03,
            /// A mean of the force that is this many of its standard deviations from rest is contact. Not
            /// measured.
            contact_sigmas: 6.0,
            /// The probe is out of the material this share of the deepest depth before the first force. Not
            /// measured.
            outside_depth: 0.05,
            /// A touch that is softer than this share of the hardest does not say where the surface is. Not
            /// measured.
            firm_touch: 0.2,
            /// A sample within this many samples' travel of the surface may be on either side of it, and a
            /// Kelvin–Voigt contact jumps by λδ̇ there: it is left out. Derived: one sample.
            surface_travel: 1.0,
        }

        /// Whether a relaxation mode more, or more than noise, is in the log.
        selection: Selection {
            /// A relaxation mode more takes this many times ln N off χ², or has not paid for its two numbers.
            /// Derived: two numbers of the Bayesian information criterion.
            mode_worth: 2.0,
            /// Noise alone leaves a χ²/N that is over 1 by less than this many of its standard errors, √(2/N).
            /// Derived: three standard errors.
            misfit_sigmas: 3.0,
            /// A law that leaves up to this many times what the best one leaves is its rival: it may be taken
            /// if its modes are known better, and where it puts the surface widens the error of that. At 1.5 a
            /// record of meat at 10 Hz takes a third mode of which nothing is known; at 2 it keeps two.
            rival: 2.0,
        }

        /// What is said of a fit.
        report: Report {
            /// A law that leaves more than this many times the noise does not explain the force. Derived: it is
            /// that of every method, with its reason there ([`EXPLAINED`](crate::estimate::EXPLAINED)).
            explained: 2.0,
            /// A parameter that must be positive is not known if its standard error is a larger share of it.
            /// Not measured.
            unknown_share: 0.7,
            /// A touch with fewer block means is not fitted by itself. Not measured.
            fewest_of_a_touch: 10.0,
            /// A log with fewer measurements in free air has none, and its resting force is one of the
            /// parameters. Not measured.
            fewest_free: 10.0,
            /// Damping that is this many standard errors below 0 is called negative. Derived: three standard
            /// errors.
            negative_damping: 3.0,
            /// A skew is said if it is this many standard errors from 0. Not measured.
            skew_sigmas: 4.0,
            /// A skew is said if it is more than this share of a sample period. Not measured.
            least_skew: 0.1,
        }
    }
}
