//! The first screen: verdict, every measurement before and after, and the parameters.

use super::Page;
use crate::Error;
use crate::answer::answer;
use crate::measurement_rows::{
    MeasurementRow, ROLES, effects_of, place, role_name, root_mean_square_z, rows,
};
use crate::numbers::{
    DASH, fixed_or_dash, in_unit, observable, signed, with_decimals_of, with_error,
};
use crate::pictures::measurement_charts;
use inference::{Comparison, DiagnosisStage, Estimate, Parameter, Role};
use report::{Column, Fact, Table, Tone};

/// Adds the section.
pub(super) fn add(page: &mut Page<'_>) -> Result<(), Error> {
    verdict(page);
    measurements(page)?;
    errors(page);
    parameters(page)?;
    inputs(page)?;
    page.chart(
        measurement_charts::errors(page.input).as_ref(),
        "Table 1 as a picture: z of the measurements by their numbers. The band is the limit within which a \
         measurement counts as met.",
    )
}

/// The verdict with the state in which the command ends.
fn verdict(page: &mut Page<'_>) {
    let found = page.input.calibration;
    let (colour, headline) = if found.met {
        (Tone::Good, "Met (exit code 0)")
    } else {
        (Tone::Bad, "Not met (exit code 1)")
    };
    page.report
        .section("Result")
        .verdict(colour, headline, &found.verdict);
    if let DiagnosisStage::Done(study) = &found.diagnosis {
        let answer = answer(study);
        page.report.paragraph(&answer.headline);
        let lines = answer.lines.iter();
        let lines: Vec<String> = lines
            .map(|(question, words)| format!("{question}: {words}"))
            .collect();
        super::list(&mut page.report, "Behind that answer:", &lines);
    }
    super::list(&mut page.report, "What to keep in mind:", &found.remarks);
}

/// The headline: measured, and simulated before and after.
fn measurements(page: &mut Page<'_>) -> Result<(), Error> {
    let added = added(page);
    let mut columns = vec![
        Column::number("no."),
        Column::text("measurement"),
        Column::text("role"),
        Column::number("measured"),
        Column::number("before"),
        Column::number("z before"),
        Column::number("fitted"),
        Column::number("z fitted"),
    ];
    if let Some(effects) = &added {
        columns.push(Column::number(format!("with {effects}")));
        columns.push(Column::number("z with it"));
    }
    columns.push(Column::text("holds (limit of |z|)"));
    let mut table = Table::new(
        "Measured, and simulated before and after. ± is the standard error of a mean; z is measured minus simulated in \
         standard errors of both. Before: with the parameters in use before. The fit uses the measurements of role \
         fit; those of role check were seen by no fit and no choice; those of role show judge nothing.",
        columns,
    )?;
    for (number, row) in rows(page.input).into_iter().enumerate() {
        let (words, unit) = observable(&row.measurement.observable);
        let simulated = |c: Option<&Comparison>| match c {
            Some(c) => with_error(c.simulated.mean, Some(c.simulated.se), unit),
            None => DASH.to_owned(),
        };
        let z = |c: Option<&Comparison>| c.map_or_else(|| DASH.to_owned(), |c| signed(c.z, 1));
        let mut cells = vec![
            (number + 1).to_string(),
            format!("{}: {words}", place(&row.model.scene, &row.model.condition)),
            role_name(row.measurement.role).to_owned(),
            with_error(row.measurement.mean, Some(row.measured_se()), unit),
            simulated(row.before),
            z(row.before),
            simulated(row.after),
            z(row.after),
        ];
        if added.is_some() {
            cells.extend([simulated(row.with_effects), z(row.with_effects)]);
        }
        cells.push(holds(row.with_effects.or(row.after)));
        table.row(cells)?;
    }
    page.table(&table);
    Ok(())
}

/// The effects that are named and added; `None` if nothing is.
fn added(page: &Page<'_>) -> Option<String> {
    page.input.calibration.with_effects.as_ref().map(effects_of)
}

/// Whether a measurement is met, in words.
fn holds(after: Option<&Comparison>) -> String {
    match after {
        None => DASH.into(),
        Some(c) if c.role == Role::Show => "not judged".into(),
        Some(c) => {
            let word = if c.holds { "yes" } else { "no" };
            format!("{word} ({})", fixed_or_dash(Some(c.z_limit), 2))
        }
    }
}

/// Root mean squares of z of each role, before and after.
fn errors(page: &mut Page<'_>) {
    let all = rows(page.input);
    let fact = |role: Role| {
        let of_role = || all.iter().filter(|r| r.measurement.role == role);
        let after = root_mean_square_z(of_role().map(|r: &MeasurementRow<'_>| r.after))?;
        let before = root_mean_square_z(of_role().map(|r| r.before));
        let with = root_mean_square_z(of_role().map(|r| r.with_effects));
        Some(Fact::new(
            format!("Root mean square of z, {}", role_name(role)),
            [
                Some(format!("{} before", fixed_or_dash(before, 2))),
                Some(format!("{} fitted", fixed_or_dash(Some(after), 2))),
                with.map(|with| format!("{} with what is added", fixed_or_dash(Some(with), 2))),
            ]
            .into_iter()
            .flatten()
            .collect::<Vec<_>>()
            .join(", "),
        ))
    };
    let facts: Vec<Fact> = ROLES.into_iter().filter_map(fact).collect();
    if !facts.is_empty() {
        page.report.facts(&facts);
    }
}

fn parameters(page: &mut Page<'_>) -> Result<(), Error> {
    let (added, found) = (added(page), page.input.calibration);
    let mut columns = vec![
        Column::text("parameter"),
        Column::number("estimate"),
        Column::number("95 % interval"),
        Column::number("start"),
        Column::number("limits"),
        Column::text("known"),
    ];
    if let Some(effects) = &added {
        columns.push(Column::number(format!("estimate with {effects}")));
        columns.push(Column::number("95 % interval with it"));
    }
    let mut table = Table::new(
        "Parameters. The interval covers 95 % and is cut at the limits of what is physically possible; start is the \
         value in use before.",
        columns,
    )?;
    for p in &page.input.calibration.parameters {
        let declared = &page.input.problem.parameters;
        let declared = declared.iter().find(|d| d.symbol == p.symbol);
        let interval = |p: &Estimate| {
            let [low, high] = p.interval95.map(|end| with_decimals_of(end, p.se));
            in_unit(&format!("{low} to {high}"), &p.unit)
        };
        let mut cells = vec![
            format!("{} {}", p.symbol, p.name),
            with_error(p.value, p.se, &p.unit),
            interval(p),
            in_unit(&p.start.to_string(), &p.unit),
            in_unit(&format!("{} to {}", p.limits[0], p.limits[1]), &p.unit),
            known(p, declared),
        ];
        let with = found.with_effects.iter().flat_map(|with| &with.parameters);
        let with = with.into_iter().find(|other| other.symbol == p.symbol);
        if added.is_some() {
            let dashes = || [DASH.to_owned(), DASH.to_owned()];
            let shown = |p: &Estimate| [with_error(p.value, p.se, &p.unit), interval(p)];
            cells.extend(with.map_or_else(dashes, shown));
        }
        table.row(cells)?;
    }
    page.table(&table);
    let sets = page.input.calibration.parameters.iter();
    // A program of the user receives the symbol itself.
    let sets = sets.filter(|p| p.sets.iter().any(|path| *path != p.symbol));
    let lines: Vec<String> = sets
        .map(|p| format!("{}: {}", p.symbol, p.sets.join(", ")))
        .collect();
    super::list(&mut page.report, "What each parameter sets:", &lines);
    Ok(())
}

/// The inputs that were stated with an error.
fn inputs(page: &mut Page<'_>) -> Result<(), Error> {
    let found = page.input.calibration;
    if found.inputs.is_empty() {
        return Ok(());
    }
    let mut columns = vec![
        Column::text("input"),
        Column::number("stated"),
        Column::number("estimate"),
        Column::number("moved (sd)"),
    ];
    for p in &found.parameters {
        columns.push(Column::number(format!("{} per sd", p.symbol)));
    }
    let mut table = Table::new(
        "Inputs that were stated with a standard deviation (±). The fit lets them move within it, so that their errors are in \
         every interval. Per sd: by how much a parameter would move if the input were one standard deviation larger.",
        columns,
    )?;
    for input in &found.inputs {
        let mut row = vec![
            format!("{} {}", input.symbol, input.name),
            with_error(input.stated, Some(input.sd), &input.unit),
            with_error(input.value, Some(input.se), &input.unit),
            signed(input.moved, 1),
        ];
        for p in &found.parameters {
            let moves = input.moves.get(&p.symbol).copied().unwrap_or(0.0);
            row.push(with_decimals_of(moves, p.se));
        }
        table.row(row)?;
    }
    page.table(&table);
    Ok(())
}

/// Whether the measurements fix a parameter, and whether it lies on a limit, in words.
fn known(p: &Estimate, declared: Option<&Parameter>) -> String {
    let prior = declared.and_then(|d| d.prior);
    let fixed = match (p.fixed_by_data, prior) {
        (true, None) => "fixed by the measurements".to_owned(),
        (true, Some(_)) => "fixed by the measurements and its prior".to_owned(),
        (false, Some(prior)) => format!(
            "held by its prior {} ± {}; the measurements alone leave it open",
            prior.mean, prior.sd
        ),
        (false, None) => "left open by the measurements".to_owned(),
    };
    if !p.at_limit {
        return fixed;
    }
    let [low, high] = p.limits;
    let (word, limit) = if (p.value - low).abs() <= (high - p.value).abs() {
        ("lower", low)
    } else {
        ("upper", high)
    };
    format!("{fixed}; lies on its {word} limit {limit}")
}

#[cfg(test)]
mod tests {
    use super::known;
    use crate::test_input::estimate;
    use inference::{Parameter, Prior};

    /// A parameter with or without a prior.
    fn declared(prior: Option<Prior>) -> Parameter {
        Parameter {
            symbol: "F".into(),
            name: "friction".into(),
            unit: "1".into(),
            sets: Vec::new(),
            range: [0.1, 0.6],
            limits: [0.0, 1.5],
            start: 0.1,
            prior,
            is_input: false,
        }
    }

    #[test]
    fn what_is_known_of_a_parameter_is_said_in_words() {
        let prior = declared(Some(Prior {
            mean: 0.4,
            sd: 0.05,
        }));
        let mut p = estimate("F", 0.33, Some(0.02));
        assert_eq!(known(&p, None), "fixed by the measurements");
        assert_eq!(
            known(&p, Some(&prior)),
            "fixed by the measurements and its prior"
        );
        p.fixed_by_data = false;
        assert_eq!(
            known(&p, Some(&prior)),
            "held by its prior 0.4 ± 0.05; the measurements alone leave it open"
        );
        p.at_limit = true;
        p.value = 1.5;
        assert_eq!(
            known(&p, Some(&declared(None))),
            "left open by the measurements; lies on its upper limit 1.5"
        );
        p.value = 0.0;
        assert!(known(&p, None).ends_with("lies on its lower limit 0"));
    }
}
