//! A body type, prepared for the contact search.

use crate::lanes::{LANES, Lanes};
use geometry::clump::Clump;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Cells from the centre of mass to the farthest sphere centre, in which centres are stored in
/// the lists of candidates: half the memory of single precision, and a sixteenth of a micrometre
/// for a grain of 4 mm.
pub(crate) const CELLS: f64 = 32767.0;

/// Which mass enters the dashpots of a contact between two agglomerates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DashpotMass {
    /// The mass of the touching sphere, as in a bonded agglomerate, where each sphere is a
    /// particle of its own (the study's model).
    Sphere,
    /// The mass of the whole body, so that the rebound of a body that touches with one sphere follows
    /// the coefficient.
    Body,
    /// The mass that a push at the point of contact moves, shared by all spheres with which the body touches the same body or
    /// wall: the coefficient of restitution holds at the contact, whatever the orientation and the number of spheres.
    Shared,
}

/// A body type.
#[derive(Debug, Clone)]
pub struct Template {
    /// Reachable spheres.
    pub(crate) spheres: Vec<OuterSphere>,
    /// Centres of the same spheres, in cells.
    pub(crate) cells: Vec<[i16; 3]>,
    /// Size of a cell, m.
    pub(crate) cell: f64,
    /// The same spheres in single precision.
    pub(crate) packed: Packed,
    /// Share of the damping of the whole body in the dashpots of its spheres, 0 to 1.
    pub(crate) whole_damping: f64,
    /// Whether the body is one sphere about its centre of mass with one moment of inertia about all axes:
    /// neither where it touches nor how it moves depends on how it is turned.
    pub(crate) is_sphere: bool,
    /// Mass, kg.
    pub(crate) mass: f64,
    /// Principal moments of inertia, kg m².
    pub(crate) inertia: Vector3<f64>,
    /// Inverse of the mass, 1/kg.
    pub(crate) inverse_mass: f64,
    /// Inverses of the moments, 1/(kg m²).
    pub(crate) inverse_inertia: Vector3<f64>,
    /// Radius of the bounding sphere about the centre of mass, m.
    pub(crate) bounding_radius: f64,
    /// Largest distance of a sphere's centre from the centre of mass, m: what a turn can move, for spheres touch by
    /// their centres and radii.
    pub(crate) arm: f64,
    /// Index of the material in the world's table.
    pub(crate) material: usize,
    /// Volume of liquid that a body carries, m³.
    pub(crate) liquid: f64,
}

/// A sphere that other bodies can touch.
#[derive(Debug, Clone, Copy)]
pub(crate) struct OuterSphere {
    /// Centre in the principal frame, m.
    pub(crate) centre: Vector3<f64>,
    /// Radius, m.
    pub(crate) radius: f64,
    /// Mass that it brings into a dashpot, kg.
    pub(crate) dashpot_mass: f64,
}

/// Copy of the spheres in single precision for the vectorised search.
#[derive(Debug, Clone, Default)]
pub(crate) struct Packed {
    /// Spheres in groups that lie together, padded to whole groups by spheres of radius minus infinity.
    pub(crate) groups: Vec<Group>,
    /// x, y, z of the centre and radius of each sphere in their order, m.
    pub(crate) spheres: Vec<[f32; 4]>,
    /// Largest radius, m.
    pub(crate) largest: f32,
    /// Lower corner of the box that holds all spheres, m.
    pub(crate) low: [f32; 3],
    /// Upper corner, m.
    pub(crate) high: [f32; 3],
}

/// Sixteen spheres side by side.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Group {
    /// x, y, z of the centres, m.
    pub(crate) centre: [Lanes; 3],
    /// Radii, m.
    pub(crate) radius: Lanes,
    /// Places of the spheres in their order.
    pub(crate) index: [u32; LANES],
}

impl Template {
    /// Prepares a body type of material number `material`.
    ///
    /// The contact search leaves out what [`Clump::without_hidden_spheres`] does; mass and inertia keep it.
    pub fn new(clump: &Clump, material: usize, dashpot_mass: DashpotMass) -> Self {
        let outer = clump.without_hidden_spheres();
        let total: f64 = clump.spheres().iter().map(|s| s.radius.powi(3)).sum();
        let dashpot = |radius: f64| match dashpot_mass {
            DashpotMass::Sphere => clump.mass() * radius.powi(3) / total,
            DashpotMass::Body | DashpotMass::Shared => clump.mass(),
        };
        let spheres: Vec<_> = outer
            .spheres()
            .iter()
            .map(|sphere| OuterSphere {
                centre: sphere.centre,
                radius: sphere.radius,
                dashpot_mass: dashpot(sphere.radius),
            })
            .collect();
        // Cells need not be finer than those of a body as large as one sphere. A sphere in the centre of
        // its body would otherwise have cells near the least number of single precision, with which
        // arithmetic is slow.
        let extents = spheres.iter().map(|sphere| sphere.centre.amax());
        let arms = spheres.iter().map(|sphere| sphere.centre.norm());
        let cell = extents.fold(clump.smallest_radius(), f64::max) / CELLS;
        Self {
            packed: Packed::new(&spheres),
            cells: spheres.iter().map(|s| in_cells(&s.centre, cell)).collect(),
            arm: arms.fold(0.0, f64::max),
            whole_damping: f64::from(u8::from(dashpot_mass == DashpotMass::Shared)),
            is_sphere: matches!(&spheres[..], [only] if only.centre == Vector3::zeros())
                && is_isotropic(&clump.inertia()),
            spheres,
            cell,
            mass: clump.mass(),
            inertia: clump.inertia(),
            inverse_mass: 1.0 / clump.mass(),
            inverse_inertia: clump.inertia().map(|moment| 1.0 / moment),
            bounding_radius: clump.bounding_radius(),
            material,
            liquid: 0.0,
        }
    }

    /// The body type with a share of the damping of the whole body in the dashpots of its spheres, 0 to 1: 0 for what
    /// [`DashpotMass::Sphere`] or [`DashpotMass::Body`] says, 1 for [`DashpotMass::Shared`].
    #[must_use]
    pub fn with_whole_damping(self, share: f64) -> Self {
        Self {
            whole_damping: share,
            ..self
        }
    }

    /// The body type with a volume of liquid on each body (m³), which its bridges share.
    #[must_use]
    pub fn with_liquid(self, volume: f64) -> Self {
        Self {
            liquid: volume,
            ..self
        }
    }

    /// Volume of liquid on each body, m³.
    pub fn liquid(&self) -> f64 {
        self.liquid
    }

    /// Mass, kg.
    pub fn mass(&self) -> f64 {
        self.mass
    }

    /// Number of spheres that take part in the contact search.
    pub fn n_outer_spheres(&self) -> usize {
        self.spheres.len()
    }

    /// Radius of the bounding sphere about the centre of mass, m.
    pub fn bounding_radius(&self) -> f64 {
        self.bounding_radius
    }

    /// Smallest radius of the spheres that take part in the contact search, m.
    pub fn smallest_radius(&self) -> f64 {
        self.spheres
            .iter()
            .map(|sphere| sphere.radius)
            .fold(f64::INFINITY, f64::min)
    }

    /// Whether two of the spheres that take part in the contact search overlap by more than a twentieth of the radius of the
    /// smaller one: then many of them are nearly in touch with whatever touches the body.
    pub fn overlaps(&self) -> bool {
        let spheres = &self.spheres;
        spheres.iter().enumerate().any(|(i, a)| {
            spheres[..i].iter().any(|b| {
                let overlap = a.radius + b.radius - (a.centre - b.centre).norm();
                overlap > 0.05 * a.radius.min(b.radius)
            })
        })
    }
}

/// Whether three moments of inertia are one but for rounding.
fn is_isotropic(inertia: &Vector3<f64>) -> bool {
    inertia.max() - inertia.min() <= 1e-12 * inertia.max()
}

/// A centre in cells (m), to the nearest.
#[expect(
    clippy::cast_possible_truncation,
    reason = "no coordinate is beyond the farthest, which is 32767 cells away"
)]
fn in_cells(centre: &Vector3<f64>, cell: f64) -> [i16; 3] {
    [0, 1, 2].map(|axis| (centre[axis] / cell).round() as i16)
}

impl Packed {
    /// Copies centres and radii.
    #[expect(
        clippy::cast_possible_truncation,
        reason = "rounding to single precision is meant"
    )]
    pub(crate) fn new(spheres: &[OuterSphere]) -> Self {
        let bound = |axis: usize, sign: f64| {
            let reaches = spheres.iter().map(|s| sign * s.centre[axis] + s.radius);
            (sign * reaches.fold(f64::NEG_INFINITY, f64::max)) as f32
        };
        let mut order: Vec<usize> = (0..spheres.len()).collect();
        put_together(&mut order, spheres);
        let group = |members: &[usize]| {
            let mut group = Group {
                radius: [f32::NEG_INFINITY; LANES],
                ..Group::default()
            };
            for (l, &member) in members.iter().enumerate() {
                for axis in 0..3 {
                    group.centre[axis][l] = spheres[member].centre[axis] as f32;
                }
                group.radius[l] = spheres[member].radius as f32;
                group.index[l] = u32::try_from(member).unwrap_or(u32::MAX);
            }
            group
        };
        let single = |s: &OuterSphere| [s.centre.x, s.centre.y, s.centre.z, s.radius];
        Self {
            groups: order.chunks(LANES).map(group).collect(),
            spheres: spheres
                .iter()
                .map(|s| single(s).map(|x| x as f32))
                .collect(),
            largest: spheres.iter().map(|s| s.radius).fold(0.0, f64::max) as f32,
            low: [bound(0, -1.0), bound(1, -1.0), bound(2, -1.0)],
            high: [bound(0, 1.0), bound(1, 1.0), bound(2, 1.0)],
        }
    }
}

/// Orders spheres so that each group of sixteen lies together: cuts across the longest side of what is left, with
/// whole groups on the one side.
fn put_together(order: &mut [usize], spheres: &[OuterSphere]) {
    if order.len() <= LANES {
        return;
    }
    let along = |axis: usize, k: usize| spheres[k].centre[axis];
    let extent = |axis: usize| {
        let of = |pick: fn(f64, f64) -> f64, start| {
            let all = order.iter().map(|&k| along(axis, k));
            all.fold(start, pick)
        };
        of(f64::max, f64::NEG_INFINITY) - of(f64::min, f64::INFINITY)
    };
    let longest = (1..3).fold(0, |best, axis| {
        if extent(axis) > extent(best) {
            axis
        } else {
            best
        }
    });
    let by_place = |a: &usize, b: &usize| {
        let places = [*a, *b].map(|k| along(longest, k));
        places[0].total_cmp(&places[1]).then(a.cmp(b))
    };
    order.sort_unstable_by(by_place);
    let middle = (order.len().div_ceil(LANES) / 2) * LANES;
    let (low, high) = order.split_at_mut(middle);
    put_together(low, spheres);
    put_together(high, spheres);
}

#[cfg(test)]
mod tests {
    use super::{DashpotMass, OuterSphere, Packed, Template};
    use crate::Settings;
    use crate::lanes::LANES;
    use geometry::clump::{Clump, Sphere, properties_of_spheres};
    use nalgebra::Vector3;

    /// Two rods of 32 and 47 spheres, far apart and in a mixed order, are cut into pieces of sixteen
    /// neighbours: spheres at a distance of 1 on one rod, within 15.
    #[test]
    fn groups_hold_neighbours_and_every_sphere_once() {
        let rod = |x: f64, n: u32| {
            (0..n).map(move |k| OuterSphere {
                centre: Vector3::new(x, f64::from(k * 23 % n), 0.0),
                radius: 1.0,
                dashpot_mass: 1.0,
            })
        };
        let spheres: Vec<_> = rod(0.0, 32).chain(rod(100.0, 47)).collect();
        let packed = Packed::new(&spheres);
        let mut seen = Vec::new();
        for group in &packed.groups {
            let used = (0..LANES).filter(|&l| group.radius[l] > 0.0);
            let (mut low, mut high) = (f32::INFINITY, f32::NEG_INFINITY);
            for l in used {
                let place = group.centre[0][l] + group.centre[1][l];
                let sphere = packed.spheres[group.index[l] as usize];
                assert!(
                    place.to_bits() == (sphere[0] + sphere[1]).to_bits(),
                    "index of sphere at {place}"
                );
                (low, high) = (low.min(place), high.max(place));
                seen.push(group.index[l]);
            }
            assert!(high - low <= 15.0, "a group from {low} to {high}");
        }
        seen.sort_unstable();
        assert!(seen.iter().copied().eq(0..79), "{seen:?}");
    }

    /// Two spheres that overlap by less than a twentieth of the radius are separate, and lists of them are wide; those that overlap by
    /// more have narrow ones. The margin is a part of the body's own size where its spheres are large.
    #[test]
    fn lists_of_overlapping_spheres_are_narrow() {
        let pair = |distance: f64| {
            let spheres = [-0.5, 0.5].map(|x| Sphere {
                centre: Vector3::new(x * distance, 0.0, 0.0),
                radius: 1e-3,
            });
            let clump = Clump::new(&spheres, &properties_of_spheres(&spheres, 1000.0)).unwrap();
            Template::new(&clump, 0, DashpotMass::Sphere)
        };
        for (distance, skin) in [(1.96e-3, 0.7e-3), (1.94e-3, 0.1e-3)] {
            let template = pair(distance);
            let reach = template.bounding_radius();
            let settings = Settings::for_templates(1e-6, Vector3::zeros(), &[template]);
            assert!(
                (settings.skin - skin).abs() < 1e-12,
                "{distance}: {settings:?}"
            );
            assert!((settings.margin - 0.5 * reach).abs() < 1e-12);
        }
    }
}
