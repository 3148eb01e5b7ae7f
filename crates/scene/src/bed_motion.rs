//! The form of motion of a bed in a turning drum, by the field's words, from what is measured of it.
//!
//! # Rule
//!
//! In this order, over the part of a run that is kept:
//!
//! ```text
//! slip > 0.5, carried > 0.25     surging        the bed sticks to the shell, slides back, again and again
//! slip > 0.5                     sliding        the shell slides under the bed
//! Fr >= 1                        centrifuging   the seeds go round with the shell
//! airborne > 0.25                cataracting    seeds are thrown off the top of the bed
//! carried > 0.25                 slumping       the bed waits, until an avalanche runs down
//! S shape > 0.1                  cascading      the surface is arched: its middle is 3.4 deg steeper than its line
//! otherwise                      rolling        a layer flows all the time over a flat surface
//! ```
//!
//! *slip*: 1 less the speed of the seeds at the shell over that of the shell. *carried*: share of the time in which the
//! centre of mass goes round with more than half of the speed of the drum; a bed over which a layer flows all the time
//! keeps its place. *airborne*: share of the seeds that touch nothing. *S shape*: cubic coefficient of the surface, see
//! [`surface_profile::SurfaceAngle`]. *Fr* = R w^2 / g.
//!
//! # Source
//!
//! The forms are those of `[Mellmann2001]`, who tells them by Froude number, filling and friction at the wall. The limits
//! are ours: `docs/steady-state.md` shows what drums of 1 to 110 rpm gave.

use crate::run::Regime;
use crate::series::{SLIDING_BELOW, SeriesPoint};
use serde::{Deserialize, Serialize};

/// Carried share above which the bed waits.
const WAITS: f64 = 0.25;
/// Airborne share above which seeds are thrown.
const THROWN: f64 = 0.25;
/// S shape above which the surface is arched.
const ARCHED: f64 = 0.1;
/// Froude number from which seeds stay at the top of the shell.
const STAYS_AT_TOP: f64 = 1.0;
/// Share of the drum's speed above which the bed counts as carried.
const CARRIED: f64 = 0.5;

/// Forms of transverse motion of a bed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BedMotion {
    /// The shell slides under the bed.
    Sliding,
    /// The bed sticks to the shell and slides back, again and again.
    Surging,
    /// The bed waits, until an avalanche runs down.
    Slumping,
    /// A layer flows all the time over a flat surface.
    Rolling,
    /// A layer flows all the time over an arched surface.
    Cascading,
    /// Seeds are thrown off the top of the bed.
    Cataracting,
    /// Seeds go round with the shell.
    Centrifuging,
}

impl BedMotion {
    /// What is measured, as the word for it.
    pub fn of(evidence: &MotionEvidence) -> Self {
        let waits = evidence.carried_share > WAITS;
        if evidence.shell_slip > SLIDING_BELOW {
            return if waits { Self::Surging } else { Self::Sliding };
        }
        if evidence.froude_number >= STAYS_AT_TOP {
            return Self::Centrifuging;
        }
        if evidence.airborne_share.is_some_and(|share| share > THROWN) {
            return Self::Cataracting;
        }
        let arched = evidence.s_shape.is_some_and(|s| s > ARCHED);
        match (waits, arched) {
            (true, _) => Self::Slumping,
            (false, true) => Self::Cascading,
            (false, false) => Self::Rolling,
        }
    }

    /// Whether the bed slides or turns with the shell: no smooth surface of angles crosses from one to the other.
    pub fn regime(self) -> Regime {
        match self {
            Self::Sliding | Self::Surging => Regime::Sliding,
            _ => Regime::Rolling,
        }
    }
}

/// Measures that distinguish the forms of motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionEvidence {
    /// R w^2 / g.
    pub froude_number: f64,
    /// Mean slip at the shell.
    pub shell_slip: f64,
    /// Share of the time in which the bed is carried round.
    pub carried_share: f64,
    /// Mean time for which the bed is carried round, s; `None` if it never is.
    pub waiting_time: Option<f64>,
    /// Mean share of seeds without a contact; `None` for bonded seeds, whose contacts are not counted.
    pub airborne_share: Option<f64>,
    /// Mean S shape of the surface; `None` if it was not read.
    pub s_shape: Option<f64>,
}

impl MotionEvidence {
    /// Looks at the kept part of a run; `spin` is the speed of the drum at a time (rad/s, counter-clockwise positive).
    pub fn of(
        series: &[SeriesPoint],
        froude_number: f64,
        s_shape: Option<f64>,
        spin: impl Fn(f64) -> f64,
    ) -> Self {
        let slip = series.iter().map(|p| p.shell_slip);
        let airborne: Option<Vec<f64>> = series.iter().map(|p| p.airborne_share).collect();
        let carried: Vec<(bool, f64)> = series
            .windows(2)
            .map(|w| {
                let time = w[1].time_s - w[0].time_s;
                let turned = (w[1].centre_of_mass_deg - w[0].centre_of_mass_deg).to_radians();
                let of_drum = spin(w[1].time_s) * time;
                (
                    turned * of_drum.signum() > CARRIED * of_drum.abs() && of_drum != 0.0,
                    time,
                )
            })
            .collect();
        let all: f64 = carried.iter().map(|c| c.1).sum();
        let waited: f64 = carried.iter().filter(|c| c.0).map(|c| c.1).sum();
        let spells = carried
            .chunk_by(|a, b| a.0 == b.0)
            .filter(|c| c[0].0)
            .count();
        Self {
            froude_number,
            shell_slip: mean(slip).unwrap_or(0.0),
            carried_share: if spells > 0 { waited / all } else { 0.0 },
            waiting_time: (spells > 0).then(|| waited / spells as f64),
            airborne_share: airborne.and_then(|shares| mean(shares.into_iter())),
            s_shape,
        }
    }
}

/// Mean; none of nothing.
pub(crate) fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (mut sum, mut n) = (0.0, 0_usize);
    for value in values {
        sum += value;
        n += 1;
    }
    (n > 0).then(|| sum / n as f64)
}

#[cfg(test)]
mod tests {
    use super::{BedMotion, MotionEvidence};
    use crate::series::SeriesPoint;
    use probability::random_stream::Stream;
    use std::f64::consts::PI;

    /// 10 rpm, rad/s.
    const SPIN: f64 = PI / 3.0;

    /// 4 s of a bed whose centre of mass has a direction (deg) at each time, with 0.1 deg of noise.
    fn series(slip: f64, direction: impl Fn(f64) -> f64) -> Vec<SeriesPoint> {
        let mut noise = Stream::new(1, "bed");
        (1..=200)
            .map(|k| {
                let time_s = 0.02 * f64::from(k);
                SeriesPoint {
                    time_s,
                    centre_of_mass_deg: direction(time_s) + 0.1 * noise.normal(),
                    shell_slip: slip,
                    drive_power_w: 0.0,
                    kinetic_energy_j: 0.0,
                    airborne_share: Some(0.05),
                }
            })
            .collect()
    }

    /// Carried with the drum for 0.3 s (18 deg at 60 deg/s), down in 0.1 s.
    fn saw_tooth(time: f64) -> f64 {
        let phase = time.rem_euclid(0.4);
        35.0 + if phase < 0.3 {
            60.0 * phase
        } else {
            18.0 - 180.0 * (phase - 0.3)
        }
    }

    fn evidence(slip: f64, direction: impl Fn(f64) -> f64) -> MotionEvidence {
        MotionEvidence::of(&series(slip, direction), 0.0078, Some(0.05), |_| SPIN)
    }

    /// Three quarters of the time up in spells of 0.3 s; each end of a spell may be one interval off.
    #[test]
    fn waiting_is_measured() {
        let got = evidence(0.1, saw_tooth);
        assert!((got.carried_share - 0.75).abs() < 0.06, "{got:?}");
        assert!(
            (got.waiting_time.unwrap() - 0.3).abs() < 0.03,
            "{got:?} s of waiting"
        );
    }

    /// A drum that turns the other way carries the bed the other way.
    #[test]
    fn the_direction_of_the_drum_does_not_matter() {
        let mirrored = series(0.1, |t| -saw_tooth(t));
        let got = MotionEvidence::of(&mirrored, 0.0078, None, |_| -SPIN);
        assert!((got.carried_share - 0.75).abs() < 0.06, "{got:?}");
    }

    /// A bed that keeps its place is not carried by the noise of its direction: 0.1 deg in 0.02 s is 7 deg/s for 30.
    #[test]
    fn a_steady_bed_does_not_wait() {
        let got = evidence(0.1, |_| 38.0);
        assert!(got.carried_share < 0.01, "{got:?}");
        assert_eq!(BedMotion::of(&got), BedMotion::Rolling);
    }

    #[test]
    fn each_form_is_named_by_what_is_measured() {
        let rolling = evidence(0.1, |_| 38.0);
        let slumping = evidence(0.1, saw_tooth);
        let cases = [
            (evidence(0.95, |_| 38.0), BedMotion::Sliding),
            (evidence(0.95, saw_tooth), BedMotion::Surging),
            (slumping, BedMotion::Slumping),
            (rolling, BedMotion::Rolling),
            (
                MotionEvidence {
                    s_shape: Some(0.2),
                    ..rolling
                },
                BedMotion::Cascading,
            ),
            (
                MotionEvidence {
                    s_shape: Some(0.3),
                    airborne_share: Some(0.3),
                    ..rolling
                },
                BedMotion::Cataracting,
            ),
            (
                MotionEvidence {
                    froude_number: 1.2,
                    airborne_share: Some(0.3),
                    ..rolling
                },
                BedMotion::Centrifuging,
            ),
        ];
        for (evidence, word) in cases {
            assert_eq!(BedMotion::of(&evidence), word, "{evidence:?}");
        }
    }
}
