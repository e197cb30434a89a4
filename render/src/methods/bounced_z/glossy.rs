//! Glossy indirect light by a bounced z-buffer: what a surface's specular lobe reflects to the eye of what the nearest
//! surfels send. Directions are spread as the lobe's visible microfacets mirror the eye's.

use super::indirect::Indirect;
use super::technique::{Reflectors, Shaders};
use super::{BouncedEffect, BouncedZ};
use crate::methods::Surface;
use crate::methods::lobe::{self, Gloss, Lobe};
use crate::screen::Compiled;
use crate::surfels::Lit;
use crate::surfels::reference::Disk;
use deepshade_shaders::wgsl;
use deepshade_shaders::{Attribute, Effect, GBuffer, MissingAttribute};
use glam::Vec3;

/// The effect.
#[derive(Clone, Copy, Debug)]
pub struct Glossy;

/// The method, compiled for a device.
pub type BouncedGlossy = Compiled<BouncedZ<Glossy>>;

impl BouncedEffect for Glossy {
    const EFFECT: Effect = Effect::Glossy;
    const ATTRIBUTES: &'static [Attribute] = lobe::ATTRIBUTES;
    const LIT: Option<Lit> = Some(Lit::Reflected);
    type Reflector = Lobe;

    fn shaders() -> Shaders {
        Shaders {
            trace: &wgsl::BOUNCED_GLOSSY_TRACE,
            arrive: &wgsl::BOUNCED_LIGHT,
            filter: &wgsl::BOUNCED_GLOSSY_FILTER,
        }
    }

    fn reflectors<'a>(
        gbuffer: &GBuffer,
        surface: &'a Surface,
    ) -> Result<Reflectors<'a, Lobe>, MissingAttribute> {
        let gloss = Gloss::of(gbuffer)?;
        Ok(Box::new(move |at| gloss.lobe_at(surface, at).filter(|lobe| lobe.usual_colour() != Vec3::ZERO)))
    }

    fn arriving(met: Option<&Disk>, direction: Vec3) -> Vec3 {
        Indirect::arriving(met, direction)
    }
}
