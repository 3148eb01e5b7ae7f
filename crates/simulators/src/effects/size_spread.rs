//! Spread of size: the seeds of one kind are not all alike.

use crate::effects::{Effect, Entry, Error, refused};
use input::quantity::Mass;
use scene::{FillingLibrary, Scene};

/// Each kind of seed in two sizes, half of the seeds each.
pub(crate) const EFFECT: Effect = Effect {
    name: "size-spread",
    physics: "Grown seeds vary in size, the model has one size a kind. A spread lets \
              small seeds fill gaps between large ones and sink to the core of the bed. \
              Two sizes stand for the distribution; they have its variance, and the \
              density of the declared seed. The amplitude is a variance because a spread \
              has no sign: what it does grows with its square, as the mean volume does, \
              by three times the variance.",
    formula: "half of the seeds have (1 + s) x, half (1 - s) x the declared lengths, with \
              s = sqrt(amplitude) the standard deviation over the mean; mass ~ length^3",
    unit: "1",
    source: "CottonStudy",
    range: [0.0, 0.09],
    probe: 0.0225,
    entry: Entry::SeedShape,
    apply,
};

fn apply(scene: &mut Scene, amplitude: f64, _: &FillingLibrary) -> Result<(), Error> {
    let mut seeds = Vec::with_capacity(2 * scene.seed.len());
    scene.fix_seeds();
    let deviation = amplitude.sqrt();
    for kind in &scene.seed {
        let all = scene.count_of(kind);
        let large = all / 2;
        for (word, factor, count) in [
            ("small", 1.0 - deviation, all - large),
            ("large", 1.0 + deviation, large),
        ] {
            let mass = Mass::from_si(kind.mass_kg() * factor.powi(3))
                .map_err(|e| refused(EFFECT.name, &e))?;
            let mut part = kind.clone();
            part.name = format!("{} {word}", kind.name);
            part.set_mass(mass);
            part.set_count(count);
            part.scale = Some(kind.scale.unwrap_or(1.0) * factor);
            seeds.push(part);
        }
    }
    scene.seed = seeds;
    Ok(())
}

#[cfg(test)]
mod tests {
    use crate::effects::{apply, tests::small_drum};
    use scene::FillingLibrary;

    /// Over all seeds the size has the declared mean and the variance asked for, the mean volume is
    /// larger by three times that variance, and the density is the declared one. The counts are even, so
    /// that only rounding is left.
    #[test]
    fn sizes_have_the_variance_asked_for() {
        let (declared, mut spread) = (small_drum(), small_drum());
        apply(&mut spread, "size-spread", 0.04, &FillingLibrary::default()).unwrap();
        assert_eq!(spread.seed_count(), declared.seed_count());
        let n = spread.seed_count() as f64;
        let mean = |f: &dyn Fn(f64) -> f64| {
            let kinds = spread.seed.iter();
            kinds
                .map(|s| spread.count_of(s) as f64 * f(s.scale.unwrap()))
                .sum::<f64>()
                / n
        };
        assert!((mean(&|x| x) - 1.0).abs() < 1e-12);
        assert!((mean(&|x| (x - 1.0).powi(2)) - 0.04).abs() < 1e-12);
        assert!((mean(&|x| x.powi(3)) - 1.12).abs() < 1e-12);
        for seed in &spread.seed {
            let density = seed.mass_kg() / seed.scale.unwrap().powi(3);
            assert!((density / 94.5e-6 - 1.0).abs() < 1e-12, "{}", seed.name);
        }
    }
}
