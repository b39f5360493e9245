//! What decides in the workflow: a struct for each decision, every number with its reason and how it was
//! found. They come in through `Options`, so that
//! `cargo run --release -p tests --example hidden -- sweep NAME` changes one without a recompile and prints
//! what that does to the score. The head of [`crate::threshold`] says what a factor means.
//!
//! Elsewhere stand what recognises a fault of a sensor in a log (`data`, `lost_counts`), what a rule of one file asks of
//! its own kind of effect, and numbers that decide nothing: steps of a fit, samples that a search can afford, places where
//! fits start, what the names of the regions mean, and the models of the motion's errors.

use crate::threshold::thresholds;

thresholds! {
    /// All of them.
    Thresholds {
        /// Whether anything can be fitted to a log.
        input: Input {
            /// A log with fewer samples is refused. Derived: twelve windows, of which every third is held out,
            /// each as wide as half of the filter that finds the speed (15 samples) and one more.
            fewest_samples: 192.0,
            /// A low-pass is refused that leaves fewer independent values. Derived: two in each of twelve windows.
            fewest_values: 24.0,
            /// A position does not move if its range is below this many standard deviations of its noise.
            /// Derived: the range of 10⁵ normal samples is 8.8 standard deviations.
            still_sigmas: 10.0,
            /// A force shows no touch if its range is below this many standard deviations of its noise. Not measured.
            silent_sigmas: 12.0,
        }

        /// Whether a long log is mostly rest, which is then thinned.
        rest: Rest {
            /// A log is mostly rest if a larger share of it stands still. Not measured.
            mostly: 0.75,
            /// A sample stands still if the position around it changes by less than this many standard deviations of
            /// its noise. A speed would not do, since a position that is held by a loop trembles. Not measured.
            still_sigmas: 6.0,
            /// A sample also stands still if the position around it changes by less than this share of the
            /// travel. Not measured.
            still_share: 2e-3,
        }

        /// What of a force is noise, which estimate of it is right, and what is a line.
        floor: Floor {
            /// A noise floor may be off by this many of its standard errors: a difference within them is
            /// scatter, and residuals may be as much larger because of them. Derived: three standard errors.
            sigmas: 3.0,
            /// Noise is coloured if it is larger at rest than second differences say by this factor, and the
            /// estimate at rest is then the right one. Not measured.
            coloured: 1.06 over 1.0,
            /// Second differences see the motion where they say so many times what fourth ones say, and more than there is at
            /// rest. Noise whose increments are white says 1.08 times as much.
            sees_motion: 1.15 over 1.0,
            /// What is at rest is a disturbance and no noise if it is larger than second differences say by more than this
            /// factor. First-order noise with a corner of 1 Hz at 1 kHz: 8; a chirp or a chaos at rest: 14 and more.
            largest_colour: 10.0 over 1.0,
            /// Up to this factor it is noise all the same if its fourth moment is that of normal noise to half of
            /// `sigmas` standard errors, and would tell a sine: behind a second-order corner of 11 to 19 Hz at 1 kHz
            /// noise is 10.5 to 13.7 times as large, and off by 0.4 at most. Of 37 rigs with something at rest that is
            /// in no catalogue none reached 5 times.
            filtered_colour: 20.0 over 1.0,
            /// Up to this factor its fourth moment may be larger than that of normal noise, as where a touch dies out in it;
            /// never smaller: that of a chirp is half. A telegraph signal at rest: 3.6; first-order noise and a hum: 2.9.
            slight_colour: 3.2 over 1.0,
            /// What is at rest comes and goes if a tenth of it is quieter than this share of its median: 0.22 to
            /// 0.34 in bursts, 0.8 to 0.95 on 200 other rigs and records.
            quiet: 0.5,
            /// A force whose code is more than this many standard deviations of its noise is quiet or not as its
            /// level lies between the codes. Derived: half of a code is then 0.7 of them.
            fine_code: 1.5,
            /// A rest with as many samples counts, however short it is. Not measured.
            shortest_rest: 128.0,
            /// So does one with as many that lasts `least_rest_s`, unless the rig touches nothing: a servo that turns a
            /// pendulum holds it for 0.3 s, 64 samples, at the end of its travel, and had a floor as large as what is
            /// missing in it. At 10 kHz 64 are a turn of the motion.
            fewest_at_rest: 64.0,
            /// A rest of few samples lasts as long (s): at 200 Hz most rigs rest for 0.5 s between strokes.
            least_rest_s: 0.3,
            /// The position of a rest stays within this many steps of the encoder. Derived: two counts and a half.
            rest_steps: 2.5,
            /// The outermost part of the travel, as large as this share of it, is free air. Not measured.
            free_air: 0.25,
            /// Where a rig touches nothing all of its travel is, as long as the mean forces of two rests and more lie
            /// within so many standard deviations at rest: friction holds a drive at another force each time. Derived:
            /// means of slow noise differ by as much as it is. 0 where something is touched.
            rests_agree: 0.0,
            /// A sample that is this many standard deviations from its neighbours, or from the trend of a rest,
            /// is a spike and no noise. Not measured.
            spike_sigmas: 4.0,
            /// Samples of a rest that are this many standard deviations from the line through its medians do not count
            /// for its trend: a quarter of a rest at 35 standard deviations would be the trend. Not measured.
            long_spike_sigmas: 6.0,
            /// A line in time is a disturbance if it holds more than this share of the power at rest. One that
            /// holds less is left in, and the floor is then at most 1.4 times too high. Not measured.
            disturbed: 0.5,
            /// A line in time has more than this many times the mean power of what is left around it. Derived:
            /// noise alone reaches it in e⁻³⁰ of the bins.
            prominence: 30.0,
            /// A bin of a rest's spectrum is a line if it has more than this many times the median of its
            /// neighbours. Derived: noise alone reaches it in e⁻⁸ of the bins of one window.
            line: 8.0,
            /// Noise is slower than second differences see if stretches of smooth motion have so many times as much of it:
            /// 1.2 times where a line was taken out of uneven samples, 1.6 behind a first-order corner at a tenth of the rate.
            slower: 1.25 over 1.0,
            /// Stretches have most of the noise where it is at most this many times as much in twice as long ones: with a
            /// corner at a hundredth of the rate 1.27 to 1.31 from 256 or 512 samples to twice as many.
            most_growth: 1.35 over 1.0,
            /// What is left in stretches is no noise if its kurtosis is smaller. Derived: 1.5 for a sine, 2.0 with half of
            /// its amplitude of noise, 3 for normal noise.
            least_kurtosis: 2.4,
            /// What is left in stretches is noise if those that move further have as much of it, within this many standard
            /// errors: filtered noise stayed within 3, events and missing effects of records were 4 to 12 off.
            stretch_sigmas: 4.0,
            /// It is noise if the upper quarter of stretches has at most this many times the mean square of the lower
            /// quarter: noise behind a filter up to 4, records with friction or play 10 to 1000.
            stretch_scatter: 4.5 over 1.0,
            /// A density f^−a rises towards low frequencies if its exponent a is larger; a smaller one is
            /// scatter. Not measured.
            least_slope: 0.3,
            /// A density f^−a with a larger exponent a is a drift and no noise. Derived: electronics make 1/f.
            largest_slope: 1.0,
        }

        /// Which fits a search follows, and when it ends.
        search: Search {
            /// An effect is refitted if it promises, to first order, more than this share of the excess. Not measured.
            least_promise: 1e-3,
            /// What an effect promises counts by this factor if its size would be negative: the base may turn
            /// that round, but rarely. Not measured.
            wrong_sign: 0.05,
            /// A fit may have run away if it leaves more than this many times the Σ w r² of noise; it is then
            /// started from the values of the model file as well. Not measured.
            ran_away: 4.0 over 1.0,
            /// The next step goes on from fits that leave at most this many times the excess of the best, if that is near
            /// the noise: there a fit that is far ahead is the right one, far from the noise none is. Not measured.
            behind: 4.0 over 1.0,
            /// An excess below this share of the Σ w r² of noise counts as this share when fits are compared
            /// with the best. Not measured.
            least_excess: 0.25,
            /// Far from the noise the search ends when two steps in turn take less than this share off what is
            /// left: what comes after them only fits the remainder. Not measured.
            least_step: 0.3,
            /// The largest of several waves of a kind stands out if it is this many times as large as the next;
            /// if it does not, they are a Fourier series of something that is no wave. Not measured.
            prominent_wave: 3.0 over 1.0,
            /// One effect is swapped for another if that improves the score by more independent residuals. Not measured.
            swap_gain: 6.0,
        }

        /// What an effect must take off Σ w r² to be significant.
        significance: Significance {
            /// Noise alone does not make this χ² of one effect. Derived: five standard deviations, squared.
            chi2: 25.0,
            /// The χ² grows by this many times the logarithm of the catalogue's size, for the best of so many
            /// effects. Derived: the largest of n squared normal numbers grows as 2 ln n.
            chi2_of_catalogue: 2.0,
            /// A new effect takes off more than this share of what is left, for the errors of the noise's own
            /// model. Not measured.
            white: 0.04,
            /// Where the noise is coloured a new effect takes off more than this share, and more than
            /// `floor.sigmas` standard errors of the floor where its slowest part is extrapolated: rests of a
            /// second do not show a wander. Not measured.
            coloured: 0.10,
            /// A log also counts as coloured here if the lines at rest are larger than this share of the noise
            /// floor. Not measured.
            lines: 0.3,
            /// Beside effects that suffice (`explained.sufficient`) another one takes off more than this share of what
            /// is left, since that is mostly the form of the first: a Stribeck friction where the catalogue says
            /// Coulomb. So does the first one where a base leaves no more than is allowed. Not measured.
            beside_sufficient: 0.15,
            /// Effects that leave more than this share of the base's Σ w r² do not suffice, however near the
            /// noise. Not measured.
            sufficient: 0.5,
            /// Effects take off more than this share of what the base left beyond the noise, for the errors of
            /// their forms. Not measured.
            form: 0.02,
            /// What takes more than this share of what is left beyond the noise is no error of form, however
            /// bad the base was. Not measured.
            certain_of_new: 0.5,
            /// The same holds from this share on for one more term of an effect that the fit has already, which
            /// adds no effect. Not measured.
            certain_of_repeated: 0.2,
        }

        /// Whether what is left is noise. There are three bounds, because three questions are asked: one of
        /// residuals on held-out parts, and two of Σ w r² of all samples, on which a fit is always better.
        explained: Explained {
            /// A log is explained if held-out residuals are below this many times what is allowed. Errors of form,
            /// of the motion between samples and of the noise floor itself are below. Not measured.
            residuals: 1.12 over 1.0,
            /// Effects suffice if they leave less than this many times the Σ w r² of noise: another one beside
            /// them has to take more. Derived: the square of `residuals`, 1.2544, rounded.
            sufficient: 1.25 over 1.0,
            /// A search ends where a fit leaves less than this many times the Σ w r² of noise: weaker effects
            /// are not looked for. Not measured.
            nothing_more: 1.02 over 1.0,
            /// The bound of residuals is this factor higher where the noise is coloured, since a rest of a
            /// second does not say what the noise does in ten: of 64 floors of pink noise the lowest was 0.82
            /// of the truth. `floor.sigmas` standard errors of the floor count instead where they are more.
            /// Beside what a model left when it was identified nothing is new below it: of 14 records that were asked with
            /// the model of another (two of a drive, three each of a damper and of cells) eight were; four got no name,
            /// and two that of the relaxation which their model lacks.
            coloured: 1.25 over 1.0,
            /// It is not higher where residuals typically are less than this share of their rms: 0.62 at least where it was
            /// needed, 0.36 of a hand's pushes.
            least_typical: 0.5,
            /// … or this of an octave: 0.49 at least in 39 rigs that needed it, 0.20 and 0.29 of weak pushes.
            least_of_octave: 0.4,
            /// … nor where they are more: 1.12 where a higher bound was needed, of a sine 1.48, of chirps 1.18 and 1.36.
            most_typical: 1.2 over 1.0,
            /// What is left is no noise where means of 32 samples in motion have this many times the power that white
            /// noise gives them. Of 125 of the harder rigs that were answered rightly over white noise five were above,
            /// with 6.0 to 9.7; three wrong answers had 6.1 to 10.3.
            slow: 4.0 over 1.0,
            /// They are no slow noise where they have this many times the power of those at rest, too. Of the five three
            /// had 0.6 to 1.8 times and two hardly a rest, the wrong ones 2.7 to 4.2 times. Without a rest in free air
            /// it is not asked.
            slow_over_rest: 2.0 over 1.0,
        }

        /// Whether an effect is named though something remains that no effect explains.
        evidence: Evidence {
            /// It takes at least this share of what stands above the noise without it. On 36 of the harder rigs true
            /// effects took 0.83 to 1, but for 0.55 of a stiffening, 0.51 of an adhesion with a range and 0.72 of an
            /// encoder's error in a fit that went astray; a lag and a friction put into measured records took 0.48 and
            /// 0.49. What was fitted to something that is in no catalogue, was no series of waves and stood in all blocks
            /// took 0.41 at most.
            share: 0.45,
            /// The best set of any size without it, or without what stands for it, leaves at least this many times as many
            /// squares. Not measured; what fits something that is in no catalogue reached 2.7, and fails elsewhere.
            lead: 1.5 over 1.0,
            /// It takes something off in at least this fraction of the blocks in which it acts. On 36 of the harder rigs
            /// true effects did so in 0.93 and more, three in 0.83 to 0.89; those that were put into measured records and
            /// took the share above in 0.80 and more, but for one in 0.75. What was fitted to a slip that is in no
            /// catalogue in 0.84, with less than that share in 0.91.
            blocks: 0.8,
            /// Beside the remainder as a process of its own, without it this many times as many squares stay. What was put
            /// into measured records and took the share above reached 1.25 and more, but for a saturation with 1.16 and a
            /// cogging with 0.99; of what was fitted to nothing in a catalogue the most was 1.24, of waves in a pendulum's
            /// remainder 1.06 to 1.62.
            beside: 1.2 over 1.0,
            /// That stands out of the scatter of the blocks by this many standard errors: 2.7 and more there.
            beside_sigmas: 2.5,
            /// Of several waves of a kind without a prominent one it takes this many times as many squares beside the
            /// remainder: waves in a pendulum's remainder reached 1.62, a line of a surgical tool's record, beside a slow
            /// wave as large, 6.1.
            sharp: 2.0 over 1.0,
            /// What takes as much beside the remainder, and stands out of the scatter of the blocks by this many standard
            /// errors, needs no share: a delay of 1.3 ms in a drive's record took 0.43 and stood 9 of them out. Of 104 sets
            /// that were fitted to nothing in a catalogue a drift reached it, where a zero jumped.
            sharp_sigmas: 4.0,
            /// It does so in at least this fraction of the blocks in which it acts. Not measured.
            sharp_blocks: 0.9,
            /// What leaves this many times as many squares without it, and more in nearly every block, needs no gain beside
            /// the remainder, whose prediction follows what is slow: the backlash of a friction damper took 2.3 to 2.7
            /// times. A softening that was fitted to a material that breaks in small steps took 1.85 times.
            everywhere_lead: 2.0 over 1.0,
            /// It takes something off in at least this fraction of the blocks in which it acts: that backlash in 0.95 and
            /// all of them. What was fitted to nothing in a catalogue and took half reached 0.93, but for drifts, where a
            /// zero jumped.
            everywhere: 0.95,
            /// Effects are named together if they explain this share of the base's excess, and no other effect could stand
            /// in the place of one. Not measured.
            together: 0.95 over 1.0,
            /// Several are if one of them has no evidence of its own: a friction made 97 % of an adhesion whose form is in
            /// no catalogue, a spectrum, an exponent and a bond 99 % of a cell's relaxation.
            together_unsound: 0.98 over 1.0,
            /// Of effects that are named together the best set without one leaves at least this many times as many squares:
            /// what fitted a fatigue of the material, 95 % of it, reached 1.13, the exponent of cells under a cantilever
            /// 1.17.
            needed: 1.15 over 1.0,
            /// Names that stand beside a remainder explain at least this share of the base's excess: 23 that were right on the
            /// harder rigs 0.6 and more; an offset that made up for a part of a bond beside four others 0.18 by itself.
            explains: 0.3,
            /// The halves of the log give it the same size within this many standard errors. On 36 of the harder rigs true
            /// effects that stand once differed by 2.6 at most.
            halves: 4.0,
            /// No effect stands out in whose place a sharp step of the zero leaves less than this many times as many
            /// squares. Not measured.
            rather_a_step: 0.8,
        }

        /// Whether effects are accepted.
        acceptance: Acceptance {
            /// An effect is idle if it takes less than this share off what is left, where much is left. Not measured.
            idle: 0.01,
            /// An effect may as well be 0 if its size is below so many standard errors: 1 of 810 that were right, 10 of 36 wrong.
            size_sigmas: 3.0,
            /// The same of what noise looks like. In 36 s of 1/f noise two waves of three and four periods were known to
            /// 4.0 and 5.1, and a ramp to 5.6; a cogging of 24 µm that stood for an offset to 3.7. Waves that were right: 12.
            wander_sigmas: 6.0,
            /// The same of a lateness: every edge tells it. Of 30 that were right the least was 10, 0.13 s of no use had 5.9.
            late_sigmas: 7.0,
            /// The same of what the held-out part misses by less than `missed`: of 480 harder rigs fifteen that were right had
            /// 44 and more, and two that stood for the form of another 3.4 and 3.6.
            hardly_missed_sigmas: 8.0,
            /// A friction of a richer form is certain if its size is known to this many standard errors, and may be
            /// Coulomb's otherwise: where bristles were hidden the stiffness of Bouc and Wen's loop, which is how it
            /// sticks, was known to 3 and 6.
            form_sigmas: 8.0,
            /// An effect is worth telling from another if it takes more than this share off what is held out. Not measured.
            missed: 0.1,
            /// An effect is dropped with which the held-out part is left this share more squares: it is none of what
            /// repeats. Of those that were right, and act outside the held-out windows, none was beyond 0.02.
            harm: 0.05,
            /// And one that is left no fewer there, where this share of what it does is. Derived: three fifths of the third
            /// that is held out.
            acts_there: 0.2,
            /// The bias of the motion's errors is taken off the numbers of a fit if that costs at most this
            /// share of Σ w r²; what costs more is no small correction. Not measured.
            correction_cost: 0.02,
        }

        /// Whether an effect could be another one as well.
        rivalry: Rivalry {
            /// Two fits are not discriminated if their Σ w r² differ by less than this many squared standard
            /// errors of independent samples. Not measured.
            margin: 12.0,
            /// A rival is refitted at the log's own rate if it leaves less than this many times the Σ w r² of
            /// the best at the search's resolution, since its distance may shrink: a compliance that follows in
            /// 2 ms, seen every 4 ms, was off by 14 %.
            followed: 1.20 over 1.0,
            /// Where a log moves at one speed each way, with fewer than four touches, drags and frictions that leave
            /// less than this many times the Σ w r² of each other are one: only a reversal tells them apart, and the
            /// errors of a form are seen there once. On three curves of cantilevers in liquid a drag left 4, 18 and
            /// 20 % more than the Coulomb friction that it is not; 1.5 is what evidence must lead by.
            at_one_speed: 1.5 over 1.0,
            /// A log does if this share of what is no rest is within 15 % of its way's median, and the noise of its
            /// speed. Of 19 such curves it was 0.91 and more without that noise but for three (0.74 to 0.86), of 48 of
            /// the harder rigs 0.87 and less but for one of 0.94.
            alike_speeds: 0.9,
            /// A rival is worse throughout the log if it is worse by this many standard errors. A delay of 4.5
            /// ms under a sine of 0.2 Hz was worse than a lag by 80, 0.7 standard errors.
            throughout_sigmas: 2.0,
            /// The richer form of an effect that suffices may be the right one if it takes more than this share off
            /// Σ w r². Of 20 of the harder rigs where Coulomb's friction, in any form, was explained to the noise a loop
            /// of Bouc and Wen's took 0.04 at most, a Stribeck friction 0.001; one that was hidden in another form, and
            /// that Coulomb's explained, took 0.12.
            richer: 0.05,
            /// Errors that make the force late do not reach this share of Σ w r²: it was 6.6 % and more for a
            /// lag that was one, mostly in the fastest of 48 stretches.
            late: 0.05,
            /// And this where they make it late by less than a period: how a force went between two samples is no
            /// part of a log. A lag of 0.3 periods left 0.13 more than a delay.
            late_within_a_period: 0.3,
            /// Where what a model left is allowed for, effects that leave less than this many times the Σ w r² of each
            /// other are one: that is no noise. In a foam's record an offset and a drift left 4 % less than the drag by
            /// direction that was put in, and what was another effect 25 % more.
            beside_remainder: 1.15 over 1.0,
        }

        /// Which regions and lines of a log are named.
        regions: Regions {
            /// This share of the regions that are named may be named wrongly, by Benjamini and Hochberg's
            /// procedure. Derived: one in a hundred.
            false_discoveries: 0.01,
            /// A region with fewer samples is not tested. Not measured.
            fewest_samples: 10.0,
            /// A region is named if it holds more than this share of the excess. Not measured.
            least_share: 0.02,
            /// A line is named if it holds more than this share of the residual's energy. Not measured.
            line_share: 0.1,
            /// A step of the zero is named if it takes more than this share off. Not measured.
            step_share: 0.5,
            /// A fitted stiffness that is this many times larger or smaller than the model's is in another
            /// unit. Not measured.
            another_unit: 100.0 over 1.0,
        }

        /// Whether a rig is another than when its model was identified.
        changes: Changes {
            /// A number has changed if it is off by more than this share of what it was: between two records of
            /// the EMPS drive the largest difference was 3.9 %.
            share: 0.05,
            /// And by more than this many standard errors of the difference; there it was 4.7.
            sigmas: 5.0,
        }

        /// Which motion is advised.
        advice: Advice {
            /// The log does not observe a number whose standard error is a larger share of it. Not measured.
            unobserved: 0.7,
            /// An advised motion brings a standard error below this share of what it was, and below
            /// `unobserved`. Not measured.
            better: 0.5,
            /// Between a lag and a delay, which lasting errors of a rig imitate, an advised motion promises
            /// this many times the standard deviations that count. Not measured.
            sure: 3.0 over 1.0,
            /// A motion that is this many times as fast as the log is said to be faster. Not measured.
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
