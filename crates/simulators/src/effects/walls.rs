//! What effects on the drum share: the drum of a scene, and the friction of one of its parts.

use crate::effects::{Error, refused};
use input::quantity::FrictionCoefficient;
use scene::{Apparatus, Drum, Scene};

/// A part of the drum.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Part {
    /// The shell.
    Shell,
    /// Both covers.
    Cover,
}

/// The drum of a scene.
///
/// # Errors
///
/// Another apparatus; the message says that the named effect needs a drum.
pub(crate) fn drum_of<'a>(
    scene: &'a mut Scene,
    effect: &'static str,
) -> Result<&'a mut Drum, Error> {
    match &mut scene.apparatus {
        Apparatus::Drum(drum) => Ok(drum),
        _ => Err(Error::Setting {
            name: effect,
            reason: "the apparatus is not a drum; leave this effect out for it".into(),
        }),
    }
}

/// Multiplies the static friction of all seeds at one part of the drum, and nowhere else.
///
/// The part gets a material of its own, so that other surfaces of the same material stay as they are.
///
/// # Errors
///
/// Another apparatus, a friction of 0 (a share of it changes nothing), a friction out of range.
pub(crate) fn scale_friction(
    scene: &mut Scene,
    part: Part,
    factor: f64,
    effect: &'static str,
) -> Result<(), Error> {
    let drum = drum_of(scene, effect)?;
    if part == Part::Cover && drum.has_periodic_ends() {
        return Err(Error::Setting {
            name: effect,
            reason: "the drum has periodic ends and no covers; leave this effect out for it".into(),
        });
    }
    let (place, word) = match part {
        Part::Shell => (&mut drum.shell, "shell"),
        Part::Cover => (&mut drum.cover, "cover"),
    };
    let own = format!("{place} of the {word}");
    let declared = std::mem::replace(place, own.clone());
    let undefined = |what: String| Error::Setting {
        name: effect,
        reason: format!("{what} is not defined in the scene"),
    };
    let material = scene.material.get(&declared);
    let material = *material.ok_or_else(|| undefined(format!("material '{declared}'")))?;
    scene.material.insert(own.clone(), material);
    for seed in &scene.seed {
        let contact = scene.contact_of(&seed.material, &declared);
        let pair = format!("{}-{declared}", seed.material);
        let mut contact = *contact.ok_or_else(|| undefined(format!("contact '{pair}'")))?;
        let friction = contact.static_friction.get();
        if friction == 0.0 {
            return Err(Error::Setting {
                name: effect,
                reason: format!("static friction of '{pair}' is 0, and so is any share of it"),
            });
        }
        contact.static_friction =
            FrictionCoefficient::new(friction * factor).map_err(|e| refused(effect, &e))?;
        scene
            .contact
            .insert(format!("{}-{own}", seed.material), contact);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use crate::effects::apply;
    use crate::effects::tests::{friction_at, small_drum};
    use input::quantity::FrictionCoefficient;
    use scene::{Apparatus, FillingLibrary};

    /// Shell and covers of one material: only the covers change.
    #[test]
    fn parts_of_one_material_are_told_apart() {
        let (mut scene, fillings) = (small_drum(), FillingLibrary::default());
        if let Apparatus::Drum(drum) = &mut scene.apparatus {
            drum.cover = drum.shell.clone();
        }
        apply(&mut scene, "cover-friction", -0.5, &fillings).unwrap();
        let [shell, cover, _] = friction_at(&scene);
        assert_eq!([shell, cover], [0.33, 0.165]);
    }

    #[test]
    fn a_share_of_no_friction_is_refused() {
        let (mut scene, fillings) = (small_drum(), FillingLibrary::default());
        let contact = scene.contact.get_mut("seed-tough_resin").unwrap();
        contact.static_friction = FrictionCoefficient::new(0.0).unwrap();
        let error = apply(&mut scene, "shell-friction", 0.5, &fillings).unwrap_err();
        assert!(error.to_string().contains("seed-tough_resin"), "{error}");
    }
}
