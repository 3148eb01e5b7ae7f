//! The fewest spheres that keep a target or a roughness.

use crate::filling::fill_body;
use crate::{Body, Error, FillSettings, Filling, Method};

/// Most spheres, when no limit is given.
const MOST: usize = 400;

impl Method {
    /// Whether the method gives a better fit for each larger count.
    pub(crate) fn follows_count(self) -> bool {
        !matches!(self, Self::Pack | Self::Lattice)
    }
}

/// Refuses a filling that misses the target, or the roughness where a count is sought for it.
pub(crate) fn require_met(body: &Body<'_>, filling: &Filling) -> Result<(), Error> {
    let (settings, report) = (&filling.settings, &filling.report);
    if let Some(target) = settings.target.filter(|target| !target.is_met(report)) {
        return Err(target.not_reached(body, filling));
    }
    match settings.roughness {
        Some(asked) if settings.method == Method::Surface && report.roughness_rms > asked => {
            Err(Error::RoughnessNotReached {
                mesh: body.mesh.source().to_owned(),
                asked_mm: asked * 1e3,
                reached_mm: report.roughness_rms * 1e3,
                spheres: filling.spheres.len(),
            })
        }
        _ => Ok(()),
    }
}

/// Doubles the count until target and roughness are kept, then halves the interval.
///
/// The errors fall with the count, but not strictly: a smaller count that happens to keep the
/// target may be missed.
pub(crate) fn fewest_spheres(body: &Body<'_>, settings: &FillSettings) -> Result<Filling, Error> {
    let with = |count: usize| {
        let settings = FillSettings {
            count: Some(count),
            ..*settings
        };
        fill_body(body, &settings)
    };
    let mut most = settings.max_spheres.unwrap_or(MOST);
    let mut too_few = 0;
    let mut count = 4.min(most);
    let mut best = loop {
        let filling = match with(count) {
            // Nobody asked for this count: what the body holds is the most.
            Err(Error::CountNotReached { reached, .. }) if reached > 0 => {
                (most, count) = (reached, reached);
                continue;
            }
            filling => filling?,
        };
        let met = require_met(body, &filling);
        if met.is_ok() {
            break filling;
        }
        if count == most {
            met?;
        }
        too_few = count;
        count = (2 * count).min(most);
    };
    while best.spheres.len() - too_few > 1 {
        let middle = usize::midpoint(too_few, best.spheres.len());
        match with(middle) {
            Ok(filling) if require_met(body, &filling).is_ok() => best = filling,
            Ok(_) | Err(Error::CountNotReached { .. }) => too_few = middle,
            Err(error) => return Err(error),
        }
    }
    Ok(best)
}
