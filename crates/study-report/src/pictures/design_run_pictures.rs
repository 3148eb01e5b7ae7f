//! What the records of the runs behind the surfaces keep to be seen: last frame and series. They stand in the page alone.

use super::NamedPicture;
use super::photographs::{shows_drum, with_reading};
use super::run_charts::series_of;
use crate::run_details::RunDetails;
use crate::{Error, ReportInput};
use inference::ModelSurfaces;

/// Most bytes of frames in a page: with more it would open slowly.
pub(crate) const MOST_BYTES: usize = 6_000_000;

/// Name of the series of a run, by the numbers of its model and of itself.
pub(crate) fn series_name(model: usize, run: usize) -> String {
    format!("design-run-{}-{}-series", model + 1, run + 1)
}

/// Name of its last frame.
pub(crate) fn frame_name(model: usize, run: usize) -> String {
    format!("design-run-{}-{}-frame", model + 1, run + 1)
}

/// The last frame of a run behind surfaces as a PNG picture, where its record keeps one.
pub(crate) fn last_frame(
    input: &ReportInput<'_>,
    surfaces: &ModelSurfaces,
    run: usize,
) -> Option<Vec<u8>> {
    let record = input.records.get(surfaces.keys.get(run)?)?;
    RunDetails::of(record).last_frame
}

/// Series and frames of all runs behind the surfaces whose records are there; frames as long as there is room.
pub(super) fn pictures(input: &ReportInput<'_>) -> Result<Vec<NamedPicture>, Error> {
    let mut all = Vec::new();
    let mut bytes = 0;
    for (model, surfaces) in input.calibration.surfaces.iter().enumerate() {
        for (run, key) in surfaces.keys.iter().enumerate() {
            let Some(record) = input.records.get(key) else {
                continue;
            };
            if let Some(chart) = series_of(record) {
                let chart = NamedPicture::chart(series_name(model, run), chart.draw()?);
                all.push(chart.only_in_page());
            }
            let Some(frame) = last_frame(input, surfaces, run) else {
                continue;
            };
            if bytes + frame.len() > MOST_BYTES {
                continue;
            }
            let name = frame_name(model, run);
            let frame = if shows_drum(input, &surfaces.model) {
                with_reading(&name, &frame)?
            } else {
                frame
            };
            bytes += frame.len();
            all.push(NamedPicture::png(name, frame).only_in_page());
        }
    }
    Ok(all)
}
