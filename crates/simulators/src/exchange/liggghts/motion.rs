//! How the walls of a bench move in LIGGGHTS, and are taken away.

use super::TOOL;
use super::law::Law;
use crate::exchange::Error;
use crate::exchange::bench_deck::{AXES, BenchDeck, Dialect, prescribed};
use crate::exchange::vtk::add;
use dem_solver::{AxialLoad, Motion};
use std::f64::consts::TAU;

/// Refuses walls whose motions LIGGGHTS does not have.
pub(super) fn refuse_motions(deck: &BenchDeck<'_>) -> Result<(), Error> {
    for (k, wall) in deck.procedure.walls.iter().enumerate() {
        let moves =
            |m: &Motion| m.velocity.norm() > 0.0 || m.spin.norm() > 0.0 || m.vibration.is_some();
        let turns =
            |m: &Motion| m.spin.norm() > 0.0 && (m.velocity.norm() > 0.0 || m.vibration.is_some());
        let is_loaded = deck.first_load(k).is_some();
        let what = if is_loaded && deck.motions_of(k).any(moves) {
            "moves in one phase and carries a load in another"
        } else if deck.motions_of(k).any(turns) {
            "turns about a point that moves"
        } else {
            continue;
        };
        return Err(Error::NotThere {
            what: format!("wall '{}', which {what}", wall.name),
            tool: TOOL,
            way_out: "give these motions to two walls, or simulate the bench here",
        });
    }
    Ok(())
}

/// The contacts of a set of walls.
pub(super) fn touched(deck: &BenchDeck<'_>, law: &Law, walls: &[usize]) -> String {
    let names: Vec<&str> = walls.iter().map(|wall| deck.ids[*wall].as_str()).collect();
    format!(
        "fix walls all wall/gran {} mesh n_meshes {} meshes {}{}\n",
        law.model,
        names.len(),
        names.join(" "),
        law.settings
    )
}

/// Commands that give a wall a load from now on. One without a load comes to the bed with the speed that a wall here has, and then follows
/// its load.
fn pressed(deck: &BenchDeck<'_>, id: &str, load: &AxialLoad, comes: bool) -> String {
    let constants = |gain: f64| {
        format!(
            "fix_modify {id} servo/ctrlParam {:e} 0.0 0.0\n",
            proportional(gain, load)
        )
    };
    let mut text = format!(
        "fix_modify {id} servo/target_val {:e}\n\
         fix_modify {id} servo/vel_max {:e}\n\
         fix_modify {id} servo/integrate start\n",
        load.force, load.greatest_speed,
    );
    if comes {
        let parts = (0..3).filter(|k| load.axis[*k] != 0.0);
        let push: Vec<_> = parts
            .map(|k| format!("({:e})*v_f{}_{id}", load.axis[k], AXES[k]))
            .collect();
        text.push_str(&constants(load.damping_time / load.mass));
        let turns = deck.approaches();
        add(
            &mut text,
            format_args!(
                "variable comes equal ({}<0)\n\
                 variable turn loop {turns}\n\
                 label comes_{id}\n\
                 run {}\n\
                 if \"${{comes}} > 0\" then \"jump SELF there_{id}\"\n\
                 next turn\n\
                 jump SELF comes_{id}\n\
                 label there_{id}\n\
                 variable turn delete\n",
                push.join("+"),
                deck.every(),
            ),
        );
    }
    text + &constants(deck.servo_gain(load))
}

/// The constant `k_p` of a gain, m/(s N).
///
/// # Formula
///
/// LIGGGHTS takes `v = v_max k_p (F - f) / F`, so that `k_p = F / v_max` times the gain.
fn proportional(gain: f64, load: &AxialLoad) -> f64 {
    gain * load.force.abs() / load.greatest_speed
}

/// Commands of LIGGGHTS.
pub(super) struct Liggghts<'a> {
    pub(super) law: &'a Law,
}

/// Kinds of prescribed motion, as the ends of the names of their fixes.
const MOVES: [&str; 3] = ["linear", "rotate", "wiggle"];

impl Dialect for Liggghts<'_> {
    fn remove(&self, deck: &BenchDeck<'_>, gone: &[usize], left: &[usize]) -> String {
        let mut text = "unfix walls\n".to_owned();
        for wall in gone {
            add(&mut text, format_args!("unfix {}\n", deck.ids[*wall]));
        }
        if left.is_empty() {
            return text;
        }
        text + &touched(deck, self.law, left)
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
        if let Some(load) = &motion.load {
            return pressed(deck, id, load, before.0.is_none());
        }
        if before.0.is_some() {
            add(
                &mut text,
                format_args!("fix_modify {id} servo/integrate stop\n"),
            );
        }
        if deck.first_load(wall).is_some() {
            return text;
        }
        for (words, name) in before
            .1
            .map_or_else(Default::default, moves)
            .iter()
            .zip(MOVES)
        {
            if !words.is_empty() {
                add(&mut text, format_args!("unfix {name}_{id}\n"));
            }
        }
        let about = deck.procedure.walls[wall].about;
        for (words, name) in moves(motion).iter().zip(MOVES) {
            if !words.is_empty() {
                let words = words.replace(
                    "ABOUT",
                    &format!("{:e} {:e} {:e}", about.x, about.y, about.z),
                );
                add(
                    &mut text,
                    format_args!("fix {name}_{id} all move/mesh mesh {id} {words}\n"),
                );
            }
        }
        for (k, axis) in AXES.iter().enumerate() {
            let moved = prescribed(deck, motion, k);
            add(
                &mut text,
                format_args!(
                    "variable from equal ${{d{axis}_{id}}}\nvariable d{axis}_{id} equal {moved}\n"
                ),
            );
        }
        text
    }

    fn insertion(&self) -> &'static str {
        "rain"
    }

    fn columns(&self) -> &'static str {
        "id type x y z radius vx vy vz"
    }
}

/// The words of velocity, spin and vibration of a motion; empty ones of what it does not have. `ABOUT` is the point about which it turns.
fn moves(motion: &Motion) -> [String; 3] {
    let (v, w) = (motion.velocity, motion.spin);
    let mut words: [String; 3] = Default::default();
    if v.norm() > 0.0 {
        words[0] = format!("linear {:e} {:e} {:e}", v.x, v.y, v.z);
    }
    if w.norm() > 0.0 {
        let axis = w.normalize();
        words[1] = format!(
            "rotate origin ABOUT axis {} {} {} period {:e}",
            axis.x,
            axis.y,
            axis.z,
            TAU / w.norm()
        );
    }
    if let Some(swing) = motion.vibration {
        let a = swing.amplitude;
        words[2] = format!(
            "wiggle amplitude {:e} {:e} {:e} period {:e}",
            a.x,
            a.y,
            a.z,
            TAU / swing.angular_frequency
        );
    }
    words
}
