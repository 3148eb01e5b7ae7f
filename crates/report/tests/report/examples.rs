//! One example of every chart, with markup in every text.

use report::{
    AxisTitle, Bar, BarsWithTarget, Comparison, Contour, DesignRun, Error, FactorEffect,
    HalfNormal, Level, LineSeries, MarkedPoint, Pareto, PredictedAgainstMeasured,
    ResidualCondition, ResidualPanel, Residuals, Role, Scatter, Series, SeriesPoint, StackedBar,
    StackedBars, Svg, Target, TimeSeries, TimeSpan,
};

/// A text that breaks a page if it is not escaped.
pub(crate) const HOSTILE: &str = "</text><b x=\"&'\">";

/// A hostile title.
fn title() -> AxisTitle {
    AxisTitle::new(HOSTILE, HOSTILE)
}

/// Pareto chart of these effects.
pub(crate) fn pareto(values: &[f64]) -> Pareto {
    let effects = values
        .iter()
        .map(|&value| FactorEffect::new(HOSTILE, value))
        .collect();
    Pareto {
        size: title(),
        effects,
        limits: vec![Level::new(HOSTILE, 2.0), Level::new("b", 2.1)],
    }
}

/// Bars of two parts each.
pub(crate) fn stacked_bars(values: &[f64]) -> StackedBars {
    let bars = values.iter().map(|&size| StackedBar {
        name: HOSTILE.into(),
        sizes: vec![size, -0.5 * size],
    });
    StackedBars {
        size: title(),
        parts: vec![HOSTILE.into(), "b".into()],
        bars: bars.collect(),
        limits: vec![Level::new(HOSTILE, 2.0)],
    }
}

/// Half-normal plot of these effects.
pub(crate) fn half_normal(values: &[f64]) -> HalfNormal {
    let effects = values
        .iter()
        .map(|&value| FactorEffect::new(HOSTILE, value))
        .collect();
    HalfNormal {
        size: title(),
        effects,
        standard_error: Some(0.4),
        named_above: 0.5,
        limits: vec![Level::new(HOSTILE, 0.5)],
    }
}

/// Contours of these values on two columns.
pub(crate) fn contour(values: &[f64]) -> Contour {
    Contour {
        x: title(),
        y: title(),
        response: title(),
        x_values: vec![0.0, 1.0],
        y_values: (0..values.len() / 2).map(|row| row as f64).collect(),
        values: values.to_vec(),
        target: Some(Level::new(HOSTILE, 1.5)),
        region_name: HOSTILE.into(),
        region: values.iter().map(|value| value - 1.0).collect(),
        points: vec![MarkedPoint {
            name: HOSTILE.into(),
            x: 0.5,
            y: 0.5,
        }],
        runs: vec![DesignRun {
            name: HOSTILE.into(),
            x: 0.5,
            y: 0.5,
            link: "#section-1".into(),
        }],
    }
}

/// These values over 0, 1, 2 and so on, each with a name.
pub(crate) fn scatter(values: &[f64]) -> Scatter {
    let points = values.iter().enumerate();
    Scatter {
        x: title(),
        y: title(),
        points: points
            .map(|(index, &value)| [index as f64, value])
            .collect(),
        names: vec![HOSTILE.into(); values.len()],
        marked: vec![MarkedPoint {
            name: HOSTILE.into(),
            x: 0.5,
            y: 0.5,
        }],
        line: Some([0.0, 1.0]),
        levels: vec![Level::new(HOSTILE, 2.0), Level::new("b", -1.0)],
    }
}

/// Predictions around these values.
pub(crate) fn predicted(values: &[f64]) -> PredictedAgainstMeasured {
    let comparisons = values
        .iter()
        .enumerate()
        .map(|(index, &value)| Comparison {
            name: HOSTILE.into(),
            measured: value,
            measured_error: 0.1,
            predicted: value + 0.2,
            predicted_error: 0.3,
            role: if index % 2 == 0 {
                Role::Fit
            } else {
                Role::Check
            },
        })
        .collect();
    PredictedAgainstMeasured {
        observable: title(),
        comparisons,
    }
}

/// Residuals of these values.
pub(crate) fn residuals(values: &[f64]) -> Residuals {
    let before: Vec<Option<f64>> = values.iter().copied().map(Some).collect();
    let panel = ResidualPanel {
        observable: title(),
        noise: vec![0.5; before.len()],
        residuals: vec![before.clone(), vec![None; before.len()], before],
    };
    Residuals {
        models: vec![HOSTILE.into(); 3],
        noise_name: HOSTILE.into(),
        conditions: values
            .iter()
            .map(|_| ResidualCondition {
                name: HOSTILE.into(),
                role: Role::Check,
            })
            .collect(),
        panels: vec![panel.clone(), panel],
    }
}

/// Two series of these values over 0, 1, 2 and so on.
pub(crate) fn lines(values: &[f64]) -> LineSeries {
    let points: Vec<SeriesPoint> = values
        .iter()
        .enumerate()
        .map(|(index, &value)| SeriesPoint::new(index as f64, value, 0.1))
        .collect();
    let series = Series {
        name: HOSTILE.into(),
        points,
    };
    LineSeries {
        x: title(),
        y: title(),
        series: vec![series.clone(), series],
        levels: vec![Level::new(HOSTILE, 1.0)],
    }
}

/// Bars of these values.
pub(crate) fn bars(values: &[f64]) -> BarsWithTarget {
    BarsWithTarget {
        value_title: title(),
        bars: values
            .iter()
            .map(|&value| Bar {
                name: HOSTILE.into(),
                value,
                error: 0.2,
            })
            .collect(),
        target: Target {
            name: HOSTILE.into(),
            value: 1.0,
            half_width: 0.1,
        },
    }
}

/// A time series of these values at 0, 1, 2 and so on.
pub(crate) fn timeseries(values: &[f64]) -> TimeSeries {
    TimeSeries {
        time_title: title(),
        value_title: title(),
        times: (0..values.len()).map(|index| index as f64).collect(),
        values: values.to_vec(),
        steady: Some(TimeSpan { from: 0.5, to: 1.0 }),
        samples: vec![0.75],
        levels: vec![Level::new(HOSTILE, 1.0)],
    }
}

/// Every chart of the same values.
pub(crate) fn all(values: &[f64]) -> Vec<(&'static str, Result<Svg, Error>)> {
    vec![
        ("pareto", pareto(values).draw()),
        ("half-normal", half_normal(values).draw()),
        ("stacked-bars", stacked_bars(values).draw()),
        ("contour", contour(values).draw()),
        ("scatter", scatter(values).draw()),
        ("predicted", predicted(values).draw()),
        ("residuals", residuals(values).draw()),
        ("lines", lines(values).draw()),
        ("bars", bars(values).draw()),
        ("timeseries", timeseries(values).draw()),
    ]
}
