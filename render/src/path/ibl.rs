//! Truth for image-based lighting, the effect `ibl`: radiance reflected to the eye from the environment,
//! which nothing blocks, by the Phong model, whatever model the material has (thesis 7.4). The diffuse and
//! the specular colour are the g-buffer's, so that a white dielectric of another model reflects up to 4 %
//! more than it gets.
//!
//! Of the effect `occluded-ibl` surfaces within a radius block the environment, as they do of `do`.

use super::Shot;
use super::at_surface::{SurfaceEffect, Visible};
use super::bsdf::Bsdf;
use crate::bvh::TracedScene;
use crate::intersection::SurfacePoint;
use crate::sampler::Stream;
use crate::scene::{Environment, Gloss};
use glam::Vec3;

/// Image-based lighting; 0 without an environment.
#[derive(Clone, Copy, Debug)]
pub struct Ibl<'a> {
    environment: Option<&'a Environment>,
    blockers: Option<Blockers<'a>>,
}

/// What blocks the environment, within a distance.
#[derive(Clone, Copy, Debug)]
struct Blockers<'a> {
    scene: &'a TracedScene,
    radius: f32,
}

impl<'a> Ibl<'a> {
    /// Light from the scene's environment, which nothing blocks.
    pub fn unoccluded(shot: &Shot<'a>) -> Self {
        Self { environment: shot.scene.scene().environment.as_deref(), blockers: None }
    }

    /// Light from the scene's environment that surfaces within the shot's radius leave.
    pub fn occluded(shot: &Shot<'a>) -> Self {
        let blockers = Blockers { scene: shot.scene, radius: shot.radius };
        Self { blockers: Some(blockers), ..Self::unoccluded(shot) }
    }
}

impl Blockers<'_> {
    /// Whether light from a direction does not arrive. Below a triangle the triangle itself blocks it.
    fn block(&self, point: &SurfacePoint, direction: Vec3) -> bool {
        direction.dot(point.geometric_normal) <= 0.0
            || self.scene.blocked(point.ray_origin(), direction, self.radius)
    }
}

impl SurfaceEffect for Ibl<'_> {
    /// A direction from the environment and one from the reflectance, weighed by the balance heuristic (Veach
    /// 1997, 9.2.2): each in proportion to its density.
    fn sample(&self, visible: &Visible, stream: &mut Stream) -> Vec3 {
        let Some(environment) = self.environment else { return Vec3::ZERO };
        let Visible { mut point, to_viewer } = *visible;
        point.surface.gloss = Gloss::Phong;
        let bsdf = Bsdf::new(&point);
        let arrives =
            |direction| self.blockers.is_none_or(|blockers| !blockers.block(&visible.point, direction));
        let mut sum = Vec3::ZERO;
        if let Some(light) = environment.sample(stream.next_2d()) {
            let densities = light.density + bsdf.density(to_viewer, light.direction);
            let reflected = light.radiance * bsdf.evaluate(to_viewer, light.direction) / densities;
            if reflected != Vec3::ZERO && arrives(light.direction) {
                sum += reflected;
            }
        }
        let reflected = bsdf.sample(to_viewer, stream);
        if let Some(reflected) = reflected.filter(|reflected| arrives(reflected.direction)) {
            let share = reflected.density / (reflected.density + environment.density(reflected.direction));
            sum += environment.radiance(reflected.direction) * reflected.weight * share;
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::TracedScene;
    use crate::path::at_surface::AtSurface;
    use crate::path::proving::{
        MeanWithError, WALL_HEIGHT, floor, integral, spotted, traced, wall, with_environment,
    };
    use crate::scene::{Camera, Material};
    use std::f32::consts::{FRAC_1_PI, PI};

    const METALLIC: f32 = 0.5;
    const ROUGHNESS: f32 = 0.5;
    const COLOUR: Vec3 = Vec3::new(0.9, 0.5, 0.2);

    /// A floor of a half metal under an environment.
    fn shiny(environment: Environment) -> TracedScene {
        let material = Material { metallic: METALLIC, roughness: ROUGHNESS, ..Material::matte("", COLOUR) };
        with_environment(traced(vec![floor()], material), environment)
    }

    /// Where the camera of [`on_floor`] stands, seen from the floor's middle.
    fn to_viewer(degrees: f32) -> Vec3 {
        let (sin, cos) = degrees.to_radians().sin_cos();
        Vec3::new(sin, cos, 0.0)
    }

    fn on_floor(scene: &TracedScene, degrees: f32) -> MeanWithError {
        let camera = Camera::look_at(to_viewer(degrees), Vec3::ZERO);
        let shot = Shot::new(scene, &camera, [1, 1], 1.0);
        MeanWithError::of(&AtSurface::new(&shot, Ibl::unoccluded(&shot)), &shot, 4096)
    }

    /// The Phong model of that floor times the cosine, written down once more: alpha is 1/4, the exponent 30.
    fn reflected(degrees: f32, to_light: Vec3, cosine: f32) -> Vec3 {
        let (diffuse, specular) = (COLOUR * 0.5, 0.5 * (Vec3::splat(0.04) + COLOUR));
        let mirror = to_viewer(degrees) * Vec3::new(-1.0, 1.0, 1.0);
        let lobe = 32.0 / (2.0 * PI) * mirror.dot(to_light).max(0.0).powi(30);
        (diffuse * FRAC_1_PI + specular * lobe) * cosine
    }

    #[test]
    fn environments_are_reflected_by_the_phong_model() {
        for environment in [Environment::uniform(Vec3::new(0.5, 1.0, 2.0)), spotted()] {
            let scene = shiny(environment.clone());
            for degrees in [5.0, 50.0, 80.0] {
                let expected = |without_cosine: bool| {
                    integral(&environment, |light| {
                        let cosine = if without_cosine { 1.0 } else { light.y };
                        if light.y > 0.0 { reflected(degrees, light, cosine) } else { Vec3::ZERO }
                    })
                };
                let value = on_floor(&scene, degrees);
                value.proves("ibl/phong", expected(false));
                value.refutes("ibl/phong", 1.02 * expected(false));
                value.refutes("ibl/phong", expected(true));
            }
        }
    }

    #[test]
    fn a_matte_surface_under_light_from_everywhere_has_its_colour() {
        let material = Material { gloss: Gloss::None, ..Material::matte("", COLOUR) };
        let scene = traced(vec![floor()], material);
        let scene = with_environment(scene, Environment::uniform(Vec3::ONE));
        assert!(on_floor(&scene, 60.0).is(COLOUR));
    }

    /// The floor of a half metal at 1 m from a wall, seen from the far side, with what blocks light as the
    /// effect has it.
    fn beside_wall(environment: &Environment, radius: f32) -> MeanWithError {
        let material = Material { metallic: METALLIC, roughness: ROUGHNESS, ..Material::matte("", COLOUR) };
        let scene = with_environment(traced(vec![floor(), wall()], material), environment.clone());
        let at = Vec3::X;
        let camera = Camera::look_at(at + to_viewer(50.0), at);
        let shot = Shot::new(&scene, &camera, [1, 1], radius);
        MeanWithError::of(&AtSurface::new(&shot, Ibl::occluded(&shot)), &shot, 4096)
    }

    #[test]
    fn a_wall_hides_what_lies_behind_it_within_the_radius() {
        let hidden = |light: Vec3| light.x < 0.0 && light.y < -light.x * WALL_HEIGHT;
        for environment in [Environment::uniform(Vec3::new(0.5, 1.0, 2.0)), spotted()] {
            let expected = |hides: bool| {
                integral(&environment, |light| {
                    let dark = light.y <= 0.0 || hides && hidden(light);
                    if dark { Vec3::ZERO } else { reflected(50.0, light, light.y) }
                })
            };
            let value = beside_wall(&environment, 1e4);
            value.proves("occluded-ibl/wall", expected(true));
            value.refutes("occluded-ibl/wall", expected(false));
            assert!(beside_wall(&environment, 0.9).is(expected(false)), "the wall is beyond the radius");
        }
    }

    #[test]
    fn without_an_environment_it_is_dark() {
        let scene = traced(vec![floor()], Material::default());
        assert_eq!(on_floor(&scene, 60.0).mean, Vec3::ZERO);
    }
}
