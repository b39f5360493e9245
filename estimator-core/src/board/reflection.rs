//! Impedance reflection: what crosses the teleoperation channel, and its local rendering.
//!
//! An estimator at the slave identifies the environment; its parameters cross the channel as a
//! [`Packet`], and a [`Renderer`] at the master turns them into a force at the master's own position
//! and speed. A delay of the channel then delays what is known of the material, and not the force
//! itself, which is what makes direct force reflection lose fidelity and stability. Symmetrically an
//! estimator at the master identifies the operator.
//!
//! Neither side commands a motion: the renderer puts out a force that pushes the operator back.

mod impedance;
mod output;
mod packet;
mod render;
mod render_params;
mod renderable;
mod rendered;
mod speed;

pub use impedance::{Impedance, Reflected};
pub use output::Output;
pub use packet::Packet;
pub use render::Renderer;
pub use render_params::{RenderConfig, RenderParams};
pub use renderable::{NotRenderable, PACKET_SLOTS};
pub use rendered::{Limit, Rendered};
pub use speed::{SPEED_TIME_S, Speed};

#[cfg(test)]
mod tests;
