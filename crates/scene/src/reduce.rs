//! The part of a scene that its run depends on.

use crate::{Apparatus, CameraSettings, Error, Protocol, Scene, SurroundingsSettings};

impl Scene {
    /// The same seeds, materials and contacts in a bench test, without what only a bed of seeds has: walls,
    /// surroundings, bonds, and the settings of protocol and camera that go with them.
    ///
    /// # Errors
    ///
    /// As [`Self::check`]: a plate or seed that the scene does not define, a contact that nobody states.
    pub fn on_bench(&self, apparatus: Apparatus) -> Result<Self, Error> {
        let mut scene = Self {
            apparatus,
            ..self.clone()
        };
        scene.drop_bed();
        scene.check()?;
        Ok(scene)
    }

    /// Drops what only a bed of seeds has.
    fn drop_bed(&mut self) {
        self.wall.clear();
        self.surroundings = SurroundingsSettings::default();
        self.model.bonds = None;
        self.camera = CameraSettings {
            distance: None,
            ..self.camera
        };
        self.protocol = Protocol {
            insertion_rate: None,
            start_slope: None,
            ..self.protocol
        };
    }
}
