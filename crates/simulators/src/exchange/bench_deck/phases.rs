//! The phases of a bench as a script: both codes have the same commands for runs, variables, jumps and tables.

use super::BenchDeck;
use crate::exchange::vtk::add;
use dem_solver::{AxialLoad, Motion};
use scene::{End, LOAD_CARRIED, Phase};

/// Commands in which the codes differ.
pub(crate) trait Dialect {
    /// Takes walls away, so that others are left.
    fn remove(&self, deck: &BenchDeck<'_>, gone: &[usize], left: &[usize]) -> String;

    /// Gives a wall a motion from now on, instead of the load and the prescribed motion before; `${begin}` is the step of now.
    fn drive(
        &self,
        deck: &BenchDeck<'_>,
        wall: usize,
        motion: &Motion,
        before: (Option<&AxialLoad>, Option<&Motion>),
    ) -> String;

    /// Name of the fixes that insert seeds, before the number of the kind.
    fn insertion(&self) -> &'static str;

    /// Columns of the dump.
    fn columns(&self) -> &'static str;
}

/// Names of the three axes in variables.
pub(crate) const AXES: [&str; 3] = ["x", "y", "z"];

/// The state of the walls between phases.
struct Walls {
    /// Which are still there.
    left: Vec<usize>,
    /// Loads that they carry now.
    loads: Vec<(usize, AxialLoad)>,
    /// Motions that they were given last, also those of walls that rest again.
    moved: Vec<(usize, Motion)>,
}

/// All phases.
pub(crate) fn script(deck: &BenchDeck<'_>, dialect: &dyn Dialect) -> String {
    let mut walls = Walls {
        left: (0..deck.ids.len()).collect(),
        loads: Vec::new(),
        moved: Vec::new(),
    };
    let mut text = String::new();
    for number in 0..deck.procedure.plan.phases.len() {
        text.push_str(&phase(deck, dialect, number, &mut walls));
    }
    text.push_str("label end\n");
    text
}

/// One phase.
fn phase(deck: &BenchDeck<'_>, dialect: &dyn Dialect, number: usize, walls: &mut Walls) -> String {
    let phase = &deck.procedure.plan.phases[number];
    let mut text = format!(
        "\n# Phase {number}: {}.\n\
         variable now equal step\n\
         variable begin equal ${{now}}\n\
         variable time equal (step-${{begin}})*{:e}\n",
        phase.name, deck.time_step
    );
    text.push_str(&act(deck, dialect, phase, walls));
    let stem = deck.stem(number);
    text.push_str(&rest(deck, walls));
    let (titles, values) = columns(deck, walls);
    add(
        &mut text,
        format_args!(
            "thermo_style custom step time atoms v_kinetic v_rests{}\n\
             thermo_modify lost ignore norm no\n\
             thermo {}\n\
             fix table all print {} \"{values}\" file {stem}.txt title \"{titles}\" screen no\n\
             dump bed all custom {} {stem}.dump {}\n\
             dump_modify bed first yes\n",
            end_values(deck, &phase.end),
            deck.test_every(),
            deck.every(),
            dump_every(deck, number),
            dialect.columns(),
        ),
    );
    text.push_str(&runs(deck, number, phase));
    text.push_str("unfix table\nundump bed\n");
    if number == 0 {
        let kinds = deck.procedure.inlet.map_or(0, |_| deck.bodies.len());
        for k in 1..=kinds {
            add(
                &mut text,
                format_args!("unfix {}{k}\n", dialect.insertion()),
            );
        }
    }
    text
}

/// Steps between dumps: the filling is seen less often.
fn dump_every(deck: &BenchDeck<'_>, number: usize) -> u64 {
    if number == 0 {
        deck.test_every()
    } else {
        deck.dump_every()
    }
}

/// Walls that the phase takes away, moves and loads.
fn act(deck: &BenchDeck<'_>, dialect: &dyn Dialect, phase: &Phase, walls: &mut Walls) -> String {
    let mut text = String::new();
    for (name, motion) in &phase.motions {
        let wall = deck.wall(name);
        let load = walls.loads.iter().find(|(of, _)| *of == wall);
        let moved = walls.moved.iter().find(|(of, _)| *of == wall);
        let before = (load.map(|(_, load)| load), moved.map(|(_, motion)| motion));
        text.push_str(&dialect.drive(deck, wall, motion, before));
        walls.loads.retain(|(of, _)| *of != wall);
        walls.loads.extend(motion.load.map(|load| (wall, load)));
        walls.moved.retain(|(of, _)| *of != wall);
        walls.moved.push((wall, *motion));
    }
    let gone: Vec<usize> = phase.removed.iter().map(|name| deck.wall(name)).collect();
    for (wall, motion) in walls.moved.iter().filter(|(wall, _)| gone.contains(wall)) {
        let load = motion.load.as_ref();
        text.push_str(&dialect.drive(deck, *wall, &Motion::default(), (load, Some(motion))));
    }
    if !gone.is_empty() {
        walls.left.retain(|wall| !gone.contains(wall));
        walls.loads.retain(|(wall, _)| !gone.contains(wall));
        walls.moved.retain(|(wall, _)| !gone.contains(wall));
        text.push_str(&dialect.remove(deck, &gone, &walls.left));
    }
    text
}

/// The variable that is 1 when all seeds rest and all loads are carried.
fn rest(deck: &BenchDeck<'_>, walls: &Walls) -> String {
    let all = deck.scene.seed_count().max(1);
    let energy = deck.procedure.rest_energy / all as f64;
    let mut text = format!("variable rests equal (v_kinetic<={energy:e}*v_seeds)");
    for (wall, load) in &walls.loads {
        let force = along(&deck.ids[*wall], &load.axis);
        let most = LOAD_CARRIED * load.force.abs();
        add(
            &mut text,
            format_args!("*(({force}+{:e})^2<={:e})", load.force, most * most),
        );
    }
    text.push('\n');
    text
}

/// Force on a wall along an axis as a formula.
fn along(id: &str, axis: &nalgebra::Vector3<f64>) -> String {
    let parts = (0..3).filter(|k| axis[*k] != 0.0);
    let parts: Vec<_> = parts
        .map(|k| format!("({:e})*v_f{}_{id}", axis[k], AXES[k]))
        .collect();
    format!("({})", parts.join("+"))
}

/// Titles and variables of the table of walls.
fn columns(deck: &BenchDeck<'_>, walls: &Walls) -> (String, String) {
    let mut titles = vec!["time_s".to_owned()];
    for wall in &walls.left {
        let id = &deck.ids[*wall];
        titles.extend(AXES.map(|axis| format!("f{axis}_{id}")));
        if walls.moved.iter().any(|(of, _)| of == wall) {
            titles.extend(AXES.map(|axis| format!("d{axis}_{id}")));
        }
    }
    let values: Vec<_> = titles
        .iter()
        .enumerate()
        .map(|(k, title)| match k {
            0 => "${time}".to_owned(),
            _ => format!("${{{title}}}"),
        })
        .collect();
    (titles.join(" "), values.join(" "))
}

/// Variables that the end of a phase looks at between runs, for the output of the last step, which computes them.
fn end_values(deck: &BenchDeck<'_>, end: &End) -> String {
    match end {
        End::Pressed { wall, .. } => {
            let id = &deck.ids[deck.wall(wall)];
            format!(" v_fy_{id} v_dy_{id}")
        }
        End::Pushed { wall, .. } => {
            let id = &deck.ids[deck.wall(wall)];
            format!(" v_fx_{id} v_fy_{id} v_fz_{id}")
        }
        End::Discharged(_) => " v_mass".into(),
        End::AtRest { .. } | End::After(_) => String::new(),
    }
}

/// The runs of a phase until it ends.
fn runs(deck: &BenchDeck<'_>, number: usize, phase: &Phase) -> String {
    let limit = deck.scene.protocol.rotation_limit.si();
    if number == 0 {
        let [shortest, longest] = deck.procedure.filling;
        let first = format!("run {}\n", deck.steps(shortest));
        let left = (longest - shortest).max(0.0);
        // A filling that does not rest goes into the next phase, as here.
        return first + &until(deck, (number, ""), "${rests} > 0", (left, false));
    }
    match &phase.end {
        End::After(time) => format!("run {}\n", deck.steps(*time)),
        End::AtRest { after } => {
            let first = format!("run {}\n", deck.steps(after.max(TEST)));
            first + &until(deck, (number, ""), "${rests} > 0", (limit - after, true))
        }
        End::Pushed {
            wall,
            along: axis,
            force,
        } => {
            let pushed = along(&deck.ids[deck.wall(wall)], axis);
            format!("variable reached equal ({pushed}>={force:e})\n")
                + &until(deck, (number, ""), "${reached} > 0", (limit, true))
        }
        End::Pressed { wall, depth } => {
            let id = &deck.ids[deck.wall(wall)];
            until(
                deck,
                (number, "touch"),
                &format!("${{fy_{id}}} > 0"),
                (limit, true),
            ) + &format!(
                "variable touched equal ${{dy_{id}}}\n\
                     variable reached equal (${{touched}}-v_dy_{id}>={depth:e})\n"
            ) + &until(deck, (number, ""), "${reached} > 0", (limit, true))
        }
        End::Discharged(fraction) => {
            format!(
                "variable whole equal ${{mass}}\n\
                 variable reached equal (${{whole}}-v_mass>={fraction:e}*${{whole}})\n"
            ) + &until(deck, (number, ""), "${reached} > 0", (limit, true))
        }
    }
}

/// Least time before the first test for rest, s: that of a sample.
const TEST: f64 = 1e-6;

/// Runs until a condition holds, at most for a time (s); if it must hold by then, the script ends otherwise.
fn until(
    deck: &BenchDeck<'_>,
    (number, part): (usize, &str),
    condition: &str,
    (time, must): (f64, bool),
) -> String {
    let is_rest = condition.contains("rests");
    let every = if is_rest {
        deck.test_every()
    } else {
        deck.dump_every()
    };
    let turns = deck.steps(time.max(0.0)).div_ceil(every).max(1);
    let [again, done] = ["run", "done"].map(|word| format!("{word}{number}{part}"));
    let otherwise = if must {
        format!(
            "print \"Phase {number} has not come to its end within {time} s.\"\njump SELF end\n"
        )
    } else {
        String::new()
    };
    // What a table does not show is known after a run only.
    let first = if is_rest {
        format!("if \"{condition}\" then \"jump SELF {done}\"\n")
    } else {
        String::new()
    };
    format!(
        "{first}variable turn loop {turns}\n\
         label {again}\n\
         run {every}\n\
         if \"{condition}\" then \"jump SELF {done}\"\n\
         next turn\n\
         jump SELF {again}\n\
         {otherwise}\
         label {done}\n\
         variable turn delete\n"
    )
}

/// Time since the start of a phase, whatever phase the script has come to, as a formula.
pub(crate) fn since_begin(deck: &BenchDeck<'_>) -> String {
    format!("((step-${{begin}})*{:e})", deck.time_step)
}

/// Displacement of a wall with a prescribed motion along an axis as a formula: from where it was, with its velocity and its vibration.
pub(crate) fn prescribed(deck: &BenchDeck<'_>, motion: &Motion, axis: usize) -> String {
    let time = since_begin(deck);
    let swing = motion.vibration.map_or_else(String::new, |v| {
        format!(
            "+({:e})*sin({:e}*{time})",
            v.amplitude[axis], v.angular_frequency
        )
    });
    format!("${{from}}+({:e})*{time}{swing}", motion.velocity[axis])
}
