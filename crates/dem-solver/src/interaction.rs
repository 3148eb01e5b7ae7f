//! What decides a contact between two kinds of surface: their laws, prepared.

#![expect(
    clippy::inline_always,
    reason = "the hot loops are vectorised only when inlined"
)]

use contact_law::{
    BridgeForce, HertzMindlin, LinearCohesion, Material, NormalForceEnd, PairParameters,
    RateDependentFriction, RollingLever, RollingSpringDashpot, ViscoelasticDamping,
    constant_attraction, material,
};
use nalgebra::Vector3;

/// Everything that decides the contact between two kinds of surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interaction {
    /// Elastic, damping and sliding part.
    pub(crate) law: HertzMindlin,
    /// Coefficient of rolling friction of type A.
    pub(crate) rolling_friction: f64,
    /// Rolling resistance of type C.
    pub(crate) rolling_spring: Option<RollingSpringDashpot>,
    /// Arm of rolling resistance.
    pub(crate) rolling_lever: RollingLever,
    /// Attraction while touching, N.
    attraction: f64,
    /// Attraction by the area of contact.
    linear_cohesion: Option<LinearCohesion>,
    /// Bridge of liquid that forms when the surfaces touch.
    bridge: Option<BridgeForce>,
}

/// Laws beside the usual ones; all off by default.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct OptionalLaws {
    /// Damping that depends on the overlap.
    pub viscoelastic: Option<ViscoelasticDamping>,
    /// Friction that depends on the speed of sliding.
    pub rate_dependent: Option<RateDependentFriction>,
    /// Rolling resistance of type C, instead of type A; it brings its own coefficient.
    pub rolling_spring: Option<RollingSpringDashpot>,
    /// Arm of rolling resistance, of either type.
    pub rolling_lever: RollingLever,
    /// Attraction by the area of contact.
    pub linear_cohesion: Option<LinearCohesion>,
    /// Bridge of liquid.
    pub bridge: Option<BridgeForce>,
    /// Share of the pull of a dashpot that is kept where the end is clipped, 0 to 1.
    pub pull: f64,
}

/// Settings of the contact of two surfaces, as a user states them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InteractionSettings {
    /// Materials of the two sides.
    pub materials: [Material; 2],
    /// Restitution and friction.
    pub parameters: PairParameters,
    /// Attraction of one touching pair of spheres, N.
    pub attraction: f64,
    /// Treatment of a dashpot that would pull.
    pub end: NormalForceEnd,
}

impl Interaction {
    /// Prepares an interaction.
    ///
    /// # Errors
    ///
    /// Contact parameters outside their range, a negative attraction.
    pub fn new(settings: &InteractionSettings) -> Result<Self, contact_law::Error> {
        let moduli = material::effective_moduli(&settings.materials[0], &settings.materials[1]);
        Ok(Self {
            law: HertzMindlin::new(moduli, &settings.parameters, settings.end)?,
            rolling_friction: settings.parameters.rolling_friction,
            rolling_spring: None,
            rolling_lever: RollingLever::default(),
            attraction: constant_attraction::check(settings.attraction)?,
            linear_cohesion: None,
            bridge: None,
        })
    }

    /// The interaction with further laws.
    #[must_use]
    pub fn with(self, further: &OptionalLaws) -> Self {
        let law = self.law.with_viscoelastic_damping(further.viscoelastic);
        let law = law.with_pull(further.pull);
        Self {
            law: law.with_rate_dependent_friction(further.rate_dependent),
            rolling_friction: if further.rolling_spring.is_some() {
                0.0
            } else {
                self.rolling_friction
            },
            rolling_spring: further.rolling_spring,
            rolling_lever: further.rolling_lever,
            linear_cohesion: further.linear_cohesion,
            bridge: further.bridge,
            ..self
        }
    }
}

impl Interaction {
    /// Gap up to which a contact that was made lives on with a bridge of a volume (m³), m: 0 without liquid.
    #[inline(always)]
    pub(crate) fn reach(&self, bridge_volume: f64) -> f64 {
        self.bridge
            .map_or(0.0, |bridge| bridge.rupture_gap(bridge_volume))
    }

    /// Whether a contact has a bridge of liquid.
    #[inline(always)]
    pub(crate) fn is_wet(&self) -> bool {
        self.bridge.is_some()
    }

    /// Whether a contact remembers the torque of a rolling spring.
    pub(crate) fn remembers_rolling(&self) -> bool {
        self.rolling_spring.is_some()
    }

    /// The interaction without further laws, in a form in which the compiler sees that they are
    /// absent.
    #[inline(always)]
    pub(crate) fn plain(&self) -> Self {
        let law = self.law.with_viscoelastic_damping(None);
        Self {
            law: law.with_rate_dependent_friction(None),
            rolling_friction: self.rolling_friction,
            rolling_spring: None,
            rolling_lever: self.rolling_lever,
            attraction: self.attraction,
            linear_cohesion: None,
            bridge: None,
        }
    }

    /// [`Self::plain`] without rolling friction.
    #[inline(always)]
    pub(crate) fn smooth(&self) -> Self {
        Self {
            rolling_friction: 0.0,
            ..self.plain()
        }
    }

    /// Elastic, damping and sliding part.
    pub(crate) fn law(&self) -> &HertzMindlin {
        &self.law
    }

    /// Attraction at an overlap (m, negative for a gap) of surfaces of a reduced radius (m) with a bridge of a volume (m³), N.
    #[inline(always)]
    pub fn attraction(&self, overlap: f64, reduced_radius: f64, bridge_volume: f64) -> f64 {
        let by_area = self
            .linear_cohesion
            .map_or(0.0, |law| law.attraction(reduced_radius, overlap));
        match &self.bridge {
            None => self.attraction + by_area,
            Some(bridge) => {
                let touching = if overlap > 0.0 { self.attraction } else { 0.0 };
                touching + by_area + bridge.attraction(-overlap, bridge_volume)
            }
        }
    }

    /// Energy that a contact of an overlap and a reduced radius (m) has by its attraction, without a bridge, J.
    pub(crate) fn energy_of_attraction(&self, overlap: f64, reduced_radius: f64) -> f64 {
        let by_area = self
            .linear_cohesion
            .map_or(0.0, |law| law.energy(reduced_radius, overlap));
        -self.attraction * overlap - by_area
    }

    /// Force on body i beside that of a dry contact without attraction: what the bridge resists the speed of approach (m/s)
    /// and of sliding (m/s); none if there is no liquid with viscosity.
    #[inline(always)]
    pub(crate) fn drag(
        &self,
        [overlap, bridge_volume]: [f64; 2],
        normal: &Vector3<f64>,
        approach: f64,
        sliding: &Vector3<f64>,
    ) -> Option<Vector3<f64>> {
        let viscous = self.bridge.as_ref()?.viscous()?;
        let [along_normal, along_surface] = viscous.resistance(-overlap, bridge_volume);
        Some(-normal * (along_normal * approach) - sliding * along_surface)
    }
}
