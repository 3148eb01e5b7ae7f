//! What the surfaces predict at other parameters.

use super::Page;
use crate::Error;
use crate::exploration::of_calibration;

/// Adds the section; nothing if no surface could be analysed.
pub(super) fn add(page: &mut Page<'_>) -> Result<(), Error> {
    let Some(explorer) = of_calibration(page.input) else {
        return Ok(());
    };
    page.report.section("Try other parameters").paragraph(
        "What the fitted surfaces of the last box predict. Move a parameter, and the predictions follow; without scripts \
         they are those at the estimate. No run is made.",
    );
    if !page.input.calibration.confirmations.is_empty() {
        page.report.paragraph(
            "The estimate rests on these surfaces shifted to meet the fresh runs; the predictions are those before the shift.",
        );
    }
    page.report.explorer(
        &explorer,
        "Predictions of the surfaces with 95 % intervals of the mean (dark) and of a new observation (light), beside what \
         was measured ± its standard error (band: 95 %). Inside: the measured mean lies in the interval of a new \
         observation. z is measured minus predicted in standard errors of both means.",
    )?;
    Ok(())
}
