//! Rays that carry light through blended surfaces: [`TracedScene::hit`] shows a camera surfaces from half
//! opacity on and [`TracedScene::blocked`] decides by the ray alone, so that neither gets nearer to the truth
//! by more samples. Here, every blended triangle stops its share of rays by a number that each ray brings, or
//! dims them all by its share. Masks are there or not, as everywhere. Panes of glass, which only
//! [`TracedScene::let_through_tinted`] knows to let light through, tint it.

use super::{Hit, TracedScene, TriangleOrigin, clock, ray};
use crate::sampler::hash;
use glam::Vec3;
use std::cell::Cell;

impl TracedScene {
    /// The nearest surface that stops light along a ray, up to `reach` lengths of `direction`. A blended
    /// triangle does with the probability of its opacity, independently of every other, decided by `chance`,
    /// a random number in [0, 1), which is drawn only in a scene with blended materials.
    pub fn hit_by_chance(
        &self,
        origin: Vec3,
        direction: Vec3,
        reach: f32,
        chance: impl FnOnce() -> f32,
    ) -> Option<Hit> {
        let chance = if self.blended { chance() } else { 0.0 };
        let stops = |opacity, origin| opacity > chance_of(origin, chance);
        self.nearest(ray(origin, direction, reach), stops)
    }

    /// The nearest surface along a ray that no light passes, up to `reach` lengths of `direction`.
    pub fn opaque_hit(&self, origin: Vec3, direction: Vec3, reach: f32) -> Option<Hit> {
        self.nearest(ray(origin, direction, reach), |opacity, _| opacity >= 1.0)
    }

    /// The share of light that gets through along a ray within `reach` lengths of `direction`: the product of
    /// what each surface lets through, 0 behind an opaque one.
    pub fn let_through(&self, origin: Vec3, direction: Vec3, reach: f32) -> f32 {
        left(|ends| self.meets_any(ray(origin, direction, reach), |opacity, _| ends(opacity)))
    }

    /// The same of each colour, where `passed` says which share of light goes straight on through a surface
    /// that is there. The distance of the hits that it is asked about is not known.
    pub fn let_through_tinted(
        &self,
        origin: Vec3,
        direction: Vec3,
        reach: f32,
        passed: impl Fn(&Hit) -> Vec3,
    ) -> Vec3 {
        let ray = ray(origin, direction, reach);
        let share = Cell::new(Vec3::ONE);
        let ends = |index: u32| {
            let opacity = self.opacity(&ray, index as usize);
            let through = match opacity > 0.0 {
                true => opacity * passed(&self.hit_at(&ray, index, f32::NAN)),
                false => Vec3::ZERO,
            };
            share.set(share.get() * (Vec3::splat((1.0 - opacity).max(0.0)) + through));
            share.get() == Vec3::ZERO
        };
        if clock::around(|| self.bvh.blocked(&ray, ends)) { Vec3::ZERO } else { share.get() }
    }
}

/// The share of light that surfaces leave: `meets` tells of the opacity of each that a ray meets, until told
/// that no light is left, and whether one let none through.
pub(super) fn left(meets: impl FnOnce(&dyn Fn(f32) -> bool) -> bool) -> f32 {
    let share = Cell::new(1.0f32);
    let ends = |opacity: f32| {
        share.set(share.get() * (1.0 - opacity).max(0.0));
        share.get() == 0.0
    };
    if meets(&ends) { 0.0 } else { share.get() }
}

/// A number in [0, 1) for each triangle, of one random number.
fn chance_of(triangle: TriangleOrigin, chance: f32) -> f32 {
    (hash(triangle.key() ^ hash(chance.to_bits())) >> 8) as f32 / 16_777_216.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{AlphaMode, Material, Mesh, Scene};
    use glam::Vec4;

    /// Two panes of opacity 0.3, one behind the other.
    fn panes() -> TracedScene {
        let pane = |z: f32| Mesh {
            positions: [(0., 0.), (1., 0.), (1., 1.), (0., 1.)].map(|(x, y)| Vec3::new(x, y, z)).to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        };
        let material = Material {
            base_colour: Vec4::new(1.0, 1.0, 1.0, 0.3),
            alpha: AlphaMode::Blend,
            ..Material::default()
        };
        TracedScene::new(Scene {
            meshes: vec![pane(0.0), pane(-1.0)].into(),
            materials: vec![material],
            ..Scene::default()
        })
        .expect("two panes")
    }

    const FROM: Vec3 = Vec3::new(0.3, 0.6, 1.0);

    #[test]
    fn panes_dim_light_by_the_product_of_their_shares() {
        let panes = panes();
        assert!((panes.let_through(FROM, Vec3::NEG_Z, 9.0) - 0.49).abs() < 1e-6);
        assert!((panes.let_through(FROM, Vec3::NEG_Z, 1.5) - 0.7).abs() < 1e-6);
        assert_eq!(panes.let_through(FROM, Vec3::Z, 9.0), 1.0);
    }

    #[test]
    fn each_pane_stops_its_share_of_rays_independently() {
        let panes = panes();
        let count = 200_000;
        let mut met = [0; 2];
        for i in 0..count {
            let chance = hash(i) as f32 / 4_294_967_296.0;
            if let Some(hit) = panes.hit_by_chance(FROM, Vec3::NEG_Z, f32::INFINITY, || chance) {
                met[hit.mesh as usize] += 1;
            }
        }
        // Three standard deviations of a binomial: 615 for 0.3, 546 for 0.7 * 0.3.
        assert!((met[0] - 60_000i32).abs() < 615, "{met:?}");
        assert!((met[1] - 42_000i32).abs() < 546, "{met:?}");
        let near = (0..100).filter_map(|i| panes.hit_by_chance(FROM, Vec3::NEG_Z, 1.5, || i as f32 / 100.0));
        assert!(near.map(|hit| hit.mesh).all(|mesh| mesh == 0), "the second is out of reach");
    }
}
