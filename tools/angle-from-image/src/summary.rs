//! All pictures together.

use crate::interface::{Heights, Interface};
use crate::results::ImageResult;
use photo_profile::{Mode, SelectionBias, Settings};
use serde::Serialize;
use std::collections::BTreeMap;
use surface_profile::{
    Avalanches, SeriesSummary, avalanches, correlation_time, longest_unbroken, summarise,
};

/// One observable over all measured pictures.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct Spread {
    pub(crate) mean: f64,
    /// Standard deviation between pictures; none of one.
    pub(crate) sd: Option<f64>,
    /// Standard error of the mean, correlation between neighbours counted; none of one.
    pub(crate) se: Option<f64>,
    /// Number of independent pictures that would tell as much.
    n_effective: f64,
}

/// The pictures refused as too rough beside those that were measured. Rough surfaces are left out for their error, not for
/// their angle; where they stand elsewhere than the others, the mean of the others is not that of the bed.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct TooRough {
    /// Pictures refused as too rough.
    pub(crate) n: usize,
    /// Mean of their lines, degrees.
    pub(crate) mean_deg: f64,
    /// That mean less the mean of the lines that were measured, degrees.
    pub(crate) difference_deg: f64,
    /// Standard error of the difference, from the spread of both, degrees; none if one of them has one picture.
    pub(crate) difference_se_deg: Option<f64>,
}

impl TooRough {
    /// Compares the lines of the surfaces refused as too rough with those that were measured.
    fn new(images: &[ImageResult]) -> Option<Self> {
        let lines = |of: fn(&ImageResult) -> Option<f64>| -> Vec<f64> {
            images.iter().filter_map(of).collect()
        };
        let rough = lines(|i| i.rough_line_deg);
        // The angle of a heap, which has no line.
        let others = summarise(&lines(|i| i.line_deg.or(i.angle_deg))).ok()?;
        let found = summarise(&rough).ok()?;
        let error = found.standard_error.hypot(others.standard_error);
        Some(Self {
            n: rough.len(),
            mean_deg: found.mean,
            difference_deg: found.mean - others.mean,
            difference_se_deg: error.is_finite().then_some(error),
        })
    }

    /// Whether the difference is more than twice its standard error.
    fn shifts_the_mean(&self) -> bool {
        self.difference_se_deg
            .is_some_and(|error| self.difference_deg.abs() > 2.0 * error)
    }

    /// The sentence for people.
    pub(crate) fn text(&self) -> String {
        let Self {
            n,
            mean_deg,
            difference_deg,
            ..
        } = self;
        let error = self
            .difference_se_deg
            .map_or_else(|| "error unknown".to_owned(), |e| format!("+- {e:.2}"));
        let advice = if self.shifts_the_mean() {
            ": the mean without them is biased; allow for them by --max-error-deg"
        } else {
            ""
        };
        format!(
            "\n{n} refused as too rough or uncertain: their lines have a mean of {mean_deg:.2} deg, {difference_deg:+.2} ({error}) from the others{advice}"
        )
    }
}

/// How far the mean of all pictures may lie from that of the measured ones, in the worst case: the others are the highest of all, or
/// the lowest ([`SelectionBias`]).
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct LargestBias {
    /// Pictures without an angle.
    n: usize,
    /// The bound to either side, degrees; none if they are too many for one.
    deg: Option<f64>,
    /// The same in standard errors of the mean.
    in_standard_errors: Option<f64>,
    /// Whether a study takes the mean over: the bound is at most one standard error.
    borne: bool,
}

impl LargestBias {
    /// Of the measured pictures and the number of the others.
    fn new(measured: &SeriesSummary, others: usize) -> Option<Self> {
        let bias = SelectionBias::new(measured, others)?;
        let finite = |value: f64| value.is_finite().then_some(value);
        Some(Self {
            n: others,
            deg: finite(bias.most),
            in_standard_errors: finite(bias.in_standard_errors),
            borne: bias.is_borne(),
        })
    }

    /// The sentence for people.
    pub(crate) fn text(&self) -> String {
        let n = self.n;
        let (Some(deg), Some(errors)) = (self.deg, self.in_standard_errors) else {
            return format!(
                "\n{n} without an angle: too many to say what the mean of all would be"
            );
        };
        let advice = if self.borne {
            ""
        } else {
            ": more than one, so that a study would refuse the pictures"
        };
        format!(
            "\n{n} without an angle: if these were the highest of all, or the lowest, the mean of all would lie {deg:.2} deg off, \
             {errors:.1} standard errors{advice}"
        )
    }
}

/// The JSON of several pictures together.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Summary {
    /// Pictures measured.
    pub(crate) n: usize,
    /// Mean angle, degrees.
    pub(crate) mean_deg: Option<f64>,
    /// Standard deviation between pictures, degrees.
    pub(crate) sd_deg: Option<f64>,
    /// Standard error of the mean, correlation between neighbours and the error of a mark for the horizontal counted, degrees.
    pub(crate) se_deg: Option<f64>,
    /// Number of independent pictures that would tell as much.
    pub(crate) n_effective: Option<f64>,
    /// Pictures refused.
    pub(crate) refused: usize,
    /// How far the mean of all pictures may lie from that of the measured ones at most; none if all were measured, or the measured
    /// ones tell no scatter.
    pub(crate) largest_bias: Option<LargestBias>,
    /// What the surfaces refused as too rough would change; none if there are none, or nothing was measured.
    pub(crate) too_rough: Option<TooRough>,
    /// Files that could not be read.
    pub(crate) unread: usize,
    /// Where the surface of a drum lies along it, and how it fluctuates there; none of fewer than two pictures.
    pub(crate) interface: Option<Interface>,
    /// All that a drum shows, by the names that studies use, each in the unit at the end of its name or in 1.
    pub(crate) observables: BTreeMap<&'static str, Spread>,
}

impl Summary {
    /// The summary of the results; `interval` is the time between pictures that follow each other, s.
    pub(crate) fn new(images: &[ImageResult], interval: Option<f64>, settings: &Settings) -> Self {
        let angles: Vec<f64> = images.iter().filter_map(|i| i.angle_deg).collect();
        let series: Option<SeriesSummary> = summarise(&angles).ok();
        let finite = |value: Option<f64>| value.filter(|v| v.is_finite());
        // All pictures share the error of the camera's roll; that of a heap cancels between its flanks.
        let shared = match settings.mode {
            Mode::Drum => settings.camera_roll_error.to_degrees(),
            Mode::Heap => 0.0,
        };
        let count = |verdict| images.iter().filter(|i| i.verdict == verdict).count();
        Self {
            n: angles.len(),
            mean_deg: finite(series.map(|s| s.mean)),
            sd_deg: finite(series.map(|s| s.sd)),
            se_deg: finite(series.map(|s| s.standard_error.hypot(shared))),
            n_effective: finite(series.map(|s| s.n_effective)),
            refused: count("refused"),
            largest_bias: series.and_then(|s| LargestBias::new(&s, images.len() - angles.len())),
            too_rough: TooRough::new(images),
            unread: count("error"),
            interface: {
                let surfaces: Vec<Heights> = images.iter().filter_map(|i| i.heights).collect();
                Interface::of(&surfaces)
            },
            observables: observables(images, interval),
        }
    }

    /// The line for people.
    pub(crate) fn text(&self) -> String {
        let number = |value: Option<f64>| value.map_or("-".to_owned(), |v| format!("{v:.2}"));
        let unread = match self.unread {
            0 => String::new(),
            unread => format!(", {unread} not read"),
        };
        let bias = self
            .largest_bias
            .as_ref()
            .map_or_else(String::new, LargestBias::text);
        let rough = self
            .too_rough
            .as_ref()
            .map_or_else(String::new, TooRough::text);
        let interface = self
            .interface
            .as_ref()
            .map_or_else(String::new, Interface::text);
        format!(
            "mean {} deg, sd {}, se {}, {} measured, {} refused{unread}{bias}{rough}{interface}",
            number(self.mean_deg),
            number(self.sd_deg),
            number(self.se_deg),
            self.n,
            self.refused
        )
    }
}

/// What is measured of a drum beside the angle, over all pictures.
fn observables(images: &[ImageResult], interval: Option<f64>) -> BTreeMap<&'static str, Spread> {
    let of = |value: fn(&ImageResult) -> Option<f64>| -> Vec<f64> {
        images.iter().filter_map(value).collect()
    };
    let all = [
        ("angle_deg", of(|i| i.high_side.and(i.angle_deg))),
        ("curvature", of(|i| i.curvature)),
        ("s_shape", of(|i| i.s_shape)),
        ("shape_4", of(|i| i.shape_4)),
        ("shape_5", of(|i| i.shape_5)),
        ("fill_level", of(|i| i.fill_level)),
        ("toe_position_deg", of(|i| i.toe_position_deg)),
        ("top_position_deg", of(|i| i.top_position_deg)),
    ];
    let of_all = all.into_iter();
    let mut found: BTreeMap<_, _> = of_all
        .filter_map(|(name, values)| Some((name, spread(&values)?)))
        .collect();
    if let Some(interval) = interval {
        found.extend(of_time(images, interval));
    }
    found
}

/// What the line through the surface tells of time, from the longest stretch of pictures that were all measured.
fn of_time(images: &[ImageResult], interval: f64) -> Vec<(&'static str, Spread)> {
    let lines: Vec<Option<f64>> = images.iter().map(|i| i.line_deg).collect();
    let series = longest_unbroken(&lines);
    let memory = correlation_time(&series, interval).map(|found| Spread {
        mean: found.time,
        sd: None,
        se: Some(found.standard_error),
        n_effective: 1.0,
    });
    let falls = avalanches(&series, interval);
    let of_falls = |values: fn(&Avalanches) -> &[f64]| spread(values(falls.as_ref()?));
    let all = [
        ("angle_correlation_time_s", memory),
        ("avalanche_size_deg", of_falls(|f| &f.sizes)),
        ("avalanche_start_deg", of_falls(|f| &f.start_angles)),
        ("avalanche_stop_deg", of_falls(|f| &f.stop_angles)),
        ("avalanche_waiting_time_s", of_falls(|f| &f.waiting_times)),
    ];
    let told = all.into_iter();
    told.filter_map(|(name, value)| Some((name, value?)))
        .collect()
}

/// Mean and spread of values; none of nothing.
fn spread(values: &[f64]) -> Option<Spread> {
    let finite = |value: f64| value.is_finite().then_some(value);
    let series = summarise(values).ok()?;
    Some(Spread {
        mean: series.mean,
        sd: finite(series.sd),
        se: finite(series.standard_error),
        n_effective: series.n_effective,
    })
}

#[cfg(test)]
mod tests {
    use super::Summary;
    use crate::results::ImageResult;
    use photo_profile::Settings;

    /// Pictures with lines at some angles, and pictures refused as too rough with lines at others, deg.
    fn pictures(measured: &[f64], rough: &[f64]) -> Vec<ImageResult> {
        let read = measured.iter().map(|&line| ImageResult {
            verdict: "ok",
            angle_deg: Some(line),
            line_deg: Some(line),
            ..ImageResult::default()
        });
        let refused = rough.iter().map(|&line| ImageResult {
            verdict: "refused",
            rough_line_deg: Some(line),
            ..ImageResult::default()
        });
        read.chain(refused).collect()
    }

    /// Means of 39 and 44 with spreads below 1: the mean of those that were measured is not that of the bed. Means of 39 and
    /// 39.2 with the same spreads tell nothing of that kind. Exact but for rounding.
    #[test]
    fn surfaces_refused_as_too_rough_are_told_where_they_stand_elsewhere() {
        let measured = [38.0, 39.5, 38.5, 40.0, 39.0];
        let steep = Summary::new(
            &pictures(&measured, &[43.5, 44.5, 44.0]),
            None,
            &Settings::default(),
        );
        let found = steep.too_rough.expect("three are refused as too rough");
        assert_eq!((found.n, steep.refused, steep.n), (3, 3, 5));
        assert!((found.difference_deg - 5.0).abs() < 1e-12, "{found:?}");
        assert!(steep.text().contains("+5.00"), "{}", steep.text());
        assert!(steep.text().contains("--max-error-deg"), "{}", steep.text());

        // Three of eight are too many. One of eight: z = 1.150, density 0.206, l = 0.235, 0.287 of the standard deviation 0.746 deg.
        assert!(
            steep.text().contains("3 without an angle: too many"),
            "{}",
            steep.text()
        );
        let one = Summary::new(
            &pictures(&[38.0, 39.5, 38.5, 40.0, 39.0, 39.0, 38.0], &[43.5]),
            None,
            &Settings::default(),
        );
        let bias = one.largest_bias.expect("one is lost");
        assert!(
            bias.borne && (bias.deg.unwrap() - 0.21435).abs() < 1e-5,
            "{bias:?}"
        );

        let alike = Summary::new(
            &pictures(&measured, &[38.7, 39.7, 39.2]),
            None,
            &Settings::default(),
        );
        assert!(!alike.text().contains("biased"), "{}", alike.text());
        let fine = Summary::new(&pictures(&measured, &[]), None, &Settings::default());
        assert!(fine.too_rough.is_none(), "{:?}", fine.too_rough);
        assert!(fine.largest_bias.is_none(), "{:?}", fine.largest_bias);
    }
}
