//! The drawing area of plotters with the canvas and the scales of this room.

use std::convert::Infallible;

use plotters::chart::ChartContext;
use plotters::coord::Shift;
use plotters::coord::cartesian::Cartesian2d;
use plotters::drawing::{DrawingArea, DrawingAreaErrorKind};

use super::{axis::Scale, canvas::Canvas};

pub(super) type Error = DrawingAreaErrorKind<Infallible>;
pub(super) type Root<'c> = DrawingArea<Canvas<'c>, Shift>;
pub(super) type Plot<'a, 'c> = ChartContext<'a, Canvas<'c>, Cartesian2d<Scale, Scale>>;
