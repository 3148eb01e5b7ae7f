//! The energy ledger of a running drum.

use crate::CheckError;
use crate::row::{Basis, Kind, Row, Tolerance};
use crate::worlds::{GRAVITY, clipped, cluster, plane, settings, soft_surface, world};
use dem_solver::{DashpotMass, EnergyLedger, EnergyTerms, Placement, Shape, Template, Wall};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use probability::random_stream::Stream;

/// Time of the drum, s.
const END: f64 = 0.5;

/// Terms at the start of the drum and at the end, with a time step (s).
fn drum(time_step: f64) -> Result<[EnergyTerms; 2], CheckError> {
    let (radius, half_width, spin) = (0.02, 5e-3, 6.0);
    let wall = |shape| Wall {
        shape,
        spin,
        ..plane(Vector3::zeros(), Vector3::z())
    };
    let cover = |sign: f64| Shape::Plane {
        point: Vector3::z() * (sign * half_width),
        normal: Vector3::z() * -sign,
    };
    let walls = vec![
        wall(Shape::Cylinder { radius }),
        wall(cover(1.0)),
        wall(cover(-1.0)),
    ];
    let row = [-1.2e-3, 0.0, 1.2e-3].map(|x: f64| ([x, x * x * 200.0, 0.0], 1e-3));
    let template = Template::new(&cluster(&row)?, 0, DashpotMass::Body);
    let mut stream = Stream::new(2, "ledger");
    let mut starts = Vec::new();
    for k in 0..36_u32 {
        let cell = Vector3::new(f64::from(k % 6), f64::from(k / 6), 0.0);
        let [w, x, y, z] = stream.rotation();
        starts.push(Placement::at_rest(
            0,
            (cell - Vector3::new(2.5, 2.5, 0.0)) * 4.6e-3,
            UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z)),
        ));
    }
    let mut world = world(
        settings(time_step, Vector3::y() * -GRAVITY, 2e-3),
        &clipped(soft_surface([0.3, 0.4, 0.02])?),
        vec![template],
        walls,
        &starts,
    )?;
    let mut ledger = EnergyLedger::default();
    ledger.step(&mut world)?;
    let first = ledger.terms();
    while world.time() < END {
        ledger.step(&mut world)?;
    }
    Ok([first, ledger.terms()])
}

/// How far the ledger is from closing, and the signs of its terms.
pub(crate) fn running_drum() -> Result<Vec<Row>, CheckError> {
    let basis = Basis {
        check: "energy-ledger",
        kind: Kind::Analytical,
        tolerance: Tolerance::Absolute(0.01),
        reason: "error of the time stepping, stated as 1 % of all energy turned over",
        source: "conservation of energy",
    };
    let sign = Basis {
        tolerance: Tolerance::Above,
        reason: "friction and dashpots only take",
        source: "second law",
        ..basis
    };
    let mut rows = Vec::new();
    for time_step in [2e-5, 1e-5] {
        let [first, last] = drum(time_step)?;
        let turned_over = last.driven + first.potential - last.potential;
        let open = (last.balance() - first.balance()) / turned_over;
        let name = format!("open share of the energy turned over, {END} s at {time_step} s");
        rows.push(basis.row(name, "1", 0.0, open));
        if time_step == 1e-5 {
            let takers = [
                ("dashpots", last.damped),
                ("sliding", last.rubbed),
                ("rolling", last.rolled),
            ];
            for (name, taken) in takers {
                rows.push(sign.row(format!("taken by {name}"), "J", 0.0, taken));
            }
            rows.push(sign.row("work of the walls", "J", 0.0, last.driven));
        }
    }
    Ok(rows)
}
