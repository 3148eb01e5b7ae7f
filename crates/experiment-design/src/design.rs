//! A design: the list of runs, in coded variables.

use probability::random_stream::Stream;
use serde::{Deserialize, Serialize};

use crate::{Error, Factor, check_factors};

/// Largest number of rows of a design; a typing error should not fill the memory.
const MOST_RUNS: usize = 1_000_000;

/// How the runs of a design were chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DesignKind {
    /// Two-level screening design, 12 to 48 runs.
    PlackettBurman,
    /// A Plackett-Burman design followed by its mirror image.
    PlackettBurmanFoldover,
    /// Three-level design of edge midpoints.
    BoxBehnken,
    /// Two-level factorial with axial points.
    CentralComposite,
    /// All combinations of two levels.
    FullFactorial,
    /// A regular fraction of all combinations of two levels.
    FractionalFactorial,
    /// Mirrored pairs of runs with one factor in its middle, for many factors at three levels.
    DefinitiveScreening,
    /// One point in each of n equal slices of every factor.
    LatinHypercube,
    /// Runs chosen for a small determinant of the coefficients' covariance.
    DOptimal,
    /// Runs chosen for a small mean variance of the prediction over the box.
    IOptimal,
    /// Points along the path of steepest ascent.
    SteepestAscent,
    /// Runs added to an earlier design.
    Augmented,
    /// Runs given by the user.
    Given,
}

/// One run of a design.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// Cell: runs of one cell are replicates of the same settings. Counted from 1.
    pub cell: usize,
    /// Which replicate of its cell this run is, from 1.
    pub replicate: usize,
    /// Block, from 1.
    pub block: usize,
    /// Coded values, one per column (factors, then dummies).
    pub coded: Vec<f64>,
}

/// Runs in coded variables, in the order they are to be done.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Design {
    /// How the runs were chosen.
    kind: DesignKind,
    /// The factors, in column order.
    factors: Vec<Factor>,
    /// Names of columns that belong to no factor; they estimate the error.
    dummies: Vec<String>,
    /// The runs, (runs, columns).
    runs: Vec<Run>,
}

impl Design {
    /// Makes a design of coded rows, one cell each; columns are the factors, then the dummies.
    ///
    /// # Errors
    /// Those of [`check_factors`]; [`Error::BadRun`] if a row has a wrong length or a value that
    /// is not finite; [`Error::EmptyTable`] without rows.
    pub fn new(
        kind: DesignKind,
        factors: &[Factor],
        dummies: Vec<String>,
        rows: Vec<Vec<f64>>,
    ) -> Result<Self, Error> {
        let runs = rows
            .into_iter()
            .enumerate()
            .map(|(i, coded)| Run {
                cell: i + 1,
                replicate: 1,
                block: 1,
                coded,
            })
            .collect();
        Self::with_runs(kind, factors, dummies, runs)
    }

    /// Makes a design of given runs; columns are the factors, then the dummies.
    ///
    /// # Errors
    /// As [`Design::new`].
    pub fn with_runs(
        kind: DesignKind,
        factors: &[Factor],
        dummies: Vec<String>,
        runs: Vec<Run>,
    ) -> Result<Self, Error> {
        check_factors(factors)?;
        if runs.is_empty() {
            return Err(Error::EmptyTable { what: "rows" });
        }
        let columns = factors.len() + dummies.len();
        for (i, run) in runs.iter().enumerate() {
            if run.coded.len() != columns || run.coded.iter().any(|x| !x.is_finite()) {
                return Err(Error::BadRun {
                    run: i + 1,
                    columns,
                });
            }
        }
        Ok(Self {
            kind,
            factors: factors.to_vec(),
            dummies,
            runs,
        })
    }

    /// Coded runs of an earlier design as block 1, and those added to them as block 2; all in block 1 without earlier ones.
    ///
    /// # Errors
    /// As [`Design::new`].
    pub fn in_stages(
        kind: DesignKind,
        factors: &[Factor],
        given: &[Vec<f64>],
        added: Vec<Vec<f64>>,
    ) -> Result<Self, Error> {
        let first = given.len();
        let rows: Vec<Vec<f64>> = given.iter().cloned().chain(added).collect();
        let blocks: Vec<usize> = (0..rows.len())
            .map(|i| 1 + usize::from(first > 0 && i >= first))
            .collect();
        Self::new(kind, factors, Vec::new(), rows)?.blocked(&blocks)
    }

    /// How the runs were chosen.
    pub fn kind(&self) -> DesignKind {
        self.kind
    }

    /// The factors, in column order.
    pub fn factors(&self) -> &[Factor] {
        &self.factors
    }

    /// Names of the columns that belong to no factor.
    pub fn dummies(&self) -> &[String] {
        &self.dummies
    }

    /// The runs in their order.
    pub fn runs(&self) -> &[Run] {
        &self.runs
    }

    /// Names of all columns: factors, then dummies.
    pub fn columns(&self) -> Vec<String> {
        let symbols = self.factors.iter().map(|f| f.symbol().to_owned());
        symbols.chain(self.dummies.iter().cloned()).collect()
    }

    /// Coded rows, (runs, columns).
    pub fn coded_rows(&self) -> Vec<Vec<f64>> {
        self.runs.iter().map(|run| run.coded.clone()).collect()
    }

    /// Natural values of the factors in run `i` (from 0), units of the factors; empty beyond the
    /// last run.
    pub fn natural(&self, i: usize) -> Vec<f64> {
        let coded = self.runs.get(i).map_or(&[][..], |run| &run.coded);
        let pairs = self.factors.iter().zip(coded);
        pairs.map(|(factor, &x)| factor.natural(x)).collect()
    }

    /// Largest |coded value| of the factors; above 1 the design leaves the ranges of the factors.
    pub fn reach(&self) -> f64 {
        let rows = self.runs.iter().flat_map(|run| run.coded.iter());
        rows.fold(0.0, |reach, x| reach.max(x.abs()))
    }

    /// Repeats every run `n` times, replicates side by side.
    ///
    /// # Errors
    /// [`Error::CountOutOfRange`] for n = 0 or more than a million runs in all.
    pub fn replicated(&self, n: usize) -> Result<Self, Error> {
        let most = (MOST_RUNS / self.runs.len()).max(1);
        if !(1..=most).contains(&n) {
            return Err(Error::CountOutOfRange {
                what: "replicates",
                given: n,
                least: 1,
                most,
            });
        }
        let repeat = |run: &Run| {
            let first = run.replicate - 1;
            let run = run.clone();
            (1..=n).map(move |i| Run {
                replicate: first * n + i,
                ..run.clone()
            })
        };
        let runs = self.runs.iter().flat_map(repeat).collect();
        Ok(Self {
            runs,
            ..self.clone()
        })
    }

    /// The same runs with the blocks given, one per run from 1.
    ///
    /// # Errors
    /// [`Error::CountOutOfRange`] unless there is one block per run, each at least 1.
    pub fn blocked(&self, blocks: &[usize]) -> Result<Self, Error> {
        if blocks.len() != self.runs.len() || blocks.contains(&0) {
            return Err(Error::CountOutOfRange {
                what: "block numbers, one per run and each at least 1",
                given: blocks.len(),
                least: self.runs.len(),
                most: self.runs.len(),
            });
        }
        let mut runs = self.runs.clone();
        for (run, &block) in runs.iter_mut().zip(blocks) {
            run.block = block;
        }
        runs.sort_by_key(|run| run.block);
        Ok(Self {
            runs,
            ..self.clone()
        })
    }

    /// The same columns with other runs, made from the present ones.
    pub(crate) fn with_other_runs(&self, kind: DesignKind, runs: Vec<Run>) -> Self {
        Self {
            kind,
            runs,
            ..self.clone()
        }
    }

    /// Puts the runs in random order within each block; the order depends on `seed` only.
    #[must_use]
    pub fn randomised(&self, seed: u64) -> Self {
        let mut runs = self.runs.clone();
        Stream::new(seed, "run order").shuffle(&mut runs);
        runs.sort_by_key(|run| run.block);
        Self {
            runs,
            ..self.clone()
        }
    }
}

/// Appends `n` centre rows.
///
/// # Errors
/// [`Error::CountOutOfRange`] for more than 10 000.
pub(crate) fn append_centres(
    rows: &mut Vec<Vec<f64>>,
    columns: usize,
    n: usize,
) -> Result<(), Error> {
    let most = 10_000;
    if n > most {
        return Err(Error::CountOutOfRange {
            what: "centre runs",
            given: n,
            least: 0,
            most,
        });
    }
    rows.extend(std::iter::repeat_n(vec![0.0; columns], n));
    Ok(())
}

#[cfg(test)]
mod tests {
    use crate::{Factor, box_behnken};

    fn three() -> Vec<Factor> {
        ["B", "E", "F"]
            .iter()
            .map(|s| Factor::coded_only(s).unwrap())
            .collect()
    }

    #[test]
    fn random_order_is_a_permutation_that_depends_on_the_seed_only() {
        let design = box_behnken(&three(), 5).unwrap();
        let (a, b) = (design.randomised(1), design.randomised(2));
        assert_eq!(a, design.randomised(1));
        assert_ne!(a, b);
        let mut cells: Vec<usize> = a.runs().iter().map(|run| run.cell).collect();
        cells.sort_unstable();
        assert_eq!(cells, (1..=17).collect::<Vec<_>>());
    }

    #[test]
    fn replicates_share_the_cell_and_count_up() {
        let design = box_behnken(&three(), 1).unwrap().replicated(3).unwrap();
        assert_eq!(design.runs().len(), 39);
        let second = &design.runs()[1];
        assert_eq!((second.cell, second.replicate), (1, 2));
        assert_eq!(design.runs()[0].coded, second.coded);
        assert!(design.replicated(0).is_err());
    }
}
