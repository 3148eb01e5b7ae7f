//! The campaigns on measured-like data, with and without a hidden effect.

use super::numbers::{digits, digits_or_dash};
use super::{Page, residual_section};
use crate::{Error, HiddenCampaign};
use report::Verdict;

/// Adds both sections.
pub(super) fn add(page: &mut Page<'_>) -> Result<(), Error> {
    let result = page.result;
    page.report.section("Campaign with something hidden").paragraph(
        "Data were made by the simulator as a laboratory would give them: means of a few runs with \
         seeds of their own, plus noise of reading. They hold something that the fit is not told \
         of. The fit starts from other parameters and sees the used conditions only. What was \
         hidden stands in the last paragraph of this section.",
    );
    residual_section::add(
        &mut page.report,
        page.pictures,
        "hidden",
        &result.hidden.study,
    )?;
    revealed(page, &result.hidden);
    page.report.section("The same with nothing hidden").paragraph(
        "The same conditions, parameters and noise, with data made by the declared model itself. A \
         method that finds something here finds it everywhere.",
    );
    residual_section::add(
        &mut page.report,
        page.pictures,
        "nothing-hidden",
        &result.nothing_hidden.study,
    )?;
    revealed(page, &result.nothing_hidden);
    Ok(())
}

/// What was hidden, and whether it was found; the last words of a section.
fn revealed(page: &mut Page<'_>, hidden: &HiddenCampaign) {
    let truth: Vec<String> = hidden
        .true_parameters
        .iter()
        .map(|(name, value)| {
            let fitted = hidden.study.fitted.get(name).copied();
            let after = hidden
                .study
                .after
                .as_ref()
                .and_then(|a| a.fitted.get(name).copied());
            format!(
                "{name} = {} (fitted before {}, after {})",
                digits(*value),
                digits_or_dash(fitted),
                digits_or_dash(after)
            )
        })
        .collect();
    let made = match &hidden.hidden_effect {
        Some(effect) => {
            let found = hidden
                .study
                .after
                .as_ref()
                .and_then(|a| a.effects.get(effect).copied());
            format!(
                "Hidden was {effect} with amplitude {}; the fit with real runs gives {}.",
                digits(hidden.hidden_amplitude),
                digits_or_dash(found)
            )
        }
        None => "Nothing was hidden.".to_owned(),
    };
    let (colour, headline) = if hidden.verdict_is_right {
        (Verdict::Good, "Revealed: the verdict is right")
    } else {
        (
            Verdict::Bad,
            "Revealed: the verdict is not what made the data",
        )
    };
    let text = format!("{made} The data were made with {}.", truth.join("; "));
    page.report.verdict(colour, headline, &text);
}
