//! Mix of shapes: other than declared.

use crate::effects::{Effect, Entry, Error, refused};
use scene::{FillingLibrary, Scene, SeedSettings};

/// Seeds of the first kind taken for seeds of the others.
pub(crate) const EFFECT: Effect = Effect {
    name: "shape-mix",
    physics: "A lot is sorted into a few shapes by eye, and a sample of it is counted. \
              The share of flat or round seeds in the drum may be another one than in the \
              sample: flat seeds lock, round ones roll.",
    formula: "share of the first kind = declared share - amplitude; the others grow in \
              proportion, the total stays",
    unit: "1",
    source: "CottonStudy",
    range: [-0.3, 0.3],
    probe: 0.1,
    entry: Entry::SeedShape,
    apply,
};

fn apply(scene: &mut Scene, amplitude: f64, _: &FillingLibrary) -> Result<(), Error> {
    let refused = |reason: String| refused(EFFECT.name, &reason);
    scene.fix_seeds();
    let total = scene.seed_count();
    let declared = scene.seed.first().map_or(0, |first| scene.count_of(first));
    let Some((first, others)) = scene.seed.split_first_mut() else {
        return Err(refused("the scene has no seeds".into()));
    };
    let rest = total - declared;
    let moved = amplitude * total as f64;
    let target = (declared as f64 - moved).round();
    if rest == 0 || !(0.0..=total as f64).contains(&target) {
        return Err(refused(format!(
            "cannot move {moved} of {total} seeds from '{}', which has {}, to the other kinds, which \
             have {rest}: state a mix of at least two kinds, or a smaller amplitude",
            first.name, declared
        )));
    }
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a whole number from 0 to the total, checked above"
    )]
    let target = target as usize;
    first.set_count(target);
    share_out(total - target, others);
    Ok(())
}

/// Gives a number of seeds to kinds in proportion to what they have (largest remainder).
fn share_out(total: usize, kinds: &mut [SeedSettings]) {
    // The numbers are fixed before they are shared out.
    let mut counts: Vec<usize> = kinds.iter().map(|k| k.count.unwrap_or(0)).collect();
    let before: usize = counts.iter().sum();
    let mut rests = Vec::new();
    for (k, count) in counts.iter_mut().enumerate() {
        let exact = *count * total;
        rests.push((exact % before, k));
        *count = exact / before;
    }
    let given: usize = counts.iter().sum();
    rests.sort_by(|a, b| b.0.cmp(&a.0).then(a.1.cmp(&b.1)));
    for &(_, k) in rests.iter().take(total - given) {
        counts[k] += 1;
    }
    for (kind, count) in kinds.iter_mut().zip(counts) {
        kind.set_count(count);
    }
}

#[cfg(test)]
mod tests {
    use crate::effects::{apply, tests::small_drum};
    use scene::FillingLibrary;

    /// A tenth of 40 seeds goes from the first kind (34) to the second (6), or back.
    #[test]
    fn the_share_asked_for_changes_its_kind() {
        for (amplitude, expected) in [(0.1, [30, 10]), (-0.1, [38, 2])] {
            let mut scene = small_drum();
            apply(
                &mut scene,
                "shape-mix",
                amplitude,
                &FillingLibrary::default(),
            )
            .unwrap();
            let counts: Vec<_> = scene.seed.iter().map(|s| scene.count_of(s)).collect();
            assert_eq!(counts, expected);
        }
    }

    /// Three kinds: the seeds that are moved are shared out 2 to 1, as the kinds are.
    #[test]
    fn the_others_keep_their_proportions() {
        let mut scene = small_drum();
        scene.seed.push(scene.seed[1].clone());
        scene.seed[2].name = "third".into();
        for (seed, count) in scene.seed.iter_mut().zip([70, 20, 10]) {
            seed.set_count(count);
        }
        apply(&mut scene, "shape-mix", 0.3, &FillingLibrary::default()).unwrap();
        let counts: Vec<_> = scene.seed.iter().map(|s| scene.count_of(s)).collect();
        assert_eq!(counts, [40, 40, 20]);
    }

    /// No other kind, or fewer seeds than are to be moved.
    #[test]
    fn a_mix_that_cannot_be_is_refused() {
        let (mut scene, fillings) = (small_drum(), FillingLibrary::default());
        let error = apply(&mut scene, "shape-mix", -0.2, &fillings).unwrap_err();
        assert!(error.to_string().contains("-8 of 40"), "{error}");
        scene.seed.pop();
        assert!(apply(&mut scene, "shape-mix", 0.1, &fillings).is_err());
    }
}
