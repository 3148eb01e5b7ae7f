//! The whole loop on simulators in closed form, where every answer is known by hand.

mod whole_loop {
    mod coarse_graining;
    mod coverage;
    mod curves;
    mod drawn_studies;
    mod estimates;
    mod inputs;
    mod kept;
    mod open_frictions;
    mod reach;
    mod toy;
    mod troubles;
}
