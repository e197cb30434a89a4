//! Scenes with what both renderers define alike: Lambert surfaces, opaque, flat or with smooth normals.

use deepshade_render::scene::{AlphaMode, Gloss, Material, MaterialId, Mesh, Scene, Texture, TextureSlot};
use glam::{Affine2, Vec3};

/// Which normals surfaces are shaded with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Normals {
    /// The triangles' own.
    Flat,
    /// Those of the mesh. Renderers differ in what light transport makes of them below the horizon.
    Smooth,
}

/// Leaves of every material its diffuse colour and emission, and of every mesh what these need.
pub fn make_lambert(scene: &mut Scene, normals: Normals) {
    for mesh in &mut scene.meshes {
        let slot = scene.materials[mesh.material.0 as usize].base_colour_texture;
        simplify(mesh, slot, normals);
    }
    let materials = scene.materials.iter().map(|material| lambert(material, scene)).collect();
    scene.materials = materials;
}

/// Makes every surface black that does not emit.
pub fn make_black(scene: &mut Scene) {
    for material in &mut scene.materials {
        *material =
            Material { base_colour: Vec3::ZERO.extend(1.0), base_colour_texture: None, ..material.clone() };
    }
}

/// Gives all that reflects specularly the Phong lobe.
pub fn make_phong(scene: &mut Scene) {
    for material in scene.materials.iter_mut().filter(|material| material.gloss != Gloss::None) {
        material.gloss = Gloss::Phong;
    }
}

/// The emission of a material, where it emits.
pub fn emission(scene: &Scene, id: MaterialId) -> Option<Vec3> {
    let emission = scene.material(id).emission;
    (emission != Vec3::ZERO).then_some(emission)
}

fn lambert(material: &Material, scene: &Scene) -> Material {
    // Mitsuba wraps a texture alike along u and v.
    let texture = |slot: &TextureSlot| -> bool {
        let wrap = texture_of(scene, slot).wrap();
        wrap[0] == wrap[1]
    };
    Material {
        base_colour: material.base_colour.truncate().extend(1.0),
        base_colour_texture: material.base_colour_texture.filter(texture).map(|slot| TextureSlot {
            uv_set: 0,
            transform: Affine2::IDENTITY,
            ..slot
        }),
        gloss: Gloss::None,
        emission: if material.emission_texture.is_none() { material.emission } else { Vec3::ZERO },
        alpha: AlphaMode::Opaque,
        ..Material::matte(&material.name, Vec3::ONE)
    }
}

/// The texture of a slot.
pub fn texture_of<'a>(scene: &'a Scene, slot: &TextureSlot) -> &'a Texture {
    &scene.textures[slot.texture.0 as usize]
}

fn simplify(mesh: &mut Mesh, slot: Option<TextureSlot>, normals: Normals) {
    let uvs = slot
        .map(|slot| mesh.uvs[slot.uv_set].iter().map(|uv| slot.transform.transform_point2(*uv)).collect());
    mesh.uvs = [uvs.unwrap_or_default(), Vec::new()];
    mesh.tangents.clear();
    mesh.colours.clear();
    if normals == Normals::Flat {
        mesh.normals.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_render::scene::{Encoding, TextureId, Wrap};
    use glam::{Vec2, Vec4};

    #[test]
    fn what_is_left_is_diffuse_and_its_texture_where_it_was() {
        let slot = TextureSlot {
            texture: TextureId(0),
            uv_set: 1,
            transform: Affine2::from_scale(Vec2::splat(2.0)),
        };
        let shiny = Material {
            base_colour: Vec4::new(0.5, 0.4, 0.3, 0.2),
            base_colour_texture: Some(slot),
            metallic: 1.0,
            alpha: AlphaMode::Blend,
            ..Material::default()
        };
        let triangle = Mesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            normals: vec![Vec3::Z; 3],
            uvs: [vec![], vec![Vec2::ZERO, Vec2::X, Vec2::Y]],
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        let texture = Texture::new(1, 1, vec![[255, 0, 0, 9]], Encoding::Linear, [Wrap::Repeat; 2]);
        let mut scene = Scene {
            meshes: vec![triangle].into(),
            materials: vec![shiny],
            textures: vec![texture.into()],
            ..Scene::default()
        };
        make_lambert(&mut scene, Normals::Flat);
        let (mesh, material) = (&scene.meshes[0], &scene.materials[0]);
        assert!(mesh.normals.is_empty() && mesh.uvs[0][1] == Vec2::new(2.0, 0.0));
        let surface = material.surface(&scene.textures, [Vec2::ZERO; 2], Vec4::ONE);
        assert_eq!((surface.diffuse, surface.specular), (Vec3::new(0.5, 0.0, 0.0), Vec3::ZERO));
        assert_eq!(material.opacity(&scene.textures, [Vec2::ZERO; 2], Vec4::ONE), 1.0);
        make_black(&mut scene);
        assert_eq!(scene.materials[0].surface(&[], [Vec2::ZERO; 2], Vec4::ONE).diffuse, Vec3::ZERO);
    }
}
