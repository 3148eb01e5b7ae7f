//! Measured curves: a few scores stand for a curve, so that its many values, which deviate together, do not count as independent.

use crate::file::{CurveEntry, MeasuredCorrelation, MeasuredValue};
use campaign::run_store::{Observation, Record};
use experiment_design::table::{Table, text_of_bytes};
use input::quantity::significant;
use scene::CurveKind;
use simulators::scene_simulator::RunDetails;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// What the scores are called, between the names of the curve and of the column.
const SCORES: [&str; 5] = ["mean", "slope", "bend", "cubic", "quartic"];
/// Most rows: the covariance of the values has the square of so many numbers.
const MOST_ROWS: usize = 2000;
/// Root mean square of what the scores leave of the curve, over the standard deviation of a value, from which on it is remarked.
const LEFT: f64 = 2.0;

/// A curve that is taken apart in the same way wherever it comes from.
///
/// # Formula
///
/// Score k is `sum_j q_k(x_j) y_j / m` over the m places `x_j` of the measured curve. `q_k` is the polynomial of degree k that is
/// orthogonal to those of lower degree on these places, with a mean square of 1 and a positive leading coefficient: score 0 is the mean
/// of the values, and the mean square of the values is the sum of the squares of all m scores.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct CurveScores {
    kind: CurveKind,
    /// Column of the values.
    column: String,
    /// Places of the measured values, ascending.
    places: Vec<f64>,
    /// Weights of the values in each score.
    weights: Vec<Vec<f64>>,
}

/// A measured curve as measurements.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct MeasuredCurve {
    pub(crate) scores: CurveScores,
    /// File, for the list of inputs.
    pub(crate) file: PathBuf,
    /// Values of each repeat at the places.
    pub(crate) repeats: Vec<Vec<f64>>,
    /// Scores by observable.
    pub(crate) values: Vec<(String, MeasuredValue)>,
    pub(crate) correlations: Vec<MeasuredCorrelation>,
    /// What the user should know.
    pub(crate) remark: Option<String>,
}

impl MeasuredCurve {
    /// Name of the curve, its columns, and the points of each repeat.
    pub(crate) fn points(&self) -> (&'static str, [&str; 2], Vec<Vec<[f64; 2]>>) {
        let scores = &self.scores;
        let pairs = |values: &Vec<f64>| {
            let places = scores.places.iter();
            places.zip(values).map(|(x, y)| [*x, *y]).collect()
        };
        let columns = [scores.kind.along, &scores.column];
        (
            scores.kind.name,
            columns,
            self.repeats.iter().map(pairs).collect(),
        )
    }
}

/// Key that is wrong, and why.
type Fault = (&'static str, String);

impl CurveScores {
    /// Names of the observables.
    fn names(&self) -> impl Iterator<Item = String> + '_ {
        let kinds = SCORES.iter().take(self.weights.len());
        kinds.map(|score| format!("{}_{score}_{}", self.kind.name, self.column))
    }

    /// The scores of values at the places.
    fn of(&self, values: &[f64]) -> Vec<f64> {
        let sum = |weights: &Vec<f64>| weights.iter().zip(values).map(|(w, y)| w * y).sum();
        self.weights.iter().map(sum).collect()
    }

    /// Root mean square of what the scores leave of values.
    fn left_of(&self, values: &[f64]) -> f64 {
        let n = values.len() as f64;
        let scores = self.of(values);
        let explained = |j: usize| {
            let all = self.weights.iter().zip(&scores);
            all.map(|(w, score)| n * w[j] * score).sum::<f64>()
        };
        let squares = values
            .iter()
            .enumerate()
            .map(|(j, y)| (y - explained(j)).powi(2));
        (squares.sum::<f64>() / n).sqrt()
    }

    /// The scores of the curve that a record holds.
    ///
    /// # Errors
    ///
    /// A record without the curve, or with one that ends before the measured one, in words.
    pub(crate) fn read(&self, record: &Record) -> Result<BTreeMap<String, Observation>, String> {
        let name = self.kind.name;
        let details = RunDetails::of(record).map_err(|error| error.to_string())?;
        let curve = details.curve.filter(|curve| curve.name == name);
        let mut columns = curve.map(|curve| curve.columns).unwrap_or_default();
        let both = columns
            .remove(self.kind.along)
            .zip(columns.remove(&self.column));
        let (along, values) = both.ok_or_else(|| {
            format!("the record has no curve '{name}', so that another version wrote it: remove it to run it again")
        })?;
        let (Some(&end), Some(&last)) = (along.last(), self.places.last()) else {
            return Err(format!("the curve '{name}' of the run is empty"));
        };
        if end < last && !self.kind.is_kept {
            return Err(format!(
                "the curve '{name}' of the run ends at {} {}, before the last measured place {}: measure or simulate the same range",
                self.kind.along,
                significant(end, 4),
                significant(last, 4)
            ));
        }
        let at: Vec<f64> = self
            .places
            .iter()
            .map(|x| value_at(*x, &along, &values))
            .collect();
        let unit = unit_of(&self.column);
        let single = |mean| Observation::of_one(mean, unit);
        Ok(self
            .names()
            .zip(self.of(&at))
            .map(|(name, score)| (name, single(score)))
            .collect())
    }
}

/// The value at a place of a curve along ascending places, by lines between them; beyond its ends the value there.
fn value_at(x: f64, along: &[f64], values: &[f64]) -> f64 {
    let next = along.partition_point(|place| *place <= x);
    if next == 0 {
        return values[0];
    }
    let Some(high) = along.get(next) else {
        return values[next - 1];
    };
    let low = along[next - 1];
    let share = (x - low) / (high - low);
    values[next - 1] + share * (values[next] - values[next - 1])
}

/// Unit at the end of the name of a column.
fn unit_of(column: &str) -> &'static str {
    let known = [("_g", "g"), ("percent", "%"), ("_kpa", "kPa"), ("_n", "N")];
    let found = known.iter().find(|(end, _)| column.ends_with(end));
    found.map_or("1", |(_, unit)| unit)
}

/// Weights of the values at places in the scores, see [`CurveScores`].
fn weights_at(places: &[f64], scores: usize) -> Vec<Vec<f64>> {
    let n = places.len() as f64;
    let (first, last) = (places[0], places[places.len() - 1]);
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>() / n;
    let mut found: Vec<Vec<f64>> = Vec::new();
    for _ in 0..scores {
        let scaled = places
            .iter()
            .map(|x| (2.0 * x - first - last) / (last - first));
        let mut next: Vec<f64> = match found.last() {
            None => vec![1.0; places.len()],
            Some(before) => scaled.zip(before).map(|(x, q)| x * q).collect(),
        };
        // Twice: what the first time leaves by rounding.
        for _ in 0..2 {
            for q in &found {
                let share = dot(&next, q);
                next.iter_mut().zip(q).for_each(|(x, y)| *x -= share * y);
            }
        }
        let size = dot(&next, &next).sqrt();
        found.push(next.into_iter().map(|x| x / size).collect());
    }
    let over_n = |q: Vec<f64>| q.into_iter().map(|x| x / n).collect();
    found.into_iter().map(over_n).collect()
}

/// The table of a curve: its places, and the values of each repeat.
#[derive(Debug)]
struct CurveTable {
    column: String,
    places: Vec<f64>,
    repeats: Vec<Vec<f64>>,
}

impl CurveTable {
    fn read(path: &Path, kind: CurveKind) -> Result<Self, String> {
        let bytes = std::fs::read(path).map_err(|error| format!("cannot be read: {error}"))?;
        let table = Table::parse(&text_of_bytes(bytes)).map_err(|error| error.to_string())?;
        let expected = format!(
            "the first column must be {}, each further one {} (the repeats with an ending, such as {}_2)",
            kind.along,
            kind.values.join(" or "),
            kind.values[0]
        );
        let header = table.header();
        let (first, others) = header.split_first().ok_or_else(|| expected.clone())?;
        let mut known = kind.values.iter();
        let column =
            known.find(|value| others.first().is_some_and(|name| name.starts_with(**value)));
        let column = column.filter(|value| others.iter().all(|name| name.starts_with(**value)));
        let column = column.filter(|_| first == kind.along).ok_or(expected)?;
        let column_of = |place: usize| {
            let rows = table.rows().iter();
            let read = rows.map(|row| table.number(row, place).map_err(|error| error.to_string()));
            read.collect::<Result<Vec<f64>, _>>()
        };
        let places = column_of(0)?;
        if let Some(k) = places.windows(2).position(|pair| pair[1] <= pair[0]) {
            let row = &table.rows()[k + 1];
            return Err(format!(
                "{}: {} is not above the one before: the places must ascend",
                table.place(row, 0),
                places[k + 1]
            ));
        }
        if places.len() > MOST_ROWS {
            return Err(format!(
                "has {} rows, at most {MOST_ROWS} are read: leave rows out",
                places.len()
            ));
        }
        Ok(Self {
            column: (*column).into(),
            places,
            repeats: (1..header.len()).map(column_of).collect::<Result<_, _>>()?,
        })
    }
}

impl MeasuredCurve {
    /// Reads a curve that a scene can give, relative to the folder of the study.
    ///
    /// # Errors
    ///
    /// The key that is wrong and its fault.
    pub(crate) fn read(entry: &CurveEntry, folder: &Path, kind: CurveKind) -> Result<Self, Fault> {
        let file = folder.join(&entry.file);
        let table = CurveTable::read(&file, kind)
            .map_err(|fault| ("file", format!("{}: {fault}", file.display())))?;
        let most = SCORES.len().min(table.places.len().saturating_sub(1));
        if entry.scores == 0 || entry.scores > most {
            let rows = table.places.len();
            return Err((
                "scores",
                format!(
                    "it must be 1 to {most}: at most {}, and fewer than the {rows} rows of the curve",
                    SCORES.len()
                ),
            ));
        }
        let scores = CurveScores {
            kind,
            weights: weights_at(&table.places, entry.scores),
            places: table.places,
            column: table.column,
        };
        let repeats = &table.repeats;
        let n = repeats.len() as f64;
        let each: Vec<Vec<f64>> = repeats.iter().map(|values| scores.of(values)).collect();
        let means: Vec<f64> = (0..entry.scores)
            .map(|k| each.iter().map(|scores| scores[k]).sum::<f64>() / n)
            .collect();
        let covariance = scores.covariance(entry, &each, &means)?;
        let sd = |k: usize| covariance(k, k).sqrt();
        let names: Vec<String> = scores.names().collect();
        let mut correlations = Vec::new();
        for b in 1..names.len() {
            correlations.extend((0..b).map(|a| MeasuredCorrelation {
                a: names[a].clone(),
                b: names[b].clone(),
                value: covariance(a, b) / (sd(a) * sd(b)),
            }));
        }
        let values = names.into_iter().enumerate();
        let values = values.map(|(k, name)| (name, MeasuredValue::of_mean(means[k], sd(k), n)));
        let values: Vec<_> = values.collect();
        drop(covariance);
        let remark = scores.remark(entry, repeats, &file);
        Ok(Self {
            repeats: table.repeats,
            scores,
            file,
            values,
            correlations,
            remark,
        })
    }
}

impl CurveScores {
    /// That the scores leave much of the curve; `None` if they do not, or if no error is stated.
    fn remark(&self, entry: &CurveEntry, repeats: &[Vec<f64>], file: &Path) -> Option<String> {
        let left = repeats.iter().map(|values| self.left_of(values));
        let left = left.fold(0.0, f64::max);
        let sd = entry.sd.filter(|sd| left > LEFT * sd)?;
        Some(format!(
            "{}: {} scores leave {} of the curve (root mean square), where one value deviates by {sd}: more scores would take more of it",
            file.display(),
            entry.scores,
            significant(left, 2)
        ))
    }

    /// Covariance of the scores of one curve.
    ///
    /// # Formula
    ///
    /// From a stated error `C_ij = sd^2 exp(-|x_i - x_j| / L)` of the values: `W C W'` with the weights W. Without one, the sample covariance
    /// of the scores of the repeats.
    fn covariance<'a>(
        &'a self,
        entry: &'a CurveEntry,
        each: &'a [Vec<f64>],
        means: &'a [f64],
    ) -> Result<Box<dyn Fn(usize, usize) -> f64 + 'a>, Fault> {
        let (sd, length) = match (entry.sd, entry.correlation_length) {
            (Some(sd), Some(length)) => (sd, length),
            (None, None) if each.len() >= self.weights.len() + 2 => {
                return Ok(Box::new(move |a, b| {
                    let products = each.iter().map(|s| (s[a] - means[a]) * (s[b] - means[b]));
                    products.sum::<f64>() / (each.len() as f64 - 1.0)
                }));
            }
            (None, None) => {
                return Err((
                    "sd",
                    format!(
                        "is missing: state sd and correlation_length of one curve, or give {} repeats or more for {} scores",
                        self.weights.len() + 2,
                        self.weights.len()
                    ),
                ));
            }
            (None, Some(_)) => return Err(("sd", "is missing beside correlation_length".into())),
            (Some(_), None) => {
                let problem = "is missing: over which length of the first column do values deviate together? That of the spacing if they do not";
                return Err(("correlation_length", problem.into()));
            }
        };
        for (key, value) in [("sd", sd), ("correlation_length", length)] {
            if !(value > 0.0 && value.is_finite()) {
                return Err((key, format!("is {value}: it must be above 0")));
            }
        }
        Ok(Box::new(move |a, b| {
            let near =
                |i: usize, j: usize| (-(self.places[i] - self.places[j]).abs() / length).exp();
            let n = self.places.len();
            let row = |i: usize| (0..n).map(|j| near(i, j) * self.weights[b][j]).sum::<f64>();
            sd * sd * (0..n).map(|i| self.weights[a][i] * row(i)).sum::<f64>()
        }))
    }
}

#[cfg(test)]
mod tests;
