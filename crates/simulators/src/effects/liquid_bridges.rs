//! Liquid bridges: moist seeds hold each other, also over a small gap.

use crate::effects::{Effect, Entry, Error, refused};
use input::quantity::Angle;
use scene::{FillingLibrary, LiquidSettings, Scene};

/// Surface tension of water at 20 °C, N/m.
const WATER_N_M: f64 = 0.0727;

/// Water in bridges between seeds, and between seeds and walls.
pub(crate) const EFFECT: Effect = Effect {
    name: "liquid-bridges",
    physics: "Water on the seeds gathers where they touch. The bridge pulls with its surface \
              tension and lives on until the gap is too long for its volume; a flat wall holds \
              twice as hard as another seed. Little water stays in the valleys of the \
              roughness: half of the force of a smooth surface is reached at 0.1 %. The \
              bridges of a seed share its water, a sixth of it at most each. The viscosity of \
              the water resists parting, closing and sliding over a bridge. That water \
              lessens dry friction, resists rolling, passes from seed to seed and runs \
              together between many seeds is left out.",
    formula: "F = 2 pi R g w/(w + 0.1 %) / (1 + 1.05 s + 2.5 s^2), s = D sqrt(R/V), gap D up to \
              V^(1/3); V = w V_seed/max(n, 6) of each seed with n bridges, g = 72.7 mN/m; 6 pi h \
              R*^2 X^2/D and 6 pi h R* (8/15 ln(R*/D) + 0.96) times the speed, h = 1 mPa s, D at \
              least 10 um; the amplitude is the volume of water w over that of the seeds",
    unit: "%",
    source: "Willett2000",
    range: [0.0, 15.0],
    probe: 0.05,
    entry: Entry::Contact,
    apply,
};

fn apply(scene: &mut Scene, amplitude: f64, _: &FillingLibrary) -> Result<(), Error> {
    let content = 0.01 * amplitude;
    let liquid = if let Some(liquid) = scene.model.liquid {
        LiquidSettings {
            content: liquid.content + content,
            ..liquid
        }
    } else {
        let angle = Angle::from_si(0.0).map_err(|e| refused(EFFECT.name, &e))?;
        LiquidSettings::new(content, WATER_N_M, angle)
    };
    scene.model.liquid = Some(liquid);
    Ok(())
}

#[cfg(test)]
mod tests {
    use crate::effects::{apply, tests::small_drum};
    use scene::FillingLibrary;

    /// 1 % and 0.5 % of water are 0.015 of the volume of the seeds. Rounding only.
    #[test]
    fn water_adds_up() {
        let (mut scene, fillings) = (small_drum(), FillingLibrary::default());
        apply(&mut scene, "liquid-bridges", 1.0, &fillings).unwrap();
        apply(&mut scene, "liquid-bridges", 0.5, &fillings).unwrap();
        let liquid = scene.model.liquid.unwrap();
        assert!((liquid.content - 0.015).abs() < 1e-15, "{}", liquid.content);
        assert!((liquid.surface_tension_n_m - 0.0727).abs() < 1e-15, "water");
    }
}
