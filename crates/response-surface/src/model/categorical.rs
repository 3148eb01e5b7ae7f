//! Factors of named levels, such as the material of a wall.

use experiment_design::Factor;
use serde::{Deserialize, Serialize};
use std::ops::Range;

use crate::fit::{FTest, f_test};
use crate::{Error, Fit, Model, NamedValues, Observations, Term, Weighting, fit_weighted};

/// Model formulas that are a word.
const ORDERS: [&str; 5] = ["mean", "linear", "2fi", "quadratic", "cubic"];

/// A factor whose levels have names and no order.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Categorical {
    /// Short name, used in model formulas.
    symbol: String,
    /// Names of the levels, at least two.
    levels: Vec<String>,
}

impl Categorical {
    /// Makes a factor of named levels.
    ///
    /// # Errors
    /// [`Error::Design`] for a symbol that cannot be used or a level that is named twice;
    /// [`Error::Length`] for fewer than two levels.
    pub fn new(symbol: &str, levels: Vec<String>) -> Result<Self, Error> {
        Factor::coded_only(symbol)?;
        if levels.len() < 2 {
            return Err(Error::Length {
                what: "levels of a categorical factor",
                expected: 2,
                given: levels.len(),
            });
        }
        for (i, level) in levels.iter().enumerate() {
            if levels[..i].contains(level) {
                return Err(experiment_design::Error::DuplicateSymbol {
                    symbol: level.clone(),
                }
                .into());
            }
        }
        Ok(Self {
            symbol: symbol.to_owned(),
            levels,
        })
    }

    /// Short name.
    pub fn symbol(&self) -> &str {
        &self.symbol
    }

    /// Names of the levels.
    pub fn levels(&self) -> &[String] {
        &self.levels
    }

    /// The columns that stand for the factor, one less than levels: +1 at their level, -1 at the last
    /// level, 0 at the others. Their coefficients are the deviations of the levels from the mean of
    /// all; that of the last level is minus their sum.
    ///
    /// # Errors
    /// [`Error::Design`] if a name cannot be made.
    pub fn columns(&self) -> Result<Vec<Factor>, Error> {
        let plain = |level: &str| {
            !level.is_empty() && level.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
        };
        let all_plain = self.levels.iter().all(|level| plain(level));
        let last = self.levels.len() - 1;
        let column = |(i, level): (usize, &String)| {
            let end = if all_plain {
                level.clone()
            } else {
                (i + 1).to_string()
            };
            Ok(Factor::coded_only(&format!("{}.{end}", self.symbol))?)
        };
        self.levels[..last].iter().enumerate().map(column).collect()
    }

    /// The values of those columns at a level; none if there is no such level.
    pub fn coded(&self, level: &str) -> Option<Vec<f64>> {
        let last = self.levels.len() - 1;
        let place = self.levels.iter().position(|l| l == level)?;
        let value = |column: usize| match place {
            place if place == last => -1.0,
            place if place == column => 1.0,
            _ => 0.0,
        };
        Some((0..last).map(value).collect())
    }
}

/// A model over numbers and named levels.
#[derive(Debug, Clone, PartialEq)]
pub struct CategoricalModel {
    /// The factors, then the columns of the categorical factors.
    pub factors: Vec<Factor>,
    /// The terms over those.
    pub model: Model,
    /// The model as written, one symbol for each categorical factor.
    written: Model,
    /// For each term of `model` the term of `written` that it is part of.
    part_of: Vec<usize>,
}

impl CategoricalModel {
    /// Reads `linear`, `2fi`, `quadratic`, `cubic`, or a formula in which categorical factors are named by their
    /// symbol: `B + wall + B:wall`. They have no powers.
    ///
    /// # Errors
    /// Those of [`Model::parse`]; [`Error::BadTerm`] for a power of a categorical factor.
    pub fn parse(
        formula: &str,
        numeric: &[Factor],
        categorical: &[Categorical],
    ) -> Result<Self, Error> {
        let k = numeric.len();
        let mut symbols = numeric.to_vec();
        let mut factors = numeric.to_vec();
        let mut columns = Vec::new();
        for factor in categorical {
            symbols.push(Factor::coded_only(factor.symbol())?);
            let own = factor.columns()?;
            columns.push(factors.len()..factors.len() + own.len());
            factors.extend(own);
        }
        let written = Model::parse(formula, &symbols)?;
        if !categorical.is_empty() && !written.has_intercept() {
            // The columns of levels are deviations from a mean that would then be held at zero.
            return Err(Error::NoIntercept {
                what: "a model with named levels needs its intercept, the mean over the levels",
            });
        }
        let powered = |term: &Term| term.powers()[k..].iter().any(|power| *power > 1);
        if let Some(term) = written.terms().iter().find(|term| powered(term))
            && !ORDERS.contains(&formula.trim())
        {
            return Err(Error::BadTerm {
                part: written.name(term),
                symbols: written.symbols().join(", "),
                most_power: 1,
            });
        }
        let keep: Vec<bool> = written.terms().iter().map(|term| !powered(term)).collect();
        let written = written.subset(&keep);
        let mut terms = Vec::new();
        for (place, term) in written.terms().iter().enumerate() {
            let expanded = expanded(term, k, &columns);
            terms.extend(expanded.into_iter().map(|powers| (place, powers)));
        }
        let names = factors.iter().map(|f| f.symbol().to_owned()).collect();
        let all = terms
            .iter()
            .map(|(_, powers)| Term::from_powers(powers.clone()));
        let entering = written.entry().iter().flat_map(|place| {
            let own = terms.iter().filter(move |(owner, _)| owner == place);
            own.map(|(_, powers)| Term::from_powers(powers.clone()))
        });
        let entering: Vec<Term> = entering.collect();
        let model = Model::from_terms(names, all.collect()).entering(&entering);
        let owner = |term: &Term| {
            let found = terms.iter().find(|(_, powers)| powers == term.powers());
            found.map_or(0, |(place, _)| *place)
        };
        Ok(Self {
            part_of: model.terms().iter().map(owner).collect(),
            factors,
            model,
            written,
        })
    }

    /// Tests every term as written, in the order of [`Model::entry`], all its columns together, with sums of squares of Type I, II and
    /// III (see [`crate::fit::TypedRow`]); `fit` is the fit of the whole model.
    ///
    /// # Errors
    /// Those of [`fit_weighted`].
    pub fn tests(
        &self,
        fit: &Fit,
        data: &Observations,
        weighting: Weighting,
    ) -> Result<NamedValues<GroupRow>, Error> {
        let sse = |keep: &dyn Fn(usize) -> bool| -> Result<f64, Error> {
            let kept: Vec<bool> = self.part_of.iter().map(|&place| keep(place)).collect();
            if kept.iter().all(|kept| *kept) {
                return Ok(fit.sse);
            }
            let model = self.model.subset(&kept);
            Ok(fit_weighted(&self.factors, &model, data, weighting)?.sse)
        };
        let terms = self.written.terms();
        let entry = self.written.entry();
        let mut rows = Vec::new();
        for (rank, &i) in entry.iter().enumerate() {
            let term = &terms[i];
            if term.degree() == 0 {
                continue;
            }
            let earlier = &entry[..rank];
            let df = self.part_of.iter().filter(|&&place| place == i).count();
            let beside = |j: usize| j != i && !terms[j].contains(term);
            let test = |ss: f64| {
                let test = fit
                    .mse
                    .map(|mse| f_test(ss.max(0.0) / df as f64, df, mse, fit.df_resid));
                GroupSum { ss, test }
            };
            let row = GroupRow {
                df,
                type_i: test(
                    sse(&|j| earlier.contains(&j))? - sse(&|j| j == i || earlier.contains(&j))?,
                ),
                type_ii: test(sse(&beside)? - sse(&|j| j == i || beside(j))?),
                type_iii: test(sse(&|j| j != i)? - fit.sse),
            };
            rows.push((self.written.name(term), row));
        }
        Ok(rows.into_iter().collect())
    }
}

/// A sum of squares with its test.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GroupSum {
    /// Sum of squares, squared unit of the response.
    pub ss: f64,
    /// Its mean square against that of the residuals; none without residual degrees of freedom.
    pub test: Option<FTest>,
}

/// The test of a term of several columns.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct GroupRow {
    /// Number of columns.
    pub df: usize,
    /// After the terms before it.
    pub type_i: GroupSum,
    /// After all terms that do not contain it.
    pub type_ii: GroupSum,
    /// After all other terms.
    pub type_iii: GroupSum,
}

/// The powers of the terms that a written term becomes in the columns of the levels, which follow the k numeric factors.
fn expanded(term: &Term, k: usize, columns: &[Range<usize>]) -> Vec<Vec<u8>> {
    let mut base = term.powers()[..k].to_vec();
    base.resize(columns.last().map_or(k, |range| range.end), 0);
    let mut expanded = vec![base];
    for (power, range) in term.powers()[k..].iter().zip(columns) {
        if *power == 1 {
            let each = |powers: &Vec<u8>| -> Vec<Vec<u8>> {
                let with = |column: usize| {
                    let mut powers = powers.clone();
                    powers[column] = 1;
                    powers
                };
                range.clone().map(with).collect()
            };
            expanded = expanded.iter().flat_map(each).collect();
        }
    }
    expanded
}

#[cfg(test)]
mod tests {
    use super::{Categorical, CategoricalModel};
    use crate::{Cell, Error, Observations, Weighting, fit_weighted, one_way};
    use experiment_design::Factor;

    fn wall() -> Categorical {
        let levels = ["steel", "glass", "resin"].map(str::to_owned);
        Categorical::new("wall", levels.to_vec()).unwrap()
    }

    #[test]
    fn a_model_over_levels_has_their_columns_and_no_powers_of_them() {
        let b = [Factor::new("B", "", "1", 0.2, 0.4).unwrap()];
        let read = |formula: &str| CategoricalModel::parse(formula, &b, &[wall()]);
        let quadratic = read("quadratic").unwrap();
        assert_eq!(
            quadratic.model.names(),
            [
                "1",
                "B",
                "wall.steel",
                "wall.glass",
                "B:wall.steel",
                "B:wall.glass",
                "B^2"
            ]
        );
        assert_eq!(read("B + wall").unwrap().model.terms().len(), 4);
        assert!(matches!(read("B + wall^2"), Err(Error::BadTerm { .. })));
        assert_eq!(read("B*wall").unwrap().model.terms().len(), 6);
        // Deviations about a mean of zero would be another model than the means of the levels.
        assert!(matches!(read("0 + wall"), Err(Error::NoIntercept { .. })));
        assert!(Categorical::new("wall", vec!["steel".to_owned()]).is_err());
        let twice = vec!["steel".to_owned(), "steel".to_owned()];
        assert!(Categorical::new("wall", twice).is_err());
    }

    /// Seven runs of two named factors that are not balanced. Between the groups of either factor alone the sum of squares is
    /// that of the one-way analysis, so the one that the formula names first has it as its Type I sum (rounding: 1e-12).
    #[test]
    fn the_first_factor_of_the_formula_has_the_sum_between_its_groups() {
        let runs = [
            ("steel", "a", 12.8),
            ("steel", "a", 13.7),
            ("steel", "b", 12.0),
            ("glass", "a", 12.2),
            ("glass", "b", 9.2),
            ("glass", "b", 10.4),
            ("glass", "b", 10.3),
        ];
        let two = |symbol: &str, levels: [&str; 2]| {
            Categorical::new(symbol, levels.map(str::to_owned).to_vec()).unwrap()
        };
        let named = [two("wall", ["glass", "steel"]), two("operator", ["a", "b"])];
        let cells = runs.map(|(wall, operator, y)| {
            let coded = [named[0].coded(wall), named[1].coded(operator)];
            Cell::single(coded.into_iter().flatten().flatten().collect(), y)
        });
        let data = Observations::from_cells(cells.to_vec()).unwrap();
        let y = runs.map(|(_, _, y)| y);
        let between =
            |labels: [&str; 7]| one_way(&labels.map(str::to_owned), &y).unwrap().between_ss;
        let walls = between(runs.map(|(wall, _, _)| wall));
        let operators = between(runs.map(|(_, operator, _)| operator));
        for (formula, first, ss) in [
            ("wall + operator", "wall", walls),
            ("operator + wall", "operator", operators),
            ("operator*wall", "operator", operators),
        ] {
            let model = CategoricalModel::parse(formula, &[], &named).unwrap();
            let fit = fit_weighted(&model.factors, &model.model, &data, Weighting::Counts).unwrap();
            let rows = model.tests(&fit, &data, Weighting::Counts).unwrap();
            let (name, row) = rows.iter().next().unwrap();
            assert_eq!(name, first, "{formula}");
            assert!((row.type_i.ss - ss).abs() < 1e-12, "{formula}: {row:?}");
            let column = format!("{first}.{}", if first == "wall" { "glass" } else { "a" });
            let of_column = fit.anova.get(&column).unwrap().type_i.ss;
            assert!((of_column - ss).abs() < 1e-12, "{formula}: {of_column}");
        }
    }

    /// With levels alone the test is the one-way analysis of variance, and the surface at a level is
    /// the mean of its runs (rounding: 1e-12).
    #[test]
    fn levels_alone_are_the_analysis_of_groups() {
        let wall = wall();
        let runs = [
            ("steel", 3.0),
            ("steel", 4.0),
            ("glass", 8.0),
            ("glass", 6.0),
            ("resin", 1.0),
            ("resin", 1.5),
            ("resin", 2.0),
        ];
        let cells = runs.map(|(level, y)| {
            let coded = [vec![0.0], wall.coded(level).unwrap()].concat();
            Cell::single(coded, y)
        });
        let data = Observations::from_cells(cells.to_vec()).unwrap();
        let b = [Factor::coded_only("B").unwrap()];
        let model = CategoricalModel::parse("wall", &b, std::slice::from_ref(&wall)).unwrap();
        let fit = fit_weighted(&model.factors, &model.model, &data, Weighting::Counts).unwrap();
        let row = model.tests(&fit, &data, Weighting::Counts).unwrap();
        let row = row.get("wall").unwrap();
        let labels = runs.map(|(level, _)| level.to_owned());
        let expected = one_way(&labels, &runs.map(|(_, y)| y)).unwrap();
        assert_eq!(row.df, 2);
        for ss in [row.type_i.ss, row.type_ii.ss, row.type_iii.ss] {
            assert!((ss - expected.between_ss).abs() < 1e-12, "{row:?}");
        }
        let f = row.type_iii.test.as_ref().unwrap().f.unwrap();
        assert!((f - expected.f.unwrap()).abs() < 1e-10, "{row:?}");
        for (level, mean) in [("steel", 3.5), ("glass", 7.0), ("resin", 1.5)] {
            let columns = wall.coded(level).unwrap();
            let held: Vec<(usize, f64)> = (1..).zip(columns).collect();
            let at_level = fit.held(&held).unwrap();
            assert_eq!(at_level.factors.len(), 1);
            assert!((at_level.value(&[0.7]) - mean).abs() < 1e-12, "{level}");
            let n = if level == "resin" { 3.0 } else { 2.0 };
            assert!(
                (at_level.leverage(&[0.7]) - 1.0 / n).abs() < 1e-12,
                "{level}"
            );
        }
        assert_eq!(wall.coded("wood"), None);
    }
}
