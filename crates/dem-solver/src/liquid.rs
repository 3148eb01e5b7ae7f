//! Liquid on bodies, and how their bridges share it.
//!
//! # Rule
//!
//! A body carries a volume L of liquid for good. With n bridges, at bodies and walls together, it gives each of
//! them `L / max(n, 6)`; what they do not hold is its film. A bridge between two bodies has what both give, one at
//! a wall what the body gives. So no body's bridges ever hold more than its liquid, a bridge that forms takes its
//! volume from the film or, behind the sixth, from its neighbours, and one that breaks gives it back.
//!
//! Six is the number of contacts of a sphere in a loose bed: a body with fewer keeps a film instead of giving all
//! of its liquid to its only bridge. Chosen here; a bridge of twice the volume pulls as hard at the touch and reaches
//! a quarter farther (`2^(1/3)`).
//!
//! The numbers of bridges are those at the end of a step and hold for the next. They are whole numbers, counted
//! in any order with the same result, so that the volumes do not depend on the number of threads; and they
//! follow from the contacts, so that a snapshot needs no more than these. That is why the liquid is not kept
//! bridge by bridge with what each took: such books depend on the order of events within a step. Liquid does
//! not pass from one body to another.

use crate::interaction::Interaction;

/// Bridges among which a body shares its liquid if it has no more.
const BRIDGES_OF_A_BODY: u32 = 6;

/// The liquid of all bodies.
#[derive(Debug, Clone, Default)]
pub(crate) struct Liquid {
    /// Bridges of each body.
    bridges: Vec<u32>,
    /// What each body gives to each of its bridges, m³.
    shares: Vec<f64>,
}

impl Liquid {
    /// What each body gives to each of its bridges, m³; empty before the first deal.
    pub(crate) fn shares(&self) -> &[f64] {
        &self.shares
    }

    /// Shares the liquid of each body (m³) among its bridges: `bodies` names, for each bridge, each of its bodies.
    pub(crate) fn deal(
        &mut self,
        liquid: impl Iterator<Item = f64>,
        bodies: impl Iterator<Item = usize>,
    ) {
        self.shares.clear();
        self.shares.extend(liquid);
        self.bridges.clear();
        self.bridges.resize(self.shares.len(), 0);
        for body in bodies {
            self.bridges[body] += 1;
        }
        for (share, &bridges) in self.shares.iter_mut().zip(&self.bridges) {
            *share = given(*share, bridges);
        }
    }

    /// What the bridges of a body hold of its liquid, m³.
    pub(crate) fn in_bridges(&self, body: usize) -> f64 {
        let n = self.bridges.get(body).copied().unwrap_or(0);
        self.shares
            .get(body)
            .map_or(0.0, |share| share * f64::from(n))
    }
}

/// What a body with so much liquid (m³) gives to each of so many bridges, m³.
fn given(liquid: f64, bridges: u32) -> f64 {
    liquid / f64::from(bridges.max(BRIDGES_OF_A_BODY))
}

/// The most that a body with so much liquid (m³) gives to a bridge, m³.
pub(crate) fn most_given(liquid: f64) -> f64 {
    given(liquid, 0)
}

/// Volume of a bridge to which bodies give some shares (m³); 0 where the interaction has none.
#[inline]
pub(crate) fn bridge_volume<const N: usize>(
    interaction: &Interaction,
    shares: &[f64],
    bodies: [usize; N],
) -> f64 {
    if !interaction.is_wet() {
        return 0.0;
    }
    bodies
        .iter()
        .map(|&body| shares.get(body).copied().unwrap_or(0.0))
        .sum()
}

#[cfg(test)]
mod tests {
    use super::Liquid;

    /// One bridge gets a sixth, six get all, and twelve get as much together. Rounding only.
    #[test]
    fn a_body_gives_a_sixth_to_a_bridge_and_never_more_than_it_has() {
        for (n, held) in [(0, 0.0), (1, 1.0 / 6.0), (6, 1.0), (12, 1.0)] {
            let mut liquid = Liquid::default();
            liquid.deal([3e-12].into_iter(), std::iter::repeat_n(0, n));
            let error = liquid.in_bridges(0) - 3e-12 * held;
            assert!(error.abs() < 1e-26, "{n} bridges: {error} m³ too much");
        }
    }
}
