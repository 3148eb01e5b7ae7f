//! The time step that dashpots bear, beside the springs of a contact.

use super::Impact;
use crate::hertz_mindlin::damping_factor;

/// Dashpots that know the mass of the whole body, so that a light touch at the tip of a long seed is damped as if all of it
/// had to be stopped.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyDashpots {
    /// Coefficient of restitution, 0 to 1; the least of all contacts damps most.
    pub restitution: f64,
    /// Share of the damping of the body in the dashpots, 0 to 1; the rest, of spheres with their own masses, is left out.
    pub share: f64,
    /// Whether all spheres that touch share the mass; otherwise each damps with the whole.
    pub shared: bool,
}

/// Share of the longest stable time step of a spring alone that is left beside a dashpot of a damping ratio.
///
/// # Formula
///
/// `sqrt(1 + z²) - z`. The scheme of the solver, `v += (-w² x - 2 z w v) dt`, `x += v dt`, multiplies its state in a step by the roots
/// of `q² - (2 - W² - 2 z W) q + (1 - 2 z W) = 0` with `W = w dt`. Both stay within the unit circle while the polynomial is
/// positive at q = -1: `4 - 4 z W - W² > 0`, thus `W < 2 (sqrt(1 + z²) - z)`.
///
/// # Source
///
/// The criterion of Jury for a polynomial of second degree; the same limit represents central differences with lagged
/// velocities in `[Belytschko2014, chapter 6]`.
pub fn stable_share(damping_ratio: f64) -> f64 {
    damping_ratio.hypot(1.0) - damping_ratio
}

impl BodyDashpots {
    /// Damping ratio of springs of some stiffnesses (N/m) side by side, whose dashpots know a reduced mass of the bodies and which
    /// move a smaller one, `felt` (kg).
    ///
    /// # Formula
    ///
    /// `z = C / (2 sqrt(K m))` with `K = sum k`, and C the sum of the [dashpots of the law](crate::HertzMindlin),
    /// `2 sqrt(5/6) b sqrt(k m*)`; shared, together `2 sqrt(5/6) b sqrt(K m*)`; the share of the body in the damping multiplies it.
    pub(super) fn damping_ratio(
        &self,
        stiffnesses: impl Iterator<Item = f64> + Clone,
        reduced_mass: f64,
        felt: f64,
    ) -> f64 {
        let whole: f64 = stiffnesses.clone().sum();
        let roots = if self.shared {
            whole.sqrt()
        } else {
            stiffnesses.map(f64::sqrt).sum()
        };
        let damping = self.share * damping_factor(self.restitution);
        0.5 * damping * roots / whole.sqrt() * (reduced_mass / felt).sqrt()
    }
}

impl Impact {
    /// Remainder of the duration of a contact for the choice of the time step: all if no dashpot knows more than the mass of its
    /// sphere. Arguments as in [`BodyDashpots::damping_ratio`].
    pub(super) fn left_by_dashpots(
        &self,
        stiffnesses: impl Iterator<Item = f64> + Clone,
        reduced_mass: f64,
        felt: f64,
    ) -> f64 {
        self.dashpots.map_or(1.0, |dashpots| {
            stable_share(dashpots.damping_ratio(stiffnesses, reduced_mass, felt))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::{BodyDashpots, stable_share};

    /// A mass on a spring and a dashpot, moved by the scheme of the solver for 20 000 steps: with 0.999 of the limit it comes to rest,
    /// with 1.001 of it the swing grows. Near the limit the swing changes by 0.001 to 0.004 in a step.
    #[test]
    fn a_damped_mass_rests_below_the_limit_and_leaves_above() {
        for ratio in [0.0, 0.1, 0.6, 1.2, 3.0] {
            let swing = |share: f64| {
                let step = 2.0 * share * stable_share(ratio);
                let (mut place, mut speed) = (1.0_f64, 0.0_f64);
                for _ in 0..20_000 {
                    if place.abs() > 1e6 {
                        break;
                    }
                    speed += step * (-place - 2.0 * ratio * speed);
                    place += step * speed;
                }
                place.abs()
            };
            // Without a dashpot nothing is lost below the limit.
            let [below, above] = [0.999, 1.001].map(swing);
            assert!(
                below < if ratio > 0.0 { 0.5 } else { 30.0 },
                "{ratio}: {below}"
            );
            assert!(above > 1e3, "{ratio}: {above}");
        }
    }

    /// Springs of one stiffness, each with the whole mass in its dashpot, damp `sqrt(n)` times as much as when they share it, which damps
    /// as one spring does. Rounding only.
    #[test]
    fn dashpots_that_do_not_share_add_up() {
        let of = |shared, n| {
            let dashpots = BodyDashpots {
                restitution: 0.1,
                share: 1.0,
                shared,
            };
            dashpots.damping_ratio(std::iter::repeat_n(3.0, n), 2.0, 0.5)
        };
        assert!((of(true, 9) / of(true, 1) - 1.0).abs() < 1e-14);
        assert!((of(false, 9) / of(true, 9) - 3.0).abs() < 1e-14);
        // b of a restitution of 0.1 is 0.591; the mass counts by its root: sqrt(5/6) 0.591 2.
        assert!((of(true, 1) - 1.079_3).abs() < 1e-3, "{}", of(true, 1));
    }
}
