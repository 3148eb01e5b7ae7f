//! The validation in the drum.

use super::Page;
use super::material::RunDetails;
use super::numbers::{DASH, degrees, fixed, fixed_or_dash, signed};
use crate::Error;
use report::{Column, Fact, Table};

/// Adds the section.
pub(super) fn add(page: &mut Page<'_>) -> Result<(), Error> {
    let (study, result) = (page.study, page.result);
    let v = &result.validation;
    let [mean, sd] = study.published.validation_angle_deg;
    let target = &study.target;
    page.report.section("Validation in the drum").paragraph(
        "Fresh seeds at the chosen point; the frames are measured by the code that measures photos.",
    );
    page.report.facts(&[
        Fact::new("Measured", degrees(target.value, Some(target.sd), target.n)),
        Fact::new("This work", degrees(v.point.mean, v.point.sd, v.point.n)),
        Fact::new(
            "Sd over the frames of a run",
            format!("{}°", fixed_or_dash(v.point.frame_sd, 2)),
        ),
        Fact::new(
            "Difference",
            format!("{} %", fixed(v.relative_error_percent, 2)),
        ),
        Fact::new(
            "Published simulation",
            format!("{}° ± {}°", fixed(mean, 2), fixed(sd, 2)),
        ),
        Fact::new(
            "Published difference",
            format!(
                "{} %",
                fixed(100.0 * (mean - target.value).abs() / target.value.abs(), 2)
            ),
        ),
    ]);
    comparison(page);
    page.png(
        "validation-frame",
        "Drum frame of a validation run with the line that was fitted to the surface",
        "Last frame of the first validation run, measured again by the same code: drum (blue), \
         surface points that count (green) and do not (magenta), fitted line (orange) and its angle \
         in this one frame.",
    )?;
    page.chart(
        "validation-series",
        "The same run: direction of the centre of mass over time, the part behind the start-up \
         (band), and the moments of the frames (dots). The image angle is read at these moments.",
    );
    table(page)?;
    image_against_position(page);
    Ok(())
}

/// Whether the difference is more than its uncertainty.
fn comparison(page: &mut Page<'_>) {
    let (target, point) = (&page.study.target, &page.result.validation.point);
    let difference = point.mean - target.value;
    let text = match point.sd {
        Some(sd) => {
            let measured = target.sd * target.sd / target.n as f64;
            let se = (sd * sd / point.n as f64 + measured).sqrt();
            format!(
                "Difference: {}° with a standard error of {}° (runs and frames together; {} standard \
                 errors). With {} runs the sd is itself uncertain.",
                signed(difference, 2),
                fixed(se, 2),
                fixed(difference.abs() / se, 1),
                point.n
            )
        }
        None => format!(
            "Difference: {}°. One run has no sd: its standard error is undefined.",
            signed(difference, 2)
        ),
    };
    page.report.paragraph(&text);
}

/// The runs one by one.
fn table(page: &mut Page<'_>) -> Result<(), Error> {
    let mut table = Table::new(
        "Validation runs: mean and sd over the frames of each.",
        vec![
            Column::number("seed"),
            Column::number("angle (°)"),
            Column::number("sd of frames (°)"),
            Column::number("frames"),
            Column::number("refused frames"),
            Column::text("regime"),
            Column::text("steady"),
        ],
    )?;
    for record in &page.material.validation {
        let details = RunDetails::of(record);
        let angle = record.observable(&page.study.target.observable);
        table.row([
            record.seed().to_string(),
            fixed_or_dash(angle.map(|o| o.mean), 2),
            fixed_or_dash(angle.and_then(|o| o.sd), 2),
            angle.map_or_else(|| DASH.to_owned(), |o| o.n.to_string()),
            details.refused.to_string(),
            details.regime,
            if details.steady { "yes" } else { "no" }.to_owned(),
        ])?;
    }
    page.report.table(&table);
    Ok(())
}

/// The angle read from pictures against that from positions.
fn image_against_position(page: &mut Page<'_>) {
    let d = &page.result.image_against_position;
    page.report.paragraph(&format!(
        "Angle from the picture minus angle from the positions of the spheres, over all drum runs \
         of the calibration: {}°, sd of run means {}°, mean sd of frames {}° ({} runs, {} frames).",
        signed(d.mean_deg, 2),
        fixed(d.sd_of_runs_deg, 2),
        fixed(d.sd_of_frames_deg, 2),
        d.n_runs,
        d.n_frames,
    ));
}
