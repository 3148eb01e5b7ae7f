//! The part of a scene that its run depends on, and what a run of it can give.

use crate::{
    Apparatus, CameraSettings, Error, ModelSettings, Protocol, Scene, SurroundingsSettings,
};
use input::quantity::FrictionCoefficient;

impl Scene {
    /// The same seeds, materials and contacts in another apparatus, without what it cannot have: in a bench test walls,
    /// surroundings and bonds; outside a drum its camera and the slope of its bed. What follows from the apparatus, as the number
    /// of seeds of a fill level, follows from the new one, and from later changes of it.
    ///
    /// # Errors
    ///
    /// As [`Self::check`]: a plate or seed that the scene does not define, a contact that nobody states.
    pub fn in_apparatus(&self, apparatus: Apparatus) -> Result<Self, Error> {
        let mut scene = Self {
            apparatus,
            ..self.clone()
        };
        // A wrong name must be told as it stands in the arguments.
        if let Some(test) = scene.apparatus.device().bench_test() {
            scene.tested_seed(test)?;
            scene.undefined(test.plate).map_or(Ok(()), Err)?;
            scene.wall.clear();
            scene.surroundings = SurroundingsSettings::default();
            scene.model.bonds = None;
            scene.protocol.insertion_rate = None;
        }
        if !scene.apparatus.device().is_photographed() {
            scene.camera = CameraSettings::default();
        }
        if !scene.apparatus.is_turned() {
            scene.protocol.start_slope = None;
        }
        scene.check()?;
        Ok(scene)
    }

    /// The scene without seeds, materials, contacts and settings of protocol and camera that cannot change its
    /// run, and with masses and numbers of seeds instead of what they follow from. Its run is the same to
    /// the last bit, and scenes that differ in nothing else become equal.
    ///
    /// Effects that drift over a session must be applied before: the session itself moves nothing.
    #[must_use]
    pub fn reduced(&self) -> Self {
        let mut scene = self.clone();
        scene.fix_seeds();
        if scene.apparatus.is_bench_test() {
            scene.reduce_bench();
        }
        if !scene.apparatus.device().is_photographed() {
            scene.camera = CameraSettings::default();
        }
        scene.protocol.session = None;
        // A fixed step rules all phases, and a share that is that of the settling seeds says nothing.
        let steps = scene.protocol.clone();
        if steps.time_step.is_some() || steps.flow_step_share == Some(steps.step_share) {
            scene.protocol.flow_step_share = None;
        }
        if scene.apparatus.has_phases() {
            let usual = Protocol::default();
            scene.protocol = Protocol {
                flow_step_share: None,
                start_up: None,
                angle_error: None,
                frame_interval: usual.frame_interval,
                frames: usual.frames,
                ..scene.protocol
            };
        }
        let touching = scene.touching_pairs();
        let pairs: Vec<String> = touching
            .iter()
            .flat_map(|[a, b]| [format!("{a}-{b}"), format!("{b}-{a}")])
            .collect();
        let names: Vec<String> = touching.concat().into_iter().map(Into::into).collect();
        scene.contact.retain(|pair, _| pairs.contains(pair));
        scene.material.retain(|name, _| names.contains(name));
        scene
    }

    /// Drops what a bench test does not look at.
    fn reduce_bench(&mut self) {
        let test = self.apparatus.device().bench_test();
        let tested = test.and_then(|test| self.tested_seed(test).ok().cloned());
        let Some(mut tested) = tested else {
            return;
        };
        tested.set_count(1);
        let plate = test.map_or("", |test| test.plate).to_owned();
        let is_smooth = plate != tested.material;
        self.seed = vec![tested];
        self.wall.clear();
        self.surroundings = SurroundingsSettings::default();
        self.model.bonds = None;
        let steps = self.protocol.clone();
        self.protocol = Protocol {
            time_step: steps.time_step,
            step_share: steps.step_share,
            ..Protocol::default()
        };
        match &mut self.apparatus {
            Apparatus::Slider(slider) => {
                slider.seed = None;
                self.model.dashpot_mass = ModelSettings::default().dashpot_mass;
                self.model.whole_seed_damping = 0.0;
                // The sled cannot turn, and a smooth plate does not.
                if let (true, Ok(none)) = (is_smooth, FrictionCoefficient::new(0.0)) {
                    for contact in self.contact.values_mut() {
                        contact.rolling_friction = none;
                    }
                }
            }
            Apparatus::Drop(drop) => drop.seed = None,
            Apparatus::Tilt(tilt) => tilt.seed = None,
            _ => {}
        }
    }

    /// Names of all observables that a run can give; one that needs what does not happen (a surface, a
    /// period) may be missing.
    pub fn observables(&self) -> Vec<&str> {
        let mut names = self.apparatus.device().observables();
        let is_turned = self.apparatus.is_turned();
        if self.model.bonds.is_some() && is_turned {
            names.push("broken_bonds");
        }
        if self.apparatus.device().lower_cover().is_some() {
            names.push("cover_angle_deg");
        }
        if self.camera.pair_interval.is_some() && matches!(self.apparatus, Apparatus::Drum(_)) {
            names.push("surface_speed_m_s");
        }
        names
    }
}
