//! Whether a calibration holds, in one sentence.

use crate::calibrate::Estimated;
use crate::confirmation::Confirmed;
use crate::search::acts;
use crate::{CalibrationProblem, Comparison, Role};
use input::quantity::significant;

/// Chance of a misfit below which measurements that hold one by one contradict each other together.
const CONTRADICTION: f64 = 0.01;

/// Whether the fit is met and the checks hold, and why.
pub(crate) fn verdict(
    problem: &CalibrationProblem,
    estimate: &Estimated,
    fit: &[Comparison],
    check: &[Comparison],
    confirmed: &Confirmed,
) -> (bool, String) {
    if let Some(why) = failure(problem, estimate, fit, check, confirmed) {
        return (false, why);
    }
    let doubts = doubts(check);
    if let Some(why) = open_parameters(problem, estimate, confirmed) {
        return (false, why + &doubts.words);
    }
    let fit_words = if estimate.test.degrees_of_freedom == 0 {
        "all measurements of the fit are met, which as many parameters as measurements always allow"
    } else {
        "all measurements of the fit are met"
    };
    let met = check.is_empty() || doubts.rows < check.len();
    let check_words = match check.len() {
        _ if !met => "but no check could have failed".to_owned(),
        0 => "and nothing was kept to check them".to_owned(),
        1 => "and the one kept for the check holds".to_owned(),
        n => format!("and the {n} kept for the check hold"),
    };
    (met, format!("{fit_words}, {check_words}{}", doubts.words))
}

/// Why a calibration fails by its measurements or its fresh runs; `None` if all hold.
fn failure(
    problem: &CalibrationProblem,
    estimate: &Estimated,
    fit: &[Comparison],
    check: &[Comparison],
    confirmed: &Confirmed,
) -> Option<String> {
    let expected = |role| problem.measurements_of(role).len();
    let missed = |rows: &[Comparison]| {
        let names: Vec<String> = rows.iter().filter(|row| !row.holds).map(name).collect();
        (!names.is_empty()).then(|| names.join(", "))
    };
    if fit.len() < expected(Role::Fit) || check.len() < expected(Role::Check) {
        let why = "some measurements could not be simulated at the estimate: the remarks say why";
        return Some(why.to_owned());
    }
    if let Some(names) = missed(fit) {
        let why = why_not_met(problem, estimate, confirmed);
        return Some(format!("the fit does not meet {names}{why}"));
    }
    if let Some(p) = estimate.test.p.filter(|p| *p < CONTRADICTION) {
        return Some(format!(
            "each measurement holds, but together they contradict the model (misfit {:.1} on {} degrees of freedom, p = {p:.2e})",
            estimate.test.misfit, estimate.test.degrees_of_freedom
        ));
    }
    if let Some(names) = missed(check) {
        return Some(format!(
            "the fit is met, but the check on {names} fails: the parameters do not hold there"
        ));
    }
    (!confirmed.agrees).then(|| {
        "the fresh runs at the estimate do not agree with the surfaces it rests on".to_owned()
    })
}

/// That parameters are not fixed although all measurements are met; none if all are.
fn open_parameters(
    problem: &CalibrationProblem,
    estimate: &Estimated,
    confirmed: &Confirmed,
) -> Option<String> {
    let found = &confirmed.found;
    let each = estimate.parameters.iter().zip(&found.free).enumerate();
    let open: Vec<usize> = each
        .filter(|(_, (p, free))| **free && p.se.is_none())
        .map(|(j, _)| j)
        .collect();
    if open.is_empty() {
        return None;
    }
    let symbols: Vec<&str> = open
        .iter()
        .map(|&j| problem.parameters[j].symbol.as_str())
        .collect();
    let symbols = symbols.join(" and ");
    let fit = found.fit(problem);
    let middle = found.region.middle();
    let responds = |&j: &usize| acts(&fit, j, &found.best) || acts(&fit, j, &middle);
    let why = if let Some(why) = problem.cannot_be_met() {
        format!(": {why}")
    } else if !open.iter().any(responds) {
        ": no fitted observable responds to them within their ranges by more than the runs scatter: a larger bed or more \
         repeats scatter less, unless the simulator does not use them"
            .into()
    } else {
        ", so that their values mean nothing: measure something else that depends on them, or fix them"
            .into()
    };
    Some(format!(
        "all measurements of the fit are met, but they do not fix {symbols}{why}"
    ))
}

/// Why measurements of the fit are not met, as the end of the sentence.
fn why_not_met(
    problem: &CalibrationProblem,
    estimate: &Estimated,
    confirmed: &Confirmed,
) -> String {
    if !confirmed.agrees {
        return ": fresh runs at the estimate do not agree with the surfaces by which it was chosen"
            .into();
    }
    let on_limits: Vec<String> = estimate
        .parameters
        .iter()
        .filter(|p| p.at_limit)
        .map(|p| format!("{} at its limit {}", p.symbol, p.value))
        .collect();
    if !on_limits.is_empty() {
        return format!(
            ", with {}: within the limits no parameters do",
            on_limits.join(" and ")
        );
    }
    let priors = problem.parameters.iter().any(|p| p.prior.is_some());
    let besides = if priors {
        " that agree with their priors"
    } else {
        ""
    };
    format!(": by the surfaces no parameters{besides} in the boxes that were searched do")
}

/// How much larger than twice the standard error of a measurement a difference may be that its check still bears.
const BEARABLE: f64 = 3.0;
/// Share of what parameters in the box can change, up to which a difference is one that such a check should notice.
const NOTICED: f64 = 0.5;

/// Checks that hold and are worth next to nothing.
struct Doubts {
    rows: usize,
    /// Why, as further parts of the sentence.
    words: String,
}

/// Checks that hold although little could have failed: parameters or simulated means that
/// are known so little, or measurements of so few values, that three times the difference that a measurement of many would bear
/// would pass, and more than half of what other parameters in the box of the file would make.
fn doubts(check: &[Comparison]) -> Doubts {
    let (mut parameters, mut runs, mut repeats) = (Vec::new(), Vec::new(), Vec::new());
    for row in check {
        let error = row.measured.sd / row.measured.n.sqrt();
        let of_parameters = row.parameter_se.unwrap_or(0.0);
        let all = error.hypot(row.simulated.se).hypot(of_parameters);
        let bears = row.z_limit * all;
        let noticed = row.reach.is_some_and(|reach| bears <= NOTICED * reach);
        if bears <= BEARABLE * 2.0 * error || noticed {
            continue;
        }
        let words = format!(
            "{}, which would bear a difference of {bears:.2},",
            name(row)
        );
        if row.z_limit > BEARABLE * 2.0 && error >= of_parameters.hypot(row.simulated.se) {
            repeats.push(words);
        } else if of_parameters > row.simulated.se {
            parameters.push(words);
        } else {
            runs.push(words);
        }
    }
    let part = |what: &str, rows: &[String], end: &str| {
        if rows.is_empty() {
            String::new()
        } else {
            format!(
                "; {what} so little that the check on {} tests next to nothing{end}",
                rows.join(" and on ")
            )
        }
    };
    Doubts {
        rows: parameters.len() + runs.len() + repeats.len(),
        words: part("the parameters are known", &parameters, "")
            + &part(
                "the simulated mean is known",
                &runs,
                ": it needs more check_runs",
            )
            + &part(
                "the measurement was repeated",
                &repeats,
                ": measure it more often",
            ),
    }
}

/// A measurement in words.
pub(crate) fn name(row: &Comparison) -> String {
    let condition: Vec<String> = row
        .condition
        .iter()
        .map(|(name, value)| format!("{name} = {value}"))
        .collect();
    let at = if condition.is_empty() {
        String::new()
    } else {
        format!(" at {}", condition.join(", "))
    };
    format!(
        "{} of {}{at} (measured {}, simulated {}, {:.1} standard errors apart)",
        row.observable,
        row.scene,
        significant(row.measured.mean, 5),
        significant(row.simulated.mean, 5),
        row.z.abs()
    )
}
