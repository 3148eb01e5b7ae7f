//! The liquid of a world: how much its bridges hold, and the deal behind each step.

use super::World;
use crate::interaction::Interaction;
use crate::liquid::bridge_volume;

impl World {
    /// Volumes of the bridges of liquid, m³: those between bodies, then those at walls.
    pub fn bridge_volumes(&self) -> Vec<f64> {
        let laws = |i: usize, other: usize| self.context().interaction(self.material(i), other);
        let shares = self.liquid.shares();
        let pairs = self.kept_pairs().map(|pair| {
            let (i, j) = (pair.body, pair.other);
            bridge_volume(laws(i, self.material(j)), shares, [i, j])
        });
        let walls = self.walls_of_contacts();
        let walls = walls.map(|(i, material)| bridge_volume(laws(i, material), shares, [i]));
        pairs.chain(walls).filter(|volume| *volume > 0.0).collect()
    }

    /// Liquid on each body that no bridge holds, m³.
    pub fn films(&self) -> Vec<f64> {
        let types = self.bodies.template.iter().enumerate();
        types
            .map(|(k, &of)| self.templates[of].liquid - self.liquid.in_bridges(k))
            .collect()
    }

    /// Shares the liquid of the bodies among the bridges that there are now.
    pub(super) fn deal_liquid(&mut self) {
        if !self.interactions.iter().any(Interaction::is_wet) {
            return;
        }
        let mut liquid = std::mem::take(&mut self.liquid);
        let context = self.context();
        let is_wet = |i: usize, other: usize| context.interaction(self.material(i), other).is_wet();
        let pairs = self.kept_pairs();
        let pairs = pairs.filter(|pair| is_wet(pair.body, self.material(pair.other)));
        let walls = self
            .walls_of_contacts()
            .filter(|&(i, material)| is_wet(i, material));
        let bodies = pairs.flat_map(|pair| [pair.body, pair.other]);
        let of_types = self
            .bodies
            .template
            .iter()
            .map(|&of| self.templates[of].liquid);
        liquid.deal(of_types, bodies.chain(walls.map(|(i, _)| i)));
        self.liquid = liquid;
    }

    /// Body and material of the wall of each contact at a wall of any kind.
    fn walls_of_contacts(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let analytic = self.kept_walls();
        let analytic = analytic.map(|c| (c.body, self.walls[c.other].material));
        analytic.chain(self.mesh_walls.bodies_at_materials())
    }

    fn material(&self, body: usize) -> usize {
        self.templates[self.bodies.template[body]].material
    }
}
