//! Correlations of the means of one measurement, as the file states them and as its photos show them.

use crate::document::below;
use crate::file::{MeasuredCorrelation, MeasuredEntry};
use crate::photos::PhotoSeries;
use crate::problem::Problems;
use inference::{Correlation, Measurement};

/// The correlations of an entry by the numbers of its measurements; those of the file come before those of photos and of a curve.
///
/// A correlation of an observable that the entry does not give is reported.
pub(crate) fn correlations_of<'a>(
    entry: &MeasuredEntry,
    series: Option<&PhotoSeries>,
    of_curve: impl Iterator<Item = &'a MeasuredCorrelation>,
    (model, measurements): (usize, &[Measurement]),
    problems: &mut Problems,
) -> Vec<Correlation> {
    let taken = series.into_iter().flat_map(|s| s.values.keys());
    let of_curve: Vec<_> = of_curve.collect();
    let in_curve = of_curve.iter().flat_map(|c| [&c.a, &c.b]);
    let given: Vec<&String> = entry.values.keys().chain(taken).chain(in_curve).collect();
    let number = |name: &String| {
        let mut all = measurements.iter();
        let place = all.position(|m| m.model == model && m.observable == *name);
        place.filter(|_| given.contains(&name))
    };
    let mut found: Vec<Correlation> = Vec::new();
    for MeasuredCorrelation { a, b, value } in &entry.correlations {
        if let (Some(a), Some(b)) = (number(a), number(b)) {
            found.push(Correlation {
                a,
                b,
                value: *value,
            });
            continue;
        }
        let missing = if given.contains(&a) { b } else { a };
        let given: Vec<&str> = given.iter().map(|name| name.as_str()).collect();
        let given = given.join(", ");
        let problem =
            format!("'{missing}' is not an observable of this [[measured]], which gives {given}");
        problems.wrong(&below(&entry.path, "correlation"), problem);
    }
    for c in series
        .into_iter()
        .flat_map(|s| &s.correlations)
        .chain(of_curve)
    {
        let (Some(a), Some(b)) = (number(&c.a), number(&c.b)) else {
            continue;
        };
        let stated = |o: &Correlation| (o.a, o.b) == (a, b) || (o.b, o.a) == (a, b);
        if !found.iter().any(stated) {
            let value = c.value;
            found.push(Correlation { a, b, value });
        }
    }
    found
}
