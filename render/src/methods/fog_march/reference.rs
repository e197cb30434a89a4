//! Steps along view rays in plain Rust: `methods/fog_march/march.wgsl`.

use super::FogMarchParameters;
use crate::bvh::TracedScene;
use crate::methods::picture::every_pixel;
use crate::methods::single_scattering::{LitMedium, distances, mean_decay};
use crate::scene::Light;
use crate::screen::View;
use deepshade_shaders::{GBuffer, MissingAttribute, Planes, random};
use glam::Vec3;

/// Nearer to a lamp than this, metres, or than this part of its distance to the eye, it counts as that near.
const NEAREST: [f32; 2] = [1e-4, 1e-5];

/// How a view ray is cut: at equal distances, or at equal angles as seen from a lamp.
enum Cut {
    /// First distance and length of a step.
    Distances([f32; 2]),
    /// First angle and step; where the lamp is nearest, and how near, metres.
    Angles([f32; 2], [f32; 2]),
}

impl Cut {
    fn new(light: &Light, eye: Vec3, direction: Vec3, [enters, leaves]: [f32; 2], steps: u32) -> Self {
        let steps = steps as f32;
        let (Light::Point { position, .. } | Light::Spot { position, .. }) = *light else {
            return Self::Distances([enters, (leaves - enters) / steps]);
        };
        let offset = position - eye;
        let nearest = offset.dot(direction);
        let least = NEAREST[0].max(NEAREST[1] * offset.length());
        let aside = (offset - direction * nearest).length().max(least);
        let [first, last] = [enters, leaves].map(|distance| ((distance - nearest) / aside).atan());
        Self::Angles([first, (last - first) / steps], [nearest, aside])
    }

    /// The distance that is so many steps along.
    fn at(&self, steps: f32) -> f32 {
        match *self {
            Self::Distances([first, step]) => first + steps * step,
            Self::Angles([first, step], [nearest, aside]) => nearest + aside * (first + steps * step).tan(),
        }
    }

    /// The length that a step counts for which is lit at `at`.
    fn length(&self, [begins, at, ends]: [f32; 3]) -> f32 {
        match *self {
            Self::Distances(_) => ends - begins,
            Self::Angles([_, step], [nearest, aside]) => {
                let tangent = (at - nearest) / aside;
                aside * step * (1.0 + tangent * tangent)
            }
        }
    }

    /// How near its lamp is.
    const fn nearest(&self) -> f32 {
        match self {
            Self::Distances(_) => 0.0,
            Self::Angles(_, [_, aside]) => *aside,
        }
    }
}

/// The image, `[3, height, width]`; black without a medium.
///
/// # Errors
/// If the g-buffer lacks an attribute.
pub fn shade(
    gbuffer: &GBuffer,
    scene: &TracedScene,
    parameters: FogMarchParameters,
    view: &View,
) -> Result<Planes, MissingAttribute> {
    let (height, width) = (view.height, view.width);
    let distances = distances(gbuffer)?;
    let Some(lit) = LitMedium::of(scene) else { return Ok(Planes::filled(3, height, width, 0.0)) };
    let pixels = every_pixel(height, width, |at| {
        let reach = distances[at.y as usize * width + at.x as usize];
        let direction = view.camera.direction(at.as_vec2() + 0.5, height, width);
        let span @ [enters, leaves] = lit.medium.seen_span(view.camera.position, direction, reach);
        if leaves <= enters {
            return Vec3::ZERO;
        }
        let shift = random::random(at.x as u32, at.y as u32, view.seed, 0);
        let ray = Ray { eye: view.camera.position, direction, span, steps: parameters.steps, shift };
        lit.medium.scattering * lit.lights().iter().map(|light| ray.scattered(&lit, light)).sum::<Vec3>()
    });
    Ok(Planes::from_fn(3, height, width, |channel, y, x| pixels[y * width + x][channel]))
}

/// A ray from the eye through the medium.
pub struct Ray {
    /// Where it starts, world space.
    pub eye: Vec3,
    /// Unit vector.
    pub direction: Vec3,
    /// From which distance to which it is in the medium, metres.
    pub span: [f32; 2],
    /// How many steps are taken.
    pub steps: u32,
    /// Where in a step light is looked for, from 0 to 1.
    pub shift: f32,
}

impl Ray {
    /// Radiance from one lamp, over the scattering coefficient.
    pub fn scattered(&self, lit: &LitMedium<'_>, light: &Light) -> Vec3 {
        let Self { eye, direction, span: [enters, leaves], steps, shift } = *self;
        let cut = Cut::new(light, eye, direction, [enters, leaves], steps);
        let extinction = lit.medium.extinction();
        let (mut sum, mut before, mut begins) = (Vec3::ZERO, 0.0, enters);
        for i in 0..steps {
            let ends = if i + 1 == steps { leaves } else { cut.at(i as f32 + 1.0) };
            let at = cut.at(i as f32 + shift).max(begins).min(ends);
            let point = eye + direction * at;
            let density = lit.medium.density.inside(point);
            let here = density * (ends - begins);
            if here > 0.0 {
                let left = (-extinction * before).exp() * mean_decay(extinction * here);
                let weight = left * density * cut.length([begins, at, ends]);
                sum += weight * lit.scattered_of(light, point, direction, cut.nearest());
            }
            before += here;
            begins = ends;
        }
        sum
    }
}
