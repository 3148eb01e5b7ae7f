//! Central composite designs.

use crate::design::append_centres;
use crate::full_factorial::two_level_rows;
use crate::{Design, DesignKind, Error, Factor, check_factors, fractional_factorial};

/// Where the axial points of a central composite design lie.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
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
    let mut rows = match k {
        2..=4 => two_level_rows(k),
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
    };
    let rotatable = (rows.len() as f64).powf(0.25);
    let (cube, alpha) = match axial {
        AxialDistance::Face => (1.0, 1.0),
        AxialDistance::Rotatable => (1.0, rotatable),
        AxialDistance::RotatableInscribed => (1.0 / rotatable, 1.0),
        AxialDistance::Spherical => (1.0, (k as f64).sqrt()),
    };
    rows.iter_mut().flatten().for_each(|x| *x *= cube);
    for j in 0..k {
        for end in [-alpha, alpha] {
            let mut row = vec![0.0; k];
            row[j] = end;
            rows.push(row);
        }
    }
    append_centres(&mut rows, k, n_centre)?;
    Design::new(DesignKind::CentralComposite, factors, Vec::new(), rows)
}

#[cfg(test)]
mod tests {
    use super::{AxialDistance, central_composite};
    use crate::Factor;

    fn factors(k: usize) -> Vec<Factor> {
        (0..k)
            .map(|i| Factor::coded_only(&format!("x{i}")).unwrap())
            .collect()
    }

    /// Rotatability of second order needs `sum x_i^4 = 3 sum x_i^2 x_j^2` `[Box1957]`;
    /// tolerance: rounding of alpha^4, 1e-12 relative.
    #[test]
    fn rotatable_designs_have_the_moments_of_rotatability() {
        for k in 2..=8 {
            for axial in [AxialDistance::Rotatable, AxialDistance::RotatableInscribed] {
                let design = central_composite(&factors(k), axial, 2).unwrap();
                let rows = design.coded_rows();
                let fourth: f64 = rows.iter().map(|r| r[0].powi(4)).sum();
                let mixed: f64 = rows.iter().map(|r| (r[0] * r[1]).powi(2)).sum();
                assert!((fourth / (3.0 * mixed) - 1.0).abs() < 1e-12, "{k} factors");
            }
            let inscribed = central_composite(&factors(k), AxialDistance::RotatableInscribed, 1);
            assert_eq!(inscribed.unwrap().reach(), 1.0);
        }
    }

    #[test]
    fn face_centred_design_of_three_factors_has_fifteen_cells_on_three_levels() {
        let design = central_composite(&factors(3), AxialDistance::Face, 1).unwrap();
        assert_eq!(design.runs().len(), 15);
        assert_eq!(design.reach(), 1.0);
        assert!(central_composite(&factors(9), AxialDistance::Face, 1).is_err());
        assert!(central_composite(&factors(1), AxialDistance::Face, 1).is_err());
    }
}
