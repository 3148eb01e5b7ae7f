//! Checks that a world is still plausible.
//!
//! A step makes only those checks that cost nothing. [`World::check_health`] makes the others; call it from time to time. It
//! changes nothing.

use crate::error::Error;
use crate::pair_force::PairFrame;
use crate::world::World;
use nalgebra::Vector3;

/// Limits of a plausible world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HealthLimits {
    /// Lower corner of the region that holds the centres of all bodies, m.
    pub low: Vector3<f64>,
    /// Upper corner, m.
    pub high: Vector3<f64>,
    /// Highest speed of any point of a body, m/s.
    pub speed: f64,
    /// Largest overlap of two spheres over the radius of the smaller one. The contact laws hold for
    /// overlaps that are small against the radius; above 0.1 a result is in doubt.
    pub overlap: f64,
}

impl World {
    /// Refuses a world with a state that is not finite, a lost body, a body that is too fast, or spheres
    /// that overlap too much.
    ///
    /// # Errors
    ///
    /// The first such body, with its place and the time.
    pub fn check_health(&self, limits: &HealthLimits) -> Result<(), Error> {
        let bodies = self.bodies();
        let (time, time_step) = (self.time(), self.settings().time_step);
        for body in 0..bodies.len() {
            let position = self.between_sides(&bodies.position[body]);
            let velocity = bodies.velocity[body];
            let spin = bodies.spin[body];
            let turned = bodies.orientation[body].coords;
            if !(position + velocity + spin).sum().is_finite() || !turned.sum().is_finite() {
                return Err(Error::Diverged {
                    body,
                    time,
                    time_step,
                });
            }
            let reach = self.templates()[bodies.template[body]].bounding_radius();
            let speed = velocity.norm() + spin.norm() * reach;
            if speed > limits.speed {
                return Err(Error::Flying {
                    body,
                    speed,
                    limit: limits.speed,
                    position: place(&position),
                    time,
                    time_step,
                });
            }
            let inside = |k: usize| position[k] >= limits.low[k] && position[k] <= limits.high[k];
            if !(0..3).all(inside) {
                let position = place(&position);
                return Err(Error::Lost {
                    body,
                    time,
                    position,
                });
            }
        }
        self.check_overlaps(limits.overlap)
    }

    /// Refuses spheres of two bodies that overlap by more than a share of the smaller radius.
    fn check_overlaps(&self, limit: f64) -> Result<(), Error> {
        let bodies = self.bodies();
        for contact in self.kept_pairs() {
            let (i, j, key) = (contact.body, contact.other, contact.key);
            let templates = [i, j].map(|k| &self.templates()[bodies.template[k]]);
            let Some(pair) =
                PairFrame::new(bodies, [i, j], self.period()).sphere_pair(key, templates, 0.0)
            else {
                continue;
            };
            let [a, b] = pair.radii;
            let share = (a + b - pair.between.norm()) / a.min(b);
            if share > limit {
                return Err(Error::TooDeep {
                    i,
                    j,
                    share,
                    limit,
                    position: place(&self.between_sides(&bodies.position[i])),
                    time: self.time(),
                    time_step: self.settings().time_step,
                });
            }
        }
        Ok(())
    }
}

/// A point as text.
fn place(point: &Vector3<f64>) -> String {
    format!("({:.5}, {:.5}, {:.5})", point.x, point.y, point.z)
}
