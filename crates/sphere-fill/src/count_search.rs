//! The fewest spheres that keep a target.

use crate::filling::fill_body;
use crate::{Body, Error, FillSettings, Filling, Method, Target};

/// Most spheres, when no limit is given.
const MOST: usize = 400;

impl Method {
    /// Whether the method gives a better fit for each larger count.
    pub(crate) fn follows_count(self) -> bool {
        !matches!(self, Self::Pack | Self::Lattice)
    }
}

/// Doubles the count until the target is kept, then halves the interval.
///
/// The errors fall with the count, but not strictly: a smaller count that happens to keep the
/// target may be missed.
pub(crate) fn fewest_spheres(
    body: &Body<'_>,
    settings: &FillSettings,
    target: &Target,
) -> Result<Filling, Error> {
    let with = |count: usize| {
        let settings = FillSettings {
            count: Some(count),
            target: Some(*target),
            ..*settings
        };
        fill_body(body, &settings)
    };
    let most = settings.max_spheres.unwrap_or(MOST);
    let mut too_few = 0;
    let mut count = 4.min(most);
    let mut best = loop {
        let filling = with(count)?;
        if target.is_met(&filling.report) {
            break filling;
        }
        if count == most {
            return Err(target.not_reached(body, &filling));
        }
        too_few = count;
        count = (2 * count).min(most);
    };
    while best.spheres.len() - too_few > 1 {
        let middle = usize::midpoint(too_few, best.spheres.len());
        let filling = with(middle)?;
        if target.is_met(&filling.report) {
            best = filling;
        } else {
            too_few = middle;
        }
    }
    Ok(best)
}
