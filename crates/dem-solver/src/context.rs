//! What all force loops need beside bodies and lists.

#![expect(
    clippy::inline_always,
    reason = "the hot loops are vectorised only when inlined"
)]

use crate::interaction::Interaction;
use crate::periodic::Period;
use crate::settings::Settings;
use crate::spheres::sphere::Sphere;
use crate::template::{CELLS, Template};
use crate::window::Window;

/// Distances of the sphere lists.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Cutoffs {
    /// Gap up to which spheres are listed, at least twice the safety, m.
    pub(crate) skin: f32,
    /// Longest gap at which a contact that was made lives on, m.
    pub(crate) reach: f32,
    /// Bound of the rounding of a gap in single precision, m.
    pub(crate) safety: f32,
}

impl Cutoffs {
    /// Distances for bodies of a largest bounding radius (m) and contacts that live on up to a gap
    /// `reach` (m).
    ///
    /// A gap is the difference of coordinates below twice the radius plus the margin. Each comes
    /// from about ten roundings of 6e-8 of that size, some of them in three components. The
    /// stored centres of the two spheres are rounded to cells of a 32767th of the radius.
    #[expect(clippy::cast_possible_truncation, reason = "the skin may be anything")]
    pub(crate) fn new(largest_radius: f64, reach: f64, settings: &Settings) -> Self {
        let cells = 3.0_f64.sqrt() * largest_radius / CELLS;
        let safety = 2e-6 * (2.0 * largest_radius + settings.margin) + cells;
        Self {
            skin: (settings.skin + reach + 2.0 * safety) as f32,
            reach: reach as f32,
            safety: safety as f32,
        }
    }
}

/// What the force loops need beside bodies and lists.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Context<'a> {
    /// Body types.
    pub(crate) templates: &'a [Template],
    /// Interaction of material a with material b at `a * n_materials + b`.
    pub(crate) interactions: &'a [Interaction],
    pub(crate) n_materials: usize,
    /// Distances of the sphere lists.
    pub(crate) cutoffs: Cutoffs,
    /// Periodic sides.
    pub(crate) period: Period,
    /// Time step, s.
    pub(crate) time_step: f64,
    /// What each body gives to each of its bridges of liquid, m³; empty in a dry world.
    pub(crate) liquid: &'a [f64],
    /// The bodies of a world of spheres; empty in another.
    pub(crate) spheres: Window<'a, Sphere>,
}

impl<'a> Context<'a> {
    /// Place of the interaction of two materials in the table.
    #[inline(always)]
    pub(crate) fn interaction_index(&self, a: usize, b: usize) -> usize {
        a * self.n_materials + b
    }

    /// Interaction of two materials.
    #[inline(always)]
    pub(crate) fn interaction(&self, a: usize, b: usize) -> &'a Interaction {
        &self.interactions[self.interaction_index(a, b)]
    }
}
