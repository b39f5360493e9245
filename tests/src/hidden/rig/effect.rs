//! What a rig can hide: an entry for each effect of the catalogue, wide enough for other forms of it.
//!
//! The catalogue's form is the special case that stands in brackets: the field has that value, or the list
//! has one entry.

/// A hidden effect with its parameters (SI).
#[allow(missing_docs, reason = "the formula of an effect names its fields")]
#[derive(Clone, Debug)]
pub enum Effect {
    /// Relaxation modes: fraction, rate ν; [one].
    Modes(Vec<(f64, f64)>),
    /// The elastic response Σ share·Kδ₀((δ+b)/δ₀)ⁿ in place of Kδ, with (share, n) in `terms` and b = `blunt`
    /// [one term, blunt 0].
    Curve { terms: Vec<(f64, f64)>, blunt: f64 },
    /// λ(δ/δ₀)^q with q = `exponent`, levelling off beyond a depth [levelling 0].
    DampingDepth { exponent: f64, levelling: f64 },
    /// The elastic response times e^{rate·δ} [locking 0], or divided by 1 − locking·δ.
    Stiffening { rate: f64, locking: f64 },
    /// The Mullins effect [energy 0], or Ogden and Roxburgh's: 1 − fraction·erf((1−(δ/δ_max)^energy)·δ_max/scale).
    Softening {
        fraction: f64,
        scale: f64,
        energy: f64,
    },
    /// stiffness·max(δ − depth, 0), rounded over a width [rounding 0].
    Layer {
        stiffness: f64,
        depth: f64,
        rounding: f64,
    },
    /// −force, a share of it on the way in [loading 1], and a neck (1 + δ/neck)^shape [shape 1].
    Adhesion {
        force: f64,
        neck: f64,
        loading: f64,
        shape: f64,
    },
    /// The surface recedes, at once [delay 0] or with a time constant (s).
    Set {
        fraction: f64,
        yield_depth: f64,
        delay: f64,
    },
    /// The surface moves as a sine with a second harmonic [second 0].
    Surface {
        amplitude: f64,
        hz: f64,
        phase: f64,
        second: f64,
    },
    /// Elements with a force and a yield displacement: Bouc–Wen [one element, jenkins false], or several
    /// Jenkins elements.
    Hysteresis {
        elements: Vec<(f64, f64)>,
        jenkins: bool,
    },
    /// Friction in the guide.
    Friction(Friction),
    /// linear·v + quadratic·v|v| [quadratic 0].
    Drag { linear: f64, quadratic: f64 },
    /// coefficient·|v|·(|v|/speed)^bend [bend 0].
    AsymmetricDrag {
        coefficient: f64,
        bend: f64,
        speed: f64,
    },
    /// mass·a; a share of the mass hangs on a spring [loose 0].
    Inertia {
        mass: f64,
        loose: f64,
        hz: f64,
        damping: f64,
    },
    /// A constant less a share that settles [settling 0].
    Offset {
        force: f64,
        settling: f64,
        time: f64,
    },
    /// rate·t [time 0, bend 0], rate·time·(1−e^{−t/time}) [bend 0], or rate·scale·(t/scale)^bend.
    Drift {
        rate: f64,
        time: f64,
        bend: f64,
        scale: f64,
    },
    /// stiffness·x·(1 + hardening·(x/scale)²) [hardening 0].
    Cable {
        stiffness: f64,
        hardening: f64,
        scale: f64,
    },
    /// amplitude·sin(2πx/pitch + phase) with a second harmonic [second 0].
    Cogging {
        amplitude: f64,
        pitch: f64,
        phase: f64,
        second: f64,
    },
    /// amplitude·sin(2πt·hz + phase) with a second harmonic and an amplitude that breathes [second 0,
    /// breathing 0].
    Disturbance {
        amplitude: f64,
        hz: f64,
        phase: f64,
        second: f64,
        breathing: f64,
    },
    /// A spring between motor and tip, F = stiffness·s·(1 + progressive·s/scale) [progressive 0].
    Compliance {
        stiffness: f64,
        progressive: f64,
        scale: f64,
    },
    /// Plays with their widths (m) and shares [one].
    Backlash { plays: Vec<(f64, f64)> },
    /// A low-pass of order one or two [order 1].
    Lag { time: f64, order: usize },
    /// A delay with relative jitter [jitter 0].
    Delay { seconds: f64, jitter: f64 },
    /// F/(1 + (F/limit)^sharpness)^(1/sharpness); infinite sharpness is min(F, limit) [sharpness ∞].
    Saturation { limit: f64, sharpness: f64 },
    /// A force in the load path that is a formula of time, position and speed: of any effect that needs no
    /// more, with its parameters.
    Load { formula: Formula, params: Vec<f64> },
    /// Elements with a force and the way (m) after which they slip, in the load path.
    Iwan { elements: Vec<(f64, f64)> },
    /// −force in contact, and −force/(1 + gap/range)² before it and after it.
    Attraction { force: f64, range: f64 },
    /// A load cell that resonates.
    Resonance { hz: f64, damping: f64 },
    /// A play in front of the cable with flanks of different widths (m) and shares [one]; between them there is no
    /// force.
    Flanks(Vec<(f64, f64)>),
    /// stiffness·z after Bouc and Wen, in steps along the way; beside it a share of the force is in a loop that
    /// yields ten times as soon [inner 0].
    Loop {
        stiffness: f64,
        beta: f64,
        gamma: f64,
        exponent: f64,
        inner: f64,
    },
    /// coefficient·(1 + rises·e^{−(v/speed)²})·|contact + cable|·tanh(v/smooth) [rises 0].
    LoadFriction {
        coefficient: f64,
        smooth: f64,
        rises: f64,
        speed: f64,
    },
    /// The elastic force times 1 + fraction·(1 + parts·(δ − half the depth))·tanh(δ̇/smooth); with `lasting` (m) the change
    /// takes that way and stays in a hold [parts 0, lasting 0].
    Curves {
        fraction: f64,
        smooth: f64,
        lasting: f64,
        parts: f64,
    },
    /// A step of −force about a depth, tanh(·/width), beyond the depth wider by a share [skewed 0].
    Snap {
        force: f64,
        depth: f64,
        width: f64,
        skewed: f64,
    },
    /// x_read = x + amplitude·sin(2πx/pitch + phase) with a second harmonic [second 0].
    Encoder {
        amplitude: f64,
        pitch: f64,
        phase: f64,
        second: f64,
    },
}

impl Effect {
    /// A cable of this stiffness (N/m), as straight as the catalogue's.
    pub(crate) fn cable(stiffness: f64) -> Effect {
        Effect::Cable {
            stiffness,
            hardening: 0.0,
            scale: 1.0,
        }
    }
}

/// A force (N) from the parameters of an effect, the time (s), the position (m) and the speed (m/s).
#[derive(Clone, Copy, Debug)]
pub struct Formula(pub(crate) fn(&[f64], f64, f64, f64) -> f64);

/// Friction in every form: the steady force g(v) = F_c + (F_s−F_c)·k(v/v_s), and the way to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction {
    /// F_c (N).
    pub(crate) kinetic: f64,
    /// F_s (N).
    pub(crate) stat: f64,
    /// v_s (m/s).
    pub(crate) speed: f64,
    /// Whether k = 1/(1+u²) in place of e^{−u²}.
    pub(crate) lorentz: bool,
    /// How far bristles bend before they slide (m), as in Dahl's model, and with F_s > F_c in LuGre.
    pub(crate) width: f64,
    /// The speed (m/s) of the transition tanh(v/smooth) in place of sgn v; 0 for sgn v.
    pub(crate) smooth: f64,
}

impl Friction {
    /// F_c·sgn(v).
    pub fn coulomb(force: f64) -> Self {
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

/// A sine with its second harmonic, which is a third of a turn ahead.
pub(crate) fn wave(angle: f64, second: f64) -> f64 {
    if second == 0.0 {
        angle.sin()
    } else {
        angle.sin() + second * (2.0 * angle + 2.1).sin()
    }
}

/// The derivative of [`wave`] by its angle.
pub(crate) fn wave_slope(angle: f64, second: f64) -> f64 {
    angle.cos() + 2.0 * second * (2.0 * angle + 2.1).cos()
}

/// A misfit that is in no catalogue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stranger {
    /// An oscillation follows the speed with its strength and frequency.
    Chatter,
    /// The force gain wanders.
    GainWalk,
    /// Every touch meets another stiffness.
    TouchStiffness,
    /// A lateral motion of the specimen, which is not recorded, leaks into the force.
    Crosstalk,
    /// The zero wanders with the temperature.
    ThermalWalk,
    /// The guide sticks over a random distance, then slips.
    StickSlip,
    /// Every impact rings.
    Ringing,
    /// The converter's nonlinearity is periodic in the force.
    ConverterWaves,
    /// The zero jumps at every touch.
    ZeroJumps,
    /// There are electrical spikes.
    Spikes,
    /// The material breaks in steps on its first way in.
    Crackle,
    /// The contact damps with the square of the speed.
    SquareDamping,
    /// The cable of the load cell drops out.
    Dropouts,
    /// A disturbance sweeps through its band again and again, at rest as well.
    Chirps,
    /// The zero is loud now and then, at rest as well.
    Bursts,
    /// The zero jumps between two levels.
    Telegraph,
    /// After some touches another material is there.
    Swap,
    /// Every touch leaves the material softer.
    Fatigue,
    /// A hand pushes now and then.
    HandBumps,
}

impl Stranger {
    /// Every misfit.
    pub(crate) const ALL: [Stranger; 19] = [
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
        Stranger::Chirps,
        Stranger::Bursts,
        Stranger::Telegraph,
        Stranger::Swap,
        Stranger::Fatigue,
        Stranger::HandBumps,
    ];

    /// The name in truth.json.
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
            Stranger::Chirps => "chirps",
            Stranger::Bursts => "bursts",
            Stranger::Telegraph => "telegraph",
            Stranger::Swap => "swap",
            Stranger::Fatigue => "fatigue",
            Stranger::HandBumps => "hand_bumps",
        }
    }
}
