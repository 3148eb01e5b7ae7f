//! Why a world cannot be built or cannot continue.

/// Why a world cannot be built or cannot continue.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A setting is not a positive finite number.
    #[error("{name} is {value}; it must be a positive finite number")]
    NotPositive {
        /// Name of the setting, with its unit.
        name: &'static str,
        /// The value given.
        value: f64,
    },
    /// A number is not finite.
    #[error("{what} is not a finite number")]
    NotFinite {
        /// What holds the number, by name or index.
        what: String,
    },
    /// Periodic sides that are too near each other.
    #[error(
        "periodic sides {length} m apart; for these bodies they must be at least {least} m apart"
    )]
    PeriodicSides {
        /// Distance of the sides, m.
        length: f64,
        /// Least distance, m.
        least: f64,
    },
    /// The steps of a world cannot be spread over threads.
    #[error("{threads} threads cannot be used: {reason}")]
    Threads {
        /// Number asked for.
        threads: usize,
        /// Why.
        reason: String,
    },
    /// An index without an item.
    #[error("{what} {index} does not exist: there are {count}")]
    NoSuch {
        /// Template or material.
        what: &'static str,
        /// The index.
        index: usize,
        /// How many there are.
        count: usize,
    },
    /// The table of interactions is not a full square.
    #[error("{got} interactions given, {expected} needed: one for each ordered pair of materials")]
    Interactions {
        /// Number given.
        got: usize,
        /// Number needed.
        expected: usize,
    },
    /// Two bodies would feel different forces depending on their order.
    #[error("the interaction of body materials {a} and {b} differs from that of {b} and {a}")]
    OneSidedInteraction {
        /// Index of one material.
        a: usize,
        /// Index of the other.
        b: usize,
    },
    /// No wall has the name.
    #[error("there is no wall '{name}'")]
    NoWall {
        /// The name asked for.
        name: String,
    },
    /// A shape that is not a surface of revolution was given a spin.
    #[error(
        "wall '{wall}' has a spin about z but is not a surface of revolution about z; move it as a wall of triangles"
    )]
    SpinningShape {
        /// Name of the wall.
        wall: String,
    },
    /// The numbers of a shape do not describe it.
    #[error("wall '{wall}': {rule}")]
    Shape {
        /// Name of the wall.
        wall: String,
        /// The rule that it breaks.
        rule: &'static str,
    },
    /// A body starts on the wrong side of a one-sided wall.
    #[error(
        "body {body} starts with its centre {depth} m behind wall '{wall}'; bodies must be inside \
         a cylinder and on the side of a plane to which its normal points"
    )]
    BehindWall {
        /// Index of the body.
        body: usize,
        /// Name of the wall.
        wall: String,
        /// Distance behind the wall, m.
        depth: f64,
    },
    /// A template has more spheres than an index of 16 bits can name.
    #[error("a body type has {count} spheres in the contact search, at most 65535 are possible")]
    TooManySpheres {
        /// Number of spheres.
        count: usize,
    },
    /// A body has run away, or its state is not finite.
    #[error(
        "body {body} has run away or has a state that is not finite after {time} s: lower the time step of \
         {time_step} s, or look for bodies that overlap at the start"
    )]
    Diverged {
        /// Index of the body.
        body: usize,
        /// Time, s.
        time: f64,
        /// Time step, s.
        time_step: f64,
    },
    /// A body is outside the region in which bodies can be.
    #[error(
        "body {body} is lost at {time} s: its centre is at {position} m, outside the region of the \
         apparatus; a wall is missing or was passed: close the walls or lower the time step"
    )]
    Lost {
        /// Index of the body.
        body: usize,
        /// Time, s.
        time: f64,
        /// Where it is, m.
        position: String,
    },
    /// A body is faster than anything in the apparatus can be.
    #[error(
        "body {body} moves with {speed} m/s at {position} m after {time} s, the limit is {limit} \
         m/s: lower the time step of {time_step} s, or look for bodies that overlap at the start"
    )]
    Flying {
        /// Index of the body.
        body: usize,
        /// Speed of its fastest point, m/s.
        speed: f64,
        /// Limit, m/s.
        limit: f64,
        /// Where it is, m.
        position: String,
        /// Time, s.
        time: f64,
        /// Time step, s.
        time_step: f64,
    },
    /// Two spheres overlap by more than the contact law holds for.
    #[error(
        "bodies {i} and {j} overlap by {share} of the smaller sphere's radius at {position} m after \
         {time} s, the limit is {limit}: raise the stiffness, lower the speed, or lower the time \
         step of {time_step} s"
    )]
    TooDeep {
        /// Index of one body.
        i: usize,
        /// Index of the other.
        j: usize,
        /// Overlap over the radius of the smaller sphere.
        share: f64,
        /// Limit of that share.
        limit: f64,
        /// Where body i is, m.
        position: String,
        /// Time, s.
        time: f64,
        /// Time step, s.
        time_step: f64,
    },
    /// A snapshot of another world.
    #[error(
        "this snapshot is of another world: {what} are {found}, not {expected}; start the run again"
    )]
    OtherWorld {
        /// What differs.
        what: &'static str,
        /// What the snapshot says.
        found: String,
        /// What the world has.
        expected: String,
    },
    /// An order of the bodies that leaves some out or names some twice.
    #[error("the order of the bodies does not name each of the {bodies} bodies once")]
    NoOrder {
        /// Number of bodies.
        bodies: usize,
    },
    /// A law that the energy ledger does not cover.
    #[error("the energy ledger does not cover {what}: leave them out of this world")]
    NotInLedger {
        /// The law.
        what: &'static str,
    },
}

impl Error {
    /// Whether the motion is no longer plausible, as with a time step that is too long for the contacts. The same run
    /// may end well with a shorter one.
    pub fn is_divergence(&self) -> bool {
        matches!(
            self,
            Self::Diverged { .. } | Self::Lost { .. } | Self::Flying { .. } | Self::TooDeep { .. }
        )
    }
}
