//! What flows in a drum: depth of the layer, speed of the surface, fill, period of avalanches.

use crate::{Frame, SeedBody};
use nalgebra::Vector3;
use std::sync::Arc;
use surface_profile::{DensitySettings, Disc, DrumCircle, bulk_level, density_of_discs};

/// Half of the stretch along the surface in which the layer is looked at, over the radius.
const STRETCH: f64 = 0.25;

/// The flowing layer in one frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlowingLayer {
    /// Depth at which the seeds stand still against the ground, m.
    pub depth: f64,
    /// Downhill speed of the topmost seeds, m/s.
    pub surface_speed: f64,
}

/// Looks at the middle of the free surface.
///
/// `direction` is the direction of the centre of mass from straight down (rad): the surface is taken
/// as perpendicular to it. Seeds within a quarter of the radius of the middle are sorted by depth in
/// layers of one seed radius; the depth of the layer is where the mean velocity downhill falls to
/// 0, by straight lines between the layers. `None` if fewer than three layers flow.
pub fn flowing_layer(
    frame: &Frame,
    bodies: &[Arc<SeedBody>],
    direction: f64,
    radius: f64,
) -> Option<FlowingLayer> {
    // Into the bed, and downhill: the bed lies on the side to which the centre of mass points.
    let inwards = Vector3::new(direction.sin(), -direction.cos(), 0.0);
    let uphill = Vector3::new(direction.cos(), direction.sin(), 0.0) * direction.signum();
    let mut seeds: Vec<(f64, f64)> = frame
        .position
        .iter()
        .zip(&frame.velocity)
        .filter(|(p, _)| p.dot(&uphill).abs() < STRETCH * radius)
        .map(|(p, v)| (p.dot(&inwards), -v.dot(&uphill)))
        .collect();
    seeds.sort_by(|a, b| a.0.total_cmp(&b.0));
    let thickness = bodies
        .iter()
        .map(|b| b.clump.bounding_radius())
        .fold(0.0, f64::max);
    let top = seeds.first()?.0;
    let mut layers: Vec<(f64, f64)> = Vec::new();
    for layer in seeds
        .chunk_by(|a, b| ((a.0 - top) / thickness).floor() == ((b.0 - top) / thickness).floor())
    {
        let n = layer.len() as f64;
        let depth = layer.iter().map(|s| s.0 - top).sum::<f64>() / n;
        layers.push((depth, layer.iter().map(|s| s.1).sum::<f64>() / n));
    }
    if layers.len() < 3 || layers[0].1 <= 0.0 {
        return None;
    }
    let crossing = layers.windows(2).find(|w| w[1].1 <= 0.0)?;
    let [(above, fast), (below, slow)] = [crossing[0], crossing[1]];
    Some(FlowingLayer {
        depth: above + (below - above) * fast / (fast - slow),
        surface_speed: layers[0].1,
    })
}

/// Share of the drum's cross-section that the bed takes in a frame: the cells within it whose density is more than half of
/// the bulk density. `None` if the drum has no bed.
pub fn fill_level(frame: &Frame, bodies: &[Arc<SeedBody>], radius: f64) -> Option<f64> {
    let drum = DrumCircle {
        x: 0.0,
        y: 0.0,
        radius,
    };
    let discs: Vec<Disc> = frame
        .spheres(bodies)
        .map(|(_, s)| Disc {
            x: s.centre.x,
            y: s.centre.y,
            radius: s.radius,
        })
        .collect();
    let field = density_of_discs(&discs, &drum, &DensitySettings::for_drum(&drum)).ok()?;
    let half_of_bulk = bulk_level(&field, &drum);
    (half_of_bulk > 0.0).then(|| field.share_above(half_of_bulk, &drum, 1.0))
}

/// Period of a series: the first highest lag of its autocorrelation behind the first one below 0.
///
/// `None` if the series is too short (four periods must fit) or does not repeat (correlation below
/// 0.2). `interval` is the time between values, s.
pub fn avalanche_period(series: &[f64], interval: f64) -> Option<f64> {
    let n = series.len();
    let mean = series.iter().sum::<f64>() / n as f64;
    let product = |lag: usize| {
        let pairs = series.iter().zip(&series[lag..]);
        pairs.map(|(a, b)| (a - mean) * (b - mean)).sum::<f64>() / (n - lag) as f64
    };
    let longest = n / 4;
    let variance = if n > 0 { product(0) } else { 0.0 };
    if longest < 3 || variance <= 0.0 {
        return None;
    }
    let correlation: Vec<f64> = (0..=longest).map(|lag| product(lag) / variance).collect();
    let negative = correlation.iter().position(|c| *c < 0.0)?;
    let best = (negative..longest).max_by(|&a, &b| correlation[a].total_cmp(&correlation[b]))?;
    let is_peak =
        correlation[best] > correlation[best - 1] && correlation[best] >= correlation[best + 1];
    (is_peak && correlation[best] > 0.2).then_some(best as f64 * interval)
}

#[cfg(test)]
mod tests {
    use super::avalanche_period;
    use probability::random_stream::Stream;

    /// A swing of 0.8 s under noise of its own size, sampled at 0.02 s for 8 s: within a sample or two.
    #[test]
    fn period_of_a_noisy_swing_is_found() {
        let mut stream = Stream::new(1, "swing");
        let series: Vec<f64> = (0..400)
            .map(|k| {
                let phase = std::f64::consts::TAU * f64::from(k) * 0.02 / 0.8;
                phase.sin() + 0.5 * stream.normal()
            })
            .collect();
        let period = avalanche_period(&series, 0.02).expect("it repeats");
        let off = (period / 0.8).round() * 0.8 - period;
        assert!(off.abs() < 0.05, "{period} s");
    }

    #[test]
    fn noise_has_no_period() {
        let mut stream = Stream::new(1, "noise");
        let series: Vec<f64> = (0..400).map(|_| stream.normal()).collect();
        assert_eq!(avalanche_period(&series, 0.02), None);
        assert_eq!(avalanche_period(&[], 0.02), None);
    }
}
