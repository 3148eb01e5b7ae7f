//! What is invalid in a scene.

use crate::apparatus::BenchTest;
use crate::interactions;
use crate::{Apparatus, Error, Scene};
use dem_solver::DashpotMass;

/// Longest time between the two pictures of a pair, s: gravity alone would add 12 mm to the way of a seed.
const MOST_PAIR_INTERVAL: f64 = 0.05;
/// Largest slope at which a bed may be laid, rad.
pub(crate) const MOST_START_SLOPE: f64 = std::f64::consts::FRAC_PI_4;

/// Whether a name can stand in a line of a table.
fn is_name(name: &str) -> bool {
    !name.trim().is_empty() && !name.contains(|c: char| c.is_control() || ",\"".contains(c))
}

impl Scene {
    /// Refuses what is invalid; for scenes that were changed after reading.
    ///
    /// # Errors
    ///
    /// The first of [`Self::problems`].
    pub fn check(&self) -> Result<(), Error> {
        self.problems().into_iter().next().map_or(Ok(()), Err)
    }

    /// All that is invalid: settings out of range, names that refer to nothing, and missing contacts. The errors name the file.
    pub fn problems(&self) -> Vec<Error> {
        let mut found = Vec::new();
        self.check_protocol(&mut found);
        self.check_steps(&mut found);
        self.check_limits(&mut found);
        self.check_model(&mut found);
        self.check_rebound(&mut found);
        self.check_camera(&mut found);
        self.check_seeds(&mut found);
        found.extend(self.surroundings.check(&self.apparatus).err());
        found.extend(self.apparatus.device().check().err());
        found.extend(self.apparatus.device().check_walls(self).err());
        if let Some(test) = self.apparatus.device().bench_test() {
            self.check_bench(test, &mut found);
        }
        self.check_phases(&mut found);
        self.check_names(&mut found);
        self.check_contacts(&mut found);
        let all = found.into_iter();
        all.map(|error| error.in_file(&self.file)).collect()
    }

    /// Finds constants of the model out of range.
    fn check_model(&self, found: &mut Vec<Error>) {
        let model = &self.model;
        // With less gravity nothing falls in the time of a run.
        let mut numbers = vec![
            ("bond_number", model.bond_number, [0.0, 100.0]),
            ("gravity_m_s2", model.gravity_m_s2, [1e-3, 1000.0]),
        ];
        if let Some(liquid) = &model.liquid {
            let tension = liquid.surface_tension_n_m;
            numbers.extend([
                ("liquid.content", liquid.content, [0.0, 0.2]),
                ("liquid.surface_tension_n_m", tension, [0.0, 1.0]),
                (
                    "liquid.viscosity_pa_s",
                    liquid.viscosity_pa_s,
                    [0.0, 1000.0],
                ),
            ]);
            let (angle, roughness) = (liquid.contact_angle, liquid.roughness);
            if !(0.0..=std::f64::consts::FRAC_PI_2).contains(&angle.si()) {
                let name = "model.liquid.contact_angle";
                found.push(bad(name, angle.to_string(), "0 to 90 deg"));
            }
            if !(1e-9..=1e-3).contains(&roughness.si()) {
                let name = "model.liquid.roughness";
                found.push(bad(name, roughness.to_string(), "1 nm to 1 mm"));
            }
        }
        for (name, value, [low, high]) in numbers {
            if !(low..=high).contains(&value) {
                let (name, range) = (format!("model.{name}"), format!("{low} to {high}"));
                found.push(bad(&name, value.to_string(), &range));
            }
        }
        if let Some(bonds) = &model.bonds {
            if let Err(source) = bonds.law() {
                found.push(Error::Text {
                    file: self.file.clone(),
                    message: format!("[model.bonds]: {source}"),
                });
            }
            if self.protocol.insertion_rate.is_some() || !self.surroundings.is_empty() {
                let other = "protocol.insertion_rate or [surroundings] beside it";
                found.push(bad(
                    "model.bonds",
                    other.into(),
                    "alone: remove one of them",
                ));
            }
        }
    }

    /// Finds shares of the damping of the whole seed, and plates that give way, which cannot be.
    fn check_rebound(&self, found: &mut Vec<Error>) {
        let whole = self.model.whole_seed_damping;
        let beside_sphere = whole == 0.0 || self.model.dashpot_mass == DashpotMass::Sphere;
        if !((0.0..=1.0).contains(&whole) && beside_sphere) {
            let requirement = "0 to 1, and 0 unless model.dashpot_mass = \"sphere\"";
            let value = whole.to_string();
            found.push(bad("model.whole_seed_damping", value, requirement));
        }
        let Apparatus::Drop(test) = &self.apparatus else {
            return;
        };
        let give = test.plate_give;
        let kind = self.apparatus.device().bench_test();
        let kind = kind.and_then(|test| self.tested_seed(test).ok());
        let of_seeds = kind.is_some_and(|kind| kind.material == test.plate);
        if !((0.0..=1.0).contains(&give) && (give == 0.0 || of_seeds)) {
            let requirement =
                "0 (rigid) to 1 (a single seed gives way), and 0 unless the plate is of seeds";
            found.push(bad("apparatus.plate_give", give.to_string(), requirement));
        }
    }

    /// Finds a camera that cannot be.
    fn check_camera(&self, found: &mut Vec<Error>) {
        if !(64..=4096).contains(&self.camera.pixels) {
            let pixels = self.camera.pixels.to_string();
            found.push(bad("camera.pixels", pixels, "64 to 4096"));
        }
        if let Some(time) = self.camera.pair_interval
            && !(time.si() > 0.0 && time.si() <= MOST_PAIR_INTERVAL)
        {
            let requirement = "above 0 and at most 50 ms, since the seeds are taken to keep their speed for this time";
            found.push(bad("camera.pair_interval", time.to_string(), requirement));
        }
        if let Some(error) = self.camera.max_angle_error
            && !(0.1..=30.0).contains(&error.si().to_degrees())
        {
            let requirement = "0.1 to 30 degrees";
            found.push(bad(
                "camera.max_angle_error",
                error.to_string(),
                requirement,
            ));
        }
        if let Some(distance) = self.camera.distance
            && distance.si() <= self.apparatus.radius()
        {
            let requirement = "above the inner radius of the drum";
            found.push(bad("camera.distance", distance.to_string(), requirement));
        }
    }

    /// Finds seeds that cannot be.
    fn check_seeds(&self, found: &mut Vec<Error>) {
        let before = found.len();
        for seed in &self.seed {
            seed.check(self, found);
        }
        // Keys that are wrong leave the number open.
        if found.len() == before && self.seed_count() == 0 {
            found.push(bad("number of seeds", "0".into(), "at least 1"));
        }
        for (k, seed) in self.seed.iter().enumerate() {
            if self.seed[..k].iter().any(|other| other.name == seed.name) {
                let requirement = "another name: each kind of seed needs its own";
                found.push(bad("seed.name", seed.name.clone(), requirement));
            }
        }
        let levels = self.seed.iter().filter_map(|s| s.fill_level);
        let level: f64 = levels.sum();
        if level > 1.0 {
            let requirement = "at most 1 over all kinds";
            found.push(bad("sum of fill_level", level.to_string(), requirement));
        }
    }

    /// Finds times and counts of the protocol that are invalid.
    fn check_protocol(&self, found: &mut Vec<Error>) {
        let p = &self.protocol;
        let mut require = |holds: bool, name: &str, value: String, requirement: &str| {
            if !holds {
                found.push(bad(name, value, requirement));
            }
        };
        for (name, time) in [
            ("protocol.settle_limit", p.settle_limit),
            ("protocol.rotation_limit", p.rotation_limit),
            ("protocol.frame_interval", p.frame_interval),
        ] {
            require(time.si() > 0.0, name, time.to_string(), "above 0");
        }
        if let Some(start_up) = p.start_up {
            let holds = start_up.si() < p.rotation_limit.si();
            let requirement = "below protocol.rotation_limit";
            require(
                holds,
                "protocol.start_up",
                start_up.to_string(),
                requirement,
            );
        }
        if let Some(ramp) = self.apparatus.device().ramp() {
            let holds = ramp < p.rotation_limit.si();
            let requirement = "below protocol.rotation_limit: only behind it the bed can be steady";
            require(holds, "apparatus.ramp", format!("{ramp} s"), requirement);
        }
        if let Some(error) = p.angle_error {
            let holds = error.si() > 0.0;
            require(holds, "protocol.angle_error", error.to_string(), "above 0");
        }
        require(
            p.frames >= 2,
            "protocol.frames",
            p.frames.to_string(),
            "at least 2",
        );
        let shaken = self.wall.iter().filter_map(|wall| wall.vibration.as_ref());
        for vibration in shaken.chain(&self.surroundings.vibration) {
            let frequency = vibration.frequency;
            let holds = frequency.si() > 0.0;
            require(
                holds,
                "vibration.frequency",
                frequency.to_string(),
                "above 0",
            );
        }
    }

    /// Finds steps, rates and slopes of the protocol that are invalid.
    fn check_steps(&self, found: &mut Vec<Error>) {
        let p = &self.protocol;
        let mut require = |holds: bool, name: &str, value: String, requirement: &str| {
            if !holds {
                found.push(bad(name, value, requirement));
            }
        };
        if let Some(rate) = p.insertion_rate {
            let holds = rate.si() >= 1.0;
            require(
                holds,
                "protocol.insertion_rate",
                rate.to_string(),
                "1 1/s or more",
            );
        }
        let shares = [
            ("protocol.step_share", Some(p.step_share)),
            ("protocol.flow_step_share", p.flow_step_share),
        ];
        for (name, share) in shares.into_iter().filter_map(|(n, s)| Some((n, s?))) {
            let holds = share > 0.0 && share <= 1.0;
            require(holds, name, share.to_string(), "above 0, at most 1");
        }
        if let Some(step) = p.time_step {
            require(
                step.si() > 0.0,
                "protocol.time_step",
                step.to_string(),
                "above 0",
            );
        }
        if let Some(session) = p.session {
            let holds = (0.0..=1.0).contains(&session);
            require(holds, "protocol.session", session.to_string(), "0 to 1");
        }
        if let Some(slope) = p.start_slope {
            let in_a_drum = matches!(self.apparatus, Apparatus::Drum(_));
            let holds = in_a_drum && (0.0..=MOST_START_SLOPE).contains(&slope.si());
            let requirement = "0 to 45 deg, in a drum only";
            require(
                holds,
                "protocol.start_slope",
                slope.to_string(),
                requirement,
            );
        }
    }

    /// Finds what an apparatus that takes seeds out, or pours them, cannot have or lacks.
    fn check_phases(&self, found: &mut Vec<Error>) {
        let device = self.apparatus.device();
        let takes_out = device.plan(self).is_some_and(|plan| plan.has_outlets());
        if takes_out && self.model.bonds.is_some() {
            let requirement = "absent in an apparatus that takes seeds out";
            found.push(bad("model.bonds", "stated".into(), requirement));
        }
        if device.needs_insertion_rate() && self.protocol.insertion_rate.is_none() {
            let requirement = "stated in this apparatus, such as \"500 1/s\": its seeds are poured";
            found.push(bad(
                "protocol.insertion_rate",
                "missing".into(),
                requirement,
            ));
        }
    }

    /// Finds what a bench test cannot have.
    fn check_bench(&self, test: BenchTest<'_>, found: &mut Vec<Error>) {
        if !(2..=100_000).contains(&test.repeats) {
            let requirement = "2 to 100000: a mean with an interval needs two";
            found.push(bad(
                "apparatus.repeats",
                test.repeats.to_string(),
                requirement,
            ));
        }
        found.extend(self.tested_seed(test).err());
        let absent = "absent in a bench test, which has a plate and single seeds alone";
        for (stated, name) in [
            (!self.wall.is_empty(), "[[wall]]"),
            (!self.surroundings.is_empty(), "[surroundings]"),
            (self.model.bonds.is_some(), "model.bonds"),
            (
                self.protocol.insertion_rate.is_some(),
                "protocol.insertion_rate",
            ),
            (self.camera.distance.is_some(), "camera.distance"),
        ] {
            if stated {
                found.push(bad(name, "stated".into(), absent));
            }
        }
    }

    /// Materials of all seeds that take part.
    fn seed_materials(&self) -> Vec<&str> {
        let all = || self.seed.iter().map(|s| s.material.as_str());
        match self.apparatus.device().bench_test() {
            None => all().collect(),
            Some(test) => {
                let tested = self.tested_seed(test).ok();
                tested.map(|s| s.material.as_str()).into_iter().collect()
            }
        }
    }

    /// Pairs of materials that can touch, each once.
    pub(crate) fn touching_pairs(&self) -> Vec<[&str; 2]> {
        let (seeds, walls) = (self.seed_materials(), self.wall_materials());
        let is_bench = self.apparatus.is_bench_test();
        let mut pairs: Vec<[&str; 2]> = Vec::new();
        for &seed in &seeds {
            // On the bench a seed meets the plate alone, or its like where that is a plate of seeds.
            let others = if is_bench { &[][..] } else { &seeds[..] };
            for &other in others.iter().chain(&walls) {
                if !pairs.contains(&[seed, other]) && !pairs.contains(&[other, seed]) {
                    pairs.push([seed, other]);
                }
            }
        }
        pairs
    }

    /// Finds values of the laws of contacts out of range.
    fn check_contacts(&self, found: &mut Vec<Error>) {
        for (pair, contact) in &self.contact {
            let refusals = interactions::refusals(contact);
            found.extend(refusals.into_iter().map(|source| Error::Contact {
                file: self.file.clone(),
                pair: pair.clone(),
                source,
            }));
        }
    }

    /// The error of a material that is not defined; `None` if it is.
    pub(crate) fn undefined(&self, material: &str) -> Option<Error> {
        let known: Vec<_> = self.material.keys().map(String::as_str).collect();
        (!self.material.contains_key(material)).then(|| Error::Undefined {
            file: self.file.clone(),
            what: "material",
            name: material.into(),
            known: known.join(", "),
        })
    }

    /// Finds names that refer to nothing, and contacts that nobody states.
    fn check_names(&self, found: &mut Vec<Error>) {
        let own_names = self.seed.iter().map(|s| ("seed.name", &s.name));
        let own_names = own_names.chain(self.wall.iter().map(|w| ("wall.name", &w.name)));
        let own_names = own_names.chain(self.material.keys().map(|name| ("material", name)));
        for (key, name) in own_names.filter(|(_, name)| !is_name(name)) {
            let requirement =
                "not empty, and without line breaks, commas and quotation marks: tables hold it";
            found.push(bad(key, format!("{name:?}"), requirement));
        }
        for name in self.material.keys().filter(|name| name.contains('-')) {
            let requirement =
                "without '-', which separates the two materials of a contact: write _ or a blank";
            found.push(bad("material", format!("{name:?}"), requirement));
        }
        let seeds = self.seed.iter().map(|s| s.material.as_str());
        let in_contacts = self.contact.keys().flat_map(|pair| pair.split('-'));
        let mut names: Vec<&str> = Vec::new();
        for name in self
            .wall_materials()
            .into_iter()
            .chain(seeds)
            .chain(in_contacts)
        {
            if !names.contains(&name) {
                names.push(name);
            }
        }
        found.extend(names.into_iter().filter_map(|name| self.undefined(name)));
        for [a, b] in self.touching_pairs() {
            if self.contact_of(a, b).is_none() {
                found.push(Error::MissingContact {
                    file: self.file.clone(),
                    pair: format!("{a}-{b}"),
                });
            }
        }
        for pair in self.contact.keys() {
            let Some((a, b)) = pair.split_once('-') else {
                continue;
            };
            let turned = format!("{b}-{a}");
            if *pair < turned && self.contact.contains_key(&turned) {
                let requirement = "stated once, in either order of the names";
                let (name, value) = (format!("contact '{pair}'"), format!("also '{turned}'"));
                found.push(bad(&name, value, requirement));
            }
        }
        self.check_names_of_walls(found);
    }

    /// Finds walls of one name.
    fn check_names_of_walls(&self, found: &mut Vec<Error>) {
        let device = self.apparatus.device();
        let planes = device.walls().into_iter().map(|wall| wall.name);
        let meshes = device.mesh_walls().into_iter().map(|wall| wall.name);
        let own: Vec<String> = planes.chain(meshes).collect();
        for (k, wall) in self.wall.iter().enumerate() {
            let twice = self.wall[..k].iter().any(|other| other.name == wall.name);
            if twice || own.contains(&wall.name) {
                let requirement = "another name: each wall needs its own";
                found.push(bad("wall.name", wall.name.clone(), requirement));
            }
        }
    }
}

/// Most digits of a number that a message tells one by one.
const MOST_DIGITS: usize = 24;

/// The refusal of a value.
pub(crate) fn bad(name: &str, value: String, requirement: &str) -> Error {
    let (number, unit) = value.split_once(' ').unwrap_or((&value, ""));
    let value = match number.parse::<f64>() {
        Ok(parsed) if number.len() > MOST_DIGITS => format!("{parsed:e} {unit}").trim().into(),
        _ => value,
    };
    Error::BadValue {
        name: name.into(),
        value,
        requirement: requirement.into(),
    }
}
