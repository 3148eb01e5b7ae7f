//! Electrostatic attraction to the wall.

use crate::effects::{Effect, Entry, Error, walls::drum_of};
use scene::{FillingLibrary, Scene};

/// Charged seeds between conducting walls.
pub(crate) const EFFECT: Effect = Effect {
    name: "wall-charge",
    physics: "Seeds that rub on resin or glass are charged, and a charge is drawn to the \
              wall by its image, whatever its sign. Seeds stick to shell and covers and \
              are carried higher. With charges of both signs the forces between seeds \
              cancel in the mean and are left out; on an insulating wall the amplitude \
              represents q sqrt((eps - 1)/(eps + 1)).",
    formula: "F = q^2/(16 pi eps0 s^2) towards shell and covers, s the distance of the \
              centre; the amplitude adds to q",
    unit: "nC",
    source: "Jackson1998",
    range: [0.0, 3.0],
    probe: 1.0,
    entry: Entry::Wall,
    apply,
};

fn apply(scene: &mut Scene, amplitude: f64, _: &FillingLibrary) -> Result<(), Error> {
    drum_of(scene, EFFECT.name)?;
    let charge = scene.surroundings.charge_nc.unwrap_or(0.0) + amplitude;
    scene.surroundings.charge_nc = Some(charge);
    Ok(())
}

#[cfg(test)]
mod tests {
    use crate::effects::{apply, tests::small_drum};
    use scene::{FillingLibrary, run};

    /// The image force of 3 nC at 2 mm is six times the weight of a seed: seeds then lie nearer to shell
    /// or cover than without charge. A claim of direction only, on the same starts.
    #[test]
    fn charged_seeds_lie_at_the_walls() {
        let fillings = FillingLibrary::default();
        let [none, some] = [0.0, 3.0].map(|amplitude| {
            let mut scene = small_drum();
            apply(&mut scene, "wall-charge", amplitude, &fillings).unwrap();
            let result = run(&scene, &fillings, 5).unwrap();
            let positions = result.frames.iter().flat_map(|f| &f.position);
            let distance = positions.map(|p| (0.035 - p.xy().norm()).min(0.007 - p.z.abs()));
            distance.sum::<f64>() / (result.frames.len() * result.n_bodies) as f64
        });
        assert!(some < none, "{some} m against {none} m");
    }
}
