//! Seeds of several sizes: an entry with a distribution of diameters becomes one kind of sphere for each class.

use crate::{Error, SOLID_FRACTION, Scene, SeedSettings};
use input::quantity::{Length, significant};
use probability::normal_cdf;
use serde::{Deserialize, Serialize};
use std::f64::consts::FRAC_PI_6;

/// Classes of a distribution that states no number: our choice.
const CLASSES: usize = 7;
/// Most classes.
const MOST_CLASSES: usize = 50;
/// Where a normal distribution is cut if nothing is stated, in standard deviations from the mean.
const CUT: f64 = 2.0;
/// Largest diameter over the smallest: the smallest sets the time step and the largest the cells of the contact search, so that
/// wider distributions cost more than a thousand times as much.
const WIDEST: f64 = 10.0;
/// Share of the mass from which a class that gets no seed is missed.
const MISSED: f64 = 0.01;

/// A distribution of diameters: exactly one of `uniform`, `normal` and `sieves`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SizeSettings {
    /// Smallest and largest diameter, all diameters between them equally frequent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub uniform: Option<[Length; 2]>,
    /// Mean and standard deviation of the diameter, by number.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub normal: Option<[Length; 2]>,
    /// Where the normal distribution is cut, in standard deviations from the mean; 2 if omitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cut: Option<f64>,
    /// Fractions between two sieves, by mass: lower and upper opening, share of the mass. Shares may have any sum.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sieves: Option<Vec<(Length, Length, f64)>>,
    /// Number of classes of `uniform` and `normal`; 7 if omitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub classes: Option<usize>,
}

/// A class: diameter (m) and share of the number of seeds.
type Class = [f64; 2];

impl SizeSettings {
    /// Diameters (m) and shares of the number.
    ///
    /// # Formula
    ///
    /// Classes of equal width, each as its middle; of a fraction between two sieves the geometric mean of the openings, so that its share
    /// of the number goes with share of the mass over diameter cubed.
    fn classes(&self) -> Result<Vec<Class>, String> {
        let stated = [
            self.uniform.is_some(),
            self.normal.is_some(),
            self.sieves.is_some(),
        ];
        if stated.iter().filter(|is| **is).count() != 1 {
            return Err("sizes needs exactly one of uniform, normal and sieves".into());
        }
        if self.cut.is_some() && self.normal.is_none() {
            return Err("sizes.cut is stated without normal; remove it".into());
        }
        if self.classes.is_some() && self.sieves.is_some() {
            return Err(
                "sizes.classes is stated beside sieves, each of which is one class; remove it"
                    .into(),
            );
        }
        let n = self.classes.unwrap_or(CLASSES);
        if !(2..=MOST_CLASSES).contains(&n) {
            return Err(format!("sizes.classes = {n}: state 2 to {MOST_CLASSES}"));
        }
        let classes = if let Some([low, high]) = self.uniform {
            ordered("uniform", low, high)?;
            of_range([low.si(), high.si()], n, |_, _| 1.0)
        } else if let Some([mean, sd]) = self.normal {
            self.of_normal(mean, sd, n)?
        } else {
            of_sieves(self.sieves.as_deref().unwrap_or_default())?
        };
        let sum: f64 = classes.iter().map(|c| c[1]).sum();
        Ok(classes.into_iter().map(|[d, w]| [d, w / sum]).collect())
    }

    fn of_normal(&self, mean: Length, sd: Length, n: usize) -> Result<Vec<Class>, String> {
        let cut = self.cut.unwrap_or(CUT);
        if sd.si() <= 0.0 {
            return Err(format!(
                "sizes.normal: the standard deviation {sd} must be above 0"
            ));
        }
        if !(cut > 0.0 && cut <= 5.0) {
            return Err(format!(
                "sizes.cut = {cut}: state more than 0 and at most 5 standard deviations"
            ));
        }
        let ends = [-1.0, 1.0].map(|side| mean.si() + side * cut * sd.si());
        if ends[0] <= 0.0 {
            return Err(format!(
                "sizes.normal reaches down to {} mm: no seed is so small; state a smaller standard deviation or a smaller cut",
                significant(1e3 * ends[0], 3)
            ));
        }
        let share = |low: f64, high: f64| {
            let z = |d: f64| (d - mean.si()) / sd.si();
            normal_cdf(z(high)) - normal_cdf(z(low))
        };
        Ok(of_range(ends, n, share))
    }
}

/// Refuses ends of a range that are not positive and rising.
fn ordered(key: &str, low: Length, high: Length) -> Result<(), String> {
    if low.si() > 0.0 && low.si() < high.si() {
        return Ok(());
    }
    Err(format!(
        "sizes.{key} from {low} to {high}: the smaller diameter comes first, and both are above 0"
    ))
}

/// Classes of equal width, each with the weight of its range.
fn of_range([low, high]: [f64; 2], n: usize, weight: impl Fn(f64, f64) -> f64) -> Vec<Class> {
    let width = (high - low) / n as f64;
    let class = |k: usize| {
        let from = low + width * k as f64;
        [from + 0.5 * width, weight(from, from + width)]
    };
    (0..n).map(class).collect()
}

/// Classes of fractions between sieves.
fn of_sieves(sieves: &[(Length, Length, f64)]) -> Result<Vec<Class>, String> {
    if sieves.is_empty() || sieves.len() > MOST_CLASSES {
        let n = sieves.len();
        return Err(format!(
            "sizes.sieves has {n} fractions: state 1 to {MOST_CLASSES}"
        ));
    }
    let mut classes = Vec::new();
    for (low, high, share) in sieves {
        ordered("sieves", *low, *high)?;
        if !(share.is_finite() && *share > 0.0) {
            return Err(format!(
                "sizes.sieves: the share {share} between {low} and {high} must be above 0; leave out what is empty"
            ));
        }
        let diameter = (low.si() * high.si()).sqrt();
        classes.push([diameter, share / diameter.powi(3)]);
    }
    Ok(classes)
}

/// Whole numbers with a sum, nearest to shares of it: what is left goes to the largest remainders.
fn whole(shares: &[f64], sum: usize) -> Vec<usize> {
    let exact: Vec<f64> = shares.iter().map(|share| share * sum as f64).collect();
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "shares of a number of seeds"
    )]
    let mut counts: Vec<usize> = exact.iter().map(|x| x.floor() as usize).collect();
    let mut order: Vec<usize> = (0..shares.len()).collect();
    order.sort_by(|a, b| exact[*b].fract().total_cmp(&exact[*a].fract()));
    let left = sum.saturating_sub(counts.iter().sum());
    for k in order.into_iter().take(left) {
        counts[k] += 1;
    }
    counts
}

impl Scene {
    /// Writes each seed with a distribution of sizes as a kind of its own for each class, `pea 1 of 7` and so on: from then on these are
    /// kinds like others.
    ///
    /// # Errors
    ///
    /// A distribution that cannot be, or that this number of seeds does not represent.
    pub(crate) fn expand_sizes(&mut self) -> Result<(), Error> {
        let mut all = Vec::new();
        for seed in &self.seed {
            if seed.sizes.is_none() {
                all.push(seed.clone());
                continue;
            }
            let classes = self.classes_of(seed);
            all.extend(classes.map_err(|problem| Error::SeedKeys {
                file: self.file.clone(),
                seed: seed.name.clone(),
                problem,
            })?);
        }
        self.seed = all;
        Ok(())
    }

    /// The kinds that a seed with a distribution represents.
    fn classes_of(&self, seed: &SeedSettings) -> Result<Vec<SeedSettings>, String> {
        let shapes = [
            ("sphere", seed.sphere.is_some()),
            ("ellipsoid", seed.ellipsoid.is_some()),
            ("mesh", seed.mesh.is_some()),
            ("spheres", seed.spheres.is_some()),
            ("mass", seed.mass.is_some()),
        ];
        if let Some((key, _)) = shapes.iter().find(|(_, stated)| *stated) {
            return Err(format!(
                "{key} is stated beside sizes, which are diameters of spheres of one density; remove one"
            ));
        }
        let classes = seed.sizes.iter().map(SizeSettings::classes).next();
        let classes = classes.unwrap_or_else(|| Ok(Vec::new()))?;
        let volume = |[d, _]: &Class| FRAC_PI_6 * d.powi(3);
        let mean: f64 = classes.iter().map(|c| c[1] * volume(c)).sum();
        let of_mass = |mass: f64| Some(mass / (seed.density?.si() * mean));
        let of_level = |level: f64| {
            let solid = seed.solid_fraction.unwrap_or(SOLID_FRACTION);
            Some(level * solid * self.apparatus.bed_volume()? / mean)
        };
        let by_mass = seed.total_mass.and_then(|mass| of_mass(mass.si()));
        let number = by_mass.or_else(|| of_level(seed.fill_level?));
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "positive, and a cast saturates"
        )]
        let number = number.map_or(0, |number| number.max(0.0).round() as usize);
        let number = seed.count.unwrap_or(number);
        check_classes(&classes, (number, mean), volume)?;
        let shares: Vec<f64> = classes.iter().map(|c| c[1]).collect();
        let counts = whole(&shares, number);
        let kinds = classes.iter().zip(counts).enumerate();
        let kind = |(k, ([diameter, _], count)): (usize, (&Class, usize))| {
            let mut kind = seed.clone();
            kind.sizes = None;
            kind.name = format!("{} {} of {}", seed.name, k + 1, classes.len());
            kind.sphere = Length::from_si(*diameter).ok();
            kind.set_count(count);
            (count > 0).then_some(kind)
        };
        Ok(kinds.filter_map(kind).collect())
    }
}

/// Refuses sizes that are too far apart, and a class that gets no seed though it has mass.
fn check_classes(
    classes: &[Class],
    (number, mean): (usize, f64),
    volume: impl Fn(&Class) -> f64,
) -> Result<(), String> {
    let mm = |d: f64| significant(1e3 * d, 3);
    let smallest = classes.iter().map(|c| c[0]).fold(f64::INFINITY, f64::min);
    let largest = classes.iter().map(|c| c[0]).fold(0.0, f64::max);
    if largest > WIDEST * smallest {
        return Err(format!(
            "sizes from {} to {} mm: the largest may be {WIDEST} times the smallest; cut the tails",
            mm(smallest),
            mm(largest)
        ));
    }
    for class in classes {
        let expected = class[1] * number as f64;
        let of_mass = class[1] * volume(class) / mean;
        if expected < 0.5 && of_mass > MISSED {
            return Err(format!(
                "sizes: {} % of the mass are seeds of {} mm, of which {number} seeds contain {}: take more seeds, or cut the tail",
                significant(100.0 * of_mass, 2),
                mm(class[0]),
                significant(expected, 2)
            ));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use crate::{Error, Scene};
    use std::path::Path;

    /// A drum of seeds with these keys.
    fn scene(keys: &str) -> Result<Scene, Error> {
        let text = format!(
            r#"
            apparatus = {{ kind = "drum", inner_diameter = "100 mm", width = "20 mm", speed = "20 rpm", shell = "a", cover = "a" }}
            seed = [{{ name = "pea", density = "1250 kg/m3", material = "a", {keys} }}]
            material.a = {{ poisson_ratio = 0.3, shear_modulus = "5 MPa" }}
            contact.a-a = {{ restitution = 0.5, static_friction = 0.4 }}
            "#
        );
        Scene::from_text(&text, "peas.toml", Path::new("."), &[])
    }

    /// Numbers and diameters (mm) of the kinds.
    fn kinds(keys: &str) -> Vec<(usize, f64)> {
        let scene = scene(keys).expect("a scene");
        let kinds = scene.seed.iter();
        let diameter = |s: &crate::SeedSettings| 1e3 * s.sphere.expect("a sphere").si();
        kinds.map(|s| (scene.count_of(s), diameter(s))).collect()
    }

    fn refusal(keys: &str) -> String {
        scene(keys).expect_err("refused").to_string()
    }

    /// By hand: 4 classes of 0.5 mm from 3 to 5 mm, 25 seeds each; the numbers have their sum however they round.
    #[test]
    fn equally_frequent_sizes_are_so() {
        let found = kinds(r#"sizes = { uniform = ["3 mm", "5 mm"], classes = 4 }, count = 100"#);
        let expected = [3.25, 3.75, 4.25, 4.75].map(|d| (25, d));
        for ((count, d), (n, expected)) in found.iter().zip(expected) {
            assert!(*count == n && (d - expected).abs() < 1e-9, "{found:?}");
        }
        let odd = kinds(r#"sizes = { uniform = ["3 mm", "5 mm"], classes = 4 }, count = 102"#);
        assert_eq!(odd.iter().map(|k| k.0).sum::<usize>(), 102);
    }

    /// A normal distribution that is cut at two standard deviations has the mean and, by hand, sqrt(1 - 4 phi(2) / 0.9545) = 0.880 of
    /// the standard deviation; classes of a tenth of it add a thousandth.
    #[test]
    fn a_cut_normal_distribution_has_its_mean_and_scatter() {
        let found =
            kinds(r#"sizes = { normal = ["4 mm", "0.4 mm"], classes = 40 }, count = 100000"#);
        let n: f64 = found.iter().map(|k| k.0 as f64).sum();
        let mean = found.iter().map(|k| k.0 as f64 * k.1).sum::<f64>() / n;
        let square = found.iter().map(|k| k.0 as f64 * (k.1 - mean).powi(2));
        let sd = (square.sum::<f64>() / n).sqrt();
        assert!((mean - 4.0).abs() < 1e-3, "{mean}");
        assert!((sd / 0.4 - 0.880).abs() < 2e-3, "{sd}");
    }

    /// Two fractions of half of the mass each, 2 and 4 mm: eight times as many small seeds as large ones. The total mass is met to one
    /// large seed, 42 mg of 10 g.
    #[test]
    fn fractions_between_sieves_have_their_mass() {
        let sieves = r#"sizes = { sieves = [["1.6 mm", "2.5 mm", 0.5], ["3.2 mm", "5 mm", 0.5]] }"#;
        let found = kinds(&format!(r#"{sieves}, total_mass = "10 g""#));
        let [(small, of_small), (large, of_large)] = found[..] else {
            panic!("{found:?}");
        };
        assert!((of_small - 2.0).abs() < 1e-9 && (of_large - 4.0).abs() < 1e-9);
        assert!(
            (small as f64 / large as f64 / 8.0 - 1.0).abs() < 0.01,
            "{found:?}"
        );
        let scene = scene(&format!(r#"{sieves}, total_mass = "10 g""#)).unwrap();
        assert!(
            (scene.seed_mass() - 0.01).abs() < 42e-6,
            "{}",
            scene.seed_mass()
        );
    }

    #[test]
    fn sizes_that_cannot_be_are_refused_by_what_is_wrong() {
        let normal = refusal(r#"sizes = { normal = ["4 mm", "2.5 mm"] }, count = 100"#);
        assert!(normal.contains("reaches down to -1.00 mm"), "{normal}");
        let giants = refusal(
            r#"sizes = { sieves = [["1 mm", "2 mm", 0.8], ["9 mm", "11 mm", 0.2]] }, count = 100"#,
        );
        assert!(
            giants.contains("20 % of the mass are seeds of 9.95 mm"),
            "{giants}"
        );
        let wide = refusal(r#"sizes = { uniform = ["1 mm", "50 mm"] }, count = 100"#);
        assert!(wide.contains("10 times the smallest"), "{wide}");
        let both = refusal(r#"sphere = "4 mm", sizes = { uniform = ["3 mm", "5 mm"] }, count = 9"#);
        assert!(both.contains("sphere is stated beside sizes"), "{both}");
        let turned = refusal(r#"sizes = { uniform = ["5 mm", "3 mm"] }, count = 9"#);
        assert!(
            turned.contains("the smaller diameter comes first"),
            "{turned}"
        );
        let none = refusal("sizes = {}, count = 9");
        assert!(
            none.contains("exactly one of uniform, normal and sieves"),
            "{none}"
        );
    }
}
