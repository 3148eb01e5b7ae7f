//! Moments of a bed as spheres, from dumps of LAMMPS and LIGGGHTS or from frames here, and what they show, read in one way.

use crate::Error;
use nalgebra::Vector3;
use scene::{Frame, SeedBody};
use std::f64::consts::PI;
use std::sync::Arc;
use surface_profile::{
    DensitySettings, Disc, DrumCircle, SurfaceAngle, measure, profile_from_discs,
};

/// Spheres count for the slip within this angle of the centre of all, as seen from the axis, rad.
const MIDDLE_OF_BED: f64 = PI / 6.0;

/// The spheres at the surface of all seeds at one moment.
#[derive(Debug, Clone, PartialEq)]
pub struct Moment {
    /// Number of the step; 0 in a frame.
    pub step: u64,
    /// Spheres as discs across the axis of the drum, m.
    pub discs: Vec<Disc>,
    /// Their velocities, m/s.
    pub velocities: Vec<Vector3<f64>>,
}

impl Moment {
    /// The spheres of a frame.
    pub fn of(frame: &Frame, bodies: &[Arc<SeedBody>]) -> Self {
        let mut moment = Self {
            step: 0,
            discs: Vec::new(),
            velocities: Vec::new(),
        };
        for i in 0..frame.position.len() {
            for sphere in bodies[frame.kind[i]].outer.spheres() {
                let arm = frame.orientation[i] * sphere.centre;
                let centre = frame.position[i] + arm;
                moment.discs.push(Disc {
                    x: centre.x,
                    y: centre.y,
                    radius: sphere.radius,
                });
                let velocity = frame.velocity[i] + frame.spin[i].cross(&arm);
                moment.velocities.push(velocity);
            }
        }
        moment
    }

    /// The surface of the bed in a drum of a radius (m) about the origin; none where it cannot be measured.
    pub fn surface(&self, radius: f64) -> Option<SurfaceAngle> {
        let drum = DrumCircle {
            x: 0.0,
            y: 0.0,
            radius,
        };
        let points =
            profile_from_discs(&self.discs, &drum, &DensitySettings::for_drum(&drum)).ok()?;
        measure(&points, &drum).ok()
    }

    /// 1 less the mean speed along the shell of the spheres that lie within their diameter of it and within 30 deg of the
    /// centre of all, over the speed of a shell of a radius (m) that turns with `spin` (rad/s).
    pub fn shell_slip(&self, radius: f64, spin: f64) -> f64 {
        let n = self.discs.len() as f64;
        let centre = self.discs.iter().map(|d| (d.x / n, d.y / n));
        let (x, y) = centre.fold((0.0, 0.0), |sum, d| (sum.0 + d.0, sum.1 + d.1));
        let direction = x.atan2(-y);
        let (mut speed, mut count) = (0.0, 0.0);
        for (d, v) in self.discs.iter().zip(&self.velocities) {
            let from_axis = d.x.hypot(d.y);
            let aside = (d.x.atan2(-d.y) - direction + PI).rem_euclid(2.0 * PI) - PI;
            if from_axis > radius - 2.0 * d.radius && aside.abs() < MIDDLE_OF_BED {
                speed += (d.x * v.y - d.y * v.x) / from_axis;
                count += 1.0;
            }
        }
        1.0 - speed / count / (spin * radius)
    }

    /// Kinetic energy of the spheres over their mass, all alike: `mean v^2 / 2`, J/kg.
    pub fn kinetic_energy(&self) -> f64 {
        let squares = self.velocities.iter().map(Vector3::norm_squared);
        0.5 * squares.sum::<f64>() / self.velocities.len() as f64
    }

    /// Mean height of the spheres over the axis, m.
    pub fn height(&self) -> f64 {
        self.discs.iter().map(|d| d.y).sum::<f64>() / self.discs.len() as f64
    }
}

/// Reads a dump of style `custom` that has the columns x, y, radius, vx, vy and vz; `file` is named in messages.
///
/// # Errors
///
/// Text that is no dump, a missing column, a cell that is no number.
pub fn read(text: &str, file: &str) -> Result<Vec<Moment>, Error> {
    let wrong = |line: usize, what: &str| Error::Dump {
        file: file.to_owned(),
        line: line + 1,
        what: what.to_owned(),
    };
    let lines: Vec<&str> = text.lines().collect();
    let mut moments = Vec::new();
    let mut at = 0;
    while at < lines.len() {
        let item = |offset: usize| lines.get(at + offset).copied().unwrap_or("");
        if !item(0).starts_with("ITEM: TIMESTEP") || !item(8).starts_with("ITEM: ATOMS") {
            return Err(wrong(at, "a moment of a dump must begin here"));
        }
        let number = |line: &str, offset: usize| {
            line.trim()
                .parse::<u64>()
                .map_err(|_| wrong(at + offset, "a whole number must stand here"))
        };
        let (step, count) = (number(item(1), 1)?, number(item(3), 3)?);
        let columns: Vec<&str> = item(8).split_whitespace().skip(2).collect();
        let place = |name: &str| {
            let found = columns.iter().position(|c| *c == name);
            found.ok_or_else(|| wrong(at + 8, &format!("column '{name}' is missing")))
        };
        let (x, y, radius) = (place("x")?, place("y")?, place("radius")?);
        let velocity = [place("vx")?, place("vy")?, place("vz")?];
        let (mut discs, mut velocities) = (Vec::new(), Vec::new());
        for k in 0..usize::try_from(count).unwrap_or(usize::MAX) {
            let row = at + 9 + k;
            let cells: Vec<&str> = lines
                .get(row)
                .map_or_else(Vec::new, |l| l.split_whitespace().collect());
            let cell = |place: usize| -> Result<f64, Error> {
                let value = cells.get(place).and_then(|c| c.parse().ok());
                let value = value.filter(|number: &f64| number.is_finite());
                value.ok_or_else(|| wrong(row, "a row of numbers must stand here"))
            };
            discs.push(Disc {
                x: cell(x)?,
                y: cell(y)?,
                radius: cell(radius)?,
            });
            let [vx, vy, vz] = velocity.map(cell);
            velocities.push(Vector3::new(vx?, vy?, vz?));
        }
        at += 9 + discs.len();
        moments.push(Moment {
            step,
            discs,
            velocities,
        });
    }
    Ok(moments)
}

#[cfg(test)]
mod tests {
    use super::{Moment, read};
    use nalgebra::Vector3;
    use surface_profile::Disc;

    const DUMP: &str = "ITEM: TIMESTEP\n100\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp pp\n\
        0 1\n0 1\n0 1\nITEM: ATOMS id x y z vx vy vz radius\n1 0.1 0.2 0 1 0 0 0.5\n2 0.3 -0.4 0 0 2 -1 0.25\n";

    /// A bed that turns with its shell slips 0, one at half of its speed slips 0.5; energy by hand. Only spheres at the
    /// shell and near the middle of the bed count.
    #[test]
    fn slip_and_energy_are_those_of_the_spheres() {
        let place = |angle: f64, from_axis: f64| Disc {
            x: from_axis * angle.sin(),
            y: -from_axis * angle.cos(),
            radius: 0.01,
        };
        // Two at the shell near the middle, one inside, one far up the shell on either side.
        let places = [
            (0.1, 0.99),
            (-0.1, 0.985),
            (0.0, 0.5),
            (1.2, 0.99),
            (-1.2, 0.99),
        ];
        let discs: Vec<Disc> = places.iter().map(|(a, r)| place(*a, *r)).collect();
        let turning = |share: f64| Moment {
            step: 0,
            discs: discs.clone(),
            velocities: discs
                .iter()
                .enumerate()
                .map(|(k, d)| {
                    let from_axis = d.x.hypot(d.y);
                    let speed = if k < 2 { share * 3.0 } else { 7.0 };
                    Vector3::new(-d.y, d.x, 0.0) * (speed / from_axis)
                })
                .collect(),
        };
        assert!(
            turning(1.0).shell_slip(1.0, 3.0).abs() < 1e-12,
            "with the shell"
        );
        assert!(
            (turning(0.5).shell_slip(1.0, 3.0) - 0.5).abs() < 1e-12,
            "half"
        );
        let energy = 0.5 * (2.0 * 9.0 + 3.0 * 49.0) / 5.0;
        assert!(
            (turning(1.0).kinetic_energy() - energy).abs() < 1e-12,
            "energy"
        );
    }

    #[test]
    fn moments_are_read_by_the_names_of_their_columns() {
        let moments = read(&DUMP.repeat(2), "bed.dump").unwrap();
        assert_eq!(moments.len(), 2);
        let disc = moments[1].discs[1];
        assert_eq!(
            (moments[1].step, disc.x, disc.y, disc.radius),
            (100, 0.3, -0.4, 0.25)
        );
        assert_eq!(moments[1].velocities[1], Vector3::new(0.0, 2.0, -1.0));
        assert!((moments[1].height() + 0.1).abs() < 1e-15, "mean height");
    }

    #[test]
    fn broken_dumps_are_refused_with_their_line() {
        let short = DUMP.replace("2 0.3 -0.4 0 0 2 -1 0.25\n", "");
        let message = read(&short, "bed.dump").unwrap_err().to_string();
        assert!(message.contains("bed.dump: line 11"), "{message}");
        let message = read(&DUMP.replace("-0.4", "NaN"), "bed.dump").unwrap_err();
        assert!(message.to_string().contains("line 11"), "{message}");
        let message = read(&DUMP.replace("radius", "mass"), "b")
            .unwrap_err()
            .to_string();
        assert!(message.contains("'radius'"), "{message}");
    }
}
