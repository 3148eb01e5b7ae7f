//! Results of an analysis beside the tables of the fit, in words.

use std::fmt::Write as _;

use command_line::significant;
use response_surface::{
    BoxCox, Contrasts, FactorShare, GroupSum, NamedValues, RandomBlocks, Share, Sobol, Spread,
};

use super::Report;
use super::text::{counted, fixed, probability};

/// Least size of an alias coefficient that is printed; all are in the JSON.
const SMALLEST_ALIAS: f64 = 0.05;
/// Most terms left out that are printed behind one term, the largest first.
const MOST_ALIASES: usize = 8;

/// All of it as text. Writing to a string cannot fail.
pub(super) fn beside(report: &Report<'_>) -> String {
    let mut text = String::new();
    levels(&mut text, report);
    if let Some(found) = &report.contrasts {
        contrasts(&mut text, found);
    }
    aliases(&mut text, report);
    if let Some(fit) = &report.random_batches {
        batches(&mut text, fit);
    }
    interactions(&mut text, report);
    if let Some(b) = &report.box_cox {
        let [best, low, high] = [b.best, b.interval95[0], b.interval95[1]].map(|x| power(b, x));
        let verdict = if b.keeps_the_response {
            "1 is in it"
        } else {
            "1 is not in it"
        };
        let _ = writeln!(
            text,
            "Box-Cox power {best}, 95 % {low} to {high}: {verdict}"
        );
    }
    if let Some(spread) = &report.spread {
        scatter(&mut text, spread);
    }
    if let Some(sobol) = &report.sobol {
        shares(&mut text, sobol);
    }
    rivals(&mut text, report);
    text
}

/// A power of the response as read; at an end of those tried it may be beyond.
pub(super) fn power(profile: &BoxCox, x: f64) -> String {
    let ends = [profile.lambda.first(), profile.lambda.last()];
    match ends.map(|end| end == Some(&x)) {
        [true, _] => format!("{x} or less"),
        [_, true] => format!("{x} or more"),
        _ => format!("{x:.2}"),
    }
}

/// Shares of the variance of the surface, largest total first; pairs that make less than noise are left to the JSON.
fn shares(text: &mut String, sobol: &Sobol) {
    let _ = writeln!(
        text,
        "shares of the variance of the surface over the ranges, % (in brackets what noise alone would make)"
    );
    let of = |share: Share| {
        let noise = fixed(share.by_noise.map(|noise| 100.0 * noise), 1);
        // Rounding may leave a share of nothing below zero.
        format!("{:>5.1} ({noise})", (100.0 * share.share).max(0.0))
    };
    let heard = |share: &Share| share.share > share.by_noise.unwrap_or(0.0) && share.share > 5e-4;
    let mut factors: Vec<(&str, &FactorShare)> = sobol.factors.iter().collect();
    factors.sort_by(|a, b| b.1.total.share.total_cmp(&a.1.total.share));
    let pairs = sobol.pairs.iter().filter(|(_, share)| heard(share));
    let mut pairs: Vec<(&str, &Share)> = pairs.collect();
    pairs.sort_by(|a, b| b.1.share.total_cmp(&a.1.share));
    let names = factors
        .iter()
        .map(|(name, _)| name)
        .chain(pairs.iter().map(|(name, _)| name));
    let width = names.map(|name| name.len()).max().unwrap_or(0);
    for (symbol, share) in factors {
        let (first, total) = (of(share.first), of(share.total));
        let _ = writeln!(text, "  {symbol:<width$}  alone {first:<14} in all {total}");
    }
    for (pair, share) in pairs {
        let _ = writeln!(
            text,
            "  {pair:<width$}  together, beyond both alone {}",
            of(*share)
        );
    }
}

/// Terms that went, tests of named factors and the response at their levels.
fn levels(text: &mut String, report: &Report<'_>) {
    if !report.reduction.is_empty() {
        let dropped = report.reduction.iter().map(|step| step.dropped.as_str());
        let dropped: Vec<&str> = dropped.collect();
        let _ = writeln!(text, "dropped in this order: {}", dropped.join(", "));
    }
    for (name, row) in report.level_tests.iter().flat_map(NamedValues::iter) {
        let of = |sum: &GroupSum| {
            let p = probability(sum.test.as_ref().and_then(|t| t.p));
            format!("SS {} p {p}", significant(sum.ss, 5))
        };
        let _ = writeln!(
            text,
            "{name:<12} dof {:>2}  Type I {}, II {}, III {}",
            row.df,
            of(&row.type_i),
            of(&row.type_ii),
            of(&row.type_iii)
        );
    }
    for level in &report.level_means {
        let interval = level.ci95.map_or_else(String::new, |[low, high]| {
            let [low, high] = [low, high].map(|end| significant(end, 6));
            format!(" (95 % {low} to {high})")
        });
        let original = level.original;
        let original = original.map_or_else(String::new, |o| format!("; {}", o.words()));
        let (names, mean) = (level.levels.join(", "), significant(level.mean, 6));
        let _ = writeln!(text, "at {names}: {mean}{interval}{original}");
    }
}

/// The contrasts of a saturated model, largest first, against Lenth's margins.
fn contrasts(text: &mut String, found: &Contrasts) {
    let lenth = &found.lenth;
    let order = if found.orthogonal {
        ""
    } else {
        " (each after the terms before it)"
    };
    let _ = writeln!(
        text,
        "saturated model, contrasts{order}; Lenth: PSE {}, ME {}, SME {}",
        significant(lenth.pse, 4),
        counted(lenth.me, 4),
        counted(lenth.sme, 4)
    );
    for point in found.half_normal.iter().rev() {
        let above = |margin: Option<f64>| margin.is_some_and(|margin| point.abs_effect > margin);
        let verdict = match (above(lenth.sme), above(lenth.me)) {
            (true, _) => "  above SME",
            (_, true) => "  above ME",
            _ => "",
        };
        let value = found.contrasts.get(&point.factor).copied().unwrap_or(0.0);
        let value = significant(value, 5);
        let _ = writeln!(text, "{:<10} {value:>12}{verdict}", point.factor);
    }
}

/// What terms left out add to each term of the fit.
fn aliases(text: &mut String, report: &Report<'_>) {
    let all = || report.aliases.iter().flat_map(NamedValues::iter);
    let mut lines = String::new();
    for term in report.fit.terms.names() {
        let behind = all().filter_map(|(left_out, parts)| Some((left_out, *parts.get(term)?)));
        let behind = behind.filter(|(_, amount)| amount.abs() >= SMALLEST_ALIAS);
        let mut behind: Vec<(&str, f64)> = behind.collect();
        if behind.is_empty() {
            continue;
        }
        behind.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
        let _ = write!(lines, "  {term}");
        for (left_out, amount) in behind.iter().take(MOST_ALIASES) {
            let sign = if *amount < 0.0 { '-' } else { '+' };
            let size = amount.abs();
            let _ = if (size - 1.0).abs() < 1e-9 {
                write!(lines, " {sign} {left_out}")
            } else {
                write!(lines, " {sign} {size:.3} {left_out}")
            };
        }
        let more = behind.len().saturating_sub(MOST_ALIASES);
        let _ = match more {
            0 => writeln!(lines),
            more => writeln!(lines, " and {more} more"),
        };
    }
    if !lines.is_empty() {
        let _ = write!(
            text,
            "aliases: the expected coefficient of a term is the sum of its own and of these left out, coded\n{lines}"
        );
    }
}

fn batches(text: &mut String, fit: &RandomBlocks) {
    let _ = writeln!(
        text,
        "{} batches drawn at random: sd of batches {}, of observations {}",
        fit.blocks,
        significant(fit.block_sd, 5),
        significant(fit.residual_sd, 5)
    );
    let [term, coef, se, dof, p] = ["term", "coef", "se", "dof", "p"];
    let _ = writeln!(text, "{term:<10} {coef:>12} {se:>10} {dof:>8} {p:>9}");
    for (name, row) in fit.terms.iter() {
        let _ = writeln!(
            text,
            "{name:<10} {:>12} {:>10} {:>8} {:>9}",
            significant(row.coef, 6),
            significant(row.se, 4),
            fixed(row.df, 2),
            probability(row.p)
        );
    }
}

/// Interactions that may hide in a screening design.
fn interactions(text: &mut String, report: &Report<'_>) {
    for step in report.interaction_search.iter().flatten() {
        let rivals = if step.rivals.is_empty() {
            "no other does as well".to_owned()
        } else {
            format!("cannot be distinguished from {}", step.rivals.join(", "))
        };
        let ([before, after], coef) = (step.aicc, significant(step.coef, 5));
        let _ = writeln!(
            text,
            "a hidden interaction may be {} ({coef}, AICc {before:.2} to {after:.2}): {rivals}",
            step.added
        );
    }
}

/// Tests that all settings scatter alike.
fn scatter(text: &mut String, spread: &Spread) {
    let bartlett = probability(spread.bartlett.as_ref().and_then(|b| b.p));
    let p = probability(spread.levene.as_ref().and_then(|l| l.p));
    let levene = match (spread.levene_groups, spread.groups) {
        (0 | 1, _) => {
            "Levene's test cannot be made: it needs two settings with three runs or more".to_owned()
        }
        (tested, all) if tested < all => {
            format!("Levene p {p} ({tested} settings, pairs left out)")
        }
        _ => format!("Levene p {p}"),
    };
    let _ = writeln!(text, "equal scatter: Bartlett p {bartlett}, {levene}");
}

/// The rival surface and the regime.
fn rivals(text: &mut String, report: &Report<'_>) {
    if let Some(comparison) = &report.gaussian_process {
        let _ = writeln!(
            text,
            "rows left out are predicted to {} by a Gaussian process and to {} by the polynomial; the {} is better",
            significant(comparison.process_leave_one_out_rmse, 4),
            counted(comparison.polynomial_leave_one_out_rmse, 4),
            comparison.better
        );
    }
    if let Some(regime) = &report.regime {
        let percent = |share: f64| 100.0 * share;
        let _ = writeln!(
            text,
            "regime '{}': {} rows, {} others left out; {:.0} % of the box; boundary right for {:.0} % of rows left out",
            regime.name,
            regime.inside,
            regime.outside,
            percent(regime.box_fraction),
            percent(regime.leave_one_out_accuracy)
        );
    }
}

#[cfg(test)]
mod tests {
    use super::power;
    use response_surface::BoxCox;

    /// Powers are tried up to 2: one that is best there is 2 or more.
    #[test]
    fn a_power_at_an_end_of_those_tried_is_told_as_such() {
        let profile = BoxCox {
            lambda: vec![-2.0, 0.5, 2.0],
            ln_sse: vec![0.0; 3],
            best: 2.0,
            interval95: [-2.0, 2.0],
            keeps_the_response: true,
        };
        let told = [-2.0, 0.5, 2.0].map(|x| power(&profile, x));
        assert_eq!(told, ["-2 or less", "0.50", "2 or more"]);
    }
}
