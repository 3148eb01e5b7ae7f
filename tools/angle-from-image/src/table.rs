//! The results as a CSV table: one row a picture, refused and unread ones with their reason.

use crate::results::ImageResult;
use experiment_design::table::csv_field;
use photo_profile::Mode;
use surface_profile::{Definition, HighSide};

/// One column: its name with the unit at the end, and the cell of a picture.
type Column = (&'static str, fn(&ImageResult) -> String);

/// Columns of every table, before those of the mode.
const FIRST: [Column; 9] = [
    ("file", |i| csv_field(&i.file)),
    ("frame", |i| {
        i.frame.map_or_else(String::new, |f| f.to_string())
    }),
    ("verdict", |i| i.verdict.to_owned()),
    ("reason", |i| csv_field(i.reason.as_deref().unwrap_or(""))),
    ("advice", |i| csv_field(i.advice.as_deref().unwrap_or(""))),
    ("angle_deg", |i| number(i.angle_deg)),
    ("standard_error_deg", |i| number(i.angle_se_deg)),
    ("interval_low_deg", |i| {
        number(i.angle_interval_deg.map(|ends| ends[0]))
    }),
    ("interval_high_deg", |i| {
        number(i.angle_interval_deg.map(|ends| ends[1]))
    }),
];

/// The time of a picture, where its rate is given.
const TIME: Column = ("time_s", |i| number(i.time_s));

const DRUM: [Column; 21] = [
    ("definition", |i| definition(i.definition).to_owned()),
    ("line_deg", |i| number(i.line_deg)),
    ("line_standard_error_deg", |i| number(i.line_se_deg)),
    ("chord_deg", |i| number(i.chord_deg)),
    ("chord_standard_error_deg", |i| number(i.chord_se_deg)),
    ("mid_deg", |i| number(i.mid_deg)),
    ("mid_standard_error_deg", |i| number(i.mid_se_deg)),
    ("rough_line_deg", |i| number(i.rough_line_deg)),
    ("curvature_1", |i| number(i.curvature)),
    ("s_shape_1", |i| number(i.s_shape)),
    ("shape_4_1", |i| number(i.shape_4)),
    ("shape_5_1", |i| number(i.shape_5)),
    ("fill_level_1", |i| number(i.fill_level)),
    ("toe_position_deg", |i| number(i.toe_position_deg)),
    ("top_position_deg", |i| number(i.top_position_deg)),
    ("toe_slope_deg", |i| number(i.toe_slope_deg)),
    ("line_through_all_deg", |i| number(i.line_through_all_deg)),
    ("high_side", |i| i.high_side.map_or("", side).to_owned()),
    ("drum_x_px", |i| number(i.drum.map(|d| d.cx))),
    ("drum_y_px", |i| number(i.drum.map(|d| d.cy))),
    ("drum_radius_px", |i| number(i.drum.map(|d| d.r))),
];

const HEAP: [Column; 15] = [
    ("left_deg", |i| number(i.heap.map(|h| h.left_deg))),
    ("left_standard_error_deg", |i| {
        number(i.heap.map(|h| h.left_se_deg))
    }),
    ("right_deg", |i| number(i.heap.map(|h| h.right_deg))),
    ("right_standard_error_deg", |i| {
        number(i.heap.map(|h| h.right_se_deg))
    }),
    ("apex_x_px", |i| number(i.heap.map(|h| h.apex[0]))),
    ("apex_y_px", |i| number(i.heap.map(|h| h.apex[1]))),
    ("rounding_px", |i| number(i.heap.map(|h| h.rounding_px))),
    ("left_top_deg", |i| number(i.heap.map(|h| h.left_top_deg))),
    ("left_toe_deg", |i| number(i.heap.map(|h| h.left_toe_deg))),
    ("right_top_deg", |i| number(i.heap.map(|h| h.right_top_deg))),
    ("right_toe_deg", |i| number(i.heap.map(|h| h.right_toe_deg))),
    ("base_deg", |i| number(i.heap.and_then(|h| h.base_deg))),
    ("seen_deg", |i| number(i.heap.map(|h| h.seen_deg))),
    ("camera_elevation_deg", |i| {
        number(i.heap.map(|h| h.camera_elevation_deg))
    }),
    ("elevation_seen_deg", |i| {
        number(i.heap.and_then(|h| h.elevation_seen_deg))
    }),
];

/// Columns of every table, after those of the mode.
const LAST: [Column; 4] = [
    ("warning", |i| csv_field(i.warning.as_deref().unwrap_or(""))),
    ("channel", |i| csv_field(i.channel.as_deref().unwrap_or(""))),
    ("quality_1", |i| {
        number(i.sha256.is_some().then_some(i.quality))
    }),
    ("sha256", |i| i.sha256.clone().unwrap_or_default()),
];

/// The table of all pictures, with times where `timed`.
pub(crate) fn csv(images: &[ImageResult], mode: Mode, timed: bool) -> String {
    let mut columns = FIRST.to_vec();
    if timed {
        columns.insert(2, TIME);
    }
    match mode {
        Mode::Drum => columns.extend(DRUM),
        Mode::Heap => columns.extend(HEAP),
    }
    columns.extend(LAST);
    let head: Vec<&str> = columns.iter().map(|(name, _)| *name).collect();
    let mut text = head.join(",") + "\n";
    for image in images {
        let cells: Vec<String> = columns.iter().map(|(_, cell)| cell(image)).collect();
        text.push_str(&cells.join(","));
        text.push('\n');
    }
    text
}

/// A number in full precision; nothing for one that is missing or not finite.
fn number(value: Option<f64>) -> String {
    let finite = value.filter(|v| v.is_finite());
    finite.map_or_else(String::new, |v| format!("{v:?}"))
}

/// Name of a definition, as in the JSON.
fn definition(definition: Definition) -> &'static str {
    match definition {
        Definition::Chord => "chord",
        Definition::Mid => "mid",
        Definition::Line => "line",
    }
}

/// Name of a side, as in the JSON.
fn side(side: HighSide) -> &'static str {
    match side {
        HighSide::Left => "left",
        HighSide::Right => "right",
    }
}

#[cfg(test)]
mod tests {
    use super::csv;
    use crate::results::ImageResult;
    use experiment_design::table::Table;
    use photo_profile::Mode;

    /// Names that a spreadsheet would run or that hold commas and quotation marks, and a reason with both: the reader of
    /// tables gives them back, and no cell begins a formula. What is not known is empty, never 0.
    #[test]
    fn names_and_reasons_come_back_and_run_nothing() {
        let names = ["=SUM(A1:A9).png", "@x.png", "a, \"b\".png"];
        let images = names.map(|name| ImageResult {
            file: name.to_owned(),
            verdict: "refused",
            reason: Some("no drum circle: 0.10, 0.25 is needed".to_owned()),
            ..ImageResult::default()
        });
        let text = csv(&images, Mode::Drum, false);
        let starts = text.lines().skip(1).map(|line| line.chars().next());
        assert_eq!(
            starts.collect::<Vec<_>>(),
            [Some('\''), Some('\''), Some('"')]
        );
        let table = Table::parse(&text).unwrap();
        let column = |name: &str| -> Vec<String> {
            let place = table.column(name).unwrap();
            let rows = table.rows().iter();
            rows.map(|row| row.text(place).to_owned()).collect()
        };
        assert_eq!(column("file"), names);
        assert_eq!(column("reason")[0], images[0].reason.clone().unwrap());
        for name in ["angle_deg", "standard_error_deg", "quality_1", "drum_x_px"] {
            assert!(column(name).iter().all(String::is_empty), "{name}");
        }
    }
}
