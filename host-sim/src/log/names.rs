//! The names that machines give to time, position and force, in English, German, French and Spanish.

use super::channel::Channel;

/// How well a name fits, the best first. Two columns that fit equally well are a question.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Fit {
    /// What the tip or the test does: `Indentation depth`, `Standardweg`, `Prüfkraft`, `Test time`.
    Specific,
    /// `Extension`, `Kraft`, `Time`.
    General,
    /// What the machine's drive does, or a part of the test: `Crosshead`, `Segment time`.
    Secondary,
    /// A letter: `x`, `Fz`, `t`.
    Letter,
    /// Only the unit fits.
    UnitOnly,
}

/// The words of one channel. Words of four letters and more, and `weg`, may stand inside others (as in
/// `Traversenweg`); shorter ones are whole words.
pub(super) struct Words {
    specific: &'static [&'static str],
    general: &'static [&'static str],
    secondary: &'static [&'static str],
    letters: &'static [&'static str],
}

#[rustfmt::skip]
pub(super) const TIME: Words = Words {
    specific: &[
        "test time", "testtime", "prüfzeit", "pruefzeit", "testzeit", "total time", "elapsed", "run time",
        "running time", "laufzeit", "temps d'essai", "tiempo de ensayo", "series time", "seriestime",
    ],
    general: &[
        "time", "zeit", "temps", "tiempo", "stamp", "epoch", "horodatage", "fecha", "datum", "date", "clock",
        "millis", "micros", "seconds", "sekunden", "secondes", "segundos",
    ],
    secondary: &[
        "cycle time", "segment time", "step time", "schrittzeit", "segmentzeit", "local time", "relative time",
    ],
    letters: &[
        "t", "sec", "secs", "s", "ms", "us", "ns",
    ],
};

#[rustfmt::skip]
pub(super) const POSITION: Words = Words {
    specific: &[
        "indentation", "indent", "penetration", "pénétration", "penetración", "eindring", "depth", "tiefe",
        "profondeur", "enfoncement", "profundidad", "standardweg", "stempelweg", "prüfweg", "pruefweg",
        "compressive extension", "compressive displacement", "compressive strain extension", "compression",
        "measuredheight", "measured height", "stauchung",
    ],
    general: &[
        "extension", "displacement", "position", "travel", "weg", "verschiebung", "verformung", "déplacement",
        "deplacement", "allongement", "desplazamiento", "posición", "posicion", "recorrido", "extensión",
        "height", "höhe", "hoehe", "hauteur", "altura", "separation", "deformation", "déformation", "disp",
        "pos", "elongation", "path", "distance", "distancia", "abstand", "gap", "spalt", "winkel", "angle",
        "ángulo", "angulo", "theta", "rotation", "twist", "extensometer", "extensómetro", "extensomètre",
    ],
    secondary: &[
        "crosshead", "traverse", "stroke", "kolben", "actuator", "piezo", "course", "carrera", "motor", "lvdt",
        "ramp",
    ],
    letters: &[
        "x", "z", "y", "h", "d", "s", "q", "dz", "zpos", "xpos",
    ],
};

#[rustfmt::skip]
pub(super) const FORCE: Words = Words {
    specific: &[
        "standardkraft", "prüfkraft", "pruefkraft", "compressive load", "compressive force", "normal force",
        "normalkraft", "contact force", "indentation force", "indentation load", "druckkraft", "force normale",
        "fuerza normal",
    ],
    general: &[
        "force", "load", "kraft", "fuerza", "carga", "charge", "effort", "last", "weight", "gewicht",
        "kraftmessdose", "wägezelle", "vdeflection", "thrust", "drehmoment", "torque", "moment", "couple",
        "momento", "par", "fz", "fn", "defl", "deflection",
    ],
    secondary: &[
        "axial", "cell",
    ],
    letters: &[
        "f", "fx", "fy", "p", "n", "m", "tau",
    ],
};

/// Columns that hold something else, or what was asked for instead of what was measured.
#[rustfmt::skip]
const OTHERS: &[&str] = &[
    "velocity", "speed", "acc", "geschwindigkeit", "vitesse", "velocidad", "accel", "beschleunigung",
    "stress", "spannung", "strain", "dehnung", "deformación unitaria", "temperature", "temperatur",
    "température", "temperatura", "temp", "setpoint", "set", "soll", "sollweg", "sollkraft", "target",
    "command", "cmd", "desired", "ref", "reference", "consigne", "consigna", "rate", "voltage", "current",
    "strom", "energy", "energie", "arbeit", "work", "error", "fehler", "std", "stiffness", "steifigkeit",
    "power", "count", "cycles", "pressure", "druck",
];

/// Whether a name says that a column holds something else.
pub(super) fn is_other(name: &str) -> bool {
    let name = Name::new(name);
    OTHERS.iter().any(|word| name.has_word(word))
}

impl Words {
    /// How well a name fits; `None` if it does not.
    pub(super) fn fit(&self, name: &str) -> Option<Fit> {
        if is_other(name) {
            return None;
        }
        let name = Name::new(name);
        let classes = [
            (self.secondary, Fit::Secondary),
            (self.specific, Fit::Specific),
            (self.general, Fit::General),
        ];
        let hit = classes
            .into_iter()
            .find(|(words, _)| words.iter().any(|word| name.has(word)));
        let letter = || {
            let whole = self.letters.iter().any(|letter| name.first_is(letter));
            whole.then_some(Fit::Letter)
        };
        hit.map(|(_, fit)| fit).or_else(letter)
    }
}

/// Whether a column holds how far a cantilever bends.
pub(super) fn is_deflection(name: &str) -> bool {
    let name = Name::new(name);
    name.has("deflection") || name.has_word("defl")
}

/// Whether a column holds a position by the sample's height (a strain) or a force by its area (a stress).
pub(super) fn is_relative(channel: Channel, name: &str) -> bool {
    let words: &[&str] = match channel {
        Channel::Time => &[],
        Channel::Position => &["strain", "dehnung", "déformation", "deformación"],
        Channel::Force => &["stress", "spannung", "contrainte", "esfuerzo", "tensión"],
    };
    let name = Name::new(name);
    words.iter().any(|word| name.has(word))
}

/// Names of columns whose changes separate the parts of one touch,
#[rustfmt::skip]
const SEGMENTS: &[&str] = &[
    "segment", "segmentindex", "phase", "step", "schritt", "étape", "etape", "fase", "abschnitt", "paso",
];
/// and recordings of their own.
#[rustfmt::skip]
const TRACES: &[&str] = &[
    "trace", "curve", "kurve", "courbe", "curva", "run", "specimen", "probe", "éprouvette", "probeta",
    "trial", "versuch", "essai", "ensayo", "repeat", "recording", "indent", "sample", "test",
];

/// Whether a column of this name separates the parts of one touch.
pub(super) fn is_segment(name: &str) -> bool {
    let name = Name::new(name);
    SEGMENTS.iter().any(|word| name.has_word(word))
}

/// Whether a column of this name separates recordings.
pub(super) fn is_trace(name: &str) -> bool {
    let name = Name::new(name);
    TRACES.iter().any(|word| name.has_word(word))
}

/// A name in small letters with its words apart.
struct Name {
    text: String,
}

impl Name {
    fn new(name: &str) -> Name {
        let mut text = String::from(" ");
        let mut before = ' ';
        for c in name.chars() {
            if c.is_uppercase() && before.is_lowercase() {
                text.push(' ');
            }
            match c.is_alphanumeric() || c == '\'' {
                true => text.extend(c.to_lowercase()),
                false if !text.ends_with(' ') => text.push(' '),
                false => {}
            }
            before = c;
        }
        if !text.ends_with(' ') {
            text.push(' ');
        }
        Name { text }
    }

    fn has(&self, word: &str) -> bool {
        match word.chars().count() >= 4 || word == "weg" {
            // `measuredHeight` is `measured height` here: words that are written together fit as well.
            true => self.text.contains(word) || self.text.replace(' ', "").contains(word),
            false => self.has_word(word),
        }
    }

    fn has_word(&self, word: &str) -> bool {
        self.text.contains(&format!(" {word} "))
    }

    /// Whether the first word is this one, or it followed by digits.
    fn first_is(&self, word: &str) -> bool {
        let first = self.text.split_whitespace().next().unwrap_or_default();
        first.trim_end_matches(|c: char| c.is_ascii_digit()) == word
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_four_languages_are_understood() {
        for name in [
            "Time",
            "Prüfzeit",
            "Temps",
            "Tiempo",
            "Elapsed Time",
            "timestamp",
            "t",
        ] {
            assert!(TIME.fit(name).is_some(), "{name}");
        }
        for name in [
            "Extension",
            "Standardweg",
            "Traversenweg",
            "Déplacement",
            "Desplazamiento",
            "Crosshead",
            "Indentation Depth",
            "measuredHeight",
            "Position(Linear:Position)",
            "z",
        ] {
            assert!(POSITION.fit(name).is_some(), "{name}");
        }
        for name in [
            "Load",
            "Standardkraft",
            "Prüfkraft",
            "Force",
            "Fuerza",
            "Carga",
            "Effort",
            "Fz",
            "vDeflection",
        ] {
            assert!(FORCE.fit(name).is_some(), "{name}");
        }
    }

    #[test]
    fn what_was_asked_for_and_what_is_derived_is_no_channel() {
        for name in [
            "Force setpoint",
            "Sollweg",
            "Extension rate",
            "x_ref",
            "Load error",
        ] {
            assert_eq!(FORCE.fit(name).or(POSITION.fit(name)), None, "{name}");
        }
    }

    #[test]
    fn the_drive_fits_less_well_than_the_tip() {
        assert!(POSITION.fit("Standardweg") < POSITION.fit("Extension"));
        assert!(POSITION.fit("Extension") < POSITION.fit("Crosshead"));
        assert!(TIME.fit("Time") < TIME.fit("Segment time"));
    }

    #[test]
    fn parts_and_recordings_are_told_apart() {
        assert!(is_segment("Segment") && is_segment("phase") && !is_segment("curve"));
        assert!(is_trace("Curve") && is_trace("Specimen no.") && !is_trace("Step"));
    }
}
