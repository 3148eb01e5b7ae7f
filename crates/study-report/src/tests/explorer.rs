//! The data behind the sliders: all that a prediction needs, and the numbers that a fit gives.

use super::page;
use crate::exploration::of_calibration;
use crate::test_input::example;
use crate::test_study::{HOSTILE, study};
use report::ExploredSurface;
use serde_json::Value;

/// The JSON of the elements of a class.
pub(super) fn data(page: &str, class: &str) -> Vec<Value> {
    let begin = format!("<script type=\"application/json\" class=\"{class}\">");
    let texts = page.split(begin.as_str()).skip(1);
    texts
        .map(|text| serde_json::from_str(text.split("</script>").next().unwrap()).unwrap())
        .collect()
}

/// A list of numbers.
fn numbers(value: &Value) -> Vec<f64> {
    let list = value.as_array().unwrap();
    list.iter().map(|x| x.as_f64().unwrap()).collect()
}

/// Mean and both intervals by the formulas of [`ExploredSurface`], from the JSON alone, at values of its parameters.
fn predicted(surface: &Value, at: &[f64]) -> [f64; 5] {
    let (middle, half) = (numbers(&surface["middle"]), numbers(&surface["half"]));
    let x: Vec<f64> = (0..at.len())
        .map(|j| (at[j] - middle[j]) / half[j])
        .collect();
    let power = |p: &Value, x: &f64| x.powi(i32::try_from(p.as_i64().unwrap()).unwrap());
    let term = |t: &Value| -> f64 {
        let powers = t.as_array().unwrap();
        powers.iter().zip(&x).map(|(p, x)| power(p, x)).product()
    };
    let row: Vec<f64> = surface["powers"]
        .as_array()
        .unwrap()
        .iter()
        .map(term)
        .collect();
    let dot = |line: &Value| -> f64 { numbers(line).iter().zip(&row).map(|(c, r)| c * r).sum() };
    let mean = dot(&surface["coefficients"]);
    let lines = surface["covariance_over_variance"].as_array().unwrap();
    let leverage: f64 = lines.iter().zip(&row).map(|(line, r)| r * dot(line)).sum();
    let (s2, t) = (
        surface["error_variance"].as_f64().unwrap(),
        surface["t_limit"].as_f64().unwrap(),
    );
    let [narrow, wide] = [leverage, 1.0 + leverage].map(|share| t * (s2 * share).sqrt());
    [mean, mean - narrow, mean + narrow, mean - wide, mean + wide]
}

/// Points of a study: values of the sliders F, E and G.
pub(super) const POINTS: [[f64; 3]; 4] = [
    [0.31, 0.4, 1.5],
    [0.1, 0.6, 1.0],
    [0.237, 0.555, 1.93],
    [0.6, 0.1, 2.0],
];

/// The data give what the fit predicts, at the estimate and elsewhere. Both sum the same terms, in an order of their own:
/// 1e-12 of the value is rounding, and a wrong variance, quantile or place of a parameter is more.
#[test]
fn the_data_of_the_sliders_give_the_predictions_of_the_fits() {
    let study = study();
    let data = data(&page(&study), "surfaces");
    assert_eq!(data.len(), 1);
    let fits = study.calibration.surfaces.iter();
    let fits: Vec<_> = fits.flat_map(|s| s.fits.values().flatten()).collect();
    let surfaces = data[0]["surfaces"].as_array().unwrap();
    assert_eq!((surfaces.len(), fits.len()), (3, 3));
    for (surface, fit) in surfaces.iter().zip(fits) {
        for point in POINTS {
            let sliders = surface["parameters"].as_array().unwrap().iter();
            let at: Vec<f64> = sliders
                .map(|j| point[usize::try_from(j.as_u64().unwrap()).unwrap()])
                .collect();
            let told = fit.predict(&at).unwrap();
            let ([low, high], [lowest, highest]) = (told.ci95.unwrap(), told.pi95.unwrap());
            let expected = [told.mean, low, high, lowest, highest];
            for (found, expected) in predicted(surface, &at).into_iter().zip(expected) {
                assert!(
                    (found - expected).abs() < 1e-12 * expected.abs(),
                    "{found} {expected} of {} at {point:?}",
                    surface["name"]
                );
            }
        }
    }
}

/// The sliders are those of the parameters, in natural units over the ranges of the runs, and begin at the estimate.
#[test]
fn every_parameter_has_a_slider_over_the_ranges_of_the_runs() {
    let study = study();
    let explorer = of_calibration(&study.input()).unwrap();
    let found = &study.calibration;
    assert_eq!(explorer.parameters.len(), 3);
    for ((slider, p), j) in explorer.parameters.iter().zip(&found.parameters).zip(0..) {
        let last = found.boxes.last().unwrap();
        assert_eq!(
            (slider.symbol.as_str(), slider.name.as_str()),
            (p.symbol.as_str(), p.name.as_str())
        );
        assert!((last.low[j]..=last.high[j]).contains(&p.value));
        assert_eq!([slider.low, slider.high], [last.low[j], last.high[j]]);
        assert_eq!(explorer.places[0].values[j], p.value);
    }
    assert_eq!(explorer.places[0].name, "estimate");
    assert_eq!(explorer.parameters[2].unit, "mm");
    let names: Vec<&str> = explorer.surfaces.iter().map(|s| s.name.as_str()).collect();
    let angle = "drum, speed 15 rpm: angle (fit)";
    assert!(names.contains(&angle), "{names:?}");
    let of = |surface: &ExploredSurface| surface.measured.unwrap();
    assert!(explorer.surfaces.iter().all(|s| of(s).se > 0.0));
}

/// A parameter whose name ends a script stays text, in the page and in the data of its scripts.
#[test]
fn a_name_that_ends_a_script_stays_text_in_page_and_data() {
    let page = page(&study());
    assert!(!page.contains("<script>alert"), "a name became a script");
    assert!(!page.contains("<!-- &"), "a name became a comment");
    assert_eq!(data(&page, "surfaces")[0]["parameters"][0]["name"], HOSTILE);
    let ends = page.matches("</script>").count();
    assert_eq!(ends, page.matches("<script").count());
}

/// The sled depends on F alone, so that E has no slider where only the sled has a surface; with no surface there is no
/// section.
#[test]
fn a_parameter_that_moves_no_surface_has_no_slider() {
    let mut example = example();
    example.calibration.surfaces.remove(0);
    let explorer = of_calibration(&example.input()).unwrap();
    let symbols = explorer.parameters.iter().map(|p| p.symbol.as_str());
    assert_eq!(symbols.collect::<Vec<_>>(), ["F"]);
    example.calibration.surfaces.clear();
    assert!(of_calibration(&example.input()).is_none());
    assert!(!page(&example).contains("Try other parameters"));
}
