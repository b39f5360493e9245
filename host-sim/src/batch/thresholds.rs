//! What decides in a fit of a whole log. The head of [`crate::threshold`] says how one is changed.

use crate::threshold::thresholds;

thresholds! {
    /// All of them.
    Thresholds {
        /// Which samples a law has to explain.
        samples: Samples {
            /// Of the peak force: on the way out of a touch, samples from where the force has fallen below
            /// it are left out, of the whole log, of the fit of the touch alone and of the scan of starts:
            /// a surface that sticks or recovers slowly does there what no law says. Not measured.
            released_force: 0.03,
            /// A mean of the force that is this many of its standard deviations from rest is contact.
            /// Not measured.
            contact_sigmas: 6.0,
            /// Of the deepest depth: the probe is out of the material this far before the first force.
            /// Not measured.
            outside_depth: 0.05,
            /// Of the peak force of the hardest touch: a softer touch does not say where the surface is.
            /// Not measured.
            firm_touch: 0.2,
            /// Samples of travel: a Kelvin-Voigt contact jumps by λδ̇ at the surface, and the rounding of a
            /// sample that is within this travel of it decides on which side it is. Derived: one sample.
            surface_travel: 1.0,
        }

        /// Whether a relaxation mode more, or more than noise, is in the log.
        selection: Selection {
            /// Times ln N of χ²: a mode that takes less off has not paid for its two numbers. Derived: two
            /// numbers of the Bayesian information criterion.
            mode_worth: 2.0,
            /// Standard errors of χ²/N, √(2/N) each: less over 1 is what noise alone leaves. Derived: three
            /// standard errors.
            misfit_sigmas: 3.0,
        }

        /// What is said of a fit.
        report: Report {
            /// A law that leaves more than this many times the noise does not explain the force.
            /// Not measured.
            explained: 3.0,
            /// Standard error over value: a parameter that must be positive and is known no better is not
            /// known. Not measured.
            unknown_share: 0.7,
            /// Block means: a touch with fewer is not fitted by itself. Not measured.
            fewest_of_a_touch: 10.0,
            /// Measurements: fewer are no free air, and the resting force is then one of the parameters.
            /// Not measured.
            fewest_free: 10.0,
            /// Standard errors below 0: damping that is further below is called negative. Derived: three
            /// standard errors.
            negative_damping: 3.0,
            /// Standard errors: a skew that is further from 0 is said. Not measured.
            skew_sigmas: 4.0,
            /// Of a sample period: a smaller skew is not said. Not measured.
            least_skew: 0.1,
        }
    }
}
