//! The environment as light that surfaces keep: directions in which it is looked for from each point.

use crate::path::lights::Arrival;
use crate::scene::environment::EnvironmentSample;
use crate::scene::glow::SKY_LAMPS;
use crate::scene::{Environment, Glow, Light, Scene};
use glam::{Vec2, Vec3};

/// Directions of a point that is looked at once.
const FINE: u32 = 1024;
/// Directions of one of many samples. States fill up less than in proportion to their light, so that the
/// mean over samples is low by what light varies from one to the next: a quarter of its variance at most.
const COARSE: u32 = 64;

/// The environment of a scene that keeps its light.
#[derive(Clone, Debug)]
pub(super) struct Sky<'a> {
    environment: &'a Environment,
    /// The schedule that it follows.
    pub(super) schedule: usize,
    count: u32,
    turn: Vec2,
    /// The lamps that stand for it in methods, where they are its light.
    lamps: Option<Vec<Arrival>>,
}

impl<'a> Sky<'a> {
    /// That of a scene; none where nothing keeps its light.
    pub(super) fn of(scene: &'a Scene, glow: &Glow) -> Option<Self> {
        let environment = scene.environment.as_deref()?;
        let schedule = glow.schedule_of_sky()?;
        Some(Self { environment, schedule, count: FINE, turn: Vec2::ZERO, lamps: None })
    }

    /// One sample of it, of many.
    pub(super) fn sampled(&self, turn: Vec2) -> Self {
        Self { count: COARSE, turn, ..self.clone() }
    }

    /// As the lamps that stand for it in methods.
    pub(super) fn by_lamps(self) -> Self {
        let lamps = self.environment.lamps(SKY_LAMPS);
        let arrival = |lamp: &Light| match lamp {
            Light::Directional { direction, irradiance, .. } => Some(far(-*direction, *irradiance)),
            Light::Point { .. } | Light::Spot { .. } => None,
        };
        Self { lamps: Some(lamps.iter().filter_map(arrival).collect()), ..self }
    }

    /// What arrives from it anywhere if nothing is in between.
    pub(super) fn arrivals(&self) -> Vec<Arrival> {
        let count = self.count;
        let arrival = |EnvironmentSample { direction, radiance, density }| {
            far(direction, radiance / (density * count as f32))
        };
        let anywhere = || self.environment.directions(count, self.turn).map(arrival).collect();
        self.lamps.clone().unwrap_or_else(anywhere)
    }
}

/// Light from infinitely far away.
const fn far(direction: Vec3, irradiance: Vec3) -> Arrival {
    Arrival { direction, distance: f32::INFINITY, irradiance }
}

#[cfg(test)]
mod tests {
    use crate::bvh::TracedScene;
    use crate::path::phosphor::{Afterglow, Phosphor, ReceivingPoint};
    use crate::path::proving::{MeanWithError, quad};
    use crate::path::{FullPath, Shot};
    use crate::scene::glow::tests::glow;
    use crate::scene::glow::{Glow, Schedule};
    use crate::scene::{Camera, Environment, Gloss, Material, MaterialId, Mesh, Scene};
    use glam::Vec3;
    use std::f32::consts::PI;

    const RADIANCE: Vec3 = Vec3::new(0.5, 2.0, 3.0);

    fn lying(half: f32, y: f32) -> Mesh {
        quad([(-1., 1.), (1., 1.), (1., -1.), (-1., -1.)].map(|(x, z)| Vec3::new(half * x, y, half * z)))
    }

    /// A black square under a sky that is alike everywhere and shines for a while, with covers that keep no
    /// light.
    fn square(covers: &[f32], decay: f32, on: f32, moment: f32) -> TracedScene {
        let mut kept = glow(&[decay], &[], moment);
        kept.surfaces[0].material = Some("square".to_owned());
        kept.schedules.insert(0, Schedule { sky: true, on: vec![[0.0, on]], ..Schedule::default() });
        let black = |name| Material { gloss: Gloss::None, ..Material::matte(name, Vec3::ZERO) };
        let covers = covers.iter().map(|y| Mesh { material: MaterialId(1), ..lying(200.0, *y) });
        TracedScene::new(Scene {
            meshes: std::iter::once(lying(0.5, 0.0)).chain(covers).collect(),
            materials: vec![black("square"), black("cover")],
            environment: Some(Environment::uniform(RADIANCE).into()),
            glow: Some(kept.into()),
            ..Scene::default()
        })
        .expect("squares")
    }

    #[test]
    fn a_plane_under_a_uniform_sky_receives_pi_of_its_radiance_a_side() {
        let received = |covers: &[f32]| {
            let scene = square(covers, 0.3, 1.0, 1.0);
            let place = ReceivingPoint::new(&scene.scene().meshes[0], 0, [0.4, 0.3, 0.3]);
            Afterglow::new(&scene).irradiance(&place)[0] / (PI * RADIANCE)
        };
        for (covers, sides) in [(&[][..], 2.0), (&[-0.02], 1.0), (&[0.02], 1.0), (&[-0.02, 0.02], 0.0)] {
            let found = received(covers);
            assert!((found - sides).abs().max_element() < 5e-3, "{covers:?}: {found}");
        }
    }

    #[test]
    fn light_of_the_sky_is_kept_as_the_closed_form_says() {
        let (decay, on, off) = (0.3f32, 1.5f32, 2.25f32);
        let scene = square(&[-0.02], decay, on, on + off);
        // Only red excites, at a rate of 0.4.
        let charge = 0.4 * PI * RADIANCE.x;
        let total = charge + decay;
        let share = charge / total * (1.0 - (-total * on).exp()) * (-decay * off).exp();
        let expected = Vec3::new(1.0, 0.5, 0.25) * decay * share;
        // So narrow that all rays are alike.
        let above = Camera::look_at(Vec3::new(0.1, 0.9, 0.2), Vec3::new(0.1, 0.0, 0.1));
        let camera = Camera { vertical_fov: 1e-3, ..above };
        let shot = Shot::new(&scene, &camera, [1, 1], f32::INFINITY);
        let found = MeanWithError::of(&Phosphor::new(&shot), &shot, 256);
        found.proves("phosphor/sky", expected);
        found.refutes("phosphor/sky", 1.02 * expected);
        // The sky is off, so that all light there is is what was kept.
        let all = MeanWithError::of(&FullPath::new(&shot), &shot, 256);
        all.proves("path/sky-kept", expected);
        let shut = square(&[-0.02, 0.02], decay, on, on + off);
        let below = Camera { position: Vec3::new(0.1, 0.01, 0.1), ..camera };
        let shot = Shot::new(&shut, &below, [1, 1], f32::INFINITY);
        // The gap at the sides shows a millionth of the sky.
        let within = MeanWithError::of(&Phosphor::new(&shot), &shot, 64).mean;
        assert!(within.max_element() < 1e-6 * expected.max_element(), "{within} gets in");
    }

    #[test]
    fn nothing_keeps_its_light_where_no_schedule_says_so() {
        let mut scene = square(&[], 0.3, 1.0, 1.0).scene().clone();
        let mut kept = Glow::of(&scene).clone();
        kept.schedules.remove(0);
        scene.glow = Some(kept.into());
        let scene = TracedScene::new(scene).expect("a square");
        let place = ReceivingPoint::new(&scene.scene().meshes[0], 0, [0.4, 0.3, 0.3]);
        assert_eq!(Afterglow::new(&scene).irradiance(&place), [Vec3::ZERO]);
    }
}
