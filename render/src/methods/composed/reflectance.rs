//! What surfaces reflect to the eye of light that comes from everywhere alike, in plain Rust:
//! `shaders/wgsl/methods/composed/reflectance.wgsl`.

use super::lamps::of_microfacets;
use crate::path::bsdf::directional_albedo;
use crate::scene::Scene;
use crate::screen::surface::vector;
use deepshade_shaders::{Attribute, GBuffer, MissingAttribute, Planes};
use glam::IVec2;

/// The share of each colour, `[3, height, width]`.
///
/// # Errors
/// If the g-buffer lacks an attribute.
pub fn image(gbuffer: &GBuffer, scene: &Scene) -> Result<Planes, MissingAttribute> {
    let of = |attribute| gbuffer.select(&[attribute]);
    let (position, normal) = (of(Attribute::Position)?, of(Attribute::Normal)?);
    let (diffuse, specular) = (of(Attribute::Diffuse)?, of(Attribute::Specular)?);
    let (glossiness, ids) = (of(Attribute::Glossiness)?, of(Attribute::ObjectId)?);
    let objects = of_microfacets(scene);
    Ok(Planes::from_fn(3, gbuffer.height(), gbuffer.width(), |c, y, x| {
        let at = IVec2::new(x as i32, y as i32);
        let (diffuse, specular) = (vector(&diffuse, at), vector(&specular, at));
        if objects[(ids.at(0, y, x) as usize).min(objects.len() - 1)] == 0 {
            return (diffuse + specular)[c];
        }
        let cosine = -vector(&normal, at).dot(vector(&position, at).normalize_or_zero());
        let roughness = 1.0 - glossiness.at(0, y, x);
        directional_albedo(diffuse, specular, roughness, cosine.clamp(0.0, 1.0))[c]
    }))
}
