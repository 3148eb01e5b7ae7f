//! What models leave of measurements, by condition, against the noise.

use report::{Axis, Mark, Plot, PlotPoint, Shape, colour};

/// A condition under which something was measured.
#[derive(Debug)]
pub(crate) struct ResidualCondition {
    pub(crate) name: String,
    /// Whether the fit used it; otherwise it was kept for the check.
    pub(crate) is_used: bool,
    /// Half width of the noise band, in the unit of the residuals.
    pub(crate) noise: f64,
}

/// Residuals by condition, those of the models side by side: a colour for each model, filled if the fit used the condition.
/// A model has one residual a condition; `None` if it was not measured.
pub(crate) fn residual_chart(
    y: Axis,
    noise_name: &str,
    conditions: &[ResidualCondition],
    models: &[(String, Vec<Option<f64>>)],
) -> Plot {
    let names = conditions.iter().map(|c| c.name.clone()).collect();
    let band = conditions.iter().enumerate().map(|(c, condition)| {
        let [left, right] = [c as f64 - 0.5, c as f64 + 0.5];
        let (low, high) = (-condition.noise, condition.noise);
        vec![[left, low], [right, low], [right, high], [left, high]]
    });
    let ends = vec![[-0.5, 0.0], [conditions.len() as f64 - 0.5, 0.0]];
    let mut plot = Plot::new(Axis::Names(names), y)
        .with(Mark::area(noise_name, colour::BAND, 0.8, band.collect()))
        .with(Mark::line("", colour::AXIS, ends));
    let step = 0.7 / models.len().max(1) as f64;
    for (m, (name, residuals)) in models.iter().enumerate() {
        let shift = step * (m as f64 - 0.5 * (models.len() as f64 - 1.0));
        let shown = colour::series(m);
        let all = residuals.iter().zip(conditions).enumerate();
        let points = all.filter_map(|(c, (residual, condition))| {
            Some((
                PlotPoint::new(c as f64 + shift, (*residual)?),
                condition.is_used,
            ))
        });
        let (used, kept): (Vec<_>, Vec<_>) = points.partition(|(_, is_used)| *is_used);
        let [used, kept] =
            [used, kept].map(|all| all.into_iter().map(|(point, _)| point).collect::<Vec<_>>());
        let stems = used
            .iter()
            .chain(&kept)
            .map(|p| vec![[p.x, 0.0], [p.x, p.y]]);
        plot = plot
            .with(Mark::lines(shown, 1.5, stems.collect()))
            .with(Mark::points(name.as_str(), Shape::Circle, shown, used))
            .with(Mark::open_points("", Shape::Square, shown, kept));
    }
    // Explains the open marks of all models.
    let name = "kept for the check";
    let is_kept = conditions.iter().any(|c| !c.is_used);
    plot.with_all(is_kept.then(|| Mark::open_points(name, Shape::Square, colour::INK, Vec::new())))
}
