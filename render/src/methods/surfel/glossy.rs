//! Glossy indirect light by surfels (thesis 4.3): what a surface's specular lobe reflects to the eye of what
//! surfels send.
//!
//! A surfel that stands for many is one direction where there are many, and as bright as all of them: a lobe
//! that is narrower than what the surfel stands for looks large would be noise. It is made so much wider
//! ([`WIDER`]), so that mirrors show surfels as blurred as they are coarse.
//!
//! What is blurred is light as a white surface would reflect it; it gets its colour afterwards. So colours
//! stay sharp, and what is matte darkens nothing beside it; pixels whose bent normal faces away from the eye
//! do. Roughness and normals that change within a plane are smeared.

use super::around::Ending;
use super::reference::{Receiver, Shade, facing, sent};
use super::{SurfelParameters, passes::Shading, reference};
use crate::methods::disks::{DiskEffect, Plain};
use crate::methods::lobe::{self, Gloss, Lobe};
use crate::surfels::reference::Disk;
use crate::surfels::{SurfelLight, Tree};
use deepshade_shaders::wgsl::Shader;
use deepshade_shaders::{Effect, MissingAttribute, Planes};
use glam::Vec3;
use std::f32::consts::PI;

/// What is added to alpha squared, over the squared angle of the radius that a surfel stands for: the
/// variance of an even disk is a fourth of its radius squared, facets turn half as far as what they mirror,
/// and alpha squared is twice a variance.
const WIDER: f32 = 0.125;

/// The effect `glossy`.
pub const GLOSSY: DiskEffect<SurfelParameters> = DiskEffect {
    effect: Effect::Glossy,
    attributes: lobe::ATTRIBUTES,
    lit: Some(SurfelLight::Reflected),
    passes: Shading {
        tree: Tree::Lit,
        splat: Shader::at("methods/surfel/glossy"),
        add: Shader::at("methods/surfel/indirect"),
        channels: 3,
        ending: Ending::Reflected,
    },
    plain,
    on_processor: None,
};

/// The image in plain Rust.
fn plain(plain: &Plain<'_, SurfelParameters>, disks: &[Disk]) -> Result<Planes, MissingAttribute> {
    let Plain { gbuffer, surface, parameters, view, .. } = *plain;
    let gloss = Gloss::of(gbuffer)?;
    let reach = |at| gloss.lobe_at(surface, at).map_or(0.0, |_| f32::INFINITY);
    let reflects = |disk: &Disk, stands_for: f32, way: Vec3, receiver: Receiver| {
        let facing = facing(way, disk);
        let Some(lobe) = gloss.lobe_at(surface, receiver.pixel).filter(|_| facing > 0.0) else {
            return [0.0; 3];
        };
        let (squared, area) = (way.length_squared(), disk.radius * disk.radius);
        let lobe = lobe.widened(WIDER * area * stands_for / squared);
        let light = way / squared.sqrt();
        let seen = PI * area * facing / (squared.sqrt() * (squared + area));
        let reflected = lobe.density(light) * lobe.visibility(light) * tint(&lobe, light);
        (sent(way, disk) * reflected * seen).to_array()
    };
    let shade = Shade { reach: &reach, of: &reflects };
    let white = reference::sums(surface, disks, shade, parameters, view);
    Ok(surface.image(0.0, |at| {
        let colour = gloss.lobe_at(surface, at).map_or(Vec3::ZERO, |lobe| lobe.usual_colour());
        std::array::from_fn::<f32, 3, _>(|c| colour[c] * white.at(c, at.y as usize, at.x as usize))
    }))
}

/// By how much more of light from a direction is reflected than where facets lie flat; of what is black as
/// much.
fn tint(lobe: &Lobe, light: Vec3) -> Vec3 {
    let (colour, usual) = (lobe.colour(light), lobe.usual_colour());
    Vec3::from_array(std::array::from_fn(|c| if usual[c] > 0.0 { colour[c] / usual[c] } else { 1.0 }))
}
