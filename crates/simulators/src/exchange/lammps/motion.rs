//! How the walls of a bench move in LAMMPS, and are taken away.

use super::regions::Regions;
use crate::exchange::bench_deck::{AXES, BenchDeck, Dialect, prescribed, since_begin};
use crate::exchange::vtk::add;
use dem_solver::{AxialLoad, Motion};

/// Commands of LAMMPS.
pub(super) struct Lammps<'a> {
    pub(super) regions: &'a Regions,
    pub(super) columns: &'static str,
}

impl Dialect for Lammps<'_> {
    fn remove(&self, deck: &BenchDeck<'_>, gone: &[usize], _: &[usize]) -> String {
        let mut text = String::new();
        for wall in gone {
            let id = &deck.ids[*wall];
            for part in 1..=self.regions[*wall].len() {
                add(
                    &mut text,
                    format_args!(
                        "uncompute push_{id}_{part}\nunfix wall_{id}_{part}\nregion at_{id}_{part} delete\n"
                    ),
                );
            }
        }
        text
    }

    fn drive(
        &self,
        deck: &BenchDeck<'_>,
        wall: usize,
        motion: &Motion,
        before: (Option<&AxialLoad>, Option<&Motion>),
    ) -> String {
        let id = &deck.ids[wall];
        let mut text = String::new();
        if before.0.is_some() {
            add(
                &mut text,
                format_args!("unfix servo_{id}\nunfix gain_{id}\n"),
            );
        }
        for (k, axis) in AXES.iter().enumerate() {
            let load = motion.load.filter(|load| load.axis[k] != 0.0);
            let pressed = load.map_or_else(String::new, |load| {
                format!("+({:e})*v_way_{id}", load.axis[k])
            });
            let moved = prescribed(deck, motion, k);
            add(
                &mut text,
                format_args!(
                    "variable from equal ${{d{axis}_{id}}}\nvariable d{axis}_{id} equal {moved}{pressed}\n"
                ),
            );
        }
        let axis = deck
            .motions_of(wall)
            .map(|m| m.spin)
            .find(|w| w.norm() > 0.0);
        let rate = axis.map_or(0.0, |axis| motion.spin.dot(&axis.normalize()));
        add(
            &mut text,
            format_args!(
                "variable from equal ${{turn_{id}}}\nvariable turn_{id} equal ${{from}}+({rate:e})*{}\n",
                since_begin(deck)
            ),
        );
        if let Some(load) = &motion.load {
            text.push_str(&servo(deck, wall, load));
        }
        text
    }

    fn insertion(&self) -> &'static str {
        "pour"
    }

    fn columns(&self) -> &'static str {
        self.columns
    }
}

/// The controllers of a wall under a load, which move it as [`AxialLoad`] states: one sums its acceleration to a speed along the axis, the
/// other the speed to a way.
fn servo(deck: &BenchDeck<'_>, wall: usize, load: &AxialLoad) -> String {
    let id = &deck.ids[wall];
    let parts = (0..3).filter(|k| load.axis[*k] != 0.0);
    let force: Vec<_> = parts
        .map(|k| format!("({:e})*v_f{}_{id}", load.axis[k], AXES[k]))
        .collect();
    let most = load.greatest_speed;
    format!(
        "variable way_{id} internal 0.0\n\
         variable rate_{id} internal 0.0\n\
         variable speed_{id} equal v_rate_{id}\n\
         variable free_{id} equal ({:e}+{})/{:e}-v_rate_{id}/{:e}\n\
         variable most_{id} equal (v_rate_{id}>={most:e})*(v_free_{id}>0)+(v_rate_{id}<=-{most:e})*(v_free_{id}<0)\n\
         variable gain_{id} equal (v_most_{id}==0)*v_free_{id}\n\
         fix gain_{id} all controller 1 -1.0 1.0 0.0 0.0 v_gain_{id} 0.0 rate_{id}\n\
         fix servo_{id} all controller 1 -1.0 1.0 0.0 0.0 v_speed_{id} 0.0 way_{id}\n",
        load.force,
        force.join("+"),
        load.mass,
        load.damping_time,
    )
}
