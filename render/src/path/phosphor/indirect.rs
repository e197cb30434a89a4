//! Truth for the effect `phosphor-gi`: `1 / pi` times the irradiance, at the point that is seen, of light
//! that surfaces within a radius kept and give back (thesis, Figure 8.15: a room whose walls glow). Times the
//! receiver's diffuse colour it is radiance. Light that is reflected on its way is not counted; a medium dims
//! the lamps' light and nothing else, and what it keeps itself lights nothing here.

use super::Afterglow;
use crate::bvh::TracedScene;
use crate::path::Shot;
use crate::path::at_surface::{SurfaceEffect, Visible};
use crate::sampler::{Stream, cosine_hemisphere, frame};
use glam::Vec3;

/// What other surfaces give back, where it arrives.
#[derive(Debug)]
pub struct KeptLight<'a> {
    scene: &'a TracedScene,
    afterglow: Afterglow<'a>,
    radius: f32,
}

impl<'a> KeptLight<'a> {
    /// That from within the shot's radius.
    pub fn new(shot: &Shot<'a>) -> Self {
        Self { scene: shot.scene, afterglow: Afterglow::new(shot.scene), radius: shot.radius }
    }
}

impl SurfaceEffect for KeptLight<'_> {
    fn sample(&self, Visible { point, .. }: &Visible, stream: &mut Stream) -> Vec3 {
        let square = stream.next_2d();
        let direction = frame(point.normal) * cosine_hemisphere(square.x, square.y);
        // What leaves below the triangle meets the triangle itself.
        if direction.dot(point.geometric_normal) <= 0.0 {
            return Vec3::ZERO;
        }
        let hit = self.scene.hit_by_chance(point.ray_origin(), direction, self.radius, || stream.next_1d());
        hit.map_or(Vec3::ZERO, |hit| self.afterglow.sampled(stream).emission(&hit))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::at_surface::AtSurface;
    use crate::path::proving::{MeanWithError, quad};
    use crate::scene::glow::Start;
    use crate::scene::glow::tests::glow;
    use crate::scene::{Camera, Material, MaterialId, Mesh, Scene};
    use std::f32::consts::PI;
    use std::sync::Arc;

    /// A patch too small to matter, and a square of half an edge above it whose paint is full.
    fn patch_below_square(half: f32, height: f32) -> TracedScene {
        let lying = |half: f32, height: f32, material: u32| {
            let corners = [(-half, half), (half, half), (half, -half), (-half, -half)];
            Mesh { material: MaterialId(material), ..quad(corners.map(|(x, z)| Vec3::new(x, height, z))) }
        };
        let mut full = glow(&[0.5], &[], 0.0);
        full.start = Start::Share(1.0);
        full.surfaces[0].material = Some("square".to_owned());
        TracedScene::new(Scene {
            meshes: vec![lying(1e-3, 0.0, 0), lying(half, height, 1)].into(),
            materials: vec![Material::default(), Material::matte("square", Vec3::ONE)],
            glow: Some(Arc::new(full)),
            ..Scene::default()
        })
        .expect("squares")
    }

    fn at_patch(scene: &TracedScene, radius: f32) -> MeanWithError {
        let camera = Camera::look_at(Vec3::new(0.0, 0.01, 0.01), Vec3::ZERO);
        let shot = Shot::new(scene, &camera, [1, 1], radius);
        MeanWithError::of(&AtSurface::new(&shot, KeptLight::new(&shot)), &shot, 4096)
    }

    #[test]
    fn a_glowing_square_sends_its_form_factor() {
        let scene = patch_below_square(1.0, 0.7);
        let emission = scene.scene().glow.as_deref().expect("glow").surfaces[0].paint.emission(&[1.0; 4]);
        // Howell's catalogue, B-3: as truth of `gi` is tested by.
        let ratio = 1.0 / 0.7f32;
        let root = (1.0 + ratio * ratio).sqrt();
        let factor = 4.0 / PI * (ratio / root) * (ratio / root).atan();
        let found = at_patch(&scene, f32::INFINITY);
        found.proves("phosphor-gi/square", emission * factor);
        found.refutes("phosphor-gi/square", emission * factor * 1.03);
        assert_eq!(at_patch(&scene, 0.69).mean, Vec3::ZERO, "beyond the radius");
    }
}
