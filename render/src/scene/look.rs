//! What can change in a scene without a triangle moving: materials, lights and what is between and around.

use super::{
    Environment, Glow, Light, Material, Medium, Mesh, Scene, SceneError, Texture, TextureId, TextureSlot,
};
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
    /// Which surfaces keep light.
    pub glow: Option<Arc<Glow>>,
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
            glow: self.glow.clone(),
        }
    }

    /// Gives the scene another look.
    pub fn set_look(&mut self, look: Look) {
        let Look { materials, textures, lights, environment, medium, glow } = look;
        (self.materials, self.textures, self.lights) = (materials, textures, lights);
        (self.environment, self.medium, self.glow) = (environment, medium, glow);
    }

    /// Whether a scene of these triangles can look like that: each mesh has a material, each material and
    /// light its textures, and lights and medium are such.
    ///
    /// # Errors
    /// Those of [`Scene::check_lights`] and [`Medium::check`], and if a mesh's material, a material's texture
    /// or its set of coordinates is missing; each names the first that is wrong.
    pub fn check_look(&self) -> Result<(), SceneError> {
        let invalid = |what: String| Err(SceneError::invalid(self.name.as_ref(), what));
        let count = self.materials.len();
        if let Some(Mesh { name, material, .. }) =
            self.meshes.iter().find(|mesh| mesh.material.0 as usize >= count)
        {
            return invalid(format!("mesh `{name}` has material {} of {count}", material.0));
        }
        for material in &self.materials {
            for TextureSlot { texture, uv_set, .. } in material.textures() {
                if !self.has_texture(texture) || uv_set > 1 {
                    let what = format!("texture {} by texture coordinates {uv_set}", texture.0);
                    return invalid(format!(
                        "material `{}` reads {what}, which are not there",
                        material.name
                    ));
                }
            }
        }
        if let Some(medium) = &self.medium {
            medium.check().or_else(|error| invalid(error.to_string()))?;
        }
        self.check_lights()
    }

    /// Whether there is a texture of that index.
    pub(super) fn has_texture(&self, texture: TextureId) -> bool {
        (texture.0 as usize) < self.textures.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::TracedScene;
    use crate::scene::{AlphaMode, Density, Encoding, Wrap};
    use glam::{Affine2, Vec3};

    fn square() -> TracedScene {
        let mesh = Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::X + Vec3::Y, Vec3::Y],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        };
        let materials = vec![Material::matte("red", Vec3::X)];
        TracedScene::new(Scene { meshes: vec![mesh].into(), materials, ..Scene::default() })
            .expect("a square")
    }

    #[test]
    fn another_look_changes_what_is_seen_and_not_where() {
        let red = square();
        let look = Look { materials: vec![Material::matte("blue", Vec3::Z)], ..red.scene().look() };
        let blue = red.with_look(look).expect("a blue square");
        let hit = |scene: &TracedScene| scene.hit(Vec3::new(0.3, 0.4, 1.0), Vec3::NEG_Z, 9.0).expect("a hit");
        assert_eq!(hit(&red), hit(&blue));
        assert_eq!(
            (&red.scene().materials[0].name, &blue.scene().materials[0].name),
            (&"red".into(), &"blue".into())
        );
        assert_eq!(red.scene().meshes.as_ptr(), blue.scene().meshes.as_ptr(), "no copy of the triangles");
    }

    #[test]
    fn looks_that_cannot_be_are_refused_by_name() {
        let square = square();
        let error = |change: &dyn Fn(&mut Look)| {
            let mut look = square.scene().look();
            change(&mut look);
            square.with_look(look).expect_err("a bad look").to_string()
        };
        let slot = |texture: u32, uv_set: usize| {
            Some(TextureSlot { texture: TextureId(texture), uv_set, transform: Affine2::IDENTITY })
        };
        let none = error(&|look| look.materials.clear());
        assert!(none.ends_with("has material 0 of 0"), "{none}");
        let texture = error(&|look| look.materials[0].emission_texture = slot(0, 0));
        assert!(texture.contains("material `red` reads texture 0"), "{texture}");
        let glass = error(&|look| look.materials[0].alpha = AlphaMode::Blend);
        assert!(glass.contains("was built opaque, and material `red` can be seen through"), "{glass}");
        let dark = error(&|look| look.materials[0].emission = Vec3::NEG_ONE);
        assert!(dark.contains("material `red` emits"), "{dark}");
        let thick = Medium {
            anisotropy: 2.0,
            ..Medium::new(Vec3::ONE, Vec3::ONE, 0.0, Density::Everywhere).expect("fog")
        };
        let fog = error(&|look| look.medium = Some(Arc::new(thick.clone())));
        assert!(fog.contains("anisotropy 2"), "{fog}");
    }

    #[test]
    fn what_could_be_seen_through_when_it_was_built_can_become_so_again() {
        let mut scene = square().scene().clone();
        scene.materials[0].alpha = AlphaMode::Blend;
        let glass = TracedScene::new(scene).expect("a pane");
        let with = |scene: &TracedScene, alpha: AlphaMode| {
            let mut look = scene.scene().look();
            look.materials[0].alpha = alpha;
            scene.with_look(look).expect("a pane")
        };
        let again = with(&with(&glass, AlphaMode::Opaque), AlphaMode::Mask(2.0));
        assert!(again.hit(Vec3::new(0.3, 0.4, 1.0), Vec3::NEG_Z, 9.0).is_none(), "all of it is a hole");
    }

    #[test]
    fn a_scene_is_dark_until_something_shines() {
        let dark = square().scene().clone();
        assert!(dark.is_dark());
        let mut lamp = dark.clone();
        lamp.materials[0].emission = Vec3::X;
        assert!(!lamp.is_dark());
        let light = Light::Directional { direction: Vec3::NEG_Y, irradiance: Vec3::ONE, pattern: None };
        assert!(!Scene { lights: vec![light], ..dark.clone() }.is_dark());
        let map = |texel: [u8; 4]| {
            let texture = Texture::new(1, 1, vec![texel], Encoding::Srgb, [Wrap::Repeat; 2]);
            let slot = TextureSlot { texture: TextureId(0), uv_set: 0, transform: Affine2::IDENTITY };
            let mut scene = Scene { textures: vec![texture.into()], ..lamp.clone() };
            scene.materials[0].emission_texture = Some(slot);
            scene.is_dark()
        };
        assert!(map([0, 0, 0, 255]) && !map([0, 1, 0, 255]), "by the emission map");
        let mut unused = dark;
        unused.materials.push(Material { emission: Vec3::X, ..Material::default() });
        assert!(unused.is_dark(), "no face has it");
    }
}
