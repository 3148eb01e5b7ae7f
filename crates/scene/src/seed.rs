//! One kind of seed: its shape, its mass, and how many there are.

use crate::{Error, Scene, SizeSettings};
use geometry::clump::files::read_spheres;
use geometry::clump::{DENSITIES, Sphere};
use input::quantity::{Density, Length, Mass, significant};
use serde::{Deserialize, Serialize};
use sphere_fill::union_moments;
use std::f64::consts::FRAC_PI_6;
use std::path::{Path, PathBuf};
use trimesh::LengthUnit;

/// Share of the volume of a poured bed that its seeds take, where a scene states none: our choice. Beds of
/// spheres reach from 0.55 (loosest random) to 0.64 (densest random); `solid_fraction` states another.
pub const SOLID_FRACTION: f64 = 0.6;

/// Sizes (m) of seeds for which a table of spheres without a unit is one in mm: our choice, from fine seeds to cobs. In metres
/// the numbers would be a thousand times smaller.
const GUESSED_SIZES: std::ops::RangeInclusive<f64> = 1e-4..=0.1;

/// Sizes of a seed, m: those of `sphere` and `ellipsoid`.
const SIZES: std::ops::RangeInclusive<f64> = 1e-6..=1.0;

/// Largest volume of the seeds over that of the apparatus, above which no fill level is possible.
const FULLEST: f64 = 1.0;

/// One kind of seed: exactly one of `mesh`, `sphere`, `ellipsoid`, `spheres` and `sizes`, one of `mass` and `density`, one of
/// `count`, `total_mass` and `fill_level`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SeedSettings {
    /// Name.
    pub name: String,
    /// Mesh of the seed (STL, OBJ, PLY), relative to the scene file; with `mesh_unit` and `filling`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mesh: Option<PathBuf>,
    /// Unit of the mesh.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mesh_unit: Option<trimesh::LengthUnit>,
    /// Diameter of a seed that is one sphere.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sphere: Option<Length>,
    /// Full axes of a seed that is an ellipsoid; filled as [`FillingSettings::of_ellipsoid`] says where
    /// `filling` is absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ellipsoid: Option<[Length; 3]>,
    /// Table of the spheres of a seed, x, y, z and radius, relative to the scene file: the seed is these spheres as they are, and
    /// its volume that of their union.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spheres: Option<PathBuf>,
    /// Unit of that table; mm if omitted, if the seed is then 0.1 to 100 mm long.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spheres_unit: Option<trimesh::LengthUnit>,
    /// Diameters of spheres of several sizes; when the scene is read, each class becomes a kind of its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sizes: Option<SizeSettings>,
    /// Mass of one seed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mass: Option<Mass>,
    /// Density of the seed: with its volume it gives the mass.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub density: Option<Density>,
    /// Number of seeds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub count: Option<usize>,
    /// Mass of all seeds of the kind.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub total_mass: Option<Mass>,
    /// Share of the volume of the apparatus that the settled bed of this kind takes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fill_level: Option<f64>,
    /// Share of the volume of the settled bed that the seeds take, for `fill_level`; [`SOLID_FRACTION`]
    /// if omitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub solid_fraction: Option<f64>,
    /// Name of the material.
    pub material: String,
    /// Size of the seed over that of its shape; the filling, stated for the shape, grows with it. A stated mass
    /// stays; a stated density stays, so that the mass grows. 1 if omitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<f64>,
    /// How mesh or ellipsoid are filled with spheres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub filling: Option<FillingSettings>,
    /// Volume of the mesh, or of the union of the spheres of the table, m³.
    #[serde(skip)]
    pub(crate) file_volume: Option<f64>,
}

/// How a mesh is filled with spheres.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FillingSettings {
    /// Method.
    pub method: sphere_fill::Method,
    /// Radius of the spheres (smallest radius for method smooth).
    pub sphere_radius: Length,
    /// Number of spheres; as many as fit if omitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sphere_count: Option<usize>,
    /// Surface roughness at which method smooth stops.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub roughness: Option<Length>,
    /// Seed of the packing.
    pub seed: u64,
}

/// Smallest radius of the spheres of an ellipsoid over its shortest semi-axis.
const ELLIPSOID_RADIUS: f64 = 0.25;
const ELLIPSOID_SPHERES: usize = 20;

impl FillingSettings {
    /// The filling of an ellipsoid of these full axes that states none: 20 overlapping spheres with the volume of
    /// the ellipsoid, the smallest of a quarter of the shortest semi-axis. They lie about its surface with a root
    /// mean square of some 1 % of the shortest semi-axis (8 by 6 by 5 mm), and of 6 % where it is as flat as 10
    /// by 6 by 3 mm.
    ///
    /// # Errors
    ///
    /// Axes that are not finite.
    pub fn of_ellipsoid(axes: [Length; 3]) -> Result<Self, input::quantity::Error> {
        let axes = axes.map(Length::si).into_iter();
        let shortest = 0.5 * axes.fold(f64::INFINITY, f64::min);
        Ok(Self {
            method: sphere_fill::Method::Surface,
            sphere_radius: Length::from_si(ELLIPSOID_RADIUS * shortest)?,
            sphere_count: Some(ELLIPSOID_SPHERES),
            roughness: None,
            seed: 1,
        })
    }
}

impl SeedSettings {
    /// Volume of one seed, m³; `None` if the shape is a file that was not read.
    pub fn volume(&self) -> Option<f64> {
        let axes = match (self.sphere, self.ellipsoid) {
            (Some(diameter), _) => Some([diameter; 3]),
            (None, axes) => axes,
        };
        let closed_form = axes.map(|axes| FRAC_PI_6 * axes.map(Length::si).iter().product::<f64>());
        let volume = closed_form.or(self.file_volume)?;
        Some(volume * self.scale.unwrap_or(1.0).powi(3))
    }

    /// Mass of one seed, kg; 0 if it is not stated, which [`Scene::check`] refuses.
    pub fn mass_kg(&self) -> f64 {
        let by_density = || Some(self.density?.si() * self.volume()?);
        self.mass.map(Mass::si).or_else(by_density).unwrap_or(0.0)
    }

    /// Density of the seed, kg/m³, stated or by its mass and volume; `None` if one of these is unknown.
    ///
    /// # Formula
    ///
    /// `m / V`: V the volume of the shape, whatever spheres stand for it.
    pub fn density_kg_m3(&self) -> Option<f64> {
        let by_mass = || Some(self.mass?.si() / self.volume()?);
        self.density.map(Density::si).or_else(by_mass)
    }

    /// The file that holds its shape; none of a shape in closed form.
    pub(crate) fn shape_file(&self) -> Option<&Path> {
        self.mesh.as_deref().or(self.spheres.as_deref())
    }

    /// The spheres of its table, m; it must state one.
    ///
    /// # Errors
    ///
    /// A file that cannot be read or holds something else.
    pub(crate) fn listed_spheres(&self, folder: &Path) -> Result<Vec<Sphere>, Error> {
        let path = folder.join(self.spheres.as_deref().unwrap_or(Path::new("")));
        let text = input::file::read_text(&path).map_err(|source| Error::Read {
            path: path.clone(),
            source,
        })?;
        let unit = self.spheres_unit.unwrap_or(LengthUnit::Millimetre);
        read_spheres(&text, &path.display().to_string(), unit.in_metres()).map_err(|source| {
            Error::Spheres {
                seed: self.name.clone(),
                source,
            }
        })
    }

    /// States the mass of one seed.
    pub fn set_mass(&mut self, mass: Mass) {
        (self.mass, self.density) = (Some(mass), None);
    }

    /// Volume of the union of the spheres of its table, m³; a unit that is not stated is written down.
    ///
    /// # Errors
    ///
    /// A table that cannot be read, or whose unit is not clear.
    fn measured_list(&mut self, folder: &Path, file: &str) -> Result<f64, Error> {
        let spheres = self.listed_spheres(folder)?;
        let extent = |k: usize| {
            let high = spheres.iter().map(|s| s.centre[k] + s.radius);
            let low = spheres.iter().map(|s| s.centre[k] - s.radius);
            high.fold(f64::NEG_INFINITY, f64::max) - low.fold(f64::INFINITY, f64::min)
        };
        let size = (0..3).map(extent).fold(0.0, f64::max);
        let in_mm = significant(1e3 * size, 3);
        let refused = |problem: String| Error::SeedKeys {
            file: file.to_owned(),
            seed: self.name.clone(),
            problem,
        };
        if self.spheres_unit.is_none() && !GUESSED_SIZES.contains(&size) {
            return Err(refused(format!(
                "spheres is stated without spheres_unit, and in mm the seed would be {in_mm} mm long; state what one unit of \
                 the table is, such as \"m\""
            )));
        }
        if !SIZES.contains(&size) {
            return Err(refused(format!(
                "spheres in the unit stated are {in_mm} mm long together; a seed is 0.001 mm to 1 m: look at spheres_unit"
            )));
        }
        self.spheres_unit.get_or_insert(LengthUnit::Millimetre);
        Ok(union_moments(&spheres).volume)
    }

    /// States the number of seeds.
    pub fn set_count(&mut self, count: usize) {
        (self.count, self.total_mass) = (Some(count), None);
        (self.fill_level, self.solid_fraction) = (None, None);
    }

    /// How the seed is filled with spheres; `None` if it is one sphere.
    ///
    /// # Errors
    ///
    /// An ellipsoid whose axes are not finite.
    pub fn filling(&self) -> Result<Option<FillingSettings>, input::quantity::Error> {
        match (&self.filling, self.ellipsoid) {
            (Some(filling), _) => Ok(Some(filling.clone())),
            (None, Some(axes)) => FillingSettings::of_ellipsoid(axes).map(Some),
            (None, None) => Ok(None),
        }
    }

    /// Finds what its keys contradict or leave open.
    pub(crate) fn check(&self, scene: &Scene, found: &mut Vec<Error>) {
        let mut tell = |problem: String| {
            found.push(Error::SeedKeys {
                file: scene.file.clone(),
                seed: self.name.clone(),
                problem,
            });
        };
        let groups: [&[(&str, bool)]; 3] = [
            &[
                ("mesh", self.mesh.is_some()),
                ("sphere", self.sphere.is_some()),
                ("ellipsoid", self.ellipsoid.is_some()),
                ("spheres", self.spheres.is_some()),
            ],
            &[
                ("mass", self.mass.is_some()),
                ("density", self.density.is_some()),
            ],
            &[
                ("count", self.count.is_some()),
                ("total_mass", self.total_mass.is_some()),
                ("fill_level", self.fill_level.is_some()),
            ],
        ];
        for group in groups {
            let names = |all: bool| {
                let listed = group.iter().filter(|(_, stated)| all || *stated);
                listed.map(|(name, _)| *name).collect::<Vec<_>>()
            };
            let stated = names(false);
            // A bench test takes single seeds, however many are stated, and their number need not be.
            let may_lack = group[0].0 == "count" && scene.apparatus.is_bench_test();
            if stated.len() != 1 && !(stated.is_empty() && may_lack) {
                let which = if stated.is_empty() {
                    "none".to_owned()
                } else {
                    stated.join(" and ")
                };
                tell(format!(
                    "{which} of {} is stated; state exactly one of them",
                    names(true).join(", ")
                ));
            }
        }
        for problem in self.lone_keys() {
            tell(problem);
        }
        self.check_values(found);
    }

    /// Keys that need another one, or cannot stand beside it.
    fn lone_keys(&self) -> Vec<String> {
        let is_mesh = self.mesh.is_some();
        let mut problems = Vec::new();
        let mut tell = |wrong: bool, problem: &str| {
            if wrong {
                problems.push(problem.to_owned());
            }
        };
        tell(
            is_mesh && self.mesh_unit.is_none(),
            "mesh is stated without mesh_unit; state what one unit of the mesh is, such as \"mm\"",
        );
        tell(
            is_mesh && self.filling.is_none(),
            "mesh is stated without filling; state how it is filled with spheres",
        );
        tell(
            !is_mesh && self.mesh_unit.is_some(),
            "mesh_unit is stated without mesh; remove it",
        );
        tell(
            self.sphere.is_some() && self.filling.is_some(),
            "filling is stated beside sphere, which is one sphere already; remove it",
        );
        tell(
            self.spheres.is_some() && self.filling.is_some(),
            "filling is stated beside spheres, which are the seed as they are; remove it",
        );
        tell(
            self.spheres.is_none() && self.spheres_unit.is_some(),
            "spheres_unit is stated without spheres; remove it",
        );
        tell(
            self.solid_fraction.is_some() && self.fill_level.is_none(),
            "solid_fraction is stated without fill_level; remove it",
        );
        problems
    }

    /// Finds numbers out of range.
    fn check_values(&self, found: &mut Vec<Error>) {
        let mut require = |holds: bool, key: &str, value: String, requirement: &str| {
            if !holds {
                let name = format!("{key} of seed '{}'", self.name);
                found.push(crate::check::bad(&name, value, requirement));
            }
        };
        let axes = self
            .ellipsoid
            .iter()
            .flatten()
            .map(|axis| ("ellipsoid", axis));
        for (key, length) in self.sphere.iter().map(|d| ("sphere", d)).chain(axes) {
            let holds = SIZES.contains(&length.si());
            require(holds, key, length.to_string(), "0.001 mm to 1 m");
        }
        if let Some(filling) = &self.filling {
            let radius = filling.sphere_radius;
            let holds = radius.si() > 0.0;
            require(holds, "sphere_radius", radius.to_string(), "above 0");
        }
        for (key, share) in [
            ("fill_level", self.fill_level),
            ("solid_fraction", self.solid_fraction),
        ] {
            if let Some(share) = share {
                let holds = share > 0.0 && share <= FULLEST;
                require(holds, key, share.to_string(), "above 0, at most 1");
            }
        }
        if let Some(scale) = self.scale {
            let holds = (0.01..=100.0).contains(&scale);
            require(holds, "scale", scale.to_string(), "0.01 to 100");
        }
        if let Some(density) = self.density_kg_m3() {
            let derived = self.mass.zip(self.volume());
            let value = derived.map_or_else(
                || format!("{density} kg/m3"),
                |(mass, volume)| {
                    let (mg, mm3) = (1e6 * mass.si(), 1e9 * volume);
                    let [density, mg, mm3] = [density, mg, mm3].map(|v| significant(v, 4));
                    format!("{density} kg/m3 (mass {mg} mg over volume {mm3} mm3)")
                },
            );
            let (least, most) = (DENSITIES.start(), DENSITIES.end());
            let requirement = format!("{least} to {most} kg/m3; mind the units of mass and size");
            require(DENSITIES.contains(&density), "density", value, &requirement);
        }
    }
}

impl Scene {
    /// Share of the volume of the apparatus that the seeds themselves take, without the voids between them; none in a bench
    /// test, or if a volume is not known without the mesh.
    pub fn solid_share(&self) -> Option<f64> {
        let volume = |kind: &SeedSettings| Some(self.count_of(kind) as f64 * kind.volume()?);
        let all: Option<Vec<f64>> = self.seed.iter().map(volume).collect();
        Some(all?.iter().sum::<f64>() / self.apparatus.bed_volume()?)
    }

    /// Number of seeds of a kind, whichever of its keys states it; rounded to the nearest. 1 in a bench test that
    /// states none.
    pub fn count_of(&self, kind: &SeedSettings) -> usize {
        let by_mass = || Some(kind.total_mass?.si() / kind.mass_kg());
        let by_level = || {
            let bed = kind.fill_level? * self.apparatus.bed_volume()?;
            Some(bed * kind.solid_fraction.unwrap_or(SOLID_FRACTION) / kind.volume()?)
        };
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "positive, and a cast saturates"
        )]
        let whole = |number: f64| {
            if number.is_finite() {
                number.round() as usize
            } else {
                0
            }
        };
        let unstated = usize::from(self.apparatus.is_bench_test());
        let derived = || by_mass().or_else(by_level).map_or(unstated, whole);
        kind.count.unwrap_or_else(derived)
    }

    /// Kinds of seeds as people read them: `380 pea (147 mg, 1300 kg/m3)`; without a number if single seeds are
    /// tested, without a density if the volume is unknown.
    pub fn seeds_in_words(&self) -> String {
        let words = |kind: &SeedSettings| {
            let number = if self.apparatus.is_bench_test() {
                String::new()
            } else {
                format!("{} ", self.count_of(kind))
            };
            let mass = significant(1e6 * kind.mass_kg(), 4);
            let density = kind.density_kg_m3().map_or_else(String::new, |density| {
                format!(", {} kg/m3", significant(density, 4))
            });
            format!("{number}{} ({mass} mg{density})", kind.name)
        };
        self.seed.iter().map(words).collect::<Vec<_>>().join(", ")
    }

    /// States masses and numbers of the seeds as they are now, where they follow from density, total mass or fill
    /// level: a later change of size or apparatus leaves them alone.
    pub fn fix_seeds(&mut self) {
        let counts: Vec<usize> = self.seed.iter().map(|kind| self.count_of(kind)).collect();
        for (kind, count) in self.seed.iter_mut().zip(counts) {
            kind.set_count(count);
            if let Ok(mass) = Mass::from_si(kind.mass_kg()) {
                kind.set_mass(mass);
            }
        }
    }

    /// Makes the seeds `factor` times as large: of the same shape and density, and so many fewer that the mass of each kind stays, to half
    /// a seed.
    pub fn coarsen_seeds(&mut self, factor: f64) {
        self.fix_seeds();
        for kind in &mut self.seed {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "positive, and a cast saturates"
            )]
            let count = (kind.count.unwrap_or(1) as f64 / factor.powi(3)).round() as usize;
            kind.set_count(count.max(1));
            kind.scale = Some(kind.scale.unwrap_or(1.0) * factor);
            if let Ok(mass) = Mass::from_si(kind.mass_kg() * factor.powi(3)) {
                kind.set_mass(mass);
            }
        }
    }

    /// Writes down the defaults of the seeds and the volumes of the shapes in files; those of `known` seeds are taken over.
    ///
    /// # Errors
    ///
    /// A mesh that cannot be read or is not closed, a table of spheres that cannot be read or whose unit is not clear.
    pub(crate) fn complete_seeds(&mut self, known: &[SeedSettings]) -> Result<(), Error> {
        for kind in &mut self.seed {
            if kind.fill_level.is_some() && kind.solid_fraction.is_none() {
                kind.solid_fraction = Some(SOLID_FRACTION);
            }
            let same = |other: &&SeedSettings| {
                (&other.mesh, other.mesh_unit) == (&kind.mesh, kind.mesh_unit)
                    && (&other.spheres, other.spheres_unit) == (&kind.spheres, kind.spheres_unit)
            };
            let before = known.iter().find(same).and_then(|other| other.file_volume);
            if kind.spheres.is_some() {
                kind.file_volume = Some(match before {
                    Some(volume) => volume,
                    None => kind.measured_list(&self.folder, &self.file)?,
                });
                continue;
            }
            let (Some(mesh), Some(unit)) = (&kind.mesh, kind.mesh_unit) else {
                continue;
            };
            let read = || {
                let read = trimesh::read_mesh(&self.folder.join(mesh), unit)?.mesh;
                read.require_closed()?;
                Ok(read.moments().volume)
            };
            let refused = |source| Error::Mesh {
                seed: kind.name.clone(),
                source,
            };
            kind.file_volume = Some(before.map_or_else(read, Ok).map_err(refused)?);
        }
        Ok(())
    }
}
