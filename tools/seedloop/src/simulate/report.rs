//! What a run gives, as text and as JSON.

use super::Outcome;
use crate::analyse::fixed;
use anyhow::Context as _;
use campaign::run_store::Observation;
use command_line::{Header, significant};
use scene::{Doubt, Override, Scene};
use serde::Serialize;
use serde_json::Value;
use simulators::scene_simulator::{
    CurveDetails, FrameDetails, RunDetails, TimingDetails, unread_frames,
};
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// Largest difference of the angle by picture and by position that nobody needs to know, deg: the usual one is 0.9 to 1.4
/// (docs/two-rulers.md), with fewer and larger seeds up to 2.
const USUAL_DIFFERENCE_DEG: f64 = 3.0;
/// Likewise of the fill level: a picture shows the highest bed along the axis.
const USUAL_FILL_DIFFERENCE: f64 = 0.1;

/// A finished run in JSON.
#[derive(Debug, Serialize)]
pub(super) struct Report {
    /// Version, seed, inputs.
    #[serde(flatten)]
    header: Header,
    /// `ok`, or `refused` if no frame of a drum shows a surface: then there is no angle, and what the places of the seeds show
    /// stands.
    verdict: &'static str,
    /// Why it is refused.
    reason: Option<String>,
    /// Results by name.
    observables: BTreeMap<String, Observation>,
    /// How the run ended up: `rolling`, `sliding` or `resting`; `None` if the apparatus has no bed.
    regime: Option<String>,
    /// Whether the start-up was found to be over; `None` if the apparatus has no such state.
    steady: Option<bool>,
    /// Why it is not steady, as the rest of a sentence that begins with "the bed".
    doubt: Option<&'static str>,
    /// The same as a kind.
    #[serde(skip)]
    kind_of_doubt: Option<Doubt>,
    /// Time of rotation before the steady state, s.
    start_up_s: Option<f64>,
    /// Time of one swing of the bed, s.
    swing_s: Option<f64>,
    /// Form of the motion of the bed; `None` if nothing turns.
    motion: Option<String>,
    /// R w^2 / g.
    froude_number: Option<f64>,
    /// Readings of the single frames.
    frames: FrameDetails,
    /// The curve of an apparatus that gives one.
    #[serde(skip_serializing_if = "Option::is_none")]
    curve: Option<CurveDetails>,
    /// Steps and times.
    timing: TimingDetails,
    /// Every setting of the scene as it was run, by its dotted path; quantities with their unit.
    parameters: BTreeMap<String, Value>,
    /// The settings that were changed, as given.
    changed: BTreeMap<String, String>,
    /// Kinds of seeds with their number, mass and density.
    seeds: String,
    /// Content key of the run.
    record: String,
    /// Whether the results come from a record that was there before.
    reused: bool,
    /// What the user should know of the values and of the result.
    pub(super) warnings: Vec<String>,
}

impl Report {
    /// Describes a finished run.
    ///
    /// # Errors
    /// A scene that has no form in JSON, a record that is not that of a run of a scene.
    pub(super) fn new(
        header: Header,
        outcome: &Outcome,
        scene: &Scene,
        changes: &[Override],
    ) -> anyhow::Result<Self> {
        let record = &outcome.record;
        let details = RunDetails::of(record)?;
        let mut report = Self {
            header,
            verdict: if details.no_surface.is_some() {
                "refused"
            } else {
                "ok"
            },
            reason: details.no_surface,
            observables: record.observables().clone(),
            regime: record.regime().map(str::to_owned),
            steady: details.steady,
            doubt: details.doubt.map(Doubt::words),
            kind_of_doubt: details.doubt,
            start_up_s: details.start_up_s,
            swing_s: details.swing_s,
            motion: details.motion,
            froude_number: details.froude_number,
            frames: details.frames,
            curve: details.curve,
            timing: details.timing,
            parameters: settings_of(scene)?,
            changed: changed(changes),
            seeds: scene.seeds_in_words(),
            record: record.key().to_owned(),
            reused: outcome.result.is_none(),
            warnings: Vec::new(),
        };
        report.warnings = report.of_result();
        Ok(report)
    }

    /// Why there is no angle; `None` if there is one, or the apparatus has none.
    pub(super) fn refusal(&self) -> Option<&str> {
        self.reason.as_deref()
    }

    /// What the user should know of the result.
    fn of_result(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        if let Some(doubt) = self.kind_of_doubt {
            let words = doubt.words();
            // More time would not help a bed that its own rolling torque drives.
            let advice = match doubt {
                Doubt::DrivenByRolling => "",
                _ => "; its means are those of a passing state. Raise protocol.rotation_limit",
            };
            warnings.push(format!("not steady: at the limit the bed {words}{advice}"));
        }
        if self.motion.as_deref() == Some("surging")
            && !self.parameters.contains_key("apparatus.ramp")
        {
            warnings.push(
                "the bed slides and swings on from its start: apparatus.ramp gives it an even one"
                    .to_owned(),
            );
        }
        let disagreements = disagreements(&self.observables);
        if !disagreements.is_empty() {
            warnings.push(format!(
                "picture and positions disagree: {}; the bed is not alike along the axis. Compare like with like: a photo with \
                 angle_deg and fill_level, the trace at the lower cover of a tilted drum with cover_angle_deg, the whole bed with \
                 the values by position",
                disagreements.join(", ")
            ));
        }
        let broken_off = self.timing.retried.len();
        if broken_off > 0 {
            warnings.push(format!(
                "the bed left what can be believed at {}: the values are those of a step of {} ms",
                if broken_off == 1 {
                    "the usual time step".to_owned()
                } else {
                    format!("the {broken_off} longer time steps tried before")
                },
                significant(1e3 * self.timing.time_step_s, 4)
            ));
        }
        if self.reason.is_none() {
            warnings.extend(unread_frames([&self.frames]));
        }
        warnings
    }

    /// How the bed moved, in a line; nothing if it has no regime.
    fn motion_in_words(&self) -> String {
        let Some(regime) = &self.regime else {
            return String::new();
        };
        let mut text = format!("regime {regime}");
        if let Some(motion) = self.motion.as_ref().filter(|m| *m != regime) {
            add(&mut text, format_args!(", {motion}"));
        }
        if let Some(froude) = self.froude_number {
            add(
                &mut text,
                format_args!(", Froude number {}", significant(froude, 4)),
            );
        }
        if let (Some(true), Some(time)) = (self.steady, self.start_up_s) {
            add(
                &mut text,
                format_args!(", steady from {time:.2} s of rotation"),
            );
        }
        if let (Some(error), Some(swing)) = (self.frames.standard_error_deg, self.swing_s) {
            add(
                &mut text,
                format_args!(
                    ", standard error of angle_deg over time {error:.2} deg (a swing takes {swing:.2} s)"
                ),
            );
        }
        text.push('\n');
        text
    }

    /// The observables as a table, and how the run went.
    pub(super) fn text(&self) -> String {
        let mut text = table_of(&self.observables);
        text.push('\n');
        text += &self.motion_in_words();
        add(&mut text, format_args!("seeds: {}\n", self.seeds));
        let timing = &self.timing;
        let per_step = timing
            .us_per_step
            .map_or_else(String::new, |us| format!(" ({us:.1} us a step)"));
        add(
            &mut text,
            format_args!(
                "{} bodies, {} spheres, {} steps in {:.2} s{per_step}{}\n",
                timing.bodies,
                timing.spheres,
                timing.steps,
                timing.wall_s,
                if self.reused { ", from its record" } else { "" },
            ),
        );
        add(
            &mut text,
            format_args!(
                "time step {} ms while settling, {} ms after",
                significant(timing.settling_time_step_s * 1e3, 4),
                significant(timing.time_step_s * 1e3, 4)
            ),
        );
        text.push('\n');
        if let Some(phases) = &timing.phases {
            let named = phases.named();
            let took = named.iter().filter(|(_, time)| *time > 0.0);
            let took: Vec<String> = took
                .map(|(name, time)| format!("{name} {time:.2} s"))
                .collect();
            add(&mut text, format_args!("{}\n", took.join(", ")));
        }
        text
    }
}

/// The settings that were changed.
fn changed(changes: &[Override]) -> BTreeMap<String, String> {
    changes
        .iter()
        .map(|change| (change.name.clone(), change.value.clone()))
        .collect()
}

/// Every setting of a scene by its dotted path; the items of a list are numbered from 0.
fn settings_of(scene: &Scene) -> anyhow::Result<BTreeMap<String, Value>> {
    fn walk(value: &Value, path: &str, out: &mut BTreeMap<String, Value>) {
        let below = |key: &str| {
            if path.is_empty() {
                key.to_owned()
            } else {
                format!("{path}.{key}")
            }
        };
        match value {
            Value::Object(map) => {
                map.iter()
                    .for_each(|(key, child)| walk(child, &below(key), out));
            }
            Value::Array(list) => {
                for (k, child) in list.iter().enumerate() {
                    walk(child, &below(&k.to_string()), out);
                }
            }
            leaf => drop(out.insert(path.to_owned(), leaf.clone())),
        }
    }
    let scene = serde_json::to_value(scene).context("the scene has no form in JSON")?;
    let mut settings = BTreeMap::new();
    walk(&scene, "", &mut settings);
    Ok(settings)
}

/// Appends to a text.
fn add(text: &mut String, more: std::fmt::Arguments<'_>) {
    text.write_fmt(more).expect("a string takes all text");
}

/// Observables as a table, a line each.
pub(crate) fn table_of(observables: &BTreeMap<String, Observation>) -> String {
    let mut text = format!(
        "{:<32}{:>12}{:>12}{:>6}  unit\n",
        "observable", "mean", "sd", "n"
    );
    for (name, o) in observables {
        let mean = significant(o.mean, 6);
        let sd = o.sd.map_or_else(|| "-".to_owned(), |sd| significant(sd, 4));
        add(
            &mut text,
            format_args!("{name:<32}{mean:>12}{sd:>12}{:>6}  {}\n", o.n, o.unit),
        );
    }
    text
}

/// Where the picture and the places of the seeds show different beds.
fn disagreements(observables: &BTreeMap<String, Observation>) -> Vec<String> {
    let mean = |name: &str| observables.get(name).map(|o| o.mean);
    let mut found = Vec::new();
    if let Some(between) = observables.get("image_minus_position_deg") {
        let error = between.sd.unwrap_or(0.0) / (between.n.max(1) as f64).sqrt();
        if between.mean.abs() > USUAL_DIFFERENCE_DEG + 2.0 * error {
            let (by_image, by_place) = (mean("angle_deg"), mean("angle_by_position_deg"));
            found.push(format!(
                "the picture shows {} deg and the places of the seeds {} deg",
                fixed(by_image, 1),
                fixed(by_place, 1)
            ));
        }
    }
    if let (Some(seen), Some(there)) = (mean("fill_level"), mean("fill_level_by_position"))
        && (seen - there).abs() > USUAL_FILL_DIFFERENCE
    {
        found.push(format!(
            "the bed takes {} of the picture and {} of the drum",
            fixed(Some(seen), 2),
            fixed(Some(there), 2)
        ));
    }
    found
}

#[cfg(test)]
mod tests {
    use super::disagreements;
    use campaign::run_store::Observation;
    use std::collections::BTreeMap;

    /// What a run shows by picture and by position: the mean difference of 20 frames with its standard deviation, and both fills.
    fn of(difference: [f64; 2], fills: [f64; 2]) -> Vec<String> {
        let observation = |mean, sd| Observation {
            mean,
            sd,
            n: 20,
            unit: "1".into(),
        };
        let all = [
            ("angle_deg", observation(44.9, None)),
            ("angle_by_position_deg", observation(53.1, None)),
            (
                "image_minus_position_deg",
                observation(difference[0], Some(difference[1])),
            ),
            ("fill_level", observation(fills[0], None)),
            ("fill_level_by_position", observation(fills[1], None)),
        ];
        disagreements(&BTreeMap::from(all.map(|(name, o)| (name.to_owned(), o))))
    }

    /// A level drum of peas, -1.5 deg and 0.449 for 0.406, is as usual; the same drum tilted by 45 deg is not, in angle and filling. A
    /// difference within 3 deg and two of its errors (2 * 4.5 / sqrt(20) = 2.0 deg) may be chance.
    #[test]
    fn picture_and_positions_of_a_tilted_drum_disagree() {
        assert_eq!(of([-1.5, 1.0], [0.449, 0.406]), Vec::<String>::new());
        let tilted = of([-7.5, 3.0], [0.61, 0.45]);
        assert_eq!(
            tilted,
            [
                "the picture shows 44.9 deg and the places of the seeds 53.1 deg",
                "the bed takes 0.61 of the picture and 0.45 of the drum",
            ]
        );
        assert!(of([-4.9, 4.5], [0.4, 0.4]).is_empty());
        assert_eq!(of([-5.1, 4.5], [0.4, 0.4]).len(), 1);
    }
}
