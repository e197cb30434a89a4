//! What can change in a scene without a triangle moving: materials, lights and what is between and around.

use super::{Environment, Light, Material, Medium, Scene, Texture};
use std::sync::Arc;

/// What a scene shows, but for its triangles. Large things are shared, so that looks are cheap to copy.
#[derive(Clone, Debug, Default)]
pub struct Look {
    /// Materials; see [`Scene::materials`].
    pub materials: Vec<Material>,
    /// Textures of the materials and lights.
    pub textures: Vec<Arc<Texture>>,
    /// Lights other than emissive triangles.
    pub lights: Vec<Light>,
    /// What shines from infinitely far away.
    pub environment: Option<Arc<Environment>>,
    /// What fills the space between surfaces.
    pub medium: Option<Arc<Medium>>,
}

impl Scene {
    /// The look that the scene has.
    pub fn look(&self) -> Look {
        Look {
            materials: self.materials.clone(),
            textures: self.textures.clone(),
            lights: self.lights.clone(),
            environment: self.environment.clone(),
            medium: self.medium.clone(),
        }
    }

    /// Gives the scene another look.
    pub fn set_look(&mut self, look: Look) {
        let Look { materials, textures, lights, environment, medium } = look;
        (self.materials, self.textures, self.lights) = (materials, textures, lights);
        (self.environment, self.medium) = (environment, medium);
    }

    /// Whether nothing in the scene shines: no light, no emissive material, no environment.
    pub fn is_dark(&self) -> bool {
        let emits = |material: &Material| material.emission.max_element() > 0.0;
        self.lights.is_empty() && self.environment.is_none() && !self.materials.iter().any(emits)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::TracedScene;
    use crate::scene::Mesh;
    use glam::Vec3;

    fn square() -> TracedScene {
        let mesh = Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        };
        let materials = vec![Material::matte("red", Vec3::X)];
        TracedScene::new(Scene { meshes: vec![mesh], materials, ..Scene::default() }).expect("a square")
    }

    #[test]
    fn another_look_changes_what_is_seen_and_not_where() {
        let red = square();
        let look = Look { materials: vec![Material::matte("blue", Vec3::Z)], ..red.scene().look() };
        let blue = red.with_look(look);
        let hit = |scene: &TracedScene| scene.hit(Vec3::new(0.3, 0.4, 1.0), Vec3::NEG_Z, 9.0).expect("a hit");
        assert_eq!(hit(&red), hit(&blue));
        assert_eq!(
            (&red.scene().materials[0].name, &blue.scene().materials[0].name),
            (&"red".into(), &"blue".into())
        );
    }

    #[test]
    fn a_scene_is_dark_until_something_shines() {
        let dark = square().scene().clone();
        assert!(dark.is_dark());
        let mut lamp = dark.clone();
        lamp.materials[0].emission = Vec3::X;
        assert!(!lamp.is_dark());
        let light = Light::Directional { direction: Vec3::NEG_Y, irradiance: Vec3::ONE, pattern: None };
        assert!(!Scene { lights: vec![light], ..dark }.is_dark());
    }
}
