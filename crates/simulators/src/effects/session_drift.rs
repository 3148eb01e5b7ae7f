//! Slow drift over the session: the seeds at its end are not those of its start.

use crate::effects::{Effect, Entry, Error, refused};
use input::quantity::FrictionCoefficient;
use scene::{FillingLibrary, Scene};

/// Friction of every contact that changes in proportion to the time since the session began.
pub(crate) const EFFECT: Effect = Effect {
    name: "session-drift",
    physics: "Coats wear off, seeds dry, dust gathers: conditions that were measured late \
              differ from early ones although nobody changed a setting. It is distinguished from an \
              effect of the speed only where the order of the measurements was random.",
    formula: "mu = (1 + amplitude x session) x declared coefficient of static friction of \
              every contact; session is 0 at the start and 1 at the end",
    unit: "1",
    source: "Archard1953",
    range: [-0.5, 0.5],
    probe: 0.3,
    entry: Entry::Contact,
    apply,
};

fn apply(scene: &mut Scene, amplitude: f64, _: &FillingLibrary) -> Result<(), Error> {
    let name = EFFECT.name;
    let factor = 1.0 + amplitude * session_of(scene, name)?;
    for contact in scene.contact.values_mut() {
        let drifted = contact.static_friction.get() * factor;
        contact.static_friction =
            FrictionCoefficient::new(drifted).map_err(|e| refused(name, &e))?;
    }
    Ok(())
}

/// When in the session the run is made.
///
/// # Errors
///
/// A scene that does not say it.
pub(crate) fn session_of(scene: &Scene, effect: &'static str) -> Result<f64, Error> {
    scene.protocol.session.ok_or_else(|| Error::Setting {
        name: effect,
        reason: "protocol.session (0 at the start of the session, 1 at its end) is not stated; \
                 give it, or the condition 'session' of each measurement, or leave this effect out"
            .into(),
    })
}

#[cfg(test)]
mod tests {
    use crate::effects::{apply, tests::small_drum};
    use scene::FillingLibrary;

    /// 0.3 x 0.5 more than 0.10, 0.33 and 0.29 in the middle of the session, nothing more at its
    /// start. Rounding only.
    #[test]
    fn friction_drifts_with_the_session() {
        for (session, factor) in [(0.0, 1.0), (0.5, 1.15)] {
            let mut scene = small_drum();
            scene.protocol.session = Some(session);
            apply(&mut scene, "session-drift", 0.3, &FillingLibrary::default()).unwrap();
            for (name, contact) in &scene.contact {
                let before = small_drum().contact[name].static_friction.get();
                let after = contact.static_friction.get();
                assert!((after - factor * before).abs() < 1e-15, "{name}: {after}");
            }
        }
    }

    #[test]
    fn a_scene_without_its_place_in_the_session_is_refused() {
        for effect in ["session-drift", "shell-wear"] {
            let mut scene = small_drum();
            scene.protocol.session = None;
            let error = apply(&mut scene, effect, 0.3, &FillingLibrary::default()).unwrap_err();
            assert!(error.to_string().contains("protocol.session"), "{error}");
        }
    }
}
