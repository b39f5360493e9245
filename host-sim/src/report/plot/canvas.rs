//! A plotters backend that writes roles instead of colours, so that one style sheet decides how a
//! grid line or the measured force looks on a light screen, on a dark one and on paper.
//!
//! The SVG backend of plotters writes fixed colours and whole pixels. In this one the unit is a tenth of a
//! pixel, paths are relative, which halves their bytes, and the curves are clipped to the plot.

use std::convert::Infallible;
use std::fmt::Write;

use plotters::style::RGBColor;
use plotters_backend::text_anchor::{HPos, VPos};
use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingBackend, DrawingErrorKind,
    FontTransform,
};

use super::ink::{Ink, StripTone, Stroke};
use crate::report::html::escape;

/// The number of units of the canvas in a pixel.
pub(crate) const PX: i32 = 10;

/// What an element of the canvas is. The style sheet decides how it looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Role(u8);

/// The classes of the roles, by number.
const CLASSES: [&str; 18] = [
    "grid",
    "minor",
    "axis",
    "tick",
    "name",
    "empty",
    "touch",
    "edge",
    "event",
    "event major",
    "event-label",
    "event-label major",
    "strip-label",
    "strip good",
    "strip warning",
    "strip bad",
    "strip neutral",
    "strip info",
];
/// The classes of the roles that belong to an ink, by number; the first four are strokes.
const INK_CLASSES: [&str; 6] = [
    "line",
    "line dashed",
    "dots",
    "line thin",
    "band",
    "envelope",
];
/// The number of the first role of the first ink.
const FIRST_INK: u8 = 32;

impl Role {
    pub(crate) const GRID: Role = Role(0);
    pub(crate) const MINOR: Role = Role(1);
    pub(crate) const AXIS: Role = Role(2);
    pub(crate) const TICK: Role = Role(3);
    pub(crate) const NAME: Role = Role(4);
    pub(crate) const EMPTY: Role = Role(5);
    pub(crate) const TOUCH: Role = Role(6);
    pub(crate) const EDGE: Role = Role(7);
    pub(crate) const STRIP_LABEL: Role = Role(12);

    pub(crate) fn event(major: bool) -> Role {
        Role(8 + u8::from(major))
    }

    pub(crate) fn event_label(major: bool) -> Role {
        Role(10 + u8::from(major))
    }

    pub(crate) fn strip(tone: StripTone) -> Role {
        Role(13 + tone as u8)
    }

    pub(crate) fn line(ink: Ink, stroke: Stroke) -> Role {
        Role(FIRST_INK + INK_CLASSES.len() as u8 * ink as u8 + stroke as u8)
    }

    pub(crate) fn band(ink: Ink) -> Role {
        Role(FIRST_INK + INK_CLASSES.len() as u8 * ink as u8 + 4)
    }

    pub(crate) fn envelope(ink: Ink) -> Role {
        Role(FIRST_INK + INK_CLASSES.len() as u8 * ink as u8 + 5)
    }

    /// The role as plotters carries it.
    pub(crate) fn color(self) -> RGBColor {
        RGBColor(self.0, 0, 0)
    }

    /// The role as plotters carries it, with a number: of the series that a curve belongs to, or the place of a
    /// label on the x axis in units of the canvas. The script of the page reads it off the element.
    pub(crate) fn numbered(self, number: usize) -> RGBColor {
        let [.., high, low] = number.to_be_bytes();
        RGBColor(self.0, high, low)
    }

    fn of(color: BackendColor) -> Role {
        Role(color.rgb.0)
    }

    /// The number that [`Role::numbered`] has put into a colour; 0 without one.
    fn number(color: BackendColor) -> u16 {
        u16::from_be_bytes([color.rgb.1, color.rgb.2])
    }

    /// The class attribute in the SVG and in the legend.
    pub(crate) fn class(self) -> String {
        match self.of_ink() {
            None => CLASSES.get(self.0 as usize).copied().unwrap_or("").into(),
            Some((ink, kind)) => format!("{} {}", INK_CLASSES[kind], Ink::CLASSES[ink]),
        }
    }

    /// The numbers of the ink and of the kind of element that is drawn in it.
    fn of_ink(self) -> Option<(usize, usize)> {
        let number = usize::from(self.0.checked_sub(FIRST_INK)?);
        Some((number / INK_CLASSES.len(), number % INK_CLASSES.len()))
    }

    fn is_dots(self) -> bool {
        self.of_ink()
            .is_some_and(|(_, kind)| kind == Stroke::Dots as usize)
    }
}

/// The layers of what has been drawn, from the back to the front. Only the data is clipped to the plot.
#[derive(Debug, Default)]
pub(crate) struct Layers {
    pub(crate) back: String,
    pub(crate) frame: String,
    pub(crate) data: String,
}

/// The backend, which draws into [`Layers`].
pub(crate) struct Canvas<'a> {
    layers: &'a mut Layers,
    size: (u32, u32),
}

type Drawn = Result<(), DrawingErrorKind<Infallible>>;

impl<'a> Canvas<'a> {
    /// A canvas of this size in units.
    pub(crate) fn new(layers: &'a mut Layers, size: (u32, u32)) -> Self {
        Canvas { layers, size }
    }

    fn layer(&mut self, role: Role) -> &mut String {
        match role {
            Role::TOUCH => &mut self.layers.back,
            _ if role == Role::event(false) || role == Role::event(true) => &mut self.layers.back,
            _ if role.of_ink().is_some() || role == Role::EDGE => &mut self.layers.data,
            _ => &mut self.layers.frame,
        }
    }

    fn path(
        &mut self,
        points: impl IntoIterator<Item = BackendCoord>,
        color: BackendColor,
        end: &str,
    ) {
        let role = Role::of(color);
        let out = self.layer(role);
        let start = out.len();
        let _ = write!(out, "<path class=\"{}\"", role.class());
        let _ = match Role::number(color) {
            0 => write!(out, " d=\""),
            series => write!(out, " data-s=\"{series}\" d=\""),
        };
        let mut previous = None;
        for (x, y) in points {
            let _ = match previous {
                None => write!(out, "M{x} {y}"),
                Some((px, py)) => write!(out, "{}{}", Step(x - px), Step(y - py)),
            };
            if previous.is_none() {
                out.push_str(if role.is_dots() { "h0m" } else { "l0 0" });
            } else if role.is_dots() {
                out.push_str("h0m");
            }
            previous = Some((x, y));
        }
        if previous.is_none() {
            out.truncate(start);
            return;
        }
        if role.is_dots() {
            out.truncate(out.len() - 1);
        }
        let _ = writeln!(out, "{end}\"/>");
    }
}

/// Appends a number to the list of a path. A minus sign separates numbers as well as a space does.
struct Step(i32);

impl std::fmt::Display for Step {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.0 >= 0 {
            f.write_char(' ')?;
        }
        write!(f, "{}", self.0)
    }
}

impl DrawingBackend for Canvas<'_> {
    type ErrorType = Infallible;

    fn get_size(&self) -> (u32, u32) {
        self.size
    }

    fn ensure_prepared(&mut self) -> Drawn {
        Ok(())
    }

    fn present(&mut self) -> Drawn {
        Ok(())
    }

    fn draw_pixel(&mut self, point: BackendCoord, color: BackendColor) -> Drawn {
        self.path([point], color, "");
        Ok(())
    }

    fn draw_line<S: BackendStyle>(
        &mut self,
        from: BackendCoord,
        to: BackendCoord,
        style: &S,
    ) -> Drawn {
        self.path([from, to], style.color(), "");
        Ok(())
    }

    fn draw_rect<S: BackendStyle>(
        &mut self,
        a: BackendCoord,
        b: BackendCoord,
        style: &S,
        _fill: bool,
    ) -> Drawn {
        let role = Role::of(style.color());
        let _ = writeln!(
            self.layer(role),
            "<rect class=\"{}\" x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/>",
            role.class(),
            a.0.min(b.0),
            a.1.min(b.1),
            (b.0 - a.0).abs(),
            (b.1 - a.1).abs(),
        );
        Ok(())
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        path: I,
        style: &S,
    ) -> Drawn {
        self.path(path, style.color(), "");
        Ok(())
    }

    fn fill_polygon<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        path: I,
        style: &S,
    ) -> Drawn {
        self.path(path, style.color(), "Z");
        Ok(())
    }

    fn draw_text<S: BackendTextStyle>(
        &mut self,
        text: &str,
        style: &S,
        (x, y): BackendCoord,
    ) -> Drawn {
        let role = Role::of(style.color());
        let anchor = match style.anchor().h_pos {
            HPos::Left => "start",
            HPos::Right => "end",
            HPos::Center => "middle",
        };
        let dy = match style.anchor().v_pos {
            VPos::Top => "0.76em",
            VPos::Center => "0.36em",
            VPos::Bottom => "-0.2em",
        };
        let turn = match style.transform() {
            FontTransform::None => String::new(),
            FontTransform::Rotate90 => format!(" transform=\"rotate(90 {x} {y})\""),
            FontTransform::Rotate180 => format!(" transform=\"rotate(180 {x} {y})\""),
            FontTransform::Rotate270 => format!(" transform=\"rotate(-90 {x} {y})\""),
        };
        let at = match Role::number(style.color()) {
            0 => String::new(),
            at => format!(" data-x=\"{at}\""),
        };
        let _ = writeln!(
            self.layer(role),
            "<text class=\"{}\"{at} x=\"{x}\" y=\"{y}\" dy=\"{dy}\" text-anchor=\"{anchor}\"{turn}>{}</text>",
            role.class(),
            escape(text),
        );
        Ok(())
    }
}
