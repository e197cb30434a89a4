//! Materials: glTF's metallic-roughness model, and what it says of a point of a surface.

use super::coat::{Coat, Coating};
use super::transmission::{Passage, Transmission, Walls};
use super::{Texture, TextureId};
use glam::{Affine2, Vec2, Vec3, Vec4};
use std::sync::Arc;

/// How alpha is used.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum AlphaMode {
    /// Not at all.
    #[default]
    Opaque,
    /// Present where alpha reaches the cutoff, absent elsewhere.
    Mask(f32),
    /// Present with probability alpha.
    Blend,
}

/// Where a material reads a value from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextureSlot {
    /// Which texture.
    pub texture: TextureId,
    /// Which of the mesh's two sets of coordinates.
    pub uv_set: usize,
    /// Applied to the coordinates first (KHR_texture_transform).
    pub transform: Affine2,
}

/// How a surface spreads what it reflects specularly.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Gloss {
    /// Microfacets with the GGX distribution, glTF's model: what path tracing uses.
    #[default]
    Microfacets,
    /// The energy-normalised Phong lobe, the model of the thesis' attributes (7.3.1). It adds to the diffuse
    /// colour, which therefore takes no more than the specular colour leaves.
    Phong,
    /// Nothing is reflected specularly: Lambert's law alone.
    None,
}

/// glTF's metallic-roughness material. Colours are linear; a texture multiplies its factor. Surfaces are seen
/// and stop light from both sides, whatever a file says of culling.
#[derive(Clone, Debug)]
pub struct Material {
    /// What the file calls it.
    pub name: String,
    /// Base colour and alpha.
    pub base_colour: Vec4,
    /// Multiplies the base colour.
    pub base_colour_texture: Option<TextureSlot>,
    /// 0 dielectric, 1 metal.
    pub metallic: f32,
    /// Perceptual roughness; 1 is rough.
    pub roughness: f32,
    /// Roughness in green, metallic in blue.
    pub metallic_roughness_texture: Option<TextureSlot>,
    /// Tangent-space normals, with the scale of their x and y.
    pub normal_texture: Option<(TextureSlot, f32)>,
    /// How what is reflected specularly spreads.
    pub gloss: Gloss,
    /// Specular colour of [`Gloss::Phong`], beside a diffuse one that is the base colour; without it, both
    /// come from base colour and metalness, as those of microfacets do.
    pub specular: Option<Vec3>,
    /// Mean free path below the surface for each colour, metres; zero where light does not enter.
    pub mean_free_path: Vec3,
    /// Emitted radiance.
    pub emission: Vec3,
    /// Multiplies the emission.
    pub emission_texture: Option<TextureSlot>,
    /// How alpha is used.
    pub alpha: AlphaMode,
    /// Index of refraction, by which a dielectric reflects and bends light: 1.5 where nothing is said.
    pub ior: f32,
    /// How light passes; `None` of an opaque material.
    pub transmission: Option<Transmission>,
    /// The clear layer over it.
    pub coat: Option<Coat>,
}

impl Default for Material {
    /// A white, rough dielectric.
    fn default() -> Self {
        Self {
            name: String::new(),
            base_colour: Vec4::ONE,
            base_colour_texture: None,
            metallic: 0.0,
            roughness: 1.0,
            metallic_roughness_texture: None,
            normal_texture: None,
            gloss: Gloss::default(),
            specular: None,
            mean_free_path: Vec3::ZERO,
            emission: Vec3::ZERO,
            emission_texture: None,
            alpha: AlphaMode::Opaque,
            ior: USUAL_IOR,
            transmission: None,
            coat: None,
        }
    }
}

/// What a material says of one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// `Rdiff`, the diffuse albedo.
    pub diffuse: Vec3,
    /// `Rspec`, specular colour at normal incidence: the material's own; else 4 % for a dielectric, the base
    /// colour for a metal, zero where nothing is reflected specularly.
    pub specular: Vec3,
    /// Perceptual roughness.
    pub roughness: f32,
    /// How what is reflected specularly spreads.
    pub gloss: Gloss,
    /// Mean free path below the surface, metres; zero where light does not enter.
    pub mean_free_path: Vec3,
    /// Emitted radiance.
    pub emission: Vec3,
    /// How light passes, of which only truth of `path` knows: the diffuse albedo is that of an opaque
    /// surface.
    pub transmission: Option<Passage>,
    /// The clear layer over it, of which only truth of `path` knows.
    pub coat: Option<Coating>,
}

/// Index of refraction where nothing is said of it (glTF 2.0, appendix B).
const USUAL_IOR: f32 = 1.5;
/// Specular reflectance of a dielectric of that index at normal incidence.
const DIELECTRIC_SPECULAR: f32 = 0.04;

impl Material {
    /// A rough dielectric of one colour.
    pub fn matte(name: &str, colour: Vec3) -> Self {
        Self { name: name.to_owned(), base_colour: colour.extend(1.0), ..Self::default() }
    }

    /// The surface at a point with two sets of texture coordinates and an interpolated vertex colour.
    pub fn surface(&self, textures: &[Arc<Texture>], uvs: [Vec2; 2], colour: Vec4) -> Surface {
        let base = self.base_colour * colour * read(self.base_colour_texture, textures, uvs);
        let metallic_roughness = read(self.metallic_roughness_texture, textures, uvs);
        let metallic = (self.metallic * metallic_roughness.z).clamp(0.0, 1.0);
        let base = base.truncate().clamp(Vec3::ZERO, Vec3::ONE);
        let (body, coat) =
            (base * (1.0 - metallic), Vec3::splat(self.dielectric_specular()).lerp(base, metallic));
        let (diffuse, specular) = match (self.gloss, self.specular) {
            (Gloss::None, _) => (body, Vec3::ZERO),
            (Gloss::Microfacets, _) => (body, coat),
            (Gloss::Phong, None) => (body.min(Vec3::ONE - coat), coat),
            (Gloss::Phong, Some(specular)) => {
                let specular = specular.clamp(Vec3::ZERO, Vec3::ONE);
                (base.min(Vec3::ONE - specular), specular)
            }
        };
        Surface {
            diffuse,
            specular,
            roughness: (self.roughness * metallic_roughness.y).clamp(0.0, 1.0),
            gloss: self.gloss,
            mean_free_path: self.mean_free_path,
            emission: self.emitted(textures, uvs),
            transmission: self.transmission.as_ref().and_then(|of| of.at(self.ior, textures, uvs)),
            coat: self.coat.as_ref().and_then(|coat| coat.at(textures, uvs)),
        }
    }

    /// What a dielectric of its index of refraction reflects at normal incidence (KHR_materials_ior).
    pub fn dielectric_specular(&self) -> f32 {
        if self.ior == USUAL_IOR {
            return DIELECTRIC_SPECULAR;
        }
        ((self.ior - 1.0) / (self.ior + 1.0)).powi(2)
    }

    /// Radiance emitted at a point, to both sides.
    pub fn emitted(&self, textures: &[Arc<Texture>], uvs: [Vec2; 2]) -> Vec3 {
        self.emission * read(self.emission_texture, textures, uvs).truncate()
    }

    /// The share of light that is stopped at a point: 1, 0 or, for blended materials, alpha.
    pub fn opacity(&self, textures: &[Arc<Texture>], uvs: [Vec2; 2], colour: Vec4) -> f32 {
        let alpha = || (self.base_colour * colour * read(self.base_colour_texture, textures, uvs)).w;
        match self.alpha {
            AlphaMode::Opaque => 1.0,
            AlphaMode::Mask(cutoff) => f32::from(alpha() >= cutoff),
            AlphaMode::Blend => alpha().clamp(0.0, 1.0),
        }
    }

    /// What it reads from textures.
    pub fn textures(&self) -> impl Iterator<Item = TextureSlot> {
        let normal = self.normal_texture.map(|(slot, _)| slot);
        let slots =
            [self.base_colour_texture, self.metallic_roughness_texture, self.emission_texture, normal];
        let transmission = self.transmission.as_ref().and_then(|transmission| transmission.texture);
        let coat = self.coat.as_ref().map_or([None; 3], Coat::textures);
        slots.into_iter().chain([transmission]).chain(coat).flatten()
    }

    /// Whether a share of light may pass through it: whether its opacity must be asked.
    pub fn can_be_seen_through(&self) -> bool {
        self.alpha != AlphaMode::Opaque
    }

    /// Whether light may pass it without being bent, as through a pane.
    pub fn may_pass_light_straight(&self) -> bool {
        self.transmission.as_ref().is_some_and(|transmission| transmission.walls == Walls::Thin)
    }

    /// The tangent-space normal at a point, unit length; `None` without a normal map.
    pub fn tangent_normal(&self, textures: &[Arc<Texture>], uvs: [Vec2; 2]) -> Option<Vec3> {
        tangent_normal(self.normal_texture, textures, uvs)
    }

    /// The same of the clear coat.
    pub fn coat_normal(&self, textures: &[Arc<Texture>], uvs: [Vec2; 2]) -> Option<Vec3> {
        tangent_normal(self.coat.as_ref()?.normal_texture, textures, uvs)
    }
}

/// The normal of a normal map.
fn tangent_normal(
    map: Option<(TextureSlot, f32)>,
    textures: &[Arc<Texture>],
    uvs: [Vec2; 2],
) -> Option<Vec3> {
    let (slot, scale) = map?;
    let value = read(Some(slot), textures, uvs).truncate() * 2.0 - Vec3::ONE;
    (value * Vec3::new(scale, scale, 1.0)).try_normalize()
}

/// The value of a slot, white where there is none.
pub(super) fn read(slot: Option<TextureSlot>, textures: &[Arc<Texture>], uvs: [Vec2; 2]) -> Vec4 {
    slot.map_or(Vec4::ONE, |slot| {
        textures[slot.texture.0 as usize].sample(slot.transform.transform_point2(uvs[slot.uv_set]))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_usual_index_of_refraction_reflects_four_percent() {
        let of = |ior| Material { ior, ..Material::default() }.dielectric_specular();
        assert_eq!(of(1.5), 0.04);
        assert!((of(1.500_001) - 0.04).abs() < 1e-6 && (of(2.0) - 1.0 / 9.0).abs() < 1e-6);
        assert_eq!(of(1.0), 0.0);
    }

    #[test]
    fn phong_reflects_its_own_specular_colour_and_no_more_than_it_receives() {
        let [base, specular] = [Vec3::new(0.9, 0.5, 0.1), Vec3::new(0.3, 0.2, 0.8)];
        let phong = Material { gloss: Gloss::Phong, metallic: 1.0, ..Material::matte("", base) };
        let surface = |material: &Material| material.surface(&[], [Vec2::ZERO; 2], Vec4::ONE);
        let own = surface(&Material { specular: Some(specular), ..phong.clone() });
        assert_eq!(own.specular, specular);
        assert_eq!(
            own.diffuse,
            Vec3::new(1.0 - 0.3, 0.5, 0.1),
            "all of the base colour that there is room for"
        );
        assert_eq!(surface(&phong).specular, base, "a metal");
        let microfacets = Material { gloss: Gloss::Microfacets, specular: Some(specular), ..phong };
        assert_eq!(surface(&microfacets).specular, base, "glTF's model knows metalness only");
        let bright = Material { specular: Some(Vec3::splat(7.0)), ..Material::default() };
        let bright = surface(&Material { gloss: Gloss::Phong, ..bright });
        assert_eq!((bright.diffuse, bright.specular), (Vec3::ZERO, Vec3::ONE));
    }
}
