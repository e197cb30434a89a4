//! What of a surface keeps light: a paint, and images of what each place of it has of the paint's numbers.

use crate::scene::{Mesh, Texture};
use deepshade_glow::paint::{Paint, PaintFactors};
use glam::Vec2;
use std::borrow::Cow;
use std::sync::Arc;

/// The paint of a scene's materials of one name.
#[derive(Clone, Debug, PartialEq)]
pub struct GlowSurface {
    /// The material that has it, by [its own](crate::scene::Scene::material_names) name, or the one of
    /// several, which means all of these that are not named themselves; all others without one.
    pub material: Option<String>,
    /// The paint.
    pub paint: Paint,
    /// What of it each place has.
    pub textures: PaintTextures,
}

/// Images, by a mesh's first texture coordinates, whose colours are what a place has of a paint's numbers;
/// all of them where there is none.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PaintTextures {
    /// Of the excitation rate by each colour.
    pub excitation: Option<Arc<Texture>>,
    /// Of the re-radiation rate: the image's red.
    pub decay: Option<Arc<Texture>>,
    /// Of what is given back: a colour, or a grey that says how much of the paint there is.
    pub emission: Option<Arc<Texture>>,
}

impl GlowSurface {
    /// A paint that is alike everywhere.
    pub fn new(material: Option<&str>, paint: Paint) -> Self {
        Self { material: material.map(str::to_owned), paint, textures: PaintTextures::default() }
    }

    /// The paint at a point of a triangle.
    pub fn paint_at(&self, mesh: &Mesh, triangle: usize, weights: [f32; 3]) -> Cow<'_, Paint> {
        match self.textures.factors(mesh, triangle, weights) {
            Some(factors) => Cow::Owned(self.paint.scaled(&factors)),
            None => Cow::Borrowed(&self.paint),
        }
    }
}

impl PaintTextures {
    /// Whether there is any.
    pub const fn is_any(&self) -> bool {
        self.excitation.is_some() || self.decay.is_some() || self.emission.is_some()
    }

    /// What a point of a triangle has of a paint; none where all of it is alike.
    pub fn factors(&self, mesh: &Mesh, triangle: usize, weights: [f32; 3]) -> Option<PaintFactors> {
        if !self.is_any() {
            return None;
        }
        let of_corner = |vertex: u32| mesh.uvs[0].get(vertex as usize).copied().unwrap_or(Vec2::ZERO);
        let corners = mesh.triangles[triangle].map(of_corner).into_iter().zip(weights);
        let uv: Vec2 = corners.map(|(uv, weight)| uv * weight).sum();
        let colour =
            |texture: &Option<Arc<Texture>>| texture.as_ref().map(|texture| texture.sample(uv).truncate());
        Some(PaintFactors {
            excitation: colour(&self.excitation).unwrap_or(PaintFactors::ONE.excitation),
            decay: colour(&self.decay).map_or(PaintFactors::ONE.decay, |colour| colour.x),
            emission: colour(&self.emission).unwrap_or(PaintFactors::ONE.emission),
        })
    }
}
