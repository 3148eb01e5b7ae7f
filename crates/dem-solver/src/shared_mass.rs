//! The mass of a body shared by the spheres with which it touches another body at the same time.
//!
//! # Formula
//!
//! With the radius of each contact a, the reduced mass of both bodies m*, and sums over the contacts of the
//! same two bodies:
//!
//! ```text
//! a_k = sqrt(R*_k d_k)
//! m_k = m* a_k / sum(a)
//! ```
//!
//! Stiffness goes with a, the dashpot with sqrt(a m). So all dashpots together are the dashpot of
//! one contact as stiff as all of them with the whole mass: `sum(sqrt(a_k m_k)) = sqrt(sum(a) m*)`. Two bodies that
//! meet face to face rebound alike, however many spheres the face is made of; a contact that begins
//! takes its share from 0 on, without a jump.
//!
//! # Source
//!
//! `[Berry2023]` lists the errors of the two usual choices, which this share avoids: a dashpot that knows only the mass of
//! its sphere damps too little, and several that know the mass of the whole body damp too much.

#![expect(
    clippy::inline_always,
    reason = "called in the force loop, which is vectorised only when inlined"
)]

/// Least share: a contact that holds by liquid alone has no radius, and needs a mass above 0.
const LEAST: f64 = 1e-9;

/// How two bodies share their masses among their contacts.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shares {
    /// Whether each of the two sides shares its mass.
    sides: [bool; 2],
    /// Sum of the radii of all contacts, m.
    total: f64,
}

impl Shares {
    /// Of two sides, with the radii (m) of all their contacts; none where no side shares its mass.
    #[inline(always)]
    pub(crate) fn new(sides: [bool; 2], radii: impl Iterator<Item = f64>) -> Option<Self> {
        sides.contains(&true).then(|| Self {
            sides,
            total: radii.sum(),
        })
    }

    /// Share of the mass of each side that a contact of a radius (m) gets.
    #[inline(always)]
    pub(crate) fn of(&self, radius: f64) -> [f64; 2] {
        let share = if self.total > 0.0 {
            (radius / self.total).max(LEAST)
        } else {
            1.0
        };
        self.sides.map(|shares| if shares { share } else { 1.0 })
    }
}

#[cfg(test)]
mod tests {
    use super::Shares;

    /// The dashpot goes with sqrt(a m): all together are that of one contact with the sum of the radii and
    /// the whole mass. Rounding only.
    #[test]
    fn dashpots_together_are_that_of_one_contact() {
        let radii: [f64; 4] = [3e-5, 1e-5, 4e-5, 2e-6];
        let shares = Shares::new([true, false], radii.into_iter()).unwrap();
        let (mut together, mut mass) = (0.0, 0.0);
        for radius in radii {
            let [own, other] = shares.of(radius);
            assert!(other == 1.0, "the second side does not share");
            together += (radius * own).sqrt();
            mass += own;
        }
        let one = radii.iter().sum::<f64>().sqrt();
        assert!((together / one - 1.0).abs() < 1e-14, "{together} for {one}");
        assert!((mass - 1.0).abs() < 1e-14, "shares sum to {mass}");
    }
}
