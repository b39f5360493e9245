//! What a rig can hide: an entry for each effect of the catalogue, wide enough for other forms of it.
//!
//! The catalogue's own form is the special case in which the field that is named in brackets is zero
//! or the list has one entry.

/// One hidden effect, with its parameters (SI).
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Effect {
    /// Relaxation modes: fraction, rate [one].
    Modes(Vec<(f64, f64)>),
    /// Elastic response Σ share·Kδ₀((δ+b)/δ₀)ⁿ in place of Kδ [one term, blunt 0].
    Curve { terms: Vec<(f64, f64)>, blunt: f64 },
    /// λ(δ/δ₀)^q, levelling off beyond a depth [levelling 0].
    DampingDepth { exponent: f64, levelling: f64 },
    /// Elastic × e^{bδ} [locking 0], or × (1−δ/δ_L)^{−1} with δ_L = 1/locking.
    Stiffening { rate: f64, locking: f64 },
    /// Mullins [energy 0]; else Ogden–Roxburgh: 1 − α erf((1−(δ/δ_max)^energy)·δ_max/d_s).
    Softening {
        fraction: f64,
        scale: f64,
        energy: f64,
    },
    /// k₂·max(δ−d₂, 0), rounded over a width [rounding 0].
    Layer {
        stiffness: f64,
        depth: f64,
        rounding: f64,
    },
    /// −F_a, `loading` of it on the way in [1], neck (1+δ/d_a)^shape [1].
    Adhesion {
        force: f64,
        neck: f64,
        loading: f64,
        shape: f64,
    },
    /// The surface recedes, at once [delay 0] or with a time constant.
    Set {
        fraction: f64,
        yield_depth: f64,
        delay: f64,
    },
    /// The surface moves, with a second harmonic [0].
    Surface {
        amplitude: f64,
        hz: f64,
        phase: f64,
        second: f64,
    },
    /// Force and yield displacement: Bouc–Wen, or several Jenkins elements.
    Hysteresis {
        elements: Vec<(f64, f64)>,
        jenkins: bool,
    },
    /// Friction in the guide.
    Friction(Friction),
    /// b·v + b₂·v|v| [b₂ 0].
    Drag { linear: f64, quadratic: f64 },
    /// c·|v|·(|v|/v₀)^(bend) [bend 0].
    AsymmetricDrag {
        coefficient: f64,
        bend: f64,
        speed: f64,
    },
    /// m·a; a share of the mass hangs on a spring [0].
    Inertia {
        mass: f64,
        loose: f64,
        hz: f64,
        damping: f64,
    },
    /// Constant, less a share that settles [0].
    Offset {
        force: f64,
        settling: f64,
        time: f64,
    },
    /// r·t [time 0], r·τ(1−e^{−t/τ}), or r·t_s·(t/t_s)^bend [bend 0: not used].
    Drift {
        rate: f64,
        time: f64,
        bend: f64,
        scale: f64,
    },
    /// k·x·(1 + hardening·(x/x₀)²) [0].
    Cable {
        stiffness: f64,
        hardening: f64,
        scale: f64,
    },
    /// A·sin(2πx/p+φ) with a second harmonic [0].
    Cogging {
        amplitude: f64,
        pitch: f64,
        phase: f64,
        second: f64,
    },
    /// A·sin(2πft+φ), with a second harmonic, and an amplitude that breathes [0, 0].
    Disturbance {
        amplitude: f64,
        hz: f64,
        phase: f64,
        second: f64,
        breathing: f64,
    },
    /// Spring between motor and tip, F = k·s·(1 + progressive·s/s₀) [0].
    Compliance {
        stiffness: f64,
        progressive: f64,
        scale: f64,
    },
    /// Play: widths and shares [one].
    Backlash { plays: Vec<(f64, f64)> },
    /// Low-pass of order one or two.
    Lag { time: f64, order: usize },
    /// Shift, with jitter (relative) [0].
    Delay { seconds: f64, jitter: f64 },
    /// F/(1+(F/F_max)^sharpness)^(1/sharpness); infinite sharpness is min(F, F_max).
    Saturation { limit: f64, sharpness: f64 },
    /// x_read = x + A·sin(2πx/p+φ), with a second harmonic [0].
    Encoder {
        amplitude: f64,
        pitch: f64,
        phase: f64,
        second: f64,
    },
}

/// Friction of every form: steady force g(v) = F_c + (F_s−F_c)·k(v/v_s), and how it gets there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Friction {
    pub(crate) kinetic: f64,
    pub(crate) stat: f64,
    /// v_s (m/s).
    pub(crate) speed: f64,
    /// k = 1/(1+u²) in place of e^{−u²}.
    pub(crate) lorentz: bool,
    /// Bristles bend this far before they slide (m): Dahl, with Stribeck LuGre.
    pub(crate) width: f64,
    /// tanh(v/smooth) in place of sgn v (m/s).
    pub(crate) smooth: f64,
}

impl Friction {
    /// F_c·sgn(v).
    pub(crate) fn coulomb(force: f64) -> Self {
        Friction {
            kinetic: force,
            stat: force,
            speed: 1e-3,
            lorentz: false,
            width: 0.0,
            smooth: 0.0,
        }
    }

    /// The same friction if it did not fall with the speed.
    pub(crate) fn level(&self) -> Self {
        Friction {
            stat: self.kinetic,
            ..*self
        }
    }

    /// g(v) (N).
    pub(crate) fn steady(&self, v: f64) -> f64 {
        let u = v / self.speed;
        let kernel = if self.lorentz {
            1.0 / (1.0 + u * u)
        } else {
            (-u * u).exp()
        };
        self.kinetic + (self.stat - self.kinetic) * kernel
    }
}

/// A wave with its second harmonic, which is a third of a turn ahead.
pub(crate) fn wave(angle: f64, second: f64) -> f64 {
    if second == 0.0 {
        angle.sin()
    } else {
        angle.sin() + second * (2.0 * angle + 2.1).sin()
    }
}

/// d/d(angle) of [`wave`].
pub(crate) fn wave_slope(angle: f64, second: f64) -> f64 {
    angle.cos() + 2.0 * second * (2.0 * angle + 2.1).cos()
}

/// Kinds of misfit that are in no catalogue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stranger {
    /// Oscillation whose strength and frequency follow the speed.
    Chatter,
    /// The force gain wanders.
    GainWalk,
    /// Every touch meets another stiffness.
    TouchStiffness,
    /// A lateral motion of what is touched, which nobody records, leaks into the force.
    Crosstalk,
    /// Zero wanders up and down with the temperature.
    ThermalWalk,
    /// The guide sticks over a random way, and slips.
    StickSlip,
    /// Every impact rings.
    Ringing,
    /// The converter's nonlinearity is periodic in the force.
    ConverterWaves,
    /// The zero jumps at every touch.
    ZeroJumps,
    /// Electrical spikes.
    Spikes,
    /// The material breaks in steps on its first way in.
    Crackle,
    /// Contact damping with the square of the speed.
    SquareDamping,
    /// The cable of the load cell drops out.
    Dropouts,
}

impl Stranger {
    pub(crate) const ALL: [Stranger; 13] = [
        Stranger::Chatter,
        Stranger::GainWalk,
        Stranger::TouchStiffness,
        Stranger::Crosstalk,
        Stranger::ThermalWalk,
        Stranger::StickSlip,
        Stranger::Ringing,
        Stranger::ConverterWaves,
        Stranger::ZeroJumps,
        Stranger::Spikes,
        Stranger::Crackle,
        Stranger::SquareDamping,
        Stranger::Dropouts,
    ];

    /// As truth.json calls it.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Stranger::Chatter => "chatter",
            Stranger::GainWalk => "gain_walk",
            Stranger::TouchStiffness => "touch_stiffness",
            Stranger::Crosstalk => "crosstalk",
            Stranger::ThermalWalk => "thermal_walk",
            Stranger::StickSlip => "stick_slip",
            Stranger::Ringing => "ringing",
            Stranger::ConverterWaves => "converter_waves",
            Stranger::ZeroJumps => "zero_jumps",
            Stranger::Spikes => "spikes",
            Stranger::Crackle => "crackle",
            Stranger::SquareDamping => "square_damping",
            Stranger::Dropouts => "dropouts",
        }
    }
}
