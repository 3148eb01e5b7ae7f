//! Tables of bench measurements.
//!
//! Columns:
//!
//! | test | columns | coefficient |
//! |---|---|---|
//! | drop | `drop_height_mm`, `rebound_height_mm` | e = sqrt(H2 / H1) |
//! | slider | `pull_force_n`, `normal_force_n` | mu = F / N |
//! | tilt | `angle_deg` | `mu_r` = tan(angle) |
//!
//! Sources: `[CottonStudy, eq. 1 and section 2.2]`.

use experiment_design::table::Table;

/// Largest pull over normal force that is believed: the tangent of 80 degrees, at which no seed holds on to another. Our
/// choice.
const MOST_FRICTION: f64 = 6.0;

/// Why a table gives no answer.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Error {
    /// A column is missing.
    #[error("no column '{column}'; the columns of this test are {known}")]
    NoColumn {
        column: &'static str,
        /// What the test reads.
        known: &'static str,
    },
    /// A cell holds no valid number.
    #[error("{place}: '{text}' must be {requirement}")]
    Cell {
        /// Where it stands, in words.
        place: String,
        text: String,
        /// What it must be.
        requirement: &'static str,
    },
    /// Too few values.
    #[error("{count} values are too few for a mean with an interval; at least 2 are needed")]
    TooFew {
        /// Their number.
        count: usize,
    },
}

/// A bench test.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Test {
    /// Restitution from heights.
    Drop,
    /// Static friction from the pull on a sled.
    Slider,
    /// Rolling friction from the angle at which a seed starts to roll.
    Tilt,
}

impl Test {
    /// The columns that the test reads.
    fn columns(self) -> (&'static [&'static str], &'static str) {
        match self {
            Self::Drop => (
                &["drop_height_mm", "rebound_height_mm"],
                "drop_height_mm and rebound_height_mm",
            ),
            Self::Slider => (
                &["pull_force_n", "normal_force_n"],
                "pull_force_n and normal_force_n",
            ),
            Self::Tilt => (&["angle_deg"], "angle_deg"),
        }
    }

    /// Name of the coefficient.
    pub(crate) fn coefficient(self) -> &'static str {
        match self {
            Self::Drop => "restitution",
            Self::Slider => "static_friction",
            Self::Tilt => "rolling_friction",
        }
    }
}

/// The coefficients of a table, one a row.
///
/// # Errors
///
/// A missing column, a cell that is not a number in its range.
pub(crate) fn coefficients(test: Test, table: &Table) -> Result<Vec<f64>, Error> {
    let (columns, known) = test.columns();
    let mut places = Vec::new();
    for &column in columns {
        let place = table.header().iter().position(|name| name == column);
        places.push(place.ok_or(Error::NoColumn { column, known })?);
    }
    let mut values = Vec::new();
    for row in table.rows() {
        let refused = |k: usize, requirement| Error::Cell {
            place: table.place(row, places[k]),
            text: row.text(places[k]).to_owned(),
            requirement,
        };
        let cell = |k: usize| -> Result<f64, Error> {
            let (high, requirement) = match (test, k) {
                (Test::Tilt, _) => (90.0, "an angle from 0 to below 90"),
                _ => (f64::MAX, "a number of 0 or more"),
            };
            let value = row.text(places[k]).parse().ok();
            let value = value.filter(|v: &f64| (0.0..high).contains(v));
            value.ok_or_else(|| refused(k, requirement))
        };
        values.push(match test {
            Test::Drop => {
                let (from, to) = (cell(0)?, cell(1)?);
                if to > from || from == 0.0 {
                    return Err(refused(1, "at most the drop height, which is above 0"));
                }
                (to / from).sqrt()
            }
            Test::Slider => {
                let (pull, load) = (cell(0)?, cell(1)?);
                if load == 0.0 {
                    return Err(refused(1, "above 0"));
                }
                if pull > MOST_FRICTION * load {
                    let requirement =
                        "at most six times the normal force; mind that both are in newtons";
                    return Err(refused(0, requirement));
                }
                pull / load
            }
            Test::Tilt => cell(0)?.to_radians().tan(),
        });
    }
    Ok(values)
}

#[cfg(test)]
mod tests {
    use super::{Test, coefficients};
    use experiment_design::table::Table;

    fn of(test: Test, text: &str) -> Result<Vec<f64>, super::Error> {
        coefficients(test, &Table::parse(text).unwrap())
    }

    #[test]
    fn each_table_gives_its_coefficient() {
        let drop = "# a comment\nseed,drop_height_mm,rebound_height_mm\n1,400,4\n2,400,16\n";
        assert_eq!(of(Test::Drop, drop).unwrap(), [0.1, 0.2]);
        let slider = "pull_force_n,normal_force_n\n0.32,1\n";
        assert_eq!(of(Test::Slider, slider).unwrap(), [0.32]);
        let tilt = of(Test::Tilt, "angle_deg\n45\n").unwrap();
        assert!((tilt[0] - 1.0).abs() < 1e-15, "{tilt:?}");
    }

    #[test]
    fn wrong_tables_are_refused_with_their_place() {
        let refused = |test, text: &str, words: &[&str]| {
            let message = of(test, text).unwrap_err().to_string();
            for word in words {
                assert!(message.contains(word), "'{word}' is not in '{message}'");
            }
        };
        refused(Test::Tilt, "angle\n1\n", &["angle_deg"]);
        refused(Test::Tilt, "angle_deg\n95\n", &["line 2", "'95'"]);
        let higher = "drop_height_mm,rebound_height_mm\n100,120\n";
        refused(Test::Drop, higher, &["line 2", "'120'", "drop height"]);
        let of_masses = "pull_force_n,normal_force_n\n0.32,1\n320,1\n";
        refused(Test::Slider, of_masses, &["line 3", "'320'", "newtons"]);
        let text = "pull_force_n,normal_force_n\n0.1,1\n0.1,x\n";
        refused(Test::Slider, text, &["line 3", "'x'", "normal_force_n"]);
    }
}
