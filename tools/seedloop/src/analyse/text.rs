//! The analysis in words and columns.

use std::fmt::Write as _;

use command_line::significant;
use experiment_design::Factor;
use response_surface::fit::{FTest, TermRow};
use response_surface::{Fit, NamedValues, Orders, Saturated, StationaryKind};

/// The analysis as text.
pub(super) fn summary(fit: &Fit, saturated: Option<&Saturated>) -> String {
    // Writing to a string cannot fail.
    let mut text = String::new();
    let names = fit.terms.names().map(|name| name.chars().count());
    let width = names.max().unwrap_or(0).max(10);
    // The sums of squares of all lines stand in one column.
    let wide = width + 24;
    let _ = writeln!(text, "model: {}", fit.formula);
    if !fit.formula.has_intercept() {
        let _ = writeln!(text, "{}", where_zero(fit));
    }
    let _ = writeln!(
        text,
        "{:<width$} {:>12} {:>10} {:>11} {:>4} {:>10} {:>9} {:>9} {:>7}",
        "term", "coef", "se", "SS", "dof", "F", "p", "p(rep)", "%"
    );
    let largest = largest_coded(fit);
    for (name, row) in fit.terms.iter() {
        let against = |r: &response_surface::fit::Replicates| r.tests.get(name)?.p;
        let _ = writeln!(
            text,
            "{name:<width$} {:>12} {:>10} {:>11} {:>4} {:>10} {:>9} {:>9} {:>7}",
            significant(free_of_rounding(row, 1.0, largest), 6),
            counted(row.se, 4),
            counted(row.ss_partial.map(|ss| free_square(ss, fit.sst)), 5),
            1,
            counted(row.f, 4),
            probability(row.p),
            probability(fit.replicates.as_ref().and_then(against)),
            fixed(row.contribution_pct, 3),
        );
    }
    for (name, ss, dof, f, p) in sources(fit) {
        let (ss, f, p) = (
            significant(free_square(ss, fit.sst), 5),
            counted(f, 4),
            probability(p),
        );
        let _ = writeln!(text, "{name:<wide$} {ss:>11} {dof:>4} {f:>10} {p:>9}");
    }
    for (name, value) in figures(fit).iter() {
        let _ = writeln!(text, "{name:<20} {value}");
    }
    natural(&mut text, fit);
    stationary(&mut text, fit);
    if let Some(saturated) = saturated {
        let lenth = &saturated.lenth;
        let (me, sme) = (counted(lenth.me, 4), counted(lenth.sme, 4));
        let pse = significant(lenth.pse, 4);
        let _ = writeln!(text, "Lenth: PSE {pse}, ME {me}, SME {sme}");
        for point in saturated.half_normal.iter().rev() {
            let _ = writeln!(
                text,
                "{:<10} |effect| {}",
                point.factor,
                significant(point.abs_effect, 5)
            );
        }
    }
    text
}

/// Adds the coefficients in natural units with their 95 % intervals.
fn natural(text: &mut String, fit: &Fit) {
    let _ = writeln!(
        text,
        "\n{:<10} {:>14} {:>14} {:>14}  (natural units, 95 %)",
        "term", "coef", "from", "to"
    );
    let reaches: Vec<f64> = fit
        .terms_natural
        .iter()
        .map(|(name, _)| natural_reach(fit, name))
        .collect();
    let rows = fit.terms_natural.iter().zip(&reaches);
    let sizes = rows.map(|((_, row), reach)| (row.coef * reach).abs());
    let largest = sizes.fold(0.0, f64::max);
    for ((name, row), reach) in fit.terms_natural.iter().zip(&reaches) {
        let shown = free_of_rounding(row, *reach, largest);
        let end = |end: f64| {
            Some(if (end - row.coef).abs() * reach < OF_LARGEST * largest {
                shown
            } else {
                end
            })
        };
        let [low, high] = row.ci95.map_or([None; 2], |ends| ends.map(end));
        let _ = writeln!(
            text,
            "{name:<10} {:>14} {:>14} {:>14}",
            significant(shown, 7),
            counted(low, 7),
            counted(high, 7)
        );
    }
}

/// Share of its standard error below which a coefficient is shown as 0: chance brings one so near to 0 once in a million.
const OF_ERROR: f64 = 1e-6;

/// Share of the largest term below which a coefficient is shown as 0: the remainder of terms of order 1 that cancel, whose
/// rounding is some 1e-16 each and grows with the condition of the columns.
const OF_LARGEST: f64 = 1e-12;

/// A coefficient as it is shown: 0 for one that is rounding. `reach` is the greatest value of its column in the ranges, and
/// `largest` the greatest product of a coefficient and its reach.
pub(super) fn free_of_rounding(row: &TermRow, reach: f64, largest: f64) -> f64 {
    let size = row.coef.abs();
    let beside_error = row.se.is_some_and(|se| size < OF_ERROR * se);
    if beside_error || size * reach < OF_LARGEST * largest {
        return 0.0;
    }
    row.coef
}

/// A sum of squares as it is shown: 0 for one that is rounding beside the total.
fn free_square(ss: f64, total: f64) -> f64 {
    if ss < OF_LARGEST * OF_LARGEST * total {
        0.0
    } else {
        ss
    }
}

/// The greatest coefficient in coded units, whose columns reach 1.
pub(super) fn largest_coded(fit: &Fit) -> f64 {
    let sizes = fit.terms.iter().map(|(_, row)| row.coef.abs());
    sizes.fold(0.0, f64::max)
}

/// The greatest value of the column of a term in natural units, over the ranges of the factors. Of a term that the natural
/// form alone has it is not known, and taken as 1.
fn natural_reach(fit: &Fit, name: &str) -> f64 {
    let mut terms = fit.formula.terms().iter();
    let term = terms.find(|term| fit.formula.name(term) == name);
    term.map_or(1.0, |term| {
        let powers = fit.factors.iter().zip(term.powers());
        powers
            .map(|(f, power)| f.low().abs().max(f.high().abs()).powi(i32::from(*power)))
            .product()
    })
}

/// Adds the stationary point with its kind and its distance from the data.
fn stationary(text: &mut String, fit: &Fit) {
    let Some(canonical) = &fit.canonical else {
        return;
    };
    let kind = match canonical.kind {
        StationaryKind::Maximum => "maximum",
        StationaryKind::Minimum => "minimum",
        StationaryKind::Saddle => "saddle",
        StationaryKind::Ridge => "ridge",
    };
    let (Some(point), Some(reach)) = (&canonical.stationary_natural, canonical.reach_coded) else {
        let _ = writeln!(text, "stationary point: none, the surface is a {kind}");
        return;
    };
    let pairs = fit.factors.iter().zip(point);
    let place: Vec<String> = pairs
        .map(|(f, x)| format!("{} = {}", f.symbol(), significant(*x, 6)))
        .collect();
    let side = match (canonical.inside_box, canonical.inside_data) {
        (Some(true), Some(false)) => {
            "inside the ranges but farther out than the runs: no optimum of these data"
        }
        (Some(true), _) => "inside the ranges",
        (_, Some(true)) => "outside the ranges but within what the runs span",
        (_, _) => "outside the data: no optimum of these data",
    };
    let _ = writeln!(
        text,
        "stationary point: {kind} at {}, value {}, {reach:.2} half-ranges from the middle, {side}",
        place.join(", "),
        counted(canonical.value, 6)
    );
}

/// A line of the analysis of variance: name, sum of squares, dof, F, p.
type Source = (String, f64, usize, Option<f64>, Option<f64>);

/// The lines of the analysis of variance that belong to no single term.
fn sources(fit: &Fit) -> Vec<Source> {
    let mut lines: Vec<Source> = Vec::new();
    for row in fit.by_order.iter().filter(|_| fit.by_order.len() > 1) {
        let (test, name) = (&row.test, &row.order);
        lines.push((
            format!("{name}, after those above"),
            row.ss,
            test.df1,
            test.f,
            test.p,
        ));
    }
    let model = &fit.model;
    lines.push(("model".to_owned(), model.ss, model.df, model.f, model.p));
    lines.push(("residual".to_owned(), fit.sse, fit.df_resid, None, None));
    if let Some(lack) = &fit.lack_of_fit {
        lines.push(("lack of fit".to_owned(), lack.ss, lack.df, lack.f, lack.p));
    }
    if let Some(pure) = &fit.pure_error {
        lines.push(("pure error".to_owned(), pure.ss, pure.df, None, None));
    }
    if let Some(replicates) = &fit.replicates {
        let (ss, df) = (
            replicates.var_of_run_mean * replicates.df as f64,
            replicates.df,
        );
        let test = fit.lack_of_fit_all_repeats.as_ref();
        let (f, p) = (test.and_then(|t| t.f), test.and_then(|t| t.p));
        lines.push(("replicates (F: misfit to all)".to_owned(), ss, df, f, p));
    }
    let intercept = usize::from(fit.formula.has_intercept());
    lines.push(("total".to_owned(), fit.sst, fit.n - intercept, None, None));
    lines
}

/// The summary figures by name.
fn figures(fit: &Fit) -> NamedValues<String> {
    let figures = [
        ("R2", fit.r2, 4),
        ("adjusted R2", fit.adj_r2, 4),
        ("predicted R2", fit.pred_r2, 4),
        ("CV %", fit.cv_pct, 2),
        ("adequate precision", fit.adeq_precision, 2),
        ("AICc", fit.information.as_ref().and_then(|i| i.aicc), 3),
        ("BIC", fit.information.as_ref().map(|i| i.bic), 3),
    ];
    let figures = figures.into_iter();
    figures
        .map(|(name, v, digits)| (name.to_owned(), fixed(v, digits)))
        .chain([("PRESS".to_owned(), counted(fit.press, 5))])
        .collect()
}

/// Where a model without intercept is zero.
fn where_zero(fit: &Fit) -> String {
    let at = |f: &Factor| format!("{} = {}", f.symbol(), significant(f.mid(), 6));
    let place: Vec<String> = fit.factors.iter().map(at).collect();
    let place = place.join(", ");
    if fit.factors.iter().all(|f| f.mid() == 0.0) {
        format!("through zero: the response is 0 at {place}")
    } else {
        format!("through zero: the response is 0 in the middle of the ranges, at {place}")
    }
}

/// A number with as many digits that matter, or `-`.
pub(super) fn counted(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(|| "-".to_owned(), |v| significant(v, digits))
}

/// A number with a fixed number of decimals, or `-`.
pub(crate) fn fixed(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(|| "-".to_owned(), |v| format!("{v:.digits$}"))
}

/// A p value: four decimals, small ones as a power of ten.
pub(super) fn probability(value: Option<f64>) -> String {
    match value {
        Some(p) if p < 1e-3 => format!("{p:.1e}"),
        value => fixed(value, 4),
    }
}

/// The sequence of orders as text.
pub(super) fn orders_text(orders: &Orders) -> String {
    let mut text = format!(
        "{:<10} {:>3} {:>11} {:>9} {:>9} {:>10} {:>8} {:>8} {:>8} {:>9}\n",
        "order", "p", "added SS", "p added", "p misfit", "sd", "R2", "adj", "pred", "AICc"
    );
    for order in &orders.orders {
        let p = |test: &Option<FTest>| probability(test.as_ref().and_then(|t| t.p));
        let _ = writeln!(
            text,
            "{:<10} {:>3} {:>11} {:>9} {:>9} {:>10} {:>8} {:>8} {:>8} {:>9}{}",
            order.order,
            order.p,
            significant(
                free_square(
                    order.added_ss,
                    orders.orders.iter().map(|o| o.added_ss).sum()
                ),
                5
            ),
            p(&order.added),
            p(&order.lack_of_fit),
            counted(order.root_mse, 4),
            fixed(order.r2, 4),
            fixed(order.adj_r2, 4),
            fixed(order.pred_r2, 4),
            fixed(order.aicc, 2),
            if order.aliased.is_empty() {
                ""
            } else {
                "  aliased"
            }
        );
    }
    let _ = writeln!(text, "suggested order: {}", orders.suggested);
    text
}
