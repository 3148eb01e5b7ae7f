//! Air drag: the air slows flowing seeds.

use crate::{Description, Effect, Entry, Error};
use scene::{FillingLibrary, Scene};

/// Drag of still air on every seed.
#[derive(Debug)]
pub(crate) struct AirDrag;

impl Effect for AirDrag {
    fn description(&self) -> Description {
        Description {
            name: "air-drag",
            physics: "Air slows seeds that move through it. For dense seeds of some millimetres \
                      at the speeds of a drum it is small; fibres and hollow or feathery seeds \
                      feel it. The air is taken as still; in a drum it turns with the covers in \
                      part.",
            formula: "F = -amplitude (pi/8) rho d^2 C v |v|, C = 24/Re (1 + 0.15 Re^0.687), d of \
                      the sphere with the volume of the seed",
            unit: "1",
            source: "SchillerNaumann1933",
            range: [0.0, 20.0],
            probe: 5.0,
            entry: Entry::Body,
        }
    }

    fn apply(&self, scene: &mut Scene, amplitude: f64, _: &FillingLibrary) -> Result<(), Error> {
        let drag = scene.surroundings.air_drag.unwrap_or(0.0) + amplitude;
        scene.surroundings.air_drag = Some(drag);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use crate::{apply, tests::small_drum};
    use scene::{FillingLibrary, run};

    /// Air of twenty times the drag carries energy away: the same seeds move less than in no air.
    /// The bed slides and rolls on at the speed of the drum, hence only a smaller mean is claimed.
    #[test]
    fn drag_takes_kinetic_energy() {
        let fillings = FillingLibrary::default();
        let [none, some] = [0.0, 20.0].map(|amplitude| {
            let mut scene = small_drum();
            apply(&mut scene, "air-drag", amplitude, &fillings).unwrap();
            let result = run(&scene, &fillings, 5).unwrap();
            let energy = result.series.iter().map(|p| p.kinetic_energy_j);
            energy.sum::<f64>() / result.series.len() as f64
        });
        assert!(some < none, "{some} J against {none} J");
    }
}
