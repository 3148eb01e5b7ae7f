//! What the measurements fix: correlations, open combinations, the set of solutions, the test of the fit.

use super::Page;
use crate::Error;
use crate::numbers::{
    DASH, digits, digits_or_dash, fixed, fixed_or_dash, in_unit, p_in_words, signed, with_error,
};
use crate::open_words::open_in_words;
use crate::pictures::solution_charts::{misfit, pair, pairs};
use inference::{Calibration, FitTest, JointEstimate};
use report::{Column, Table, counted};

/// Adds both sections.
pub(super) fn add(page: &mut Page<'_>) -> Result<(), Error> {
    let found = page.input.calibration;
    page.report
        .section("What the measurements fix")
        .paragraph(&test_in_words(&found.test));
    correlations(page, "Correlations of the estimates.", &found.correlation)?;
    let lines: Vec<String> = found
        .open_combinations
        .iter()
        .map(|c| open_in_words(c, &found.parameters))
        .collect();
    super::list(&mut page.report, "What they leave open:", &lines);
    next_measurement(page)?;
    solutions(page)?;
    compare(page)?;
    match &found.joint {
        Some(joint) => joint_estimate(page, joint),
        None => Ok(()),
    }
}

/// The test of a fit in a sentence.
fn test_in_words(test: &FitTest) -> String {
    let misfit = format!(
        "Sum of squares of what the fit leaves: {}",
        digits(test.misfit)
    );
    match test.degrees_of_freedom {
        0 => format!(
            "{misfit}. There are as many parameters as measurements and priors: the fit tests nothing, and only \
             measurements of role check can speak against it."
        ),
        df => format!(
            "{misfit} with {}, {}. A small p says that the model misses more than noise.",
            counted(df, "degree of freedom", "degrees of freedom"),
            p_in_words(test.p)
        ),
    }
}

/// The matrix of correlations; nothing for a single parameter.
fn correlations(page: &mut Page<'_>, caption: &str, matrix: &[Vec<f64>]) -> Result<(), Error> {
    let parameters = &page.input.calibration.parameters;
    if parameters.len() < 2 || matrix.len() != parameters.len() {
        return Ok(());
    }
    let columns = parameters.iter().map(|p| Column::number(p.symbol.clone()));
    let columns = std::iter::once(Column::text("parameter")).chain(columns);
    let mut table = Table::new(caption, columns.collect())?;
    for (p, row) in parameters.iter().zip(matrix) {
        let numbers = (0..parameters.len()).map(|k| fixed_or_dash(row.get(k).copied(), 2));
        table.row(std::iter::once(p.symbol.clone()).chain(numbers))?;
    }
    page.table(&table);
    Ok(())
}

/// What to measure next; nothing if no parameter is open or no candidate is named.
fn next_measurement(page: &mut Page<'_>) -> Result<(), Error> {
    let found = page.input.calibration;
    let Some(next) = &found.next_for_parameters else {
        return Ok(());
    };
    page.report.paragraph(&format!(
        "What to measure next. The separation says how many standard errors apart the two ends of what agrees with the measurements \
         would be: now {}, and {} would do. It is taken where a candidate distinguishes the solutions worst; single runs that \
         scatter more than the stated standard deviation count instead of it, and the noise of the runs is taken off.",
        fixed(next.now, 1),
        digits(next.needed)
    ));
    let errors = found.parameters.iter();
    let errors = errors.map(|p| Column::number(format!("standard error of {}", p.symbol)));
    let mut columns = vec![
        Column::text("measurement"),
        Column::number("separation"),
        Column::number("minutes"),
    ];
    columns.extend(errors);
    let mut table = Table::new(
        "Candidates for the next measurement, the most helpful for its minutes first.",
        columns,
    )?;
    for ranked in &next.ranked {
        let mut row = vec![
            ranked.name.clone(),
            fixed(ranked.separation, 1),
            digits(ranked.minutes),
        ];
        row.extend(found.parameters.iter().map(|p| {
            let se = ranked.standard_errors.get(&p.symbol);
            in_unit(&digits_or_dash(se.copied().flatten()), &p.unit)
        }));
        table.row(row)?;
    }
    page.table(&table);
    let left_out = next.left_out.iter();
    let lines: Vec<String> = left_out
        .map(|(name, why)| format!("{name}: {why}"))
        .collect();
    super::list(
        &mut page.report,
        "Candidates that could not be run:",
        &lines,
    );
    Ok(())
}

/// The set of solutions.
fn solutions(page: &mut Page<'_>) -> Result<(), Error> {
    let found = page.input.calibration;
    let set = &found.solutions;
    // None of some thousand drawn points lies in a narrow set.
    let share = if set.share_of_box > 0.0 {
        digits(100.0 * set.share_of_box)
    } else {
        "less than 0.1".to_owned()
    };
    let said = if found.fit.iter().all(|row| row.holds) {
        format!("Of the last box {share} % agrees with all measurements of the fit at 95 %.")
    } else {
        format!(
            "No point of the last box agrees with all measurements of the fit; {share} % of it does nearly as well as the best \
             point (at 95 %)."
        )
    };
    page.report
        .subsection("The set of solutions")
        .paragraph(&said);
    let table = table_of_solutions(found)?;
    page.table(&table);
    page.chart(
        misfit(page.input)?.as_ref(),
        "Root of the sum of squares of z over the last box, by the surfaces of the measurements of the fit and the \
         priors; high walls are cut. A valley is a combination that is left open.",
    )?;
    pairs_of_parameters(page)
}

/// Extent of the set along each parameter, and its separate best points.
fn table_of_solutions(found: &Calibration) -> Result<Table, Error> {
    let set = &found.solutions;
    let names = (1..=set.separate.len()).map(|k| Column::number(format!("solution {k}")));
    let mut columns = vec![
        Column::text("parameter"),
        Column::number("lowest"),
        Column::number("highest"),
    ];
    columns.extend(names);
    let mut table = Table::new(
        "Lowest and highest value of each parameter in the set, and the separate best points, the best first.",
        columns,
    )?;
    for (j, p) in found.parameters.iter().enumerate() {
        let [low, high] = set
            .extent
            .get(j)
            .map_or([None, None], |[low, high]| [Some(*low), Some(*high)]);
        let unit = |value: Option<f64>| in_unit(&digits_or_dash(value), &p.unit);
        let mut row = vec![format!("{} {}", p.symbol, p.name), unit(low), unit(high)];
        let points = set.separate.iter();
        row.extend(points.map(|point| unit(point.get(j).copied())));
        table.row(row)?;
    }
    Ok(table)
}

/// A chart of each pair of parameters, of which the reader chooses one.
fn pairs_of_parameters(page: &mut Page<'_>) -> Result<(), Error> {
    let found = page.input.calibration;
    let mut charts = Vec::new();
    for [a, b] in pairs(page.input) {
        let Some(chart) = pair(page.input, [a, b]) else {
            continue;
        };
        let [x, y] = [&found.parameters[a], &found.parameters[b]];
        let others = if found.parameters.len() > 2 {
            "; the other parameters are free, within the set"
        } else {
            ""
        };
        let caption = format!(
            "Points of the set of solutions: {} against {}, drawn evenly from the set{others}.",
            y.symbol, x.symbol
        );
        let name = format!("{} and {}", x.symbol, y.symbol);
        charts.push((name, chart.draw()?, caption));
    }
    if !charts.is_empty() {
        page.report.choice("Pair of parameters:", &charts);
    }
    Ok(())
}

/// Values of others beside what was found; nothing without any.
fn compare(page: &mut Page<'_>) -> Result<(), Error> {
    if page.input.compare.is_empty() {
        return Ok(());
    }
    page.report.subsection("Beside values of others");
    let mut table = Table::new(
        "What was found (± standard error) beside what others give (± their standard deviation); nothing here enters \
         a fit.",
        vec![
            Column::text("result"),
            Column::number("found"),
            Column::number("other"),
            Column::number("difference"),
            Column::text("source"),
        ],
    )?;
    for c in page.input.compare {
        let (words, unit) = crate::numbers::observable(&c.result);
        let difference = c.found.map(|found| signed_digits(found - c.value));
        table.row([
            words,
            c.found
                .map_or_else(|| DASH.to_owned(), |found| with_error(found, c.se, unit)),
            with_error(c.value, c.sd, unit),
            difference.map_or_else(|| DASH.to_owned(), |d| in_unit(&d, unit)),
            c.source.clone(),
        ])?;
    }
    page.table(&table);
    Ok(())
}

/// About three digits with a sign.
fn signed_digits(value: f64) -> String {
    let sign = if value >= 0.0 { "+" } else { "" };
    format!("{sign}{}", digits(value))
}

/// The estimate from all measurements beside that of the fit alone.
fn joint_estimate(page: &mut Page<'_>, joint: &JointEstimate) -> Result<(), Error> {
    page.report.section("Joint estimate").paragraph(&format!(
        "The same from all measurements together, checks included, after the check was made. {}",
        test_in_words(&joint.test)
    ));
    let mut table = Table::new(
        "Parameters from the fit alone and from all measurements. The shift is in standard errors of the fit alone.",
        vec![
            Column::text("parameter"),
            Column::number("fit alone"),
            Column::number("all measurements"),
            Column::number("95 % interval"),
            Column::number("shift"),
        ],
    )?;
    let alone = &page.input.calibration.parameters;
    for p in &joint.parameters {
        let before = alone.iter().find(|a| a.symbol == p.symbol);
        let shift = before.and_then(|a| Some((p.value - a.value) / a.se?));
        let like = |x: f64| crate::numbers::with_decimals_of(x, p.se);
        let [low, high] = p.interval95;
        table.row([
            format!("{} {}", p.symbol, p.name),
            before.map_or_else(|| DASH.to_owned(), |a| with_error(a.value, a.se, &a.unit)),
            with_error(p.value, p.se, &p.unit),
            in_unit(&format!("{} to {}", like(low), like(high)), &p.unit),
            shift.map_or_else(|| DASH.to_owned(), |s| signed(s, 1)),
        ])?;
    }
    page.table(&table);
    correlations(
        page,
        "Correlations of the joint estimates.",
        &joint.correlation,
    )?;
    predictions(page, joint)
}

/// The measurements at the joint estimate, by the linear model.
fn predictions(page: &mut Page<'_>, joint: &JointEstimate) -> Result<(), Error> {
    if joint.predicted.is_empty() {
        return Ok(());
    }
    let mut table = Table::new(
        "Measurements beside what the linear model predicts at the joint estimate; no run was made there.",
        vec![
            Column::text("measurement"),
            Column::number("measured"),
            Column::number("predicted"),
            Column::number("difference (%)"),
        ],
    )?;
    for p in &joint.predicted {
        let (words, unit) = crate::numbers::observable(&p.observable);
        let percent = 100.0 * (p.predicted - p.measured) / p.measured.abs();
        table.row([
            format!(
                "{}: {words}",
                crate::measurement_rows::place(&p.scene, &p.condition)
            ),
            in_unit(
                &crate::numbers::with_decimals_of(p.measured, Some(p.se)),
                unit,
            ),
            with_error(p.predicted, Some(p.se), unit),
            if percent.is_finite() {
                signed(percent, 1)
            } else {
                fixed(percent, 1)
            },
        ])?;
    }
    page.table(&table);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::test_in_words;
    use inference::FitTest;

    #[test]
    fn a_fit_without_degrees_of_freedom_is_said_to_test_nothing() {
        let test = |degrees_of_freedom, p| {
            test_in_words(&FitTest {
                misfit: 3.2,
                degrees_of_freedom,
                p,
            })
        };
        assert!(test(0, None).contains("tests nothing"));
        assert!(test(2, Some(0.2019)).contains("3.20 with 2 degrees of freedom, p = 0.2019"));
    }
}
