//! Which two-factor interactions may stand behind a screening design?

use experiment_design::Factor;
use serde::{Deserialize, Serialize};

use crate::{Error, Fit, Model, Observations, Weighting, fit_weighted};

/// Interactions taken up at most.
const MOST_STEPS: usize = 3;
/// A rival whose criterion lies this close cannot be told from the chosen term: the evidence ratio is
/// e^1, below what is called weak `[BurnhamAnderson2002, section 2.6]`.
const RIVAL: f64 = 2.0;

/// An interaction that was taken up.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct InteractionStep {
    /// Name of the term.
    pub added: String,
    /// Its coefficient, unit of the response.
    pub coef: f64,
    /// Its p in the model with it; it does not know of the search.
    pub p: Option<f64>,
    /// Akaike's corrected criterion before and after.
    pub aicc: [f64; 2],
    /// Other interactions that would have done about as well: they cannot be told from it.
    pub rivals: Vec<String>,
}

/// Main effects with p below `alpha` and, one after the other, the interactions of at least one of them
/// (weak heredity) that lower Akaike's corrected criterion most.
///
/// In a Plackett-Burman design every interaction is mixed into many main effects; this search finds
/// the few that stand out and names the rivals that do as well. It is a hint for the next design, not a
/// test.
///
/// # Source
/// `[HamadaWu1992]`.
///
/// # Errors
/// Those of [`fit_weighted`] for the main effects; [`Error::SettingOutOfRange`] for a limit outside 0 to 1.
pub fn interaction_search(
    factors: &[Factor],
    data: &Observations,
    weighting: Weighting,
    alpha: f64,
) -> Result<Vec<InteractionStep>, Error> {
    if !(0.0..=1.0).contains(&alpha) {
        return Err(Error::SettingOutOfRange {
            what: "the limit of p",
            value: alpha,
            range: "0 to 1",
        });
    }
    let symbols: Vec<&str> = factors.iter().map(Factor::symbol).collect();
    let mains = fit_weighted(factors, &Model::linear(factors)?, data, weighting)?;
    let is_active = |symbol: &&str| {
        let p = mains.terms.get(symbol).and_then(|row| row.p);
        p.is_some_and(|p| p < alpha)
    };
    let active: Vec<&str> = symbols.iter().copied().filter(is_active).collect();
    let candidates: Vec<String> = symbols
        .iter()
        .enumerate()
        .flat_map(|(i, a)| symbols[..i].iter().map(move |b| (*b, *a)))
        .filter(|(a, b)| active.contains(a) || active.contains(b))
        .map(|(a, b)| format!("{a}:{b}"))
        .collect();
    let mut terms: Vec<String> = vec!["1".to_owned()];
    terms.extend(active.iter().map(|symbol| (*symbol).to_owned()));
    let fitted = |terms: &[String]| {
        let model = Model::parse(&terms.join(" + "), factors).ok()?;
        // A term that the runs cannot separate from the others is not a candidate.
        let fit = fit_weighted(factors, &model, data, weighting).ok()?;
        let aicc = fit.information.as_ref()?.aicc?;
        Some((aicc, fit))
    };
    let mut steps = Vec::new();
    while steps.len() < MOST_STEPS
        && let Some(step) = best_step(&terms, &candidates, &fitted)
    {
        terms.push(step.added.clone());
        steps.push(step);
    }
    Ok(steps)
}

/// Akaike's corrected criterion and the fit of some terms; `None` if the runs cannot separate them.
type Fitted<'a> = dyn Fn(&[String]) -> Option<(f64, Fit)> + 'a;

/// The candidate that lowers the criterion most beside these terms; `None` if none lowers it.
fn best_step(
    terms: &[String],
    candidates: &[String],
    fitted: &Fitted<'_>,
) -> Option<InteractionStep> {
    let (before, _) = fitted(terms)?;
    let with = |term: &String| [terms, std::slice::from_ref(term)].concat();
    let mut tried: Vec<(f64, &String)> = candidates
        .iter()
        .filter(|term| !terms.contains(*term))
        .filter_map(|term| Some((fitted(&with(term))?.0, term)))
        .collect();
    tried.sort_by(|a, b| a.0.total_cmp(&b.0));
    let &(after, best) = tried.first().filter(|(aicc, _)| *aicc < before)?;
    let (_, fit) = fitted(&with(best))?;
    // Names in a fit are short if all symbols are single letters.
    let short = || fit.terms.get(&best.replace(':', ""));
    let row = fit.terms.get(best).or_else(short)?;
    let close = tried[1..].iter().filter(|(aicc, _)| aicc - after < RIVAL);
    Some(InteractionStep {
        added: best.clone(),
        coef: row.coef,
        p: row.p,
        aicc: [before, after],
        rivals: close.map(|(_, term)| (*term).clone()).collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::interaction_search;
    use crate::{Cell, Observations, Weighting};
    use experiment_design::{Factor, plackett_burman};

    /// Hamada and Wu's point: with A, B and A:B at work, the main effects alone leave 8/9 of the
    /// interaction's sum of squares in the error. The search must find it, and nothing without noise.
    #[test]
    fn an_interaction_hidden_in_a_screening_design_is_found() {
        let factors: Vec<Factor> = "ABCDEFG"
            .chars()
            .map(|c| Factor::coded_only(&c.to_string()).unwrap())
            .collect();
        let design = plackett_burman(&factors).unwrap();
        let noise = [
            0.1, -0.2, 0.15, 0.0, -0.1, 0.2, -0.05, 0.1, 0.05, -0.15, 0.0, -0.1,
        ];
        let cells = design.coded_rows().into_iter().zip(noise).map(|(x, e)| {
            let y = 5.0 + 3.0 * x[0] + 2.0 * x[1] + 2.5 * x[0] * x[1] + e;
            Cell::single(x[..7].to_vec(), y)
        });
        let data = Observations::from_cells(cells.collect()).unwrap();
        let steps = interaction_search(&factors, &data, Weighting::Counts, 0.2).unwrap();
        assert_eq!(steps[0].added, "A:B", "{steps:?}");
        assert!((steps[0].coef - 2.5).abs() < 0.15, "{steps:?}");
        assert!(steps[0].rivals.is_empty(), "{steps:?}");
        let again = steps[1..].iter().any(|step| step.added == "A:B");
        assert!(!again, "a step builds on those before: {steps:?}");
        assert!(interaction_search(&factors, &data, Weighting::Counts, 2.0).is_err());
    }
}
