//! Where a g-buffer shows no surface without saying so by what [`deepshade_render::exr_file`] knows: normals
//! of no length, and numbers by which a renderer means the sky.
//!
//! Renderers have such numbers of their own: -1, the distance of the far plane, 1e5 or 1e8. One is told by
//! what no surface does: it fills much of the image, and lies far beyond all else or behind the camera.

use super::normals;
use super::space::vectors;
use deepshade_shaders::{Attribute, GBuffer, MissingAttribute};
use glam::Vec3;
use std::fmt;

/// The least share of the image that a sky fills: one of so many pixels.
const ONE_OF: usize = 100;
/// How many times further away it is than all else, and by how much its own numbers may differ.
const BEYOND: f32 = 100.0;
const SAME: f32 = 1.001;
/// The fewest pixels that must show something else.
const FEWEST: usize = 16;

/// What was taken for the sky.
#[derive(Clone, Debug, PartialEq)]
pub struct Sky {
    /// What holds the number.
    pub layer: &'static str,
    /// The number.
    pub value: f32,
    /// The share of the image that has it, 0 to 1.
    pub share: f32,
}

impl fmt::Display for Sky {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { layer, value, share } = self;
        let percent = (1000.0 * share).round() / 10.0;
        write!(f, "no surface is taken to be seen where {layer} is {value}, {percent} % of the image")
    }
}

/// The g-buffer, which has `valid`, with nothing seen where normals that are read have no length.
///
/// # Errors
/// If it has no `valid`.
pub fn without_normals_of_no_length(
    gbuffer: GBuffer,
    read: &[Attribute],
) -> Result<GBuffer, MissingAttribute> {
    let layers = normals::LAYERS.into_iter().filter(|layer| read.contains(layer));
    let normals: Vec<Vec<Vec3>> = layers.filter_map(|layer| vectors(&gbuffer, layer)).collect();
    let seen = seen(&gbuffer)?;
    let is_none = |at: &usize| normals.iter().any(|normals| normals[*at] == Vec3::ZERO);
    Ok(cleared(gbuffer, &seen.into_iter().filter(is_none).collect::<Vec<_>>()))
}

/// The g-buffer, which has `valid`, with nothing seen where depth or position hold a number that stands for
/// the sky, and what that was. `sign_before` is the sign of z before the camera, if it is known.
///
/// # Errors
/// If it has no `valid`.
pub fn without_sky(
    mut gbuffer: GBuffer,
    sign_before: Option<f32>,
) -> Result<(GBuffer, Vec<Sky>), MissingAttribute> {
    let mut skies = Vec::new();
    for found in [in_depth, of_z, of_distance, behind] {
        let seen = seen(&gbuffer)?;
        if let Some((layer, value, pixels)) = found(&gbuffer, &seen, sign_before) {
            skies.push(Sky { layer, value, share: pixels.len() as f32 / gbuffer.planes().pixels() as f32 });
            gbuffer = cleared(gbuffer, &pixels);
        }
    }
    Ok((gbuffer, skies))
}

/// A layer, the number in it, and where it is.
type Found = (&'static str, f32, Vec<usize>);

/// A sky by its depth: far beyond all else, or not before the camera.
fn in_depth(gbuffer: &GBuffer, seen: &[usize], _: Option<f32>) -> Option<Found> {
    let depth = gbuffer.planes().plane(gbuffer.first_plane(Attribute::Depth).ok()?);
    // What is seen through, such as glass, may have a position and no depth.
    let has_positions = gbuffer.attributes().contains(&Attribute::Position);
    let is_behind = |depth: &f32| *depth < 0.0 || *depth == 0.0 && !has_positions;
    let pixels =
        far(gbuffer, seen, |at| depth[at]).or_else(|| constant(gbuffer, seen, |at| depth[at], is_behind))?;
    Some(("`depth`", depth[pixels[0]], pixels))
}

/// A sky whose points lie on a plane far away.
fn of_z(gbuffer: &GBuffer, seen: &[usize], _: Option<f32>) -> Option<Found> {
    let positions = vectors(gbuffer, Attribute::Position)?;
    let pixels = far(gbuffer, seen, |at| positions[at].z)?;
    Some(("`position.Z`", positions[pixels[0]].z, pixels))
}

/// A sky whose points lie on a sphere far away.
fn of_distance(gbuffer: &GBuffer, seen: &[usize], _: Option<f32>) -> Option<Found> {
    let positions = vectors(gbuffer, Attribute::Position)?;
    let pixels = far(gbuffer, seen, |at| positions[at].length())?;
    Some(("the length of `position`", positions[pixels[0]].length(), pixels))
}

/// A sky that is one point, not before the camera.
fn behind(gbuffer: &GBuffer, seen: &[usize], sign_before: Option<f32>) -> Option<Found> {
    let (positions, sign) = (vectors(gbuffer, Attribute::Position)?, sign_before?);
    let pixels = constant(gbuffer, seen, |at| positions[at], |position| sign * position.z <= 0.0)?;
    Some(("`position.Z`", positions[pixels[0]].z, pixels))
}

/// The pixels of the largest number, if it fills much of the image and all else is far below.
fn far(gbuffer: &GBuffer, seen: &[usize], value: impl Fn(usize) -> f32) -> Option<Vec<usize>> {
    let largest = seen.iter().map(|at| value(*at).abs()).fold(0.0, f32::max);
    let (far, near): (Vec<usize>, Vec<usize>) =
        seen.iter().partition(|at| value(**at).abs() >= largest / SAME);
    let next = near.iter().map(|at| value(*at).abs()).fold(0.0, f32::max);
    // All of one sign: a world has its distances on all sides.
    let sign = value(*far.first()?).signum();
    let is_one = far.iter().all(|at| value(*at).signum() == sign);
    (is_one && next > 0.0 && largest >= BEYOND * next && is_much(gbuffer, &far, &near)).then_some(far)
}

/// The pixels whose values are not before the camera, if they are all the same and fill much of the image.
fn constant<T: PartialEq>(
    gbuffer: &GBuffer,
    seen: &[usize],
    value: impl Fn(usize) -> T,
    is_behind: impl Fn(&T) -> bool,
) -> Option<Vec<usize>> {
    let (behind, before): (Vec<usize>, Vec<usize>) = seen.iter().partition(|at| is_behind(&value(**at)));
    let first = value(*behind.first()?);
    let is_one = behind.iter().all(|at| value(*at) == first);
    (is_one && is_much(gbuffer, &behind, &before)).then_some(behind)
}

fn is_much(gbuffer: &GBuffer, sky: &[usize], rest: &[usize]) -> bool {
    sky.len() * ONE_OF > gbuffer.planes().pixels() && rest.len() >= FEWEST
}

fn seen(gbuffer: &GBuffer) -> Result<Vec<usize>, MissingAttribute> {
    let seen = gbuffer.seen()?;
    Ok((0..seen.len()).filter(|at| seen[*at]).collect())
}

/// The g-buffer with all channels 0 at some pixels.
fn cleared(gbuffer: GBuffer, pixels: &[usize]) -> GBuffer {
    let mut planes = gbuffer.planes().clone();
    for channel in 0..planes.channels() {
        pixels.iter().for_each(|at| planes.plane_mut(channel)[*at] = 0.0);
    }
    GBuffer::new(gbuffer.attributes().to_vec(), planes)
}

#[cfg(test)]
mod tests;
