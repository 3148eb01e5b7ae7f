//! Parts that all sections on residuals share: verdict, errors, parameters, candidates.

use crate::numbers::{
    DASH, digits, digits_or_dash, fixed, fixed_or_dash, listed, observable, p_in_words, p_value,
    with_error,
};
use crate::residual::{models, stages};
use inference::ResidualStudy;
use inference::diagnosis::Verdict;
use report::{Column, Report, Table, Tone, counted};
use std::collections::BTreeMap;

/// The colour of a verdict: green where an answer was found, also where it is "nothing".
pub(super) fn answer_colour(verdict: Verdict) -> Tone {
    match verdict {
        Verdict::None | Verdict::Named => Tone::Good,
        Verdict::Refused | Verdict::NotTestable => Tone::Note,
        _ => Tone::Caution,
    }
}

/// The verdict of the diagnosis with its own words.
pub(super) fn verdict(report: &mut Report, study: &ResidualStudy) {
    let d = &study.diagnosis;
    report.verdict(
        answer_colour(d.verdict),
        &format!("Verdict of the diagnosis: {}", d.verdict),
        d.summary(),
    );
    let s = &d.structured_residual;
    report.paragraph(&format!(
        "What re-tuning cannot absorb: sum of squares {} with {}, {}; smooth part \
         {} with {}, {}. Effects that help but are not named: {}.",
        digits_or_dash(s.t0),
        counted(s.df, "degree of freedom", "degrees of freedom"),
        p_in_words(s.p),
        digits_or_dash(s.t0_smooth),
        s.df_smooth,
        p_in_words(s.p_smooth),
        listed(&d.suspects),
    ));
    if !d.warnings.is_empty() {
        let warnings: Vec<&str> = d.warnings.iter().map(String::as_str).collect();
        report.paragraph("What limits the verdict:").list(&warnings);
    }
}

/// Declared parameters before and after; nothing if none is declared.
pub(super) fn parameters(report: &mut Report, study: &ResidualStudy) -> Result<(), report::Error> {
    if study.plan.parameters.is_empty() {
        return Ok(());
    }
    let models = models(study);
    let mut columns = vec![
        Column::text("parameter"),
        Column::number("start"),
        Column::number("prior sd"),
        Column::number("fitted before"),
        Column::number("shift (prior sd)"),
    ];
    let names = models.iter().map(|(name, _)| format!("fitted {name}"));
    columns.extend(names.map(Column::number));
    let mut table = Table::new(
        "Declared parameters: start, standard deviation of its prior, fitted without and with the added effect, ± standard \
         errors.",
        columns,
    )?;
    let or_dash = |value: Option<f64>, se| {
        value.map_or_else(|| DASH.to_owned(), |value| with_error(value, se, ""))
    };
    for d in &study.plan.parameters {
        let fitted = study.fitted.get(&d.symbol).copied();
        let result = study.diagnosis.declared.get(&d.symbol);
        let shift = d
            .prior
            .zip(fitted)
            .map(|(prior, value)| (value - prior.mean) / prior.sd);
        let mut row = vec![
            d.symbol.clone(),
            digits(d.start),
            digits_or_dash(d.prior.map(|p| p.sd)),
            or_dash(fitted, result.and_then(|r| r.se_without)),
            fixed_or_dash(shift, 1),
        ];
        let of = |values: &BTreeMap<String, f64>| values.get(&d.symbol).copied();
        let after = models.iter();
        row.extend(after.map(|(_, m)| or_dash(of(&m.fitted), of(&m.fitted_se))));
        table.row(row)?;
    }
    report.table(&table);
    Ok(())
}

/// What each effect of the library would do.
pub(super) fn candidates(report: &mut Report, study: &ResidualStudy) -> Result<(), report::Error> {
    let d = &study.diagnosis;
    if d.candidates.is_empty() {
        report.paragraph("No candidate was tested.");
        return Ok(());
    }
    let mut table = Table::new(
        "Effects of the library, by the linear prediction. Amplitudes in the unit of each effect; \
         z is standard normal where the effect is absent.",
        vec![
            Column::text("effect"),
            Column::number("z"),
            Column::number("p of the largest z"),
            Column::number("amplitude ± standard error"),
            Column::number("absorbed by re-tuning"),
            Column::number("p of what remains"),
            Column::number("smallest seen (90 %)"),
            Column::text("testable"),
        ],
    )?;
    for (name, c) in &d.candidates {
        table.row([
            name.clone(),
            fixed_or_dash(c.z, 2),
            p_value(c.p_max_test),
            c.amplitude
                .map_or_else(|| DASH.to_owned(), |a| with_error(a, c.se, "")),
            fixed_or_dash(c.absorbed_fraction, 3),
            p_value(c.p_adequacy),
            digits_or_dash(c.smallest_detectable),
            if c.testable { "yes" } else { "no" }.to_owned(),
        ])?;
    }
    report.table(&table);
    Ok(())
}

/// The models that real runs have fitted again, against the best of them; nothing if there is none.
pub(super) fn refits(report: &mut Report, study: &ResidualStudy) -> Result<(), report::Error> {
    let refits = &study.diagnosis.refits;
    if refits.is_empty() {
        return Ok(());
    }
    let mut table = Table::new(
        "Models with an effect, fitted again by real runs, at the conditions of the fit. A model is refuted where it would be as far \
         behind the best one in fewer cases than the level of the test if it were right.",
        vec![
            Column::text("with"),
            Column::number("sum of squares left"),
            Column::number("p of what remains"),
            Column::text("odds of the best over it"),
            Column::text("refuted"),
        ],
    )?;
    for refit in refits {
        table.row([
            refit.effects.join(" and "),
            fixed(refit.sum_of_squares, 1),
            p_value(refit.p),
            refit
                .ln_odds_of_best
                .map_or_else(|| DASH.to_owned(), inference::diagnosis::odds),
            if refit.refuted { "yes" } else { "no" }.to_owned(),
        ])?;
    }
    report.table(&table);
    Ok(())
}

/// Errors of real runs before and after, on used and kept conditions.
pub(super) fn errors(report: &mut Report, study: &ResidualStudy) -> Result<(), report::Error> {
    let mut columns = vec![
        Column::text("model"),
        Column::text("conditions"),
        Column::number("n"),
    ];
    for name in &study.plan.observables {
        let (words, unit) = observable(name);
        let unit = if unit.is_empty() { "1" } else { unit };
        columns.push(Column::number(format!("rms error, {words} ({unit})")));
    }
    columns.push(Column::number("whitened mean square"));
    let mut table = Table::new(
        "Errors of real runs (no linear prediction). The whitened mean square is 1 where only noise \
         is left.",
        columns,
    )?;
    for stage in stages(study) {
        for (part, used, errors) in [
            ("used", true, Some(stage.used)),
            ("kept", false, stage.kept),
        ] {
            let n = study.plan.count(used);
            let mut row = vec![stage.name.clone(), part.to_owned(), n.to_string()];
            for name in &study.plan.observables {
                row.push(digits_or_dash(
                    errors.and_then(|e| e.rmse.get(name).copied()),
                ));
            }
            row.push(errors.map_or_else(|| DASH.to_owned(), |e| fixed(e.whitened_mse, 2)));
            table.row(row)?;
        }
    }
    report.table(&table);
    Ok(())
}

/// The added effects with their amplitudes.
pub(super) fn added(study: &ResidualStudy) -> Option<String> {
    let after = study.after.as_ref()?;
    let one = |(name, amplitude): (&String, &f64)| {
        let run = format!("{name}, {} in these runs", digits(*amplitude));
        match after.estimates.get(name) {
            Some(amplitude) => format!("{run}; by the data its amplitude is {amplitude}"),
            None => run,
        }
    };
    Some(after.effects.iter().map(one).collect::<Vec<_>>().join("; "))
}

/// Why no single effect is added.
pub(super) fn not_added(study: &ResidualStudy) -> &'static str {
    match (study.rivals.is_empty(), study.diagnosis.effects.is_empty()) {
        (true, true) => "No effect is added, because the diagnosis names none.",
        (true, false) => "No effect is added: the model with it could not be run.",
        (false, true) => {
            "The effects that explain it best were added to the model in turn, each with a fit of its own, and taken \
             out because real runs speak against all of them."
        }
        (false, false) => {
            "The effects that explain it best were added to the model in turn, each with a fit of its own; real runs \
             do not tell them apart."
        }
    }
}

/// What each observable alone says of the effect that stands out.
pub(super) fn support(report: &mut Report, study: &ResidualStudy) -> Result<(), report::Error> {
    let support = &study.diagnosis.observable_support;
    // The rows of one observable may be fewer than the parameters.
    let Some(first) = support
        .first()
        .filter(|_| support.iter().any(|row| row.z.is_some()))
    else {
        return Ok(());
    };
    let mut table = Table::new(
        format!(
            "Which observable carries the verdict: score of {} by the rows of each alone.",
            first.effect
        ),
        vec![Column::text("observable"), Column::number("z alone")],
    )?;
    for row in support {
        table.row([observable(&row.observable).0, fixed_or_dash(row.z, 2)])?;
    }
    report.table(&table);
    Ok(())
}
