//! What the residual says.

use super::{Page, residual_section};
use crate::Error;
use inference::DiagnosisStage;

/// Adds the section.
pub(super) fn add(page: &mut Page<'_>) -> Result<(), Error> {
    page.report.section("Residual and diagnosis");
    match &page.input.calibration.diagnosis {
        DiagnosisStage::LeftOut { reason } => {
            page.report.paragraph(&format!("Left out: {reason}"));
            Ok(())
        }
        DiagnosisStage::Done(study) => {
            residual_section::add(&mut page.report, study)?;
            let reasons = study.left_out.iter();
            let lines: Vec<String> = reasons
                .map(|(name, why)| format!("{name}: {why}"))
                .collect();
            super::list(&mut page.report, "Effects that could not be run:", &lines);
            Ok(())
        }
    }
}
