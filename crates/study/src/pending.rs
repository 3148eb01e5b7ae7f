//! What the scene crate is about to give.

use scene::{Apparatus, Error, FillingLibrary, Scene};

/// What the scene crate is about to give.
pub(crate) trait SceneSoon: Sized {
    /// Without what cannot matter.
    fn reduced(&self) -> Self;
    /// Names of observables.
    fn observables(&self) -> Vec<&'static str>;
    /// Builds the scene once.
    fn build_check(&self, fillings: &FillingLibrary) -> Result<(), Error>;
}

impl SceneSoon for Scene {
    fn reduced(&self) -> Self {
        let mut scene = self.clone();
        let walls: Vec<String> = match &self.apparatus {
            Apparatus::Drum(d) => vec![d.shell.clone(), d.cover.clone()],
            Apparatus::Metering(m) => vec![m.plate.clone(), m.front.clone(), m.board.clone()],
            Apparatus::Heap(h) => vec![h.floor.clone(), h.cylinder.clone()],
            Apparatus::BoxCollapse(b) => vec![b.floor.clone(), b.wall.clone()],
            Apparatus::Slider(a) => vec![a.plate.clone()],
            Apparatus::Drop(a) => vec![a.plate.clone()],
            Apparatus::Tilt(a) => vec![a.plate.clone()],
        };
        let seeds: Vec<String> = self.seed.iter().map(|s| s.material.clone()).collect();
        scene.contact.retain(|pair, _| {
            let (a, b) = pair.split_once('-').unwrap_or((pair, ""));
            let [a, b] = [a, b].map(str::to_owned);
            let known = |n: &String| walls.contains(n) || seeds.contains(n);
            known(&a) && known(&b) && (seeds.contains(&a) || seeds.contains(&b))
        });
        scene
    }
    fn observables(&self) -> Vec<&'static str> {
        match self.apparatus {
            Apparatus::Drum(_) => vec![
                "angle_deg",
                "curvature",
                "s_shape",
                "fluctuation_deg",
                "fill_level",
            ],
            Apparatus::Metering(_) => vec!["filling_angle_deg", "angle_deg"],
            Apparatus::Slider(_) => vec!["shown_static_friction"],
            Apparatus::Drop(_) => vec!["shown_restitution"],
            Apparatus::Tilt(_) => vec!["shown_rolling_friction"],
            Apparatus::Heap(_) => vec!["angle_of_repose_deg", "height_mm", "base_radius_mm"],
            Apparatus::BoxCollapse(_) => vec![
                "angle_of_repose_deg",
                "height_mm",
                "runout_mm",
                "toe_angle_deg",
                "top_angle_deg",
            ],
        }
    }
    fn build_check(&self, fillings: &FillingLibrary) -> Result<(), Error> {
        self.seed
            .iter()
            .try_for_each(|seed| fillings.body(self, seed).map(|_| ()))
    }
}
