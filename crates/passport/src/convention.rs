//! The conventions in which codes differ, as rival effects: each changes the reading of the parameters.

use crate::model::Model;
use crate::variant::{History, SlidingLimit, Variant};
use scene::RollingLaw;

/// The factor that represents nothing at all.
pub(crate) const NOTHING: f64 = 0.01;

/// Which value of the parameter file a factor acts on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Value {
    Rolling,
    Restitution,
    Friction,
    Modulus,
    Cohesion,
    /// A value that the user of a code does not state.
    Derived,
}

/// What a convention changes.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Change {
    /// A factor of a quantity, at these contacts (grains, wall).
    Factor {
        apply: fn(&mut Variant, f64),
        value: Value,
        at: [bool; 2],
    },
    /// One of two ways.
    Switch {
        apply: fn(&mut Variant),
        /// What to do if the other code has it the other way.
        remedy: &'static str,
    },
}

/// A convention.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Convention {
    /// Name, as the diagnosis gives it.
    pub(crate) name: &'static str,
    /// What differs, as the start of a sentence.
    pub(crate) subject: &'static str,
    pub(crate) change: Change,
}

impl Convention {
    /// The reading of a variant with the convention read in another way; the factor counts for a [`Change::Factor`].
    pub(crate) fn apply(&self, variant: &mut Variant, factor: f64) {
        match self.change {
            Change::Factor { apply, .. } => apply(variant, factor),
            Change::Switch { apply, .. } => apply(variant),
        }
    }

    pub(crate) fn is_factor(&self) -> bool {
        matches!(self.change, Change::Factor { .. })
    }
}

const fn factor(
    name: &'static str,
    subject: &'static str,
    value: Value,
    at: [bool; 2],
    apply: fn(&mut Variant, f64),
) -> Convention {
    let change = Change::Factor { apply, value, at };
    Convention {
        name,
        subject,
        change,
    }
}

const fn switch(
    name: &'static str,
    subject: &'static str,
    remedy: &'static str,
    apply: fn(&mut Variant),
) -> Convention {
    let change = Change::Switch { apply, remedy };
    Convention {
        name,
        subject,
        change,
    }
}

const GRAINS: [bool; 2] = [true, false];
const WALL: [bool; 2] = [false, true];
const BOTH: [bool; 2] = [true, true];

/// All conventions that the cases can show.
pub(crate) const CONVENTIONS: [Convention; 28] = [
    factor(
        "rolling",
        "the rolling torque",
        Value::Rolling,
        BOTH,
        |v, f| {
            v.rolling = [f; 2];
        },
    ),
    factor(
        "rolling-grains",
        "the rolling torque between grains",
        Value::Rolling,
        GRAINS,
        |v, f| {
            v.rolling[0] = f;
        },
    ),
    factor(
        "rolling-wall",
        "the rolling torque at the wall",
        Value::Rolling,
        WALL,
        |v, f| {
            v.rolling[1] = f;
        },
    ),
    factor(
        "damping",
        "the dashpot",
        Value::Restitution,
        BOTH,
        |v, f| {
            v.damping = [f; 2];
        },
    ),
    factor(
        "damping-grains",
        "the dashpot between grains",
        Value::Restitution,
        GRAINS,
        |v, f| {
            v.damping[0] = f;
        },
    ),
    factor(
        "damping-wall",
        "the dashpot at the wall",
        Value::Restitution,
        WALL,
        |v, f| {
            v.damping[1] = f;
        },
    ),
    factor(
        "friction",
        "the static friction",
        Value::Friction,
        BOTH,
        |v, f| {
            v.scale_friction(0, f);
            v.scale_friction(1, f);
        },
    ),
    factor(
        "friction-grains",
        "the static friction between grains",
        Value::Friction,
        GRAINS,
        |v, f| {
            v.scale_friction(0, f);
        },
    ),
    factor(
        "friction-wall",
        "the static friction at the wall",
        Value::Friction,
        WALL,
        |v, f| {
            v.scale_friction(1, f);
        },
    ),
    factor(
        "stiffness",
        "the stiffness of all contacts",
        Value::Modulus,
        BOTH,
        |v, f| {
            v.stiffness = [f; 2];
        },
    ),
    factor(
        "stiffness-grains",
        "the stiffness between grains",
        Value::Modulus,
        GRAINS,
        |v, f| {
            v.stiffness[0] = f;
        },
    ),
    factor(
        "stiffness-wall",
        "the stiffness at the wall",
        Value::Modulus,
        WALL,
        |v, f| {
            v.stiffness[1] = f;
        },
    ),
    factor(
        "tangential-stiffness",
        "the tangential stiffness",
        Value::Derived,
        BOTH,
        |v, f| {
            v.tangential_stiffness = f;
        },
    ),
    factor(
        "tangential-damping",
        "the tangential dashpot",
        Value::Derived,
        BOTH,
        |v, f| {
            v.tangential_damping = f;
        },
    ),
    factor(
        "cohesion",
        "the attraction",
        Value::Cohesion,
        BOTH,
        Variant::scale_attraction,
    ),
    switch(
        "normal-force-end",
        "the end of the normal force is the other one (clipped where the model lets it pull, or the reverse)",
        "set it in the code (LAMMPS limit_damping, LIGGGHTS limitForce); if it has no such setting, calibrate with its end",
        Variant::flip_end,
    ),
    switch(
        "dashpot-mass",
        "the dashpot of a clump takes the other mass (that of the body instead of the sphere, or the reverse)",
        "scale the damping ratio by the root of sphere over body mass and turn it back into a restitution",
        Variant::flip_mass,
    ),
    switch(
        "rolling-lever",
        "the rolling resistance of a clump takes the other lever arm (to the sphere's centre instead of the body's, or the reverse)",
        "multiply the rolling coefficient by the mean ratio of the two arms over the surface",
        Variant::flip_lever,
    ),
    switch(
        "rolling-law",
        "the law of rolling resistance is of the other type (A, constant torque, or C, spring and dashpot)",
        "choose the law of the model; if the code lacks it, calibrate with the law of the code",
        Variant::flip_law,
    ),
    switch(
        "rolling-by-spring",
        "rolling resistance takes the elastic part of the normal force alone, without the dashpot",
        "nothing to put in: it belongs to the code (LIGGGHTS); accept it",
        |v| v.rolling_by_spring = true,
    ),
    switch(
        "rolling-without-twist",
        "rolling resistance acts against rolling alone, and a spin about the normal is free",
        "nothing to put in: it belongs to the code (LAMMPS, YADE); accept it",
        |v| v.rolling_without_twist = true,
    ),
    switch(
        "history-as-force",
        "the tangential history is kept as a force: unloading does not reduce it",
        "choose the history as a displacement (LAMMPS mindlin); if the code lacks it (YADE), accept it",
        |v| v.history = History::Force,
    ),
    switch(
        "history-rescaled",
        "the tangential history is rescaled on unloading",
        "choose the history without rescaling (LAMMPS mindlin instead of mindlin_rescale)",
        |v| v.history = History::Rescaled,
    ),
    switch(
        "no-history",
        "the tangential force has no spring",
        "choose a law with tangential history",
        |v| v.history = History::Off,
    ),
    switch(
        "limit-of-spring",
        "the limit of sliding holds for the spring alone, and the dashpot is added below it",
        "nothing to put in: it belongs to the code (LIGGGHTS, MercuryDPM, YADE); accept it",
        |v| v.limit = SlidingLimit::Spring,
    ),
    switch(
        "limit-of-sum",
        "the limit of sliding holds for the sum, and the spring continues to stretch",
        "nothing to put in: choose a law that shortens the spring at the limit",
        |v| v.limit = SlidingLimit::Sum,
    ),
    switch(
        "limit-moves-spring",
        "the limit of sliding holds for the sum, and the spring takes up what it cuts from the dashpot, so that fast sliding is braked less",
        "nothing to put in: it belongs to the code (LAMMPS); accept it",
        |v| v.limit = SlidingLimit::SumMovesSpring,
    ),
    switch(
        "limit-by-size",
        "the limit of sliding takes the size of the normal force, also while this pulls",
        "nothing to put in: it belongs to the code (LAMMPS, LIGGGHTS, MercuryDPM); accept it",
        |v| v.limit_by_size = true,
    ),
];

/// Whether a convention can matter to a model at all.
pub(crate) fn concerns(convention: &Convention, model: &Model) -> bool {
    let rolls = model.contacts.iter().any(|c| c.rolling_friction > 0.0);
    match convention.name {
        "dashpot-mass" => model.clumps,
        "rolling-lever" => model.clumps && rolls,
        "cohesion" => model.coheres(),
        "rolling-without-twist" => model.rolling_law == RollingLaw::ConstantTorque && rolls,
        "rolling-law" | "rolling-by-spring" | "rolling" | "rolling-grains" | "rolling-wall" => {
            rolls
        }
        _ => true,
    }
}

/// The law of rolling resistance in words.
pub(crate) fn rolling_law_in_words(law: RollingLaw) -> &'static str {
    match law {
        RollingLaw::ConstantTorque => "type A, a torque of constant size against the relative spin",
        RollingLaw::SpringDashpot => "type C, an elastic-plastic spring with a dashpot",
    }
}
