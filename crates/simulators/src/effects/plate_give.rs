//! A plate of glued seeds that gives way.

use crate::effects::{Effect, Entry, Error, refused};
use scene::{Apparatus, FillingLibrary, Scene};

/// A plate of seeds on tape in the drop test.
pub(crate) const EFFECT: Effect = Effect {
    name: "plate-give",
    physics: "Seeds glued on tape make a plate that gives way where it is hit and takes a part of the momentum; the tape brings it \
              back when the hit is over. A seed comes back more slowly than from a rigid plate, and so much the more the less it \
              rebounds. Only a drop on seeds has such a plate.",
    formula: "mass of the plate = mass of the seed / amplitude; head on e' = (e - amplitude) / (1 + amplitude); the tape returns the \
              plate by x'' = -r (r x + 2 x'), r = 100/s",
    unit: "1",
    source: "Stronge2000",
    range: [0.0, 1.0],
    probe: 0.03,
    entry: Entry::Wall,
    apply,
};

fn apply(scene: &mut Scene, amplitude: f64, _: &FillingLibrary) -> Result<(), Error> {
    let Apparatus::Drop(test) = &mut scene.apparatus else {
        return Err(refused(
            EFFECT.name,
            &"only a drop on seeds has a plate that gives way",
        ));
    };
    test.plate_give += amplitude;
    Ok(())
}

#[cfg(test)]
mod tests {
    use crate::effects::{apply, tests::small_drum};
    use scene::{Apparatus, FillingLibrary, Scene};

    /// A plate of seeds gives way, the more the larger the amplitude; a plate of resin, and a drum, do not.
    #[test]
    fn only_a_plate_of_seeds_gives_way() {
        let fillings = FillingLibrary::default();
        let drop = |plate: &str| {
            let scene = small_drum();
            let test = scene::Drop {
                plate: plate.into(),
                seed: None,
                repeats: 40,
                height: "200 mm".parse().unwrap(),
                plate_give: 0.0,
            };
            Scene {
                apparatus: Apparatus::Drop(test),
                ..scene
            }
        };
        let mut on_seeds = drop("seed");
        for expected in [0.25, 0.5] {
            apply(&mut on_seeds, "plate-give", 0.25, &fillings).unwrap();
            let Apparatus::Drop(test) = &on_seeds.apparatus else {
                panic!("no drop");
            };
            assert_eq!(test.plate_give, expected);
        }
        let on_resin = apply(&mut drop("tough_resin"), "plate-give", 0.25, &fillings);
        let told = on_resin.unwrap_err().to_string();
        assert!(told.contains("apparatus.plate_give"), "{told}");
        let told = apply(&mut small_drum(), "plate-give", 0.25, &fillings).unwrap_err();
        assert!(told.to_string().contains("only a drop"), "{told}");
    }
}
