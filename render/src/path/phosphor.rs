//! Truth for phosphorescence, the effect `phosphor`: the radiance of what the surface that is seen gives back
//! of light that it kept (thesis, equation 8.3).
//!
//! What excites it is direct light of lamps without an extent, and of the environment where a schedule of
//! [`Glow`](crate::scene::Glow) says so, on either side of the surface: what keeps light is a layer without
//! sides. Shadows are those of rays; lamps are switched at their exact moments, and
//! between them each state moves by its closed form ([`Scheme::Exact`](deepshade_glow::rate::Scheme)), for
//! which steps of any fineness are the same. What moves was where its poses of the past have it
//! ([`TracedScene::past`](crate::bvh::TracedScene::past)), each for the stretch of time that it stands for;
//! without any the scene stays as it is at the moment that is shown. Light that reached a lamp-lit place by a
//! detour, phosphorescent light included, excites nothing and is not shown.
//!
//! Light falls on the mesh as its vertices' normals have it; normal maps change nothing.

mod afterglow;
pub mod in_medium;
mod indirect;
mod sky;

pub use afterglow::{Afterglow, ReceivingPoint};
pub use indirect::KeptLight;

use super::{Footprint, Integrator, Shot};
use crate::sampler::{PixelSampler, Stream};
use glam::{Vec2, Vec3};

/// The integrator.
#[derive(Debug)]
pub struct Phosphor<'a> {
    shot: Shot<'a>,
    afterglow: Afterglow<'a>,
}

impl<'a> Phosphor<'a> {
    /// What the shot's scene gives back.
    pub fn new(shot: &Shot<'a>) -> Self {
        Self { shot: *shot, afterglow: Afterglow::new(shot.scene) }
    }

    fn seen(&self, at: Vec2, afterglow: &Afterglow<'_>) -> Vec3 {
        let Shot { scene, camera, height, width, .. } = self.shot;
        let (origin, direction) = (camera.position, camera.direction(at, height, width));
        let hit = scene.hit(origin, direction, f32::INFINITY);
        let reach = hit.map_or(f32::INFINITY, |hit| hit.distance);
        let surface = hit.map_or(Vec3::ZERO, |hit| afterglow.emission(&hit));
        afterglow.through_medium((origin, direction, reach), surface)
    }
}

impl Integrator for Phosphor<'_> {
    fn sample(&self, at: Vec2, stream: &mut Stream) -> Vec3 {
        self.seen(at, &self.afterglow.sampled(stream))
    }

    /// A pixel's middle shows the same to all samples, unless they look for the environment.
    fn pixel(&self, shot: &Shot<'_>, x: usize, y: usize, sampler: PixelSampler, count: u32) -> Vec3 {
        if shot.footprint == Footprint::Box || self.afterglow.varies() {
            return super::mean_of_samples(self, shot, x, y, sampler, count);
        }
        self.seen(Vec2::new(x as f32 + 0.5, y as f32 + 0.5), &self.afterglow)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::TracedScene;
    use crate::path::FullPath;
    use crate::path::proving::{MeanWithError, quad};
    use crate::scene::glow::Start;
    use crate::scene::glow::tests::glow;
    use crate::scene::{
        Bounds, Camera, Density, Gloss, Glow, Light, Material, MaterialId, Medium, Mesh, Scene,
    };
    use std::sync::Arc;

    /// A square of 2 m at z = 0 under a lamp of 8 W/sr at a distance of 2 m, of which only the middle is
    /// asked.
    fn square(glow: Glow, more: Vec<Mesh>) -> TracedScene {
        let corners = [(-1., -1.), (1., -1.), (1., 1.), (-1., 1.)].map(|(x, y)| Vec3::new(x, y, 0.0));
        let lamp =
            Light::Point { position: Vec3::Z * 2.0, intensity: Vec3::splat(8.0), range: f32::INFINITY };
        TracedScene::new(Scene {
            meshes: [vec![quad(corners)], more].concat().into(),
            materials: vec![Material::matte("wall", Vec3::splat(0.5))],
            lights: vec![lamp],
            glow: Some(Arc::new(glow)),
            ..Scene::default()
        })
        .expect("a square")
    }

    /// What its middle sends to somebody in front of it, or behind.
    fn middle(scene: &TracedScene, eye: Vec3) -> Vec3 {
        let camera = Camera::look_at(eye, Vec3::ZERO);
        let shot = Shot::new(scene, &camera, [1, 1], f32::INFINITY);
        let phosphor = Phosphor::new(&shot);
        phosphor.pixel(&shot, 0, 0, PixelSampler::new(0, 0, 0), 1)
    }

    const EYE: Vec3 = Vec3::new(0.1, 0.2, 1.0);

    #[test]
    fn light_that_was_on_for_a_while_decays_as_the_closed_form_says() {
        let (on, off) = (1.5f32, 2.25f32);
        let decays = [0.6f32, 0.05];
        let scene = square(glow(&decays, &[[0.0, on]], on + off), vec![]);
        // 8 W/sr at 2 m; only red excites, at a rate of 0.4.
        let charge = 0.4 * 2.0;
        let share = |decay: f32| {
            let total = charge + decay;
            charge / total * (1.0 - (-total * on).exp()) * (-decay * off).exp()
        };
        let sent: f32 = decays.iter().map(|decay| decay * share(*decay)).sum();
        let expected = Vec3::new(1.0, 0.5, 0.25) * sent;
        for eye in [EYE, -EYE] {
            let found = middle(&scene, eye);
            assert!((found - expected).abs().max_element() < 1e-6, "{found} {expected}");
        }
    }

    #[test]
    fn a_shadow_keeps_a_place_dark_and_long_light_is_the_equilibrium() {
        let mut lit = glow(&[0.2], &[], 0.0);
        lit.start = Start::LitForLong;
        let found = middle(&square(lit.clone(), vec![]), EYE).x;
        assert!((found - 0.2 * 0.8 / (0.8 + 0.2)).abs() < 1e-6, "{found}");
        let corners = [(-1., -1.), (1., -1.), (1., 1.), (-1., 1.)].map(|(x, y)| Vec3::new(x, y, 1.5));
        assert_eq!(middle(&square(lit, vec![quad(corners)]), EYE), Vec3::ZERO);
    }

    /// A small patch without paint that looks at a square of half an edge `half` above it, which glows.
    fn reflected(start: f32, moment: f32) -> MeanWithError {
        let corners = |half: f32, y: f32| {
            [(-1., 1.), (1., 1.), (1., -1.), (-1., -1.)].map(|(x, z)| Vec3::new(half * x, y, half * z))
        };
        let mut kept = glow(&[0.3], &[[0.0, 1.0]], moment);
        (kept.start, kept.surfaces[0].material) = (Start::Share(start), Some("sender".to_owned()));
        let sender = Mesh { material: MaterialId(1), ..quad(corners(1.0, 0.7)) };
        let matte = |name, grey| Material { gloss: Gloss::None, ..Material::matte(name, Vec3::splat(grey)) };
        let scene = TracedScene::new(Scene {
            meshes: vec![quad(corners(1e-3, 0.0)), sender].into(),
            materials: vec![matte("patch", 0.5), matte("sender", 0.0)],
            lights: vec![Light::Directional { direction: Vec3::NEG_Y, irradiance: Vec3::ONE, pattern: None }],
            glow: Some(Arc::new(kept)),
            ..Scene::default()
        });
        let scene = scene.expect("squares");
        let camera = Camera::look_at(Vec3::new(0.0, 0.01, 0.01), Vec3::ZERO);
        let shot = Shot::new(&scene, &camera, [1, 1], f32::INFINITY);
        MeanWithError::of(&FullPath::new(&shot), &shot, 4096)
    }

    #[test]
    fn kept_light_lights_other_surfaces_once_the_lamp_is_off() {
        // Four corners of `(2 pi)^-1 2 A atan A` with A = (a / h) / sqrt(1 + (a / h)^2) each (Howell's
        // catalogue, B-3).
        let ratio = 1.0f32 / 0.7;
        let part = ratio / (1.0 + ratio * ratio).sqrt();
        let factor = 4.0 / std::f32::consts::PI * part * part.atan();
        let expected = |share: f32| Vec3::new(1.0, 0.5, 0.25) * 0.3 * share * 0.5 * factor;
        // From full, in light from behind at the sender's rate of 0.4 for a second, then in the dark.
        let lit = 0.4 / 0.7 + (1.0 - 0.4 / 0.7) * (-0.7f32).exp();
        let dark = lit * (-0.3f32 * 2.0).exp();
        reflected(1.0, 3.0).proves("phosphor/reflected", expected(dark));
        reflected(1.0, 3.0).refutes("phosphor/reflected", expected(1.02 * dark));
        assert_eq!(reflected(0.0, 0.0).mean, Vec3::ZERO, "the lamp is behind the sender");
    }

    /// A blocker hung before the lamp for the first half of a second of light, and is gone in the other: its
    /// shadow stays.
    #[test]
    fn a_shadow_leaves_a_trace_where_it_was() {
        let decay = 0.4;
        let corners = [(-1., -1.), (1., -1.), (1., 1.), (-1., 1.)];
        let blocker = |x: f32| quad(corners.map(|(across, up)| Vec3::new(x + 0.3 * across, 0.3 * up, 1.5)));
        let scene = |x: f32, moment: f32| square(glow(&[decay], &[[0.0, 1.0]], moment), vec![blocker(x)]);
        let now = scene(9.0, 3.0);
        let share = |seconds: f32, after: f32| {
            let total: f32 = 0.8 + decay;
            0.8 / total * (1.0 - (-total * seconds).exp()) * (-decay * after).exp()
        };
        let expected = |share: f32| Vec3::new(1.0, 0.5, 0.25) * decay * share;
        let untold = middle(&now, EYE);
        assert!(
            (untold - expected(share(1.0, 2.0))).abs().max_element() < 1e-6,
            "as if it had never been: {untold}"
        );
        let past = vec![(0.0, scene(0.0, 3.0)), (0.5, scene(9.0, 3.0))];
        let told = now.clone().with_past(past).expect("the same triangles");
        let found = middle(&told, EYE);
        assert!((found - expected(share(0.5, 2.0))).abs().max_element() < 1e-6, "{found}");
        assert!(
            now.with_past(vec![(0.0, square(glow(&[decay], &[], 0.0), vec![]))]).is_err(),
            "other triangles"
        );
    }

    /// A box of fog before the square, lit evenly from afar, hides half of what is behind it and looks half
    /// like its paint.
    #[test]
    fn a_medium_shines_as_much_as_it_hides() {
        let mut kept = glow(&[0.3], &[[0.0, 1.5]], 4.0);
        kept.medium = kept.surfaces.pop().map(|surface| surface.paint);
        let density =
            Density::Within(Bounds { min: Vec3::new(-1.0, -1.0, 0.2), max: Vec3::new(1.0, 1.0, 0.7) });
        // Of absorption alone of red: what excites it is dimmed as the closed form says, from front to back.
        let thin = Vec3::splat(1e-3);
        let medium = Medium::new(Vec3::ZERO, thin, 0.0, density).expect("a medium");
        let scene = TracedScene::new(Scene {
            medium: Some(Arc::new(medium)),
            lights: vec![Light::Directional {
                direction: Vec3::NEG_Z,
                irradiance: Vec3::ONE * 2.0,
                pattern: None,
            }],
            ..square(kept, vec![]).scene().clone()
        });
        let found = middle(&scene.expect("a square"), Vec3::Z);
        let total = 0.4f32 * 2.0 + 0.3;
        let share = 0.8 / total * (1.0 - (-total * 1.5).exp()) * (-0.3f32 * 2.5).exp();
        let expected = Vec3::new(1.0, 0.5, 0.25) * 0.3 * share * (1.0 - (-1e-3f32 * 0.5).exp());
        assert!((found / expected - 1.0).abs().max_element() < 2e-3, "{found} {expected}");
    }

    /// The lamp is above all three corners, which are one.
    #[test]
    fn what_has_no_area_gets_no_light_whatever_its_normals() {
        let scene = square(glow(&[0.2], &[[0.0, 9.0]], 1.0), vec![]);
        let mut mesh = quad([(-1., -1.), (1., -1.), (1., 1.), (-1., 1.)].map(|(x, y)| Vec3::new(x, y, 0.0)));
        mesh.normals = vec![Vec3::Z; 4];
        let received = |mesh: &Mesh| {
            Afterglow::new(&scene).irradiance(&ReceivingPoint::new(mesh, 0, [0.4, 0.3, 0.3])).remove(0)
        };
        assert!(received(&mesh).min_element() > 1.0);
        mesh.positions = vec![Vec3::ZERO; 4];
        assert_eq!(received(&mesh), Vec3::ZERO);
    }

    #[test]
    fn what_has_no_paint_is_dark() {
        let mut other = glow(&[0.2], &[[0.0, 9.0]], 1.0);
        other.surfaces[0].material = Some("floor".to_owned());
        assert_eq!(middle(&square(other, vec![]), EYE), Vec3::ZERO);
    }
}
