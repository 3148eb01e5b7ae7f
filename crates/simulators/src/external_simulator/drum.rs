//! The drum that positions of another code show: its size, its axes, its times.

use crate::exchange::Moment;
use input::quantity::{Angle, AngularSpeed, Length, Time};
use nalgebra::{Matrix3, Rotation3, Vector3};
use scene::DrumCamera;
use serde::{Deserialize, Deserializer};
use std::collections::BTreeMap;

/// A drum as a study describes it; `{name}` in a text takes the value of a condition or parameter.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DrumDescription {
    /// Inner diameter, such as "60 mm".
    pub inner_diameter: String,
    /// Width between the covers.
    pub width: String,
    /// Speed, such as "{rpm} rpm"; positive where the bed rises on the right of the picture.
    pub speed: String,
    /// Point of the axis halfway between the covers, three lengths.
    #[serde(default = "usual::centre")]
    pub centre: [String; 3],
    /// Direction of the axis towards the camera: x, y or z, with a minus where it points the other way.
    #[serde(default = "usual::axis")]
    pub axis: String,
    /// Direction upwards, in the same way.
    #[serde(default = "usual::up")]
    pub up: String,
    /// Gravity, m/s².
    #[serde(default = "usual::gravity")]
    pub gravity_m_s2: f64,
    /// Time from one moment to the next, if the files do not contain times.
    pub interval: Option<String>,
    /// Time step, if the files contain steps.
    pub time_step: Option<String>,
    /// Time that is left out at the start.
    pub start_up: Option<String>,
    /// Edge of the pictures that are drawn of the spheres, px.
    #[serde(default = "usual::pixels")]
    pub pixels: u32,
    /// Largest standard error with which the angle may be known from one picture, rad.
    #[serde(default = "usual::max_angle_error", deserialize_with = "angle")]
    pub max_angle_error: f64,
}

/// An angle with its unit, rad.
fn angle<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    Angle::deserialize(from).map(Angle::si)
}

/// What a file leaves out.
mod usual {
    pub(super) fn centre() -> [String; 3] {
        ["0 mm", "0 mm", "0 mm"].map(str::to_owned)
    }

    pub(super) fn axis() -> String {
        "z".into()
    }

    pub(super) fn up() -> String {
        "y".into()
    }

    pub(super) fn gravity() -> f64 {
        9.81
    }

    pub(super) fn pixels() -> u32 {
        480
    }

    pub(super) fn max_angle_error() -> f64 {
        photo_profile::MAX_ANGLE_ERROR
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct DrumOfRun {
    /// The drum and a camera in front of it.
    pub(crate) camera: DrumCamera,
    /// Speed, rad/s.
    pub(crate) spin: f64,
    /// Gravity, m/s².
    pub(crate) gravity: f64,
    /// Start-up, s.
    pub(crate) start_up: Option<f64>,
    /// Middle of the drum in the axes of the other code, m.
    centre: Vector3<f64>,
    /// Turn from the axes of the other code to those here.
    turn: Rotation3<f64>,
    /// Time from moment to moment, s.
    interval: Option<f64>,
    /// Time step, s.
    time_step: Option<f64>,
}

impl DrumDescription {
    /// All of it as one text, for the key of a run.
    pub(crate) fn text(&self) -> String {
        format!("{self:?}")
    }

    /// The drum of a run with these values.
    ///
    /// # Errors
    ///
    /// A text that is not such a quantity, or axes that are not perpendicular, in words.
    pub(crate) fn at(&self, values: &BTreeMap<String, String>) -> Result<DrumOfRun, String> {
        let filled = |text: &str| {
            let mut text = text.to_owned();
            for (name, value) in values {
                text = text.replace(&format!("{{{name}}}"), value);
            }
            text
        };
        let length = |key: &str, text: &str| {
            let text = filled(text);
            Length::parse(&text)
                .map(Length::si)
                .map_err(|e| format!("[scene.drum] {key} = '{text}': {e}"))
        };
        let time = |key: &str, text: &Option<String>| {
            let read = |text: &String| {
                let text = filled(text);
                let time = Time::parse(&text).map(Time::si);
                time.map_err(|e| format!("[scene.drum] {key} = '{text}': {e}"))
            };
            text.as_ref().map(read).transpose()
        };
        let speed = filled(&self.speed);
        let spin = AngularSpeed::parse(&speed)
            .map_err(|e| format!("[scene.drum] speed = '{speed}': {e}"))?;
        let [x, y, z] = &self.centre;
        Ok(DrumOfRun {
            camera: DrumCamera {
                radius: 0.5 * length("inner_diameter", &self.inner_diameter)?,
                width: length("width", &self.width)?,
                pixels: self.pixels,
                roll: 0.0,
                distance: None,
                max_angle_error: self.max_angle_error,
            },
            spin: spin.si(),
            gravity: self.gravity_m_s2,
            start_up: time("start_up", &self.start_up)?,
            centre: Vector3::new(
                length("centre", x)?,
                length("centre", y)?,
                length("centre", z)?,
            ),
            turn: turn(&self.axis, &self.up)?,
            interval: time("interval", &self.interval)?,
            time_step: time("time_step", &self.time_step)?,
        })
    }

    /// Checks everything that does not depend on a run; places for values count as the number 1.
    ///
    /// # Errors
    ///
    /// As of a run, in words.
    pub fn check(&self, names: &[String]) -> Result<(), String> {
        let ones: BTreeMap<String, String> =
            names.iter().map(|n| (n.clone(), "1".to_owned())).collect();
        let drum = self.at(&ones)?;
        if drum.interval.is_some() && drum.time_step.is_some() {
            return Err("[scene.drum] has interval and time_step: keep one of both".into());
        }
        Ok(())
    }
}

/// The turn that brings an axis to z and a direction upwards to y.
fn turn(axis: &str, up: &str) -> Result<Rotation3<f64>, String> {
    let vector = |key: &str, name: &str| -> Result<Vector3<f64>, String> {
        let (sign, letter) = match name.strip_prefix('-') {
            Some(rest) => (-1.0, rest),
            None => (1.0, name),
        };
        match letter {
            "x" => Ok(sign * Vector3::x()),
            "y" => Ok(sign * Vector3::y()),
            "z" => Ok(sign * Vector3::z()),
            _ => Err(format!(
                "[scene.drum] {key} = '{name}' must be x, y, z, -x, -y or -z"
            )),
        }
    };
    let (z, y) = (vector("axis", axis)?, vector("up", up)?);
    if z.dot(&y) != 0.0 {
        return Err(format!(
            "[scene.drum] axis = '{axis}' and up = '{up}' must be two different axes"
        ));
    }
    let rows = [y.cross(&z).transpose(), y.transpose(), z.transpose()];
    Ok(Rotation3::from_matrix_unchecked(Matrix3::from_rows(&rows)))
}

impl DrumOfRun {
    /// A moment in the axes here.
    pub(crate) fn turned(&self, moment: Moment) -> Moment {
        moment.seen_from(&self.centre, &self.turn)
    }

    /// Time from one moment to the next, s.
    ///
    /// # Errors
    ///
    /// Times that are not equally spaced, or not known, in words.
    pub(crate) fn interval(&self, moments: &[Moment]) -> Result<f64, String> {
        if let Some(interval) = self.interval {
            return Ok(interval);
        }
        let time = |m: &Moment| {
            let by_step = m.step.zip(self.time_step).map(|(n, dt)| n as f64 * dt);
            m.time.or(by_step)
        };
        let times: Option<Vec<f64>> = moments.iter().map(time).collect();
        let times = times.ok_or(
            "the files of positions contain no times: state [scene.drum] time_step for dumps, or interval",
        )?;
        let n = times.len() - 1;
        let interval = (times[n] - times[0]) / n as f64;
        for (k, pair) in times.windows(2).enumerate() {
            // Times are written with few digits.
            if (pair[1] - pair[0] - interval).abs() > 0.02 * interval {
                return Err(format!(
                    "moments {} and {} are {} s apart, and {interval} s in the mean: write them at equal times",
                    k + 1,
                    k + 2,
                    pair[1] - pair[0]
                ));
            }
        }
        Ok(interval)
    }
}

/// The moments in the order of their times or steps; as they are where they have neither. Twice the same is once.
///
/// # Errors
///
/// Fewer than two moments, in words.
pub(crate) fn in_order(mut moments: Vec<Moment>) -> Result<Vec<Moment>, String> {
    if moments.iter().all(|m| m.time.is_some()) {
        moments.sort_by(|a, b| a.time.unwrap_or(0.0).total_cmp(&b.time.unwrap_or(0.0)));
        moments.dedup_by(|a, b| a.time == b.time);
    } else if moments.iter().all(|m| m.step.is_some()) {
        moments.sort_by_key(|m| m.step);
        moments.dedup_by(|a, b| a.step == b.step);
    }
    if moments.len() < 2 {
        return Err(format!(
            "the positions hold {} moments: a bed must be seen over time",
            moments.len()
        ));
    }
    Ok(moments)
}

#[cfg(test)]
mod tests {
    use super::{DrumDescription, in_order, turn};
    use crate::exchange::Moment;
    use nalgebra::Vector3;

    fn drum() -> DrumDescription {
        DrumDescription {
            inner_diameter: "60 mm".into(),
            width: "{w} mm".into(),
            speed: "{rpm} rpm".into(),
            centre: ["0 mm", "0 mm", "0 mm"].map(str::to_owned),
            axis: "z".into(),
            up: "y".into(),
            gravity_m_s2: 9.81,
            interval: None,
            time_step: Some("0.01 ms".into()),
            start_up: None,
            pixels: 480,
            max_angle_error: photo_profile::MAX_ANGLE_ERROR,
        }
    }

    /// A drum along y with z up, seen from the side of small y: x stays to the right.
    #[test]
    fn axes_of_another_code_are_turned() {
        let turn = turn("-y", "z").unwrap();
        assert_eq!(
            turn * Vector3::new(1.0, -2.0, 3.0),
            Vector3::new(1.0, 3.0, 2.0)
        );
        assert!((turn.matrix().determinant() - 1.0).abs() < 1e-15);
        assert!(super::turn("y", "-y").is_err() && super::turn("a", "y").is_err());
    }

    #[test]
    fn values_of_a_run_take_their_places() {
        let values = [("w", "20"), ("rpm", "30")];
        let values = values.map(|(k, v)| (k.to_owned(), v.to_owned())).into();
        let run = drum().at(&values).unwrap();
        assert!((run.spin - std::f64::consts::PI).abs() < 1e-12);
        assert!((run.camera.width - 0.02).abs() < 1e-15);
        let error = drum().check(&["rpm".into()]).unwrap_err();
        assert!(error.contains("width = '{w} mm'"), "{error}");
    }

    #[test]
    fn times_follow_from_steps_and_must_be_equally_spaced() {
        let values = [("w", "20"), ("rpm", "30")];
        let values = values.map(|(k, v)| (k.to_owned(), v.to_owned())).into();
        let run = drum().at(&values).unwrap();
        let at = |step: u64| Moment {
            step: Some(step),
            ..Moment::default()
        };
        let moments = in_order(vec![at(2000), at(0), at(1000), at(1000)]).unwrap();
        assert_eq!(moments.len(), 3);
        assert!((run.interval(&moments).unwrap() - 0.01).abs() < 1e-15);
        let error = run.interval(&[at(0), at(1000), at(5000)]).unwrap_err();
        assert!(error.contains("equal times"), "{error}");
        assert!(in_order(vec![at(1)]).is_err());
    }
}
