//! What a run may ask for at most: times, steps, seeds, frames, speed.
//!
//! The limits are our choice. They lie far above what is simulated here, and keep a slip of the pen from a run that
//! never ends or takes all memory of the machine.

use crate::check::bad;
use crate::motion::SERIES_INTERVAL;
use crate::{Error, Protocol, Scene, SeedSettings};

/// Longest time of one phase of a run, s: a day. The bed is written down every 0.02 s.
const MOST_TIME: f64 = 1e5;

/// Most steps of a run: at 1 us each, the least of any bed, three hours. The study's drum takes 1e5.
const MOST_STEPS: f64 = 1e10;

/// Most seeds of a run: a thousand drums of the study, in some 6 GB.
const MOST_SEEDS: usize = 1_000_000;

/// Most kinds of seeds and most materials: each pair of them has laws and a duration of contact of its own, which are worked out before the
/// first step. A hundred take seconds, ten times as many a hundred times as long; size distributions have ten to thirty classes.
const MOST_KINDS: usize = 100;

/// Greatest acceleration at a wall that turns, m/s²: a hundred times gravity, where from one time gravity on all seeds
/// lie at the shell.
const MOST_ACCELERATION: f64 = 1000.0;

/// Greatest speed of a wall from a mesh, m/s: three times that of the fans that throw seeds.
const MOST_WALL_SPEED: f64 = 100.0;

/// Memory of a seed in the solver, with its share of the contacts, B (docs/benchmarks.md: 106 MiB for 19 200 seeds).
const BYTES_OF_SEED: f64 = 6e3;

/// Memory of a seed in a frame, B: kind, place, turn, velocity and spin.
const BYTES_IN_FRAME: f64 = 112.0;

impl Scene {
    /// Memory that a run of the scene takes at its end, B; a rough estimate.
    ///
    /// # Formula
    ///
    /// `N (6000 + 112 f)`: N the number of bodies, which are spheres where seeds are bonded, f the number of frames.
    pub fn estimated_memory(&self) -> f64 {
        let spheres = |kind: &SeedSettings| {
            let filling = kind.filling().ok().flatten();
            let count = filling.and_then(|filling| filling.sphere_count);
            let parts = self.model.bonds.and(count).unwrap_or(1);
            self.count_of(kind) as f64 * parts as f64
        };
        let bodies: f64 = self.seed.iter().map(spheres).sum();
        let frames = if self.turns() {
            self.expected_rotation() / self.protocol.frame_interval.si()
        } else {
            1.0
        };
        bodies * (BYTES_OF_SEED + frames * BYTES_IN_FRAME)
    }

    /// Whether a drive turns the apparatus.
    fn turns(&self) -> bool {
        !self.apparatus.is_bench_test() && !self.apparatus.has_phases()
    }

    /// Finds times, steps, seeds, frames and speeds that no run can have.
    pub(crate) fn check_limits(&self, found: &mut Vec<Error>) {
        found.extend(self.check_kinds());
        found.extend(self.check_times());
        found.extend(self.check_frames());
        found.extend(self.check_numbers());
        found.extend(self.check_walls());
        let (radius, speed) = (self.apparatus.radius(), self.apparatus.speed());
        if radius * speed * speed > MOST_ACCELERATION {
            let most = (MOST_ACCELERATION / radius).sqrt() * 60.0 / std::f64::consts::TAU;
            let requirement = format!(
                "at most {most:.0} rpm here, where the wall is accelerated by {MOST_ACCELERATION} m/s2"
            );
            found.push(bad(
                "apparatus.speed",
                self.apparatus.speed_text(),
                &requirement,
            ));
        }
    }

    /// More kinds of seeds or materials than a run can have.
    fn check_kinds(&self) -> Option<Error> {
        let lists = [
            (
                "number of [[seed]]",
                self.seed.len(),
                "kinds of seeds: join sizes into classes",
            ),
            (
                "number of [material]",
                self.material.len(),
                "materials: remove those not in use",
            ),
        ];
        let (name, number, of) = lists
            .into_iter()
            .find(|(_, number, _)| *number > MOST_KINDS)?;
        let requirement = format!("at most {MOST_KINDS} {of}");
        Some(bad(name, number.to_string(), &requirement))
    }

    /// The first wall from a mesh that is too fast somewhere in the apparatus.
    fn check_walls(&self) -> Option<Error> {
        let [low, high] = self.apparatus.device().room();
        let size = (high - low).norm();
        let own = self.apparatus.device().fastest_wall();
        let requirement = format!("at most {MOST_WALL_SPEED} m/s");
        if own > MOST_WALL_SPEED {
            let speed = format!("{own:.4e} m/s");
            return Some(bad("fastest motion of a phase", speed, &requirement));
        }
        let mut walls = self.wall.iter();
        let wall = walls.find(|w| w.fastest(size) > MOST_WALL_SPEED)?;
        let name = format!("velocity, spin and vibration of wall '{}'", wall.name);
        let speed = format!("{:.4e} m/s within {size:.3} m", wall.fastest(size));
        Some(bad(&name, speed, &requirement))
    }

    /// The first time of the protocol that is too long, or the fixed step that does not fit them.
    fn check_times(&self) -> Option<Error> {
        let p = &self.protocol;
        for (name, time) in [
            ("protocol.settle_limit", p.settle_limit),
            ("protocol.rotation_limit", p.rotation_limit),
        ] {
            if time.si() > MOST_TIME {
                let requirement = format!("at most {MOST_TIME} s");
                return Some(bad(name, time.to_string(), &requirement));
            }
        }
        let step = p.time_step.filter(|step| step.si() > 0.0)?;
        let requirement = p.limit_of_step(step.si())?;
        Some(bad("protocol.time_step", step.to_string(), &requirement))
    }

    /// Frames that the run cannot have, or a time between them that it does not keep to.
    fn check_frames(&self) -> Option<Error> {
        let p = &self.protocol;
        let every = p.frame_interval.si() / SERIES_INTERVAL;
        if !self.turns() || every <= 0.0 {
            return None;
        }
        if every < 1.0 - 1e-9 || (every - every.round()).abs() > 1e-9 * every {
            let requirement = "20 ms or a multiple of it, at which the bed is looked at";
            let interval = p.frame_interval.to_string();
            return Some(bad("protocol.frame_interval", interval, requirement));
        }
        let most = (p.rotation_limit.si() / p.frame_interval.si() + 1e-9).floor();
        if p.frames as f64 <= most {
            return None;
        }
        let requirement = format!(
            "at most {most}, as many as protocol.rotation_limit ({}) holds with one every {} \
             (protocol.frame_interval)",
            p.rotation_limit, p.frame_interval
        );
        Some(bad("protocol.frames", p.frames.to_string(), &requirement))
    }

    /// More seeds than a run can have: of one kind, by the key that states them, or of all.
    fn check_numbers(&self) -> Option<Error> {
        let requirement = format!("at most {MOST_SEEDS} seeds: take a part of the apparatus");
        for kind in &self.seed {
            let count = self.count_of(kind);
            if count > MOST_SEEDS {
                let key = match (kind.count, kind.total_mass) {
                    (Some(_), _) => "count",
                    (None, Some(_)) => "number of seeds by total_mass",
                    (None, None) => "number of seeds by fill_level",
                };
                let name = format!("{key} of seed '{}'", kind.name);
                return Some(bad(&name, count.to_string(), &requirement));
            }
        }
        let all = self.seed_count();
        (all > MOST_SEEDS).then(|| bad("sum of the seeds", all.to_string(), &requirement))
    }
}

impl Protocol {
    /// The requirement that a time step (s) violates; `None` if the run can use it.
    pub(crate) fn limit_of_step(&self, step: f64) -> Option<String> {
        if step.is_nan() || step > SERIES_INTERVAL {
            return Some("at most 20 ms, the time after which the bed is looked at".into());
        }
        let time = self.settle_limit.si() + self.rotation_limit.si();
        let least = time / MOST_STEPS;
        (step < least).then(|| {
            format!(
                "at least {least:.1e} s: with shorter ones protocol.settle_limit ({}) and protocol.rotation_limit ({}) \
                 take more than {MOST_STEPS:.0e} steps",
                self.settle_limit, self.rotation_limit
            )
        })
    }
}
