//! How often the answers were right, against what is wanted and what an ideal rule could reach.

use crate::SIZES;
use crate::outcome::{Outcome, Told};
use crate::page::percent;
use std::fmt::Write as _;

/// All answers, in the order of the table.
const KINDS: [Told; 6] = [
    Told::Named,
    Told::SmallTie,
    Told::LargeTie,
    Told::False,
    Told::Unknown,
    Told::Nothing,
];

/// Writes the numbers of answers and the goals, with standard errors.
pub(crate) fn write(outcomes: &[Outcome], text: &mut String) {
    write_answers(outcomes, text);
    text.push_str("\n| goal | wanted | found | ideal |\n|---|--:|--:|--:|\n");
    let answered: Vec<&Outcome> = outcomes.iter().filter(|o| o.told().is_some()).collect();
    let nothing = answered.iter().filter(|o| o.hidden.effect.is_none());
    let alarms: Vec<bool> = nothing.map(|o| o.told() != Some(Told::Nothing)).collect();
    let _ = writeln!(
        text,
        "| something reported where nothing is hidden | at most 5 % | {} | 5 % |",
        share(&alarms)
    );
    for size in SIZES {
        write_truth(outcomes, size, text);
    }
    let false_names: Vec<bool> = answered
        .iter()
        .map(|o| o.told() == Some(Told::False))
        .collect();
    let _ = writeln!(
        text,
        "| a name without the truth, all campaigns | at most 2 % | {} | |",
        share(&false_names)
    );
    write_reduction(&answered, text);
}

/// The campaigns of one size.
pub(crate) fn of_size(outcomes: &[Outcome], size: f64) -> Vec<&Outcome> {
    let hidden = outcomes.iter().filter(|o| o.hidden.effect.is_some());
    hidden
        .filter(|o| (o.hidden.size - size).abs() < 0.01)
        .collect()
}

/// The number of each answer by size.
fn write_answers(outcomes: &[Outcome], text: &mut String) {
    text.push_str("\n| answers |");
    for kind in KINDS {
        let _ = write!(text, " {} |", kind.word());
    }
    text.push_str(" could not be run |\n|---|--:|--:|--:|--:|--:|--:|--:|\n");
    for size in SIZES {
        let _ = write!(text, "| size {size:.0} |");
        let all = of_size(outcomes, size);
        for kind in KINDS.map(Some).into_iter().chain([None]) {
            let count = all.iter().filter(|o| o.told() == kind).count();
            let _ = write!(text, " {count} |");
        }
        text.push('\n');
    }
}

/// How often the truth was named, or in a small tie: of the answers, and of all campaigns.
fn write_truth(outcomes: &[Outcome], size: f64, text: &mut String) {
    let all = of_size(outcomes, size);
    let right = |o: &&&Outcome| o.told().is_some_and(Told::is_right);
    let answered: Vec<bool> = all
        .iter()
        .filter(|o| o.told().is_some())
        .map(|o| right(&o))
        .collect();
    let of_all: Vec<bool> = all.iter().map(|o| right(&o)).collect();
    let three = all.iter().filter_map(|o| o.ideal.as_ref());
    let three: Vec<f64> = three.map(|ideal| ideal.among_three).collect();
    let wanted = if size < SIZES[SIZES.len() - 1] {
        "-"
    } else {
        "80 %"
    };
    let _ = writeln!(
        text,
        "| truth named or in a tie of at most three, size {size:.0} | {wanted} | {} | {} |\n\
         | the same of all campaigns, no answer counted as missed | | {} | |",
        share(&answered),
        mean_and_error(&three),
        share(&of_all),
    );
}

/// How far a named effect lowers the error on the conditions kept aside; ideal is a model that leaves noise alone.
fn write_reduction(answered: &[&Outcome], text: &mut String) {
    let hidden = answered.iter().filter(|o| o.hidden.effect.is_some());
    let both = hidden.filter_map(|o| match o.kept()? {
        (before, Some(after)) => Some((1.0 - after / before, 1.0 - 1.0_f64.min(1.0 / before))),
        _ => None,
    });
    let (found, ideal): (Vec<f64>, Vec<f64>) = both.unzip();
    let _ = writeln!(
        text,
        "| reduction of the whitened mean square on the kept conditions, where something is named | 60 % | {} | {} |",
        mean_and_error(&found),
        mean_and_error(&ideal),
    );
}

/// A share with its standard error; at its ends the bound that holds with a chance of 95 %.
pub(crate) fn share(hits: &[bool]) -> String {
    let n = hits.len();
    if n == 0 {
        return "-".into();
    }
    let count = hits.iter().filter(|hit| **hit).count();
    let p = count as f64 / n as f64;
    let error = match count {
        0 => format!("below {}", percent(1.0 - 0.05_f64.powf(1.0 / n as f64))),
        _ if count == n => format!("above {}", percent(0.05_f64.powf(1.0 / n as f64))),
        _ => format!("± {}", percent((p * (1.0 - p) / n as f64).sqrt())),
    };
    format!("{} ({count} of {n}, {error})", percent(p))
}

/// A mean in percent with its standard error.
fn mean_and_error(values: &[f64]) -> String {
    let n = values.len() as f64;
    if values.is_empty() {
        return "-".into();
    }
    let mean = values.iter().sum::<f64>() / n;
    if values.len() == 1 {
        return percent(mean);
    }
    let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
    let error = (squares / (n - 1.0) / n).sqrt();
    format!("{} (n = {n}, ± {})", percent(mean), percent(error))
}
