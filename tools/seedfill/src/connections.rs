//! How the spheres hang together, and the table of their bonds.

use crate::arguments::{Arguments, MethodName};
use command_line::significant;
use serde::Serialize;
use sphere_fill::{Connectivity, Filling, SpherePair};
use std::fmt::Write as _;
use trimesh::LengthUnit;

/// What `--json` tells of the contacts; lengths are in the unit of the mesh.
#[derive(Debug, Serialize)]
pub(crate) struct Connections {
    /// Largest gap that counts as contact.
    bond_gap: f64,
    /// Pairs in contact.
    contacts: usize,
    mean_coordination: f64,
    /// Spheres without contact.
    rattlers: usize,
    /// Parts that no contact joins.
    pieces: usize,
    /// Spheres of the largest part.
    largest_piece: usize,
    /// Smallest gap that makes all one piece; 0 where overlaps do.
    joining_gap: f64,
    /// Radius of the narrowest neck that a piece hangs by; 0 for a point.
    loosest_neck_radius: Option<f64>,
    /// The two spheres beside it.
    loosest_neck_spheres: Option<[usize; 2]>,
    #[serde(skip)]
    spheres: usize,
    #[serde(skip)]
    unit: LengthUnit,
}

impl Connections {
    pub(crate) fn new(found: &Connectivity, spheres: usize, unit: LengthUnit) -> Self {
        let metre = unit.in_metres();
        Self {
            bond_gap: found.largest_gap / metre,
            contacts: found.pairs.len(),
            mean_coordination: found.mean_coordination,
            rattlers: found.without_contact,
            pieces: found.pieces,
            largest_piece: found.largest_piece,
            joining_gap: found.joining_gap / metre,
            loosest_neck_radius: found.loosest.map(|pair| pair.neck_radius / metre),
            loosest_neck_spheres: found.loosest.map(|pair| pair.spheres),
            spheres,
            unit,
        }
    }

    /// Names and values for people.
    pub(crate) fn lines(&self) -> Vec<(&'static str, String)> {
        let (unit, n) = (self.unit, self.spheres);
        let pieces = match self.pieces {
            1 => "1".to_owned(),
            several => format!(
                "{several} (the largest of {} of {n} spheres)",
                self.largest_piece
            ),
        };
        let contacts = format!(
            "{}, {:.2} a sphere, {} rattlers (a gap of {} {unit} counts)",
            self.contacts,
            self.mean_coordination,
            self.rattlers,
            significant(self.bond_gap, 3)
        );
        let mut lines = vec![("pieces", pieces), ("contacts", contacts)];
        if let (Some(radius), Some([i, j])) = (self.loosest_neck_radius, self.loosest_neck_spheres)
        {
            let neck = if radius > 0.0 {
                format!("radius {} {unit}", significant(radius, 3))
            } else {
                "a point".to_owned()
            };
            lines.push(("loosest neck", format!("{neck}, spheres {i} and {j}")));
        }
        if self.joining_gap > 0.0 {
            lines.push((
                "gap that joins all",
                format!("{} {unit}", rounded_up(self.joining_gap)),
            ));
        }
        lines
    }

    /// Says that bonds would not hold the spheres together, with the ways out that the flags leave open.
    pub(crate) fn warning(&self, arguments: &Arguments, smallest_radius: f64) -> Option<String> {
        if self.pieces == 1 {
            return None;
        }
        let unit = self.unit;
        let gap = rounded_up(self.joining_gap);
        let widest = widest_gap(smallest_radius) / unit.in_metres();
        let by_gap = gap.parse().is_ok_and(|gap: f64| gap <= widest).then(|| {
            format!(
                "a gap of {gap} {unit} joins all (--bond-gap {gap}{unit}, in a scene largest_gap of model.bonds)"
            )
        });
        let ways: Vec<String> = by_gap
            .into_iter()
            .chain([self.by_spheres(arguments)])
            .collect();
        Some(format!(
            "{} spheres lie in {} loose pieces: a rigid body holds them together, bonds do not; {}",
            self.spheres,
            self.pieces,
            ways.join("; or ")
        ))
    }

    /// Which other spheres may be one piece.
    fn by_spheres(&self, arguments: &Arguments) -> String {
        let n = self.spheres;
        if arguments.spheres.is_some() {
            // They were placed elsewhere: no flag changes them.
            return "place spheres between the pieces".to_owned();
        }
        match arguments.method {
            MethodName::Pack | MethodName::Lattice | MethodName::Favier => {
                "take spheres that follow the surface and overlap (--method surface or smooth)"
                    .to_owned()
            }
            MethodName::DistanceTransform if arguments.count.is_none() => {
                "take more and smaller spheres (a smaller --radius)".to_owned()
            }
            _ if arguments.max_spheres.is_some() => {
                format!("take more spheres (--max-spheres above {n})")
            }
            _ => format!("take more spheres (--count above {n})"),
        }
    }
}

/// Largest gap that may be bonded, m: through a wider one another sphere might lie between.
fn widest_gap(smallest_radius: f64) -> f64 {
    2.0 * smallest_radius
}

/// A positive length with four digits, the last rounded up, so that a gap of this length is enough.
fn rounded_up(length: f64) -> String {
    let last = 10.0_f64.powf(length.log10().floor() - 3.0);
    significant((length / last).ceil() * last, 4)
}

/// The largest gap in contact as the user gives it, m.
///
/// # Errors
///
/// No length; one so large that it would bond spheres between which another has room.
pub(crate) fn bond_gap(arguments: &Arguments, smallest_radius: f64) -> anyhow::Result<Option<f64>> {
    let Some(text) = arguments.bond_gap.as_deref() else {
        return Ok(None);
    };
    let gap = crate::arguments::length_in_metres("bond-gap", text, arguments.unit)?;
    let metre = arguments.unit.in_metres();
    anyhow::ensure!(
        gap <= widest_gap(smallest_radius),
        "--bond-gap {text}: it must be at most the diameter of the smallest sphere, {} {}, or spheres were bonded \
         through others",
        significant(widest_gap(smallest_radius) / metre, 4),
        arguments.unit
    );
    Ok(Some(gap))
}

/// The bonds as CSV: numbers of the spheres from 0 in their order in `--out`, lengths in the unit of the mesh.
pub(crate) fn bond_table(filling: &Filling, found: &Connectivity, unit: LengthUnit) -> String {
    let metre = unit.in_metres();
    let mut text = format!(
        "sphere_i,sphere_j,distance_{unit},gap_{unit},neck_radius_{unit},radius_i_{unit},radius_j_{unit}\n"
    );
    for SpherePair {
        spheres: [i, j],
        distance,
        gap,
        neck_radius,
    } in &found.pairs
    {
        let radius = |k: usize| filling.spheres[k].radius;
        let lengths = [*distance, *gap, *neck_radius, radius(*i), radius(*j)];
        let [distance, gap, neck, first, second] = lengths.map(|length| length / metre);
        writeln!(text, "{i},{j},{distance},{gap},{neck},{first},{second}")
            .expect("a string takes all text");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::Connections;
    use crate::arguments::Arguments;
    use clap::Parser as _;
    use geometry::clump::Sphere;
    use nalgebra::Vector3;
    use sphere_fill::Connectivity;

    /// Message about two balls of 1 mm, some mm apart, after a command line.
    fn said(gap: f64, words: &str) -> String {
        let words = format!("seedfill mesh.stl {words}");
        let arguments = Arguments::try_parse_from(words.split(' ')).unwrap();
        let balls = [0.0, 2.0 + gap].map(|x| Sphere {
            centre: Vector3::new(1e-3 * x, 0.0, 0.0),
            radius: 1e-3,
        });
        let found = Connectivity::new(&balls, None);
        let connections = Connections::new(&found, 2, arguments.unit);
        connections.warning(&arguments, 1e-3).unwrap()
    }

    /// No way out repeats the method in use or names a flag that does not go with those given.
    #[test]
    fn advice_on_loose_pieces_goes_with_the_flags_given() {
        for (words, way) in [
            ("--radius 1", "(--method surface or smooth)"),
            (
                "--radius 1 --method lattice",
                "(--method surface or smooth)",
            ),
            ("--radius 1 --method favier", "(--method surface or smooth)"),
            ("--radius 1 --method surface", "(--count above 2)"),
            ("--radius 1 --method smooth --count 2", "(--count above 2)"),
            ("--radius 1 --method ferellec", "(--count above 2)"),
            (
                "--radius 1 --method surface --max-spheres 2",
                "(--max-spheres above 2)",
            ),
            (
                "--radius 1 --method distance-transform",
                "(a smaller --radius)",
            ),
            (
                "--radius 1 --method distance-transform --count 2",
                "(--count above 2)",
            ),
            ("--spheres given.csv", "place spheres between the pieces"),
        ] {
            let said = said(0.5, words);
            let gap = "(--bond-gap 0.5000mm, in a scene largest_gap of model.bonds); or ";
            let (_, rest) = said.split_once(gap).expect(&said);
            assert!(rest.ends_with(way), "{words}: {said}");
            let ways = ["--method", "--count", "--max-spheres", "--radius"];
            let named = ways.iter().filter(|flag| rest.contains(*flag)).count();
            assert!(named <= 1, "{words}: {said}");
        }
    }

    /// A gap wider than a sphere is refused by `--bond-gap`, and so not proposed.
    #[test]
    fn a_gap_is_proposed_only_if_it_may_be_bonded() {
        assert!(said(1.999, "--radius 1").contains("--bond-gap 1.999mm"));
        let said = said(2.001, "--radius 1");
        assert!(
            !said.contains("--bond-gap") && said.contains("--method surface"),
            "{said}"
        );
    }
}
