//! Central composite designs.

use crate::design::append_centres;
use crate::full_factorial::two_level_rows;
use crate::{Design, DesignKind, Error, Factor, check_factors, fractional_factorial};

/// Position of the axial points of a central composite design.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AxialDistance {
    /// On the faces of the box, coded 1: three levels, nothing outside the ranges.
    Face,
    /// At (number of cube runs)^(1/4): equal prediction variance at equal distance from the
    /// centre. Beyond the ranges of the factors.
    Rotatable,
    /// As rotatable, shrunk so that the axial points lie on the bounds of the factors.
    RotatableInscribed,
    /// At the square root of the number of factors: all points on one sphere, beyond the ranges.
    Spherical,
    /// At a stated distance, coded.
    At(f64),
}

/// Central composite design for 2 to 8 factors: the cube (from five factors on the fraction of
/// resolution V or more), 2 k axial runs, and `n_centre` centre runs, in this order.
///
/// # Formula
/// rotatable: alpha = F^(1/4), F the number of cube runs `[Box1957]`.
///
/// # Source
/// `[Box1951]`; `[Box1957]`.
///
/// # Errors
/// [`Error::FactorCount`] outside 2 to 8 factors; [`Error::CountOutOfRange`] beyond 10 000 centre
/// runs; those of [`check_factors`].
pub fn central_composite(
    factors: &[Factor],
    axial: AxialDistance,
    n_centre: usize,
) -> Result<Design, Error> {
    check_factors(factors)?;
    let k = factors.len();
    let mut rows = cube(factors)?;
    let rotatable = (rows.len() as f64).powf(0.25);
    let (cube, alpha) = match axial {
        AxialDistance::Face => (1.0, 1.0),
        AxialDistance::Rotatable => (1.0, rotatable),
        AxialDistance::RotatableInscribed => (1.0 / rotatable, 1.0),
        AxialDistance::Spherical => (1.0, (k as f64).sqrt()),
        AxialDistance::At(alpha) if alpha > 0.0 && alpha <= 100.0 => (1.0, alpha),
        AxialDistance::At(value) => return Err(Error::BadAxialDistance { value }),
    };
    rows.iter_mut().flatten().for_each(|x| *x *= cube);
    rows.extend(axial_rows(k, alpha));
    append_centres(&mut rows, k, n_centre)?;
    Design::new(DesignKind::CentralComposite, factors, Vec::new(), rows)
}

/// Central composite design in two orthogonal blocks: the cube with `n_centre_cube` centre runs, and
/// the axial runs with `n_centre_axial`. The axial distance is the one that makes the blocks
/// orthogonal to the quadratic.
///
/// # Formula
/// `alpha^2 = F (2 k + c_a) / (2 (F + c_f))`, F the cube runs, `c_f` and `c_a` the centre runs of the
/// two blocks `[Box1957]`.
///
/// # Errors
/// As [`central_composite`].
pub fn central_composite_in_blocks(
    factors: &[Factor],
    n_centre_cube: usize,
    n_centre_axial: usize,
) -> Result<Design, Error> {
    check_factors(factors)?;
    let k = factors.len();
    let mut rows = cube(factors)?;
    let f = rows.len() as f64;
    let axial = (2 * k + n_centre_axial) as f64;
    let alpha = (f * axial / (2.0 * (f + n_centre_cube as f64))).sqrt();
    append_centres(&mut rows, k, n_centre_cube)?;
    let first = rows.len();
    rows.extend(axial_rows(k, alpha));
    append_centres(&mut rows, k, n_centre_axial)?;
    let blocks: Vec<usize> = (0..rows.len())
        .map(|i| 1 + usize::from(i >= first))
        .collect();
    Design::new(DesignKind::CentralComposite, factors, Vec::new(), rows)?.blocked(&blocks)
}

/// The two axial runs of every factor.
fn axial_rows(k: usize, alpha: f64) -> impl Iterator<Item = Vec<f64>> {
    (0..k).flat_map(move |j| {
        [-alpha, alpha].map(|end| {
            let mut row = vec![0.0; k];
            row[j] = end;
            row
        })
    })
}

/// The runs of the cube: all corners, or the fraction of resolution V or more.
fn cube(factors: &[Factor]) -> Result<Vec<Vec<f64>>, Error> {
    Ok(match factors.len() {
        k @ 2..=4 => two_level_rows(k),
        5..=7 => fractional_factorial(factors, 1, 0)?.design.coded_rows(),
        8 => fractional_factorial(factors, 2, 0)?.design.coded_rows(),
        given => {
            return Err(Error::FactorCount {
                design: "central composite",
                given,
                least: 2,
                most: 8,
                way_out: "screen first (Plackett-Burman) and keep the factors that matter, or \
                          take a Latin hypercube",
            });
        }
    })
}

#[cfg(test)]
mod tests {
    use super::{AxialDistance, central_composite, central_composite_in_blocks};
    use crate::factor::coded_factors;

    /// Rotatability of second order needs `sum x_i^4 = 3 sum x_i^2 x_j^2` `[Box1957]`;
    /// tolerance: rounding of alpha^4, 1e-12 relative.
    #[test]
    fn rotatable_designs_have_the_moments_of_rotatability() {
        for k in 2..=8 {
            for axial in [AxialDistance::Rotatable, AxialDistance::RotatableInscribed] {
                let design = central_composite(&coded_factors(k), axial, 2).unwrap();
                let rows = design.coded_rows();
                let fourth: f64 = rows.iter().map(|r| r[0].powi(4)).sum();
                let mixed: f64 = rows.iter().map(|r| (r[0] * r[1]).powi(2)).sum();
                assert!((fourth / (3.0 * mixed) - 1.0).abs() < 1e-12, "{k} factors");
            }
            let inscribed =
                central_composite(&coded_factors(k), AxialDistance::RotatableInscribed, 1);
            assert_eq!(inscribed.unwrap().reach(), 1.0);
        }
    }

    /// Orthogonal blocks `[Box1957]`: the sum of squares of a factor is the same share of the runs
    /// of both blocks (rounding of alpha^2: 1e-12).
    #[test]
    fn blocks_are_orthogonal_to_the_quadratic() {
        for k in 2..=8 {
            let design = central_composite_in_blocks(&coded_factors(k), 4, 2).unwrap();
            let share = |block: usize| {
                let runs: Vec<_> = design.runs().iter().filter(|r| r.block == block).collect();
                let squares: f64 = runs.iter().map(|r| r.coded[0].powi(2)).sum();
                squares / runs.len() as f64
            };
            assert!((share(1) / share(2) - 1.0).abs() < 1e-12, "{k} factors");
        }
        assert!(central_composite(&coded_factors(3), AxialDistance::At(-1.0), 1).is_err());
    }

    #[test]
    fn face_centred_design_of_three_factors_has_fifteen_cells_on_three_levels() {
        let design = central_composite(&coded_factors(3), AxialDistance::Face, 1).unwrap();
        assert_eq!(design.runs().len(), 15);
        assert_eq!(design.reach(), 1.0);
        assert!(central_composite(&coded_factors(9), AxialDistance::Face, 1).is_err());
        assert!(central_composite(&coded_factors(1), AxialDistance::Face, 1).is_err());
    }
}
