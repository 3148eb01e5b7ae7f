//! From the raw form of a problem to one that has passed all checks.

use nalgebra::{DMatrix, DVector};
use std::collections::BTreeSet;

mod entries;
mod experiments;

use entries::{
    check_finite, check_length, check_names, check_positive, covariance, matrix, root_of_precision,
    symmetric,
};

use crate::diagnosis::Error;
use crate::diagnosis::covariance::Covariance;
use crate::diagnosis::problem::{
    Candidate, Part, Prior, Problem, Row, SlopeNoise, condition_label,
};
use crate::diagnosis::problem_file::{
    Condition, CovarianceInput, Largest, Level, PriorPrecision, ProblemFile,
};

struct RawPart<'a> {
    /// Prefix of the keys, for errors.
    prefix: &'static str,
    conditions: &'a [Condition],
    residual: &'a [Option<f64>],
    /// Its sensitivities to the declared parameters.
    declared: &'a [Vec<f64>],
    library: &'a [Vec<f64>],
    measurement: Option<&'a CovarianceInput>,
    simulator: Option<&'a CovarianceInput>,
}

impl TryFrom<ProblemFile> for Problem {
    type Error = Error;

    /// Checks a raw problem.
    ///
    /// # Errors
    ///
    /// [`Error`] when a list has the wrong length, a number is not finite, a covariance is
    /// missing, not symmetric or not positive definite, or a name is not known or not unique.
    fn try_from(file: ProblemFile) -> Result<Self, Error> {
        let declared = declared_names(&file);
        check_names(&file.observables, "observables")?;
        check_names(&declared, "declared")?;
        check_names(&file.library, "library")?;
        let mut used = part(&file, &used_lists(&file), declared.len())?;
        let noise = |inputs: &[CovarianceInput], key: &str, columns: usize| {
            sensitivity_noise(inputs, key, columns, &file)
        };
        used.declared_noise = slope_noise(&file, declared.len())?;
        used.library_noise = noise(
            &file.cov_sensitivities_library,
            "cov_sensitivities_library",
            file.library.len(),
        )?;
        let used = without_missing(&file.residual_obs_minus_sim, &used);
        let unused = unused_part(&file, declared.len())?;
        used.covariance.whitener()?;
        if let Some(part) = &unused {
            part.covariance.whitener()?;
        }
        if let Some(dof) = file.covariance_dof {
            check_positive(dof, "covariance_dof")?;
        }
        Ok(Self {
            candidates: candidates(&file)?,
            limits: limits(&file, declared.len())?,
            at_fit: file.at_fitted_parameters,
            prior: prior(&file, declared.len())?,
            experiments: file
                .candidate_experiments
                .iter()
                .map(|e| experiments::experiment(e, declared.len(), &file.library))
                .collect::<Result<_, _>>()?,
            warnings: warnings(&file),
            id: file.id,
            observables: file.observables,
            declared,
            used,
            unused,
            covariance_dof: file.covariance_dof,
        })
    }
}

fn used_lists(file: &ProblemFile) -> RawPart<'_> {
    RawPart {
        prefix: "",
        conditions: &file.conditions,
        residual: &file.residual_obs_minus_sim,
        declared: &file.sensitivities_declared,
        library: &file.sensitivities_library,
        measurement: file.cov_measurement.as_ref(),
        simulator: file.cov_simulator.as_ref(),
    }
}

/// Names of the declared parameters, P1, P2 ... where the file has none.
fn declared_names(file: &ProblemFile) -> Vec<String> {
    if !file.declared.is_empty() {
        return file.declared.clone();
    }
    let columns = file.sensitivities_declared.first().map_or(0, Vec::len);
    (1..=columns).map(|i| format!("P{i}")).collect()
}

/// The part kept for the check, if there is one.
fn unused_part(file: &ProblemFile, n_declared: usize) -> Result<Option<Part>, Error> {
    if file.unused_conditions.is_empty() && file.unused_residual_obs_minus_sim.is_empty() {
        return Ok(None);
    }
    let shared = |own: &'_ Option<CovarianceInput>, used: &'_ Option<CovarianceInput>| {
        own.clone().or_else(|| match used {
            Some(CovarianceInput::Matrix(m)) if m.len() == file.observables.len() => used.clone(),
            _ => None,
        })
    };
    let measurement = shared(&file.unused_cov_measurement, &file.cov_measurement);
    let simulator = shared(&file.unused_cov_simulator, &file.cov_simulator);
    let raw = RawPart {
        prefix: "unused_",
        conditions: &file.unused_conditions,
        residual: &file.unused_residual_obs_minus_sim,
        declared: &file.unused_sensitivities_declared,
        library: &file.unused_sensitivities_library,
        measurement: measurement.as_ref(),
        simulator: simulator.as_ref(),
    };
    let part = part(file, &raw, n_declared)?;
    Ok(Some(without_missing(raw.residual, &part)))
}

/// Makes a part with all its rows; a residual that is missing is 0 in it.
fn part(file: &ProblemFile, raw: &RawPart<'_>, n_declared: usize) -> Result<Part, Error> {
    let (n_conditions, n_observables) = (raw.conditions.len(), file.observables.len());
    let n_rows = n_conditions * n_observables;
    let key = |name: &str| format!("{}{name}", raw.prefix);
    let rows_reason = format!("{n_conditions} conditions x {n_observables} observables");
    check_length(
        &key("residual_obs_minus_sim"),
        raw.residual.len(),
        n_rows,
        &rows_reason,
    )?;
    if n_rows == 0 {
        return Err(Error::Missing {
            what: key("conditions"),
            way_out: "give at least one condition and one observable".into(),
        });
    }
    for condition in raw.conditions {
        for (name, level) in condition {
            if let Level::Number(x) = level {
                check_finite(*x, || format!("{} {name}", key("conditions")))?;
            }
        }
    }
    for (i, residual) in raw.residual.iter().enumerate() {
        let place = || format!("{}[{i}]", key("residual_obs_minus_sim"));
        check_finite(residual.unwrap_or(0.0), place)?;
    }
    let labels: Vec<String> = raw.conditions.iter().map(condition_label).collect();
    let covariance_of = |input: Option<&CovarianceInput>, name: &str| match input {
        Some(input) => covariance(input, &key(name), n_observables, &labels),
        None => Err(missing_covariance(&key(name))),
    };
    let measurement = covariance_of(raw.measurement, "cov_measurement")?;
    let simulator = covariance_of(raw.simulator, "cov_simulator")?;
    let matrix_of = |rows: &[Vec<f64>], name: &str, columns: usize| {
        matrix(rows, &key(name), (n_rows, columns), &rows_reason)
    };
    Ok(Part {
        conditions: raw.conditions.to_vec(),
        rows: (0..n_rows)
            .map(|i| Row {
                condition: i / n_observables,
                observable: i % n_observables,
            })
            .collect(),
        residual: DVector::from_iterator(n_rows, raw.residual.iter().map(|r| r.unwrap_or(0.0))),
        covariance: measurement.plus_scaled(1.0, &simulator),
        declared: matrix_of(raw.declared, "sensitivities_declared", n_declared)?,
        library: matrix_of(raw.library, "sensitivities_library", file.library.len())?,
        declared_noise: Vec::new(),
        library_noise: Vec::new(),
    })
}

/// The part without the rows whose residual is missing.
fn without_missing(residual: &[Option<f64>], part: &Part) -> Part {
    let present: BTreeSet<(usize, usize)> = part
        .rows
        .iter()
        .zip(residual)
        .filter(|(_, r)| r.is_some())
        .map(|(row, _)| (row.condition, row.observable))
        .collect();
    part.keep(|row| present.contains(&(row.condition, row.observable)))
}

/// Why a covariance must be given.
fn missing_covariance(what: &str) -> Error {
    Error::Missing {
        what: what.to_owned(),
        way_out: "noise left out makes every residual look structured; give one block for all \
                  conditions, one block per condition, or the whole matrix (zeros only if \
                  there is truly no noise)"
            .into(),
    }
}

/// Covariances of the columns of a sensitivity matrix.
fn sensitivity_noise(
    inputs: &[CovarianceInput],
    key: &str,
    columns: usize,
    file: &ProblemFile,
) -> Result<Vec<Covariance>, Error> {
    if inputs.is_empty() {
        return Ok(Vec::new());
    }
    check_length(key, inputs.len(), columns, "one covariance per column")?;
    let labels: Vec<String> = file.conditions.iter().map(condition_label).collect();
    inputs
        .iter()
        .enumerate()
        .map(|(k, input)| {
            covariance(
                input,
                &format!("{key}[{k}]"),
                file.observables.len(),
                &labels,
            )
        })
        .collect()
}

/// Errors of the sensitivities to the declared parameters.
fn slope_noise(file: &ProblemFile, n: usize) -> Result<Vec<SlopeNoise>, Error> {
    let (key, along_key) = (
        "cov_sensitivities_declared",
        "cov_sensitivities_declared_along",
    );
    let along = &file.cov_sensitivities_declared_along;
    let entries = if along.is_empty() { n } else { along.len() };
    let covariances = sensitivity_noise(&file.cov_sensitivities_declared, key, entries, file)?;
    if along.is_empty() {
        let each = covariances.into_iter().enumerate();
        return Ok(each
            .map(|(k, covariance)| SlopeNoise::of_one(k, n, covariance))
            .collect());
    }
    check_length(
        key,
        covariances.len(),
        entries,
        "one covariance per entry of cov_sensitivities_declared_along",
    )?;
    let along = matrix(along, along_key, (entries, n), "one number per parameter")?;
    let each = covariances.into_iter().zip(along.row_iter());
    Ok(each
        .map(|(covariance, along)| SlopeNoise {
            along: along.transpose(),
            covariance,
        })
        .collect())
}

fn limits(file: &ProblemFile, n: usize) -> Result<Vec<[f64; 2]>, Error> {
    if file.shift_limits.is_empty() {
        return Ok(vec![[f64::NEG_INFINITY, f64::INFINITY]; n]);
    }
    check_length(
        "shift_limits",
        file.shift_limits.len(),
        n,
        "one pair per parameter",
    )?;
    let check = |(k, [least, greatest]): (usize, &[Option<f64>; 2])| {
        let limits = [
            least.unwrap_or(f64::NEG_INFINITY),
            greatest.unwrap_or(f64::INFINITY),
        ];
        if limits[0] <= 0.0 && limits[1] >= 0.0 {
            return Ok(limits);
        }
        Err(Error::OutOfRange {
            what: format!("shift_limits[{k}]"),
            value: if limits[0] > 0.0 {
                limits[0]
            } else {
                limits[1]
            },
            range: "[least, greatest] with 0 between them",
        })
    };
    file.shift_limits.iter().enumerate().map(check).collect()
}

/// Prior knowledge as rows of least squares.
fn prior(file: &ProblemFile, n: usize) -> Result<Option<Prior>, Error> {
    let precision = match &file.prior_precision {
        None if file.prior_offset.is_empty() => return Ok(None),
        None => {
            return Err(Error::Missing {
                what: "prior_precision".into(),
                way_out: "prior_offset means nothing without it; give 1/sd^2 of each parameter"
                    .into(),
            });
        }
        Some(PriorPrecision::Diagonal(values)) => {
            check_length("prior_precision", values.len(), n, "one per parameter")?;
            for (k, &x) in values.iter().enumerate() {
                check_finite(x, || format!("prior_precision[{k}]"))?;
            }
            DMatrix::from_diagonal(&DVector::from_column_slice(values))
        }
        Some(PriorPrecision::Matrix(rows)) => symmetric(rows, "prior_precision", n)?,
    };
    let offset = if file.prior_offset.is_empty() {
        DVector::zeros(n)
    } else {
        check_length(
            "prior_offset",
            file.prior_offset.len(),
            n,
            "one per parameter",
        )?;
        for (k, &x) in file.prior_offset.iter().enumerate() {
            check_finite(x, || format!("prior_offset[{k}]"))?;
        }
        DVector::from_column_slice(&file.prior_offset)
    };
    let root = root_of_precision(precision)?;
    Ok(Some(Prior {
        offset: &root * offset,
        root,
    }))
}

/// The library with its limits.
fn candidates(file: &ProblemFile) -> Result<Vec<Candidate>, Error> {
    let known = |name: &String, place| {
        if file.library.contains(name) {
            Ok(())
        } else {
            Err(Error::BadName {
                name: name.clone(),
                place,
                problem: "is not an effect of the library",
            })
        }
    };
    for (name, &amplitude) in &file.largest_amplitudes {
        known(name, "largest_amplitudes")?;
        let place = format!("largest_amplitudes.{name}");
        match amplitude {
            Largest::Size(size) => check_positive(size, &place)?,
            Largest::Ends([least, greatest]) => {
                check_positive(greatest - least, &format!("the width of {place}"))?;
                if let Some(value) = [least, -greatest].into_iter().find(|end| *end > 0.0) {
                    return Err(Error::OutOfRange {
                        what: place,
                        value: value.abs(),
                        range: "[least, greatest] with 0 between them",
                    });
                }
            }
        }
    }
    for name in file.signs.keys() {
        known(name, "signs")?;
    }
    for name in &file.not_run {
        known(name, "not_run")?;
    }
    Ok(file
        .library
        .iter()
        .map(|name| Candidate {
            name: name.clone(),
            ends: file.largest_amplitudes.get(name).map(|l| l.ends()),
            sign: file.signs.get(name).copied().unwrap_or_default(),
            was_run: !file.not_run.contains(name),
        })
        .collect())
}

/// What is odd but harmless.
fn warnings(file: &ProblemFile) -> Vec<String> {
    file.other
        .keys()
        .map(|key| format!("the key '{key}' means nothing here and was not used"))
        .collect()
}
