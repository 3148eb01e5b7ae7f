//! Charts of what the runs show against their parameters.

use campaign::{CampaignPlan, ParameterName};
use report::{AxisTitle, Level, MarkedPoint, Scatter};
use std::collections::{BTreeMap, BTreeSet};

use crate::folder::{AskedRun, Snapshot};

/// Most charts of a page, so that it is made and shown in milliseconds. Our choice.
pub(crate) const MOST_CHARTS: usize = 12;

/// An observable of a model over its runs.
#[derive(Debug)]
pub(crate) struct Shown<'a> {
    /// The model.
    pub(crate) model: &'a str,
    /// Name of the observable.
    pub(crate) observable: &'a str,
    /// Its unit.
    pub(crate) unit: &'a str,
    /// Measured mean and what it serves for; none where nothing was measured.
    pub(crate) measured: Option<(f64, &'a str)>,
    /// Values of the requests by name, and of the observable, in the order in which the runs ended.
    pub(crate) points: Vec<(BTreeMap<&'a str, f64>, f64)>,
}

/// A chart with what it shows.
#[derive(Debug)]
pub(crate) struct Chart {
    /// The picture, markup.
    pub(crate) markup: String,
    /// What it shows, plain text.
    pub(crate) caption: String,
}

/// What the runs show: what was measured in the order of the study, or everything where nothing was.
pub(crate) fn shown<'a>(snapshot: &'a Snapshot<'_>) -> Vec<Shown<'a>> {
    let plan = snapshot.state.as_ref().map(|(state, _)| &state.plan);
    let measured = plan.map_or(&[][..], |plan| &plan.measured);
    if measured.is_empty() {
        let mut names = BTreeSet::new();
        for run in &snapshot.runs {
            let model = run.request.map_or("", |request| request.model.as_str());
            names.extend(
                run.run
                    .observables
                    .keys()
                    .map(|name| (model, name.as_str())),
            );
        }
        let each = names.into_iter();
        return each
            .map(|(model, observable)| gathered(snapshot, model, observable, None))
            .collect();
    }
    let each = measured.iter();
    each.map(|m| {
        let told = Some((m.mean, m.role.as_str()));
        gathered(snapshot, &m.model, &m.observable, told)
    })
    .collect()
}

/// Gathers an observable of a model from the runs.
fn gathered<'a>(
    snapshot: &'a Snapshot<'_>,
    model: &'a str,
    observable: &'a str,
    measured: Option<(f64, &'a str)>,
) -> Shown<'a> {
    let mut unit = "";
    let mut points = Vec::new();
    for run in &snapshot.runs {
        let is_of_model = run.request.map_or("", |request| request.model.as_str()) == model;
        let Some(value) = run.run.observables.get(observable).filter(|_| is_of_model) else {
            continue;
        };
        if value.mean.is_finite() {
            unit = &value.unit;
            points.push((values_of(run), value.mean));
        }
    }
    Shown {
        model,
        observable,
        unit,
        measured,
        points,
    }
}

/// All numbers that a run was asked for with.
fn values_of<'a>(run: &AskedRun<'a>) -> BTreeMap<&'a str, f64> {
    let mut values = BTreeMap::new();
    if let Some(request) = run.request {
        let all = [&request.parameters, &request.condition, &request.effects];
        for (name, value) in all.into_iter().flatten() {
            values.insert(name.as_str(), *value);
        }
    }
    values
}

impl Shown<'_> {
    /// Names of the values that differ between its runs.
    pub(crate) fn varied(&self) -> Vec<&str> {
        let mut ends: BTreeMap<&str, (f64, f64, usize)> = BTreeMap::new();
        for (name, value) in self.points.iter().flat_map(|(values, _)| values) {
            let end = ends.entry(name).or_insert((*value, *value, 0));
            *end = (end.0.min(*value), end.1.max(*value), end.2 + 1);
        }
        let is_varied = |(low, high, number): &(f64, f64, usize)| {
            // An effect that a request does not name is off.
            low < high || (*number < self.points.len() && *high != 0.0)
        };
        let varied = ends.iter().filter(|(_, end)| is_varied(end));
        varied.map(|(name, _)| *name).collect()
    }

    /// Its charts: one for each value that differs.
    pub(crate) fn charts(&self, plan: Option<&CampaignPlan>) -> Vec<Chart> {
        let each = self.varied().into_iter();
        each.filter_map(|name| self.chart(name, plan)).collect()
    }

    /// The observable against one value.
    fn chart(&self, name: &str, plan: Option<&CampaignPlan>) -> Option<Chart> {
        let place = |(values, y): &(BTreeMap<&str, f64>, f64)| {
            [values.get(name).copied().unwrap_or(0.0), *y]
        };
        let points: Vec<[f64; 2]> = self.points.iter().map(place).collect();
        let latest = *points.last()?;
        let mut quantity = name.to_owned();
        let mut unit = String::new();
        if let Some(ParameterName {
            name: words,
            unit: of,
        }) = plan.and_then(|plan| plan.parameters.get(name))
        {
            if words != name {
                quantity = format!("{words} {name}");
            }
            unit = plain_unit(of);
        }
        let y = AxisTitle::new(self.title(), plain_unit(self.unit));
        let level = self.measured.map(|(mean, _)| Level::new("measured", mean));
        let scatter = Scatter {
            x: AxisTitle::new(quantity, unit),
            y,
            points,
            names: Vec::new(),
            marked: vec![MarkedPoint {
                name: "latest".to_owned(),
                x: latest[0],
                y: latest[1],
            }],
            line: None,
            levels: level.into_iter().collect(),
        };
        // What cannot be drawn is in the table all the same.
        let picture = scatter.draw().ok()?;
        Some(Chart {
            markup: picture.as_str().trim_end().to_owned(),
            caption: if self.model.is_empty() {
                format!("{} against {name}", self.title())
            } else {
                format!("{}: {} against {name}", self.model, self.title())
            },
        })
    }

    /// Name of the observable without its unit: `angle` of `angle_deg`.
    pub(crate) fn title(&self) -> String {
        let unit = self.unit.to_lowercase().replace(['/', '²'], "_");
        let name = self.observable;
        let bare = name.strip_suffix(&unit).and_then(|n| n.strip_suffix('_'));
        let bare = bare.filter(|bare| !bare.is_empty()).unwrap_or(name);
        bare.replace('_', " ")
    }
}

/// A unit for an axis; nothing for that of a pure number.
pub(crate) fn plain_unit(unit: &str) -> String {
    if unit == "1" {
        return String::new();
    }
    unit.to_owned()
}
