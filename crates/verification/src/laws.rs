//! Contact laws as functions, against closed forms.

use crate::CheckError;
use crate::row::{Basis, Kind, Row, Tolerance};
use contact_law::capillary_bridge::CapillaryBridge;
use contact_law::rolling_spring_dashpot::{RollingContact, RollingSpringDashpot};
use nalgebra::Vector3;
use std::f64::consts::PI;

/// Liquid bridges, rolling resistance of type C.
pub(crate) fn laws() -> Result<Vec<Row>, CheckError> {
    let basis = Basis {
        check: "laws",
        kind: Kind::Analytical,
        tolerance: Tolerance::Relative(1e-12),
        reason: "rounding",
        source: "[Willett2000]",
    };
    let radius = 1e-3;
    let bridge = CapillaryBridge::new(0.072, 0.0)?;
    let touching = bridge.between(radius).attraction(0.0, 1e-12);
    let mut rows = vec![basis.row(
        "water bridge at touch, 2 pi R g",
        "N",
        2.0 * PI * radius * 0.072,
        touching,
    )];
    rows.extend(wheel(&basis, radius)?);
    Ok(rows)
}

/// A wheel of moment I on a contact that turns: the limit torque stops it in w I / (mu F R).
fn wheel(basis: &Basis, radius: f64) -> Result<[Row; 2], CheckError> {
    let law = RollingSpringDashpot::new(0.1, 0.3, 2.25)?;
    let inertia = 1e-9;
    let contact = |spin: f64| RollingContact {
        normal_force: 2.0,
        reduced_radius: radius,
        tangential_stiffness: 1e4,
        reduced_inertia: inertia,
        normal: Vector3::y(),
        relative_spin: Vector3::z() * spin,
    };
    let limit = 0.1 * 2.0 * radius;
    let time = 1e4 * inertia / limit;
    let step = time / 200_000.0;
    let (mut spin, mut spring, mut stopped, mut last) = (1e4, Vector3::zeros(), 0.0, 0.0);
    for k in 0..400_000_u32 {
        let got = law.torque(&contact(spin), spring, step);
        (spring, last) = (got.spring, got.torque.z);
        spin += got.torque.z / inertia * step;
        if spin > 0.0 && stopped == 0.0 {
            continue;
        }
        if stopped == 0.0 {
            stopped = f64::from(k) * step;
        }
    }
    let wheel = Basis {
        tolerance: Tolerance::Relative(0.005),
        reason: "while the spring loads, the dashpot takes 0.3 % of the spin",
        source: "w I / (mu_r F R*); [Ai2011, type C]",
        ..*basis
    };
    let rest = Basis {
        tolerance: Tolerance::Absolute(1e-6),
        reason: "decay over 0.05 s with 1400 per second",
        ..wheel
    };
    let (stops, rests) = (
        "type C: time until a wheel stops",
        "type C: torque left at rest over its limit",
    );
    Ok([
        wheel.row(stops, "s", time, stopped),
        rest.row(rests, "1", 0.0, last / limit),
    ])
}
