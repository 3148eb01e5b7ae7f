//! Plackett-Burman screening designs.

use crate::hadamard::saturated_rows;
use crate::{Design, DesignKind, Error, Factor, check_factors};

/// Screens up to 47 factors in the smallest of 12, 20, 24, 28, 36, 40, 44 and 48 runs that holds
/// them. (16 and 32 runs are offered too, but alias two-factor interactions fully.)
///
/// Columns without a factor become dummies that estimate the error. Where the design is
/// cyclic, row i + 1 is row i shifted one place to the right; the last row is all minus. The columns are orthogonal, X'X = N I, but
/// each main effect is partially aliased with the two-factor interactions of the others.
///
/// # Source
/// `[Plackett1946]`; 28 runs: `[Paley1933]`.
///
/// # Errors
/// [`Error::FactorCount`] beyond 47 factors; those of [`check_factors`].
pub fn plackett_burman(factors: &[Factor]) -> Result<Design, Error> {
    let n_runs = match factors.len() {
        0..=11 => 12,
        12..=19 => 20,
        20..=23 => 24,
        24..=27 => 28,
        28..=35 => 36,
        36..=39 => 40,
        40..=43 => 44,
        _ => 48,
    };
    plackett_burman_with_runs(factors, n_runs)
}

/// Screens factors in a stated number of runs: a multiple of four from 12 to 48.
///
/// # Errors
/// [`Error::RunCount`] for another number of runs; [`Error::FactorCount`] for more factors than
/// runs - 1; those of [`check_factors`].
pub fn plackett_burman_with_runs(factors: &[Factor], n_runs: usize) -> Result<Design, Error> {
    check_factors(factors)?;
    let rows = saturated_rows(n_runs).filter(|_| n_runs >= 12);
    let Some(rows) = rows else {
        return Err(Error::RunCount {
            design: "Plackett-Burman",
            given: n_runs,
            way_out: "take 12, 16, 20, 24, 28, 32, 36, 40, 44 or 48 runs",
        });
    };
    if factors.len() >= n_runs {
        return Err(Error::FactorCount {
            design: "Plackett-Burman",
            given: factors.len(),
            least: 1,
            most: n_runs - 1,
            way_out: "take a larger one (up to 47 factors in 48 runs), screen in groups, or take \
                      a Latin hypercube",
        });
    }
    let columns = n_runs - 1;
    let dummies = dummy_names(factors, columns - factors.len());
    Design::new(DesignKind::PlackettBurman, factors, dummies, rows)
}

impl Design {
    /// Appends the mirror image of every run, all signs reversed, as the next block.
    ///
    /// The main effects are then free of two-factor interactions.
    ///
    /// # Source
    /// `[Box1951]`.
    #[must_use]
    pub fn folded_over(&self) -> Self {
        let cells = self.runs().iter().map(|run| run.cell).max().unwrap_or(0);
        let blocks = self.runs().iter().map(|run| run.block).max().unwrap_or(0);
        let mirror = self.runs().iter().map(|run| crate::Run {
            cell: run.cell + cells,
            replicate: run.replicate,
            block: run.block + blocks,
            coded: run.coded.iter().map(|x| -x).collect(),
        });
        let kind = match self.kind() {
            DesignKind::PlackettBurman => DesignKind::PlackettBurmanFoldover,
            kind => kind,
        };
        let runs = self.runs().iter().cloned().chain(mirror).collect();
        self.with_other_runs(kind, runs)
    }
}

/// Names for `n` columns without factor: the next free capital letters without I (as the study
/// does: G, H, J, K, L), then `dummy1`, `dummy2` and so on.
fn dummy_names(factors: &[Factor], n: usize) -> Vec<String> {
    let taken = |name: &str| factors.iter().any(|f| f.symbol() == name);
    let single = factors.iter().all(|f| f.symbol().len() == 1);
    let letters = ('A'..='Z')
        .filter(|&c| single && c != 'I')
        .map(String::from);
    let numbered = (1..).map(|i: usize| format!("dummy{i}"));
    letters
        .chain(numbered)
        .filter(|name| !taken(name))
        .take(n)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::{plackett_burman, plackett_burman_with_runs};
    use crate::Error;
    use crate::factor::coded_factors;

    /// Signs are whole numbers, so orthogonality is exact.
    #[test]
    fn columns_are_balanced_and_orthogonal_for_every_published_size() {
        for n in [12, 16, 20, 24, 28, 32, 36, 40, 44, 48] {
            let rows = plackett_burman_with_runs(&coded_factors(3), n)
                .unwrap()
                .coded_rows();
            assert_eq!(rows.len(), n);
            for i in 0..n - 1 {
                assert_eq!(
                    rows.iter().map(|r| r[i]).sum::<f64>(),
                    0.0,
                    "column {i} of {n}"
                );
                for j in 0..n - 1 {
                    let product: f64 = rows.iter().map(|r| r[i] * r[j]).sum();
                    let expected = if i == j { n as f64 } else { 0.0 };
                    assert_eq!(product, expected, "columns {i}, {j} of {n}");
                }
            }
        }
    }

    /// The designs take the smallest size that holds the factors, and fill up with dummies.
    #[test]
    fn the_smallest_design_that_holds_the_factors_is_taken() {
        for (k, n) in [
            (6, 12),
            (12, 20),
            (23, 24),
            (24, 28),
            (30, 36),
            (39, 40),
            (47, 48),
        ] {
            let design = plackett_burman(&coded_factors(k)).unwrap();
            assert_eq!(design.runs().len(), n);
            assert_eq!(design.dummies().len(), n - 1 - k);
        }
    }

    /// In a fold-over every product of three columns sums to zero, so no two-factor interaction
    /// is aliased with a main effect.
    #[test]
    fn fold_over_frees_main_effects_of_two_factor_interactions() {
        let single = plackett_burman(&coded_factors(6)).unwrap();
        let double = single.folded_over();
        assert_eq!(double.runs().len(), 24);
        assert_eq!(double.runs()[12].block, 2);
        let sum = |rows: &[Vec<f64>]| rows.iter().map(|r| r[0] * r[1] * r[2]).sum::<f64>();
        assert_ne!(sum(&single.coded_rows()), 0.0);
        assert_eq!(sum(&double.coded_rows()), 0.0);
    }

    #[test]
    fn sizes_beyond_the_published_ones_are_refused_with_a_way_out() {
        assert!(matches!(
            plackett_burman(&coded_factors(48)),
            Err(Error::FactorCount { most: 47, .. })
        ));
        let error = plackett_burman_with_runs(&coded_factors(3), 18).unwrap_err();
        assert!(error.to_string().contains("44 or 48"), "{error}");
        assert!(plackett_burman_with_runs(&coded_factors(12), 12).is_err());
    }
}
