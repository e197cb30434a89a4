//! What can be seen of a g-buffer that is not what a network reads: camera space, y up, the camera looking
//! down -z, unit normals that face the camera.
//!
//! The thresholds let pass what is right and looks odd: the backs of leaves, normal maps, normals that were
//! averaged over an edge and so are shorter.

mod depths;
mod normals;
mod rotation;
mod told;
mod world;

use super::projection::{self, ProjectedPoint, Projection};
use super::space::vectors;
use deepshade_shaders::{Attribute, GBuffer, MissingAttribute};
use glam::{DVec2, Vec3};

/// The fewest pixels that say something.
const FEWEST: usize = 16;
/// The most of what is seen that may lie behind the camera.
const BEHIND: f32 = 0.1;
/// The least of the spread of directions that columns and rows must explain.
const EXPLAINED: f64 = 0.95;
/// Cosine between normal and direction from the eye above which a normal is one that faces away, and how
/// much of what is seen may have such ones, without a word and with one.
const AWAY: f32 = 0.1;
const SOME_AWAY: f32 = 0.2;
const MOST_AWAY: f32 = 0.6;

/// A way in which a g-buffer is not what it should be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Contradiction {
    /// Much of what is seen has a positive z, and would be where it is seen if z pointed forward.
    LooksForward(f32),
    /// Much of what is seen has a positive z, or positions do not fall on their pixels at all.
    OtherSpace(f32),
    /// y grows downwards.
    UpsideDown,
    /// x grows to the left.
    Mirrored,
    /// The normals of this layer are all within 0 to 1, and are unit ones if that stands for -1 to 1.
    UnsignedNormals(Attribute),
    /// This share of the vectors of this layer is not of length 1, and the median length.
    NotUnit(Attribute, f32, f32),
    /// This share of the normals faces away from the eye.
    FacingAway(f32),
    /// Normals stand on the surface that the positions make once these axes of theirs are reversed.
    Reversed([bool; 3]),
    /// This share of the normals does not stand on the surface that the positions make.
    OtherNormals(f32),
    /// Normals stand on the surface that the positions make once all are turned by so many degrees.
    Turned(f32),
    /// This share of pairs of pixels has another angle between world normals than between normals.
    OtherWorldNormals(f32),
    /// World normals are those of a mirrored scene.
    MirroredWorldNormals,
    /// Directions to the camera are those from the camera.
    FromCamera,
    /// Depth is not what the positions say: their median ratio, and what depth seems to be.
    Depth(f32, DepthKind),
}

/// What a depth seems to be that is not the positions'.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DepthKind {
    /// Depth in another unit.
    OtherUnit,
    /// Distance from the eye.
    Distance,
    /// z in camera space, negative before the camera.
    Negative,
    /// What a rasteriser's depth buffer holds, from 0 to 1.
    Buffer,
    /// None of these.
    Unknown,
}

impl Contradiction {
    /// Whether the image could not be right, for a network that reads some attributes. Else it is worth a
    /// word.
    pub fn is_grave(&self, read: &[Attribute]) -> bool {
        match self {
            Self::FacingAway(share) => *share > MOST_AWAY,
            // A depth that nobody reads does no harm. Nor does a unit that only such positions have.
            Self::Depth(_, DepthKind::OtherUnit) => {
                read.contains(&Attribute::Depth) && read.contains(&Attribute::Position)
            }
            Self::Depth(..) => read.contains(&Attribute::Depth),
            _ => true,
        }
    }
}

/// In which ways a g-buffer contradicts what it should be, as far as its positions, normals, depth and
/// directions to the camera say. A way that follows from another one is not named. Of what is there and not
/// among what the network reads, only what tells of that is.
///
/// # Errors
/// If it has no `valid`.
pub fn contradictions(gbuffer: &GBuffer, read: &[Attribute]) -> Result<Vec<Contradiction>, MissingAttribute> {
    let seen: Vec<usize> =
        gbuffer.seen()?.iter().enumerate().filter(|(_, seen)| **seen).map(|(at, _)| at).collect();
    if seen.len() < FEWEST {
        return Ok(Vec::new());
    }
    let reads = |attribute: Attribute| read.contains(&attribute);
    let there = vectors(gbuffer, Attribute::Normal);
    let normals = there.clone().filter(|_| reads(Attribute::Normal));
    let (mut found, positions) = of_space(gbuffer, normals.as_deref(), &seen, reads(Attribute::Position));
    let of_their_own = [Attribute::Normal, Attribute::WorldNormal, Attribute::ToCamera].map(|attribute| {
        let values = vectors(gbuffer, attribute).filter(|_| reads(attribute))?;
        normals::of_lengths(attribute, &values, &seen)
    });
    found.extend(of_their_own.into_iter().flatten());
    // What follows is only sound where space and normals are right as such.
    if !found.is_empty() {
        return Ok(found);
    }
    if let Some(normals) = &normals {
        found.extend(match &positions {
            Some(positions) => normals::of_both(gbuffer, positions, normals, &seen),
            None => normals::of_camera(normals, &seen),
        });
    }
    if reads(Attribute::Position) || reads(Attribute::Depth) {
        found.extend(depths::of_depth(gbuffer, positions.as_deref(), &seen));
    }
    if let Some(world) = vectors(gbuffer, Attribute::WorldNormal).filter(|_| reads(Attribute::WorldNormal)) {
        let to_camera = vectors(gbuffer, Attribute::ToCamera).filter(|_| reads(Attribute::ToCamera));
        found
            .extend(to_camera.and_then(|to_camera| world::of_directions(gbuffer, &world, &to_camera, &seen)));
        found.extend(there.and_then(|normals| world::of_both(&normals, &world, &seen)));
    }
    Ok(found)
}

/// What contradicts camera space, and the positions if they do not. Positions that nobody reads may be in
/// whatever space, unless normals that are read are in that space, too.
fn of_space(
    gbuffer: &GBuffer,
    normals: Option<&[Vec3]>,
    seen: &[usize],
    is_read: bool,
) -> (Vec<Contradiction>, Option<Vec<Vec3>>) {
    let Some(positions) = vectors(gbuffer, Attribute::Position) else { return (Vec::new(), None) };
    let found = of_positions(gbuffer, &positions, seen);
    if found.is_empty() {
        return (found, Some(positions));
    }
    let are_alike = || normals.is_some_and(|normals| normals::stand_on(gbuffer, &positions, normals, seen));
    if is_read || are_alike() { (found, None) } else { (Vec::new(), None) }
}

/// How positions fall on their pixels.
pub fn projection(width: usize, height: usize, positions: &[Vec3], seen: &[usize]) -> Option<Projection> {
    let points = seen
        .iter()
        .map(|at| ProjectedPoint { pixel: pixel(width, height, *at), point: positions[*at].as_dvec3() });
    projection::of(&points.collect::<Vec<_>>())
}

/// Column and row of a pixel, from the middle of the image, the row upwards.
fn pixel(width: usize, height: usize, at: usize) -> DVec2 {
    let middle = 0.5 * DVec2::new(width as f64 - 1.0, height as f64 - 1.0);
    DVec2::new((at % width) as f64 - middle.x, middle.y - (at / width) as f64)
}

/// Whether positions do not contradict camera space.
pub fn is_in_camera_space(gbuffer: &GBuffer, positions: &[Vec3]) -> bool {
    let seen = gbuffer.seen().unwrap_or_default();
    let seen: Vec<usize> = (0..seen.len()).filter(|at| seen[*at]).collect();
    seen.is_empty() || of_positions(gbuffer, positions, &seen).is_empty()
}

fn of_positions(gbuffer: &GBuffer, positions: &[Vec3], seen: &[usize]) -> Vec<Contradiction> {
    let behind = share(seen, |at| positions[at].z > 0.0);
    let fits = |positions: &[Vec3]| projection(gbuffer.width(), gbuffer.height(), positions, seen);
    let is_right = |fit: &Option<Projection>| fit.is_some_and(|fit| fit.explained >= EXPLAINED);
    if behind > BEHIND {
        let turned: Vec<Vec3> = positions.iter().map(|at| Vec3::new(at.x, at.y, -at.z)).collect();
        let looks_forward = behind > 1.0 - BEHIND && is_right(&fits(&turned));
        return vec![match looks_forward {
            true => Contradiction::LooksForward(behind),
            false => Contradiction::OtherSpace(behind),
        }];
    }
    let fit = fits(positions);
    let Some(Projection { mirrored, upside_down, .. }) = fit else { return Vec::new() };
    if !is_right(&fit) {
        return vec![Contradiction::OtherSpace(behind)];
    }
    let ways = [(upside_down, Contradiction::UpsideDown), (mirrored, Contradiction::Mirrored)];
    ways.into_iter().filter(|(is_so, _)| *is_so).map(|(_, way)| way).collect()
}

fn share(seen: &[usize], is_so: impl Fn(usize) -> bool) -> f32 {
    seen.iter().filter(|at| is_so(**at)).count() as f32 / seen.len() as f32
}

fn median(mut values: Vec<f32>) -> f32 {
    values.sort_unstable_by(f32::total_cmp);
    values[values.len() / 2]
}

#[cfg(test)]
mod tests;
