//! What decides in the workflow: a struct for each decision, every number with its reason and how it was
//! found. They come in through `Options`, so that
//! `cargo run --release -p tests --example hidden -- sweep NAME` changes one without a recompile and prints
//! what that does to the score. The head of [`crate::threshold`] says what a factor means.
//!
//! Elsewhere stand numbers that decide nothing: steps of a fit, samples that a search can afford, places
//! where fits start, what the names of the regions mean, and the models of the motion's errors.

use crate::threshold::thresholds;

thresholds! {
    /// All of them.
    Thresholds {
        /// Whether anything can be fitted to a log.
        input: Input {
            /// Samples: a log with fewer is refused. Derived: twelve windows, of which every third is held out,
            /// each as wide as half of the filter that finds the speed (15 samples) and one more.
            fewest_samples: 192.0,
            /// Standard deviations of the position's noise: a position with a smaller range does not move.
            /// Derived: the range of 10⁵ normal samples is 8.8 standard deviations.
            still_sigmas: 10.0,
            /// Standard deviations of the force's noise: a force with a smaller range shows no touch. Not measured.
            silent_sigmas: 12.0,
        }

        /// Whether a long log is mostly rest, which is then thinned.
        rest: Rest {
            /// The share of the log that stands still in a log that is mostly rest. Not measured.
            mostly: 0.75,
            /// Standard deviations of the position's noise: a sample stands still if the position around it
            /// changes by less. A speed would not do, since a position that is held by a loop trembles. Not
            /// measured.
            still_sigmas: 6.0,
            /// Of the travel: a sample also stands still if the position around it changes by less. Not measured.
            still_share: 2e-3,
        }

        /// What of a force is noise, which estimate of it is right, and what is a line.
        floor: Floor {
            /// Standard errors of a noise floor: a difference within them is scatter, and what is left of a force
            /// may be as much larger because of them. Derived: three standard errors.
            sigmas: 3.0,
            /// Noise at rest over noise from second differences, from which on the noise is coloured and the
            /// estimate at rest is the right one. Not measured.
            coloured: 1.06 over 1.0,
            /// Samples: a shorter rest does not count. Not measured.
            shortest_rest: 128.0,
            /// Steps of the encoder within which the position of a rest stays. Derived: two counts, and half of
            /// one for rounding.
            rest_steps: 2.5,
            /// Of the travel: the part that is furthest out and counts as free air. Not measured.
            free_air: 0.25,
            /// Standard deviations: a sample that is further from its neighbours, or from the trend of a rest, is
            /// a spike and no noise. Not measured.
            spike_sigmas: 4.0,
            /// Standard deviations from the line through the medians of a rest, from which on spikes do not count
            /// for its trend: a quarter of a rest at 35 standard deviations would be the trend. Not measured.
            long_spike_sigmas: 6.0,
            /// Of the power at rest: a line in time that holds more is a disturbance. One that holds less is left
            /// in, and the floor is then at most 1.4 times too high.
            disturbed: 0.5,
            /// Times the mean of what is left around it: a line in time stands out by more. Derived: noise alone
            /// reaches it in e⁻³⁰ of the bins.
            prominence: 30.0,
            /// Times the median of its neighbours: a bin of a rest's spectrum with more is a line. Derived: noise
            /// alone reaches it in e⁻⁸ of the bins of one window.
            line: 8.0,
            /// The least exponent a of a density f^−a that is more than scatter. Not measured.
            least_slope: 0.3,
            /// The largest exponent that is noise: electronics make 1/f, and what is steeper is a drift.
            largest_slope: 1.0,
        }

        /// Which fits a search follows, and when it ends.
        search: Search {
            /// Of the excess: an effect that promises less, to first order, is not refitted. Not measured.
            least_promise: 1e-3,
            /// The factor on what an effect promises if its size would be negative: the base may turn that round,
            /// but rarely. Not measured.
            wrong_sign: 0.05,
            /// Times Σ w r² of noise: a fit with more may have run away, and another start is made from the
            /// values of the model file. Not measured.
            ran_away: 4.0 over 1.0,
            /// Times the excess of the best: the next step goes on from no fit that leaves more. Near the noise a
            /// fit that is far ahead is the right one; far from it none is. Not measured.
            behind: 4.0 over 1.0,
            /// Of Σ w r² of noise: an excess that is smaller counts as this much when fits are compared with the
            /// best. Not measured.
            least_excess: 0.25,
            /// Of the base's excess: with more left after two effects the search ends with nothing named. True
            /// sets of three leave 4 % at most, what is in no catalogue 5 to 50 %.
            hopeless_after_two: 0.5,
            /// The same after three effects. Three of the five effects of cells under a cantilever leave 17 %.
            hopeless_after_three: 0.25,
            /// Times the next: the largest of three waves of a kind that is smaller does not stand out, and the
            /// waves are a Fourier series of something that is no wave. Not measured.
            prominent_wave: 3.0 over 1.0,
            /// In units of independent residuals: a swap of one effect for another improves the score by more.
            /// Not measured.
            swap_gain: 6.0,
        }

        /// What an effect must take off Σ w r² to be significant.
        significance: Significance {
            /// The χ² that noise alone does not make of one effect. Derived: five standard deviations, squared.
            chi2: 25.0,
            /// Times the logarithm of the catalogue's size, for the best of so many effects. Derived: the largest
            /// of n squared normal numbers grows as 2 ln n.
            chi2_of_catalogue: 2.0,
            /// Of what is left: a new effect takes more, for the errors of the noise's own model. Not measured.
            white: 0.04,
            /// The same where the noise is coloured, and more where its slowest part is extrapolated
            /// (`floor.sigmas` standard errors of it): rests of a second do not show a wander. Not measured.
            coloured: 0.10,
            /// Lines at rest over the noise floor, from which on a log counts as coloured here. Not measured.
            lines: 0.3,
            /// Of what is left: an effect beside others that suffice (`explained.sufficient`) takes more, since
            /// what is left then is mostly the form of the first, a Stribeck friction where the catalogue says
            /// Coulomb. Not measured.
            beside_sufficient: 0.15,
            /// Of the base's Σ w r²: effects that leave more do not suffice, however near the noise. Not measured.
            sufficient: 0.5,
            /// Of what the base left beyond the noise: the errors of the effects' forms. Not measured.
            form: 0.02,
            /// Of what is left beyond the noise: what takes more of it is no error of form, however bad the base
            /// was. Not measured.
            certain_of_new: 0.5,
            /// The same for one more term of an effect that the fit has already, which adds no effect. Not
            /// measured.
            certain_of_repeated: 0.2,
        }

        /// Whether what is left is noise. There are four bounds, because four questions are asked: two of
        /// residuals on held-out parts, and two of Σ w r² of all samples, on which a fit is always better.
        explained: Explained {
            /// Held-out residuals over what is allowed: effects that leave less explain the log. Errors of form,
            /// of the motion between samples and of the noise floor itself are below. Not measured.
            with_effects: 1.12 over 1.0,
            /// Held-out residuals over what is allowed: a base that leaves less explains a log in which nothing
            /// more is found. Lower than with effects, since no effect's form is wrong then. Not measured.
            without_effects: 1.08 over 1.0,
            /// Σ w r² over that of noise: effects that leave less suffice, and another one beside them has to
            /// take more. Derived: the square of `with_effects`, rounded; that is 1.2544, and to say it exactly
            /// would move decisions at this bound.
            sufficient: 1.25 over 1.0,
            /// Σ w r² over that of noise: a search that leaves less looks for nothing more. Tighter, since a weak
            /// effect is found only beyond it. Not measured.
            nothing_more: 1.02 over 1.0,
            /// The factor on the two bounds of residuals where the noise is coloured, since a rest of a second
            /// does not say what the noise does in ten: of 64 floors of pink noise the lowest was 0.82 of the
            /// truth. `floor.sigmas` standard errors of the floor count instead where they are more.
            coloured: 1.25 over 1.0,
        }

        /// Whether effects are accepted.
        acceptance: Acceptance {
            /// Of the base's excess: effects that explain more together are accepted where something is left.
            /// Not measured.
            explained_share: 0.95 over 1.0,
            /// Of the base's excess: effects that leave less are accepted as well, if they are far ahead of any
            /// other set as large. Not measured.
            largest_remainder: 0.25,
            /// Times what the effects leave: any other set as large leaves more if they are far ahead. The
            /// nearest effect to a crackling that is in no catalogue was 3.1 times ahead, a soft limit 4.7 times.
            least_lead: 4.0 over 1.0,
            /// Of what is left: an effect that takes less off where much is left is idle. Not measured.
            idle: 0.01,
            /// Standard errors: the size of an effect that is smaller may as well be 0. Of 810 effects that were
            /// right one was that badly known, of 36 wrong ones ten.
            size_sigmas: 3.0,
            /// Of the held-out squares: an effect that takes less off is not worth telling from another. Not
            /// measured.
            missed: 0.1,
            /// Of Σ w r²: taking the bias of the motion's errors off the numbers of a fit costs less, or is no
            /// small correction and is not made. Not measured.
            correction_cost: 0.02,
        }

        /// Whether an effect could be another one as well.
        rivalry: Rivalry {
            /// Squared standard errors of independent samples: fits whose Σ w r² differ by less are not
            /// discriminated. Not measured.
            margin: 12.0,
            /// Times the Σ w r² of the best at the search's resolution: a rival with less is refitted at the
            /// log's own rate, where its distance may shrink. A compliance that follows in 2 ms, seen every 4 ms,
            /// was off by 14 %.
            followed: 1.20 over 1.0,
            /// Standard errors by which a rival is worse throughout the log. A delay of 4.5 ms under a sine of
            /// 0.2 Hz was worse than a lag by 80, 0.7 standard errors.
            throughout_sigmas: 2.0,
            /// Of Σ w r²: errors that make the force late do not reach it. A delay was worse by 6.6 % and more
            /// for a lag that was one, mostly in the fastest of 48 stretches.
            late: 0.05,
        }

        /// Which regions and lines of a log are named.
        regions: Regions {
            /// The share of false names among the regions, by Benjamini and Hochberg's procedure. Derived: one
            /// in a hundred.
            false_discoveries: 0.01,
            /// Samples: a region with fewer is not tested. Not measured.
            fewest_samples: 10.0,
            /// Of the excess: a region that holds less is not named. Not measured.
            least_share: 0.02,
            /// Of the residual's energy: a line that holds less is not named. Not measured.
            line_share: 0.1,
            /// Times: a fitted stiffness that is this many times larger or smaller than the model's is in another
            /// unit. Not measured.
            another_unit: 100.0 over 1.0,
        }

        /// Which motion is advised.
        advice: Advice {
            /// Standard error over value: the log does not observe a number with more. Not measured.
            unobserved: 0.7,
            /// Of what it was: an advised motion brings a standard error below, and below `unobserved`. Not
            /// measured.
            better: 0.5,
            /// Times the standard deviations that count: what a motion promises between a lag and a delay, which
            /// lasting errors of a rig imitate. Not measured.
            sure: 3.0 over 1.0,
            /// Times the speed of the log: a motion that is faster is said to be. Not measured.
            faster: 1.5 over 1.0,
        }
    }
}

impl Significance {
    /// The χ² by which a difference counts, for the best of so many effects.
    pub(crate) fn chi2_of(&self, catalogue: usize) -> f64 {
        self.chi2 + self.chi2_of_catalogue * (catalogue as f64).ln()
    }
}
