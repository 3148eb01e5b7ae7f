//! Contact laws as functions, against closed forms.

use crate::CheckError;
use crate::row::{Basis, Kind, Row, Tolerance};
use contact_law::capillary_bridge::CapillaryBridge;
use contact_law::johnson_kendall_roberts::JohnsonKendallRoberts;
use contact_law::rolling_spring_dashpot::{RollingContact, RollingSpringDashpot};
use nalgebra::Vector3;
use std::f64::consts::PI;

/// Adhesion, liquid bridges, rolling resistance of type C.
pub(crate) fn laws() -> Result<Vec<Row>, CheckError> {
    let basis = Basis {
        check: "laws",
        kind: Kind::Analytical,
        tolerance: Tolerance::Relative(1e-5),
        reason: "2000 places over a flat minimum",
        source: "[JohnsonKendallRoberts1971]",
    };
    let (radius, work) = (1e-3, 0.05);
    let law = JohnsonKendallRoberts::new(4e6, work)?;
    let end = law.breaking_overlap(radius);
    let deepest = (0..2000)
        .map(|k| law.force(end * (1.0 - f64::from(k) / 1000.0), radius, true))
        .fold(f64::INFINITY, f64::min);
    let mut rows = vec![basis.row(
        "JKR: pull-off, 3/2 pi W R",
        "N",
        1.5 * PI * work * radius,
        -deepest,
    )];

    let bridge = CapillaryBridge::new(0.072, 0.0)?;
    let water = Basis {
        source: "[Willett2000]",
        reason: "rounding",
        ..basis
    };
    let touching = bridge.between(radius).attraction(0.0, 1e-12);
    rows.push(water.row(
        "water bridge at touch, 2 pi R g",
        "N",
        2.0 * PI * radius * 0.072,
        touching,
    ));

    // A wheel of moment I on a contact that turns: the limit torque stops it in w I / (mu F R).
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
        ..basis
    };
    rows.push(wheel.row("type C: time until a wheel stops", "s", time, stopped));
    let rest = Basis {
        tolerance: Tolerance::Absolute(1e-6),
        reason: "decay over 0.05 s with 1400 per second",
        ..wheel
    };
    rows.push(rest.row(
        "type C: torque left at rest over its limit",
        "1",
        0.0,
        last / limit,
    ));
    Ok(rows)
}
