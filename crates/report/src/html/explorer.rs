//! Predictions of response surfaces that follow sliders.

use serde::Serialize;
use std::fmt::Write as _;

use super::script::data_element;
use crate::Error;
use crate::check::Field;
use crate::escape::escaped;

/// Name of this part, for messages.
const CHART: &str = "explorer";
/// Width of the picture in a row, px.
const WIDTH: f64 = 200.0;
/// Half width of a two-sided 95 % interval of a normal distribution, in standard errors; for measured means.
const NORMAL_975: f64 = 1.959_963_984_540_054;

/// A parameter that a slider moves.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SliderParameter {
    /// Symbol.
    pub symbol: String,
    /// Name for the reader.
    pub name: String,
    /// Unit of its values; empty for a plain number.
    pub unit: String,
    /// Lower end of the slider, unit of the parameter.
    pub low: f64,
    /// Upper end of the slider, unit of the parameter.
    pub high: f64,
}

/// A named place for all sliders.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NamedPlace {
    /// Name of the place.
    pub name: String,
    /// Values of the parameters in their order, units of the parameters.
    pub values: Vec<f64>,
}

/// A measured value beside a surface.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ExploredTarget {
    /// Measured mean, unit of the surface.
    pub mean: f64,
    /// Its standard error, unit of the surface.
    pub se: f64,
}

/// Prediction of a surface at the start of the sliders.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ExploredPrediction {
    /// Mean, unit of the surface.
    pub mean: f64,
    /// Standard error of the mean; none without degrees of freedom.
    pub se_mean: Option<f64>,
    /// 95 % interval of the mean.
    pub mean95: Option<[f64; 2]>,
    /// 95 % prediction interval of a new observation.
    pub new95: Option<[f64; 2]>,
}

/// A polynomial in coded parameters with all that its predictions need.
///
/// # Formula
/// `x_j = (u_j - middle_j) / half_j`; the row r holds each term's product of powers of x; mean `r b`; with the error
/// variance s² and t the limit, `se_mean = s sqrt(r C r')`, the interval of the mean is `mean ± t se_mean`, and that of
/// a new observation `mean ± t s sqrt(1 + r C r')` `[Myers2016, chapter 2]`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ExploredSurface {
    /// Name of the predicted quantity.
    pub name: String,
    /// Its unit; empty for a plain number.
    pub unit: String,
    /// Decimals that are shown.
    pub decimals: usize,
    /// Numbers of the sliders that it depends on, from 0.
    pub parameters: Vec<usize>,
    /// Value of each of these parameters at coded 0.
    pub middle: Vec<f64>,
    /// Length of a coded unit of each.
    pub half: Vec<f64>,
    /// Powers of each term, (terms, parameters of the surface).
    pub powers: Vec<Vec<u8>>,
    /// Coefficients b of the terms, coded.
    pub coefficients: Vec<f64>,
    /// C, the covariance of the coefficients over the error variance, (terms, terms).
    pub covariance_over_variance: Vec<Vec<f64>>,
    /// s², variance of an observation, squared unit of the surface; none without degrees of freedom.
    pub error_variance: Option<f64>,
    /// Two-sided 5 % limit of Student's t.
    pub t_limit: Option<f64>,
    /// The measured value; `None` if it was not measured.
    pub measured: Option<ExploredTarget>,
    /// Ends of the axis of its picture, unit of the surface.
    pub axis: [f64; 2],
    /// Its prediction at the start of the sliders.
    pub prediction: ExploredPrediction,
}

/// Surfaces over common parameters.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Explorer {
    /// The parameters.
    pub parameters: Vec<SliderParameter>,
    /// Places to which all sliders can be set; they begin at the first.
    pub places: Vec<NamedPlace>,
    /// The surfaces.
    pub surfaces: Vec<ExploredSurface>,
}

impl Explorer {
    /// Refuses what cannot be shown.
    ///
    /// # Errors
    /// [`Error`] without a parameter, place or surface, for lists that do not match, ends that do not ascend, or a number
    /// that is not finite.
    pub fn check(&self) -> Result<(), Error> {
        let k = self.parameters.len();
        Field::new(CHART, "parameters").at_least(1, k)?;
        Field::new(CHART, "places").at_least(1, self.places.len())?;
        Field::new(CHART, "surfaces").at_least(1, self.surfaces.len())?;
        for parameter in &self.parameters {
            Field::new(CHART, "end of a slider").ascending(&[parameter.low, parameter.high])?;
        }
        for place in &self.places {
            Field::new(CHART, "values of a place").length(k, "parameter", place.values.len())?;
            Field::new(CHART, "value of a place").finite(place.values.iter().copied())?;
        }
        self.surfaces.iter().try_for_each(|s| s.check(k))
    }

    /// The table of the predictions where the sliders begin, with the data for the script.
    pub(crate) fn markup(&self, number: usize, caption: &str) -> String {
        let is_measured = self
            .surfaces
            .iter()
            .any(|surface| surface.measured.is_some());
        let measured = if is_measured { MEASURED } else { "" };
        let mut markup = format!(
            "<div class=\"explorer\">\n{}\n<div class=\"table\"><table>\n<caption><b>Table {number}.</b> {}</caption>\n\
             <thead><tr><th scope=\"col\">observable</th><th scope=\"col\" class=\"right\">predicted</th>\
             <th scope=\"col\" class=\"right\">95 % of the mean</th>\
             <th scope=\"col\" class=\"right\">95 % of a new one</th><th scope=\"col\" class=\"picture\">picture</th>\
             {measured}</tr></thead>\n<tbody>\n",
            data_element("surfaces", self),
            escaped(caption)
        );
        for surface in &self.surfaces {
            markup.push_str(&surface.row(is_measured));
        }
        markup.push_str("</tbody></table></div></div>");
        markup
    }
}

impl ExploredSurface {
    /// Refuses what cannot be shown.
    fn check(&self, n_sliders: usize) -> Result<(), Error> {
        let (k, p) = (self.parameters.len(), self.powers.len());
        let field = |name| Field::new(CHART, name);
        let beyond = self.parameters.iter().filter(|j| **j >= n_sliders).count();
        field("parameters without a slider").length(0, "surface", beyond)?;
        field("middle").length(k, "parameter", self.middle.len())?;
        field("half").length(k, "parameter", self.half.len())?;
        field("coefficients").length(p, "term", self.coefficients.len())?;
        field("covariance").length(p, "term", self.covariance_over_variance.len())?;
        for (powers, line) in self.powers.iter().zip(&self.covariance_over_variance) {
            field("powers").length(k, "parameter", powers.len())?;
            field("line of the covariance").length(p, "term", line.len())?;
            field("covariance").finite(line.iter().copied())?;
        }
        field("middle").finite(self.middle.iter().copied())?;
        field("half").finite(self.half.iter().map(|half| 1.0 / half))?;
        field("coefficient").finite(self.coefficients.iter().copied())?;
        field("error variance").not_negative(self.error_variance)?;
        field("t limit").not_negative(self.t_limit)?;
        field("measured").finite(self.measured.iter().flat_map(|m| [m.mean, m.se]))?;
        field("axis").ascending(&self.axis)?;
        field("prediction").finite([self.prediction.mean])?;
        let ends = [self.prediction.mean95, self.prediction.new95];
        field("interval").finite(ends.into_iter().flatten().flatten())
    }

    /// The row of the table, with what was measured where the table has columns for it. The script fills the cells with a class
    /// again.
    fn row(&self, is_measured: bool) -> String {
        let shown = &self.prediction;
        let ends = |ends: Option<[f64; 2]>| match ends {
            Some([low, high]) => {
                let both = format!("{} to {}", self.number(low), self.number(high));
                self.in_unit(&both)
            }
            None => DASH.into(),
        };
        let mut row = format!("<tr><td>{}</td>", escaped(&self.name));
        let mean = self.in_unit(&self.number(shown.mean));
        row.push_str(&cell("right mean", &escaped(&mean)));
        row.push_str(&cell("right mean95", &escaped(&ends(shown.mean95))));
        row.push_str(&cell("right new95", &escaped(&ends(shown.new95))));
        row.push_str(&cell("picture", &self.picture()));
        if is_measured {
            row.push_str(&self.measured_cells());
        }
        row.push_str("</tr>\n");
        row
    }

    /// The cells of what was measured, beside the prediction.
    fn measured_cells(&self) -> String {
        let shown = &self.prediction;
        let measured = self.measured.as_ref().map_or_else(
            || DASH.into(),
            |m| self.in_unit(&format!("{} ± {}", self.number(m.mean), self.number(m.se))),
        );
        let inside = match (&self.measured, shown.new95) {
            (Some(m), Some([low, high])) if (low..=high).contains(&m.mean) => "yes",
            (Some(_), Some(_)) => "no",
            _ => DASH,
        };
        let z = self.measured.as_ref().zip(shown.se_mean);
        let z = z.map(|(m, se)| (m.mean - shown.mean) / m.se.hypot(se));
        let z = z.filter(|z| z.is_finite());
        let z = z.map_or_else(|| DASH.into(), signed);
        [
            cell("right", &escaped(&measured)),
            cell("inside", inside),
            cell("right z", &z),
        ]
        .concat()
    }

    /// Intervals, mean and measured band along the axis of the surface.
    fn picture(&self) -> String {
        let [low, high] = self.axis;
        let place = |value: f64| (WIDTH * (value - low) / (high - low)).clamp(0.0, WIDTH);
        let mut picture = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"22\" viewBox=\"0 0 {WIDTH} 22\" \
             role=\"img\"><title>predicted and measured, {} to {}</title>\
             <rect class=\"axis\" x=\"0\" y=\"10.5\" width=\"{WIDTH}\" height=\"1\"/>",
            escaped(&self.in_unit(&self.number(low))),
            escaped(&self.in_unit(&self.number(high)))
        );
        let mut bar = |class: &str, [from, to]: [f64; 2], height: f64| {
            let (x, y) = (place(from), 11.0 - 0.5 * height);
            let width = (place(to) - x).max(1.5);
            write!(
                picture,
                "<rect class=\"{class}\" x=\"{x:.2}\" y=\"{y}\" width=\"{width:.2}\" height=\"{height}\"/>"
            )
            .expect("a String takes any text");
        };
        if let Some(m) = &self.measured {
            let half = NORMAL_975 * m.se;
            bar("target", [m.mean - half, m.mean + half], 20.0);
        }
        let shown = &self.prediction;
        bar(
            "new95",
            shown.new95.unwrap_or([shown.mean, shown.mean]),
            4.0,
        );
        bar(
            "mean95",
            shown.mean95.unwrap_or([shown.mean, shown.mean]),
            10.0,
        );
        picture.push_str("</svg>");
        picture
    }

    /// A number with the decimals of the surface.
    fn number(&self, value: f64) -> String {
        let decimals = self.decimals;
        without_hyphen(&format!("{value:.decimals$}"))
    }

    /// A text followed by the unit.
    fn in_unit(&self, text: &str) -> String {
        match self.unit.as_str() {
            "" => text.to_owned(),
            "°" => format!("{text}°"),
            unit => format!("{text} {unit}"),
        }
    }
}

/// A cell of the table.
fn cell(class: &str, text: &str) -> String {
    format!("<td class=\"{class}\">{text}</td>")
}

/// Heads of the columns of what was measured.
const MEASURED: &str = "<th scope=\"col\" class=\"right\">measured</th><th scope=\"col\">inside</th>\
     <th scope=\"col\" class=\"right\">z</th>";

/// Text of an empty cell.
const DASH: &str = "–";

/// A number of standard errors with its sign.
fn signed(z: f64) -> String {
    without_hyphen(&format!("{z:+.1}"))
}

/// A number with the sign of mathematics; a rounded zero has none.
fn without_hyphen(text: &str) -> String {
    let zero = text.chars().all(|c| matches!(c, '-' | '+' | '0' | '.'));
    if zero {
        return text.trim_start_matches(['-', '+']).to_owned();
    }
    text.replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A plane over one slider: 5 + 2 x, variance 0.04.
    fn explorer() -> Explorer {
        Explorer {
            parameters: vec![SliderParameter {
                symbol: "F".into(),
                name: "</script><script>alert(1)</script>".into(),
                unit: "mm".into(),
                low: 1.0,
                high: 3.0,
            }],
            places: vec![NamedPlace {
                name: "estimate".into(),
                values: vec![2.0],
            }],
            surfaces: vec![ExploredSurface {
                name: "drum: angle".into(),
                unit: "°".into(),
                decimals: 1,
                parameters: vec![0],
                middle: vec![2.0],
                half: vec![1.0],
                powers: vec![vec![0], vec![1]],
                coefficients: vec![5.0, 2.0],
                covariance_over_variance: vec![vec![0.5, 0.0], vec![0.0, 0.5]],
                error_variance: Some(0.04),
                t_limit: Some(4.0),
                measured: Some(ExploredTarget { mean: 5.6, se: 0.1 }),
                axis: [0.0, 10.0],
                prediction: ExploredPrediction {
                    mean: 5.0,
                    se_mean: Some(0.1),
                    mean95: Some([4.6, 5.4]),
                    new95: Some([4.1, 5.9]),
                },
            }],
        }
    }

    #[test]
    fn without_a_script_the_predictions_stand_in_a_table() {
        let markup = explorer().markup(3, "Predictions.");
        for part in [
            "<b>Table 3.</b> Predictions.",
            "<td class=\"right mean\">5.0°</td>",
            "<td class=\"right mean95\">4.6 to 5.4°</td>",
            "<td class=\"right new95\">4.1 to 5.9°</td>",
            "<td class=\"right\">5.6 ± 0.1°</td>",
            "<td class=\"inside\">yes</td>",
            // 0.6 / sqrt(0.1² + 0.1²).
            "<td class=\"right z\">+4.2</td>",
            // 4.1 of 10 on 200 px, and 1.8 wide.
            "<rect class=\"new95\" x=\"82.00\" y=\"9\" width=\"36.00\" height=\"4\"/>",
        ] {
            assert!(markup.contains(part), "{part} is not in {markup}");
        }
        let mut outside = explorer();
        outside.surfaces[0].prediction.new95 = Some([4.1, 5.5]);
        assert!(
            outside
                .markup(1, "")
                .contains("<td class=\"inside\">no</td>")
        );
    }

    /// The columns of measurements are left out if there are none; heads and cells stay alike in number.
    #[test]
    fn without_measurements_there_are_no_columns_for_them() {
        let mut unmeasured = explorer();
        unmeasured.surfaces[0].measured = None;
        for (explorer, columns) in [(explorer(), 8), (unmeasured, 5)] {
            let markup = explorer.markup(1, "");
            assert_eq!(markup.matches("<th ").count(), columns, "{markup}");
            assert_eq!(markup.matches("<td").count(), columns, "{markup}");
        }
    }

    #[test]
    fn a_name_with_markup_stays_text_in_the_data() {
        let markup = explorer().markup(1, "");
        assert_eq!(markup.matches("<script").count(), 1, "{markup}");
        assert_eq!(markup.matches("</script>").count(), 1, "{markup}");
    }

    #[test]
    fn what_does_not_match_is_refused() {
        assert!(explorer().check().is_ok());
        let broken: [fn(&mut Explorer); 9] = [
            |e| e.parameters.clear(),
            |e| e.places.clear(),
            |e| e.surfaces.clear(),
            |e| e.parameters[0].high = 1.0,
            |e| e.places[0].values.push(1.0),
            |e| e.surfaces[0].parameters[0] = 1,
            |e| e.surfaces[0].coefficients[1] = f64::NAN,
            |e| e.surfaces[0].half[0] = 0.0,
            |e| e.surfaces[0].powers[1].push(1),
        ];
        for (number, spoil) in broken.into_iter().enumerate() {
            let mut explorer = explorer();
            spoil(&mut explorer);
            assert!(explorer.check().is_err(), "{number}");
        }
    }
}
