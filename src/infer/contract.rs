//! What can be seen of a g-buffer that is not what a network reads: camera space, y up, the camera looking
//! down -z, unit normals that face the camera.
//!
//! The thresholds let pass what is right and looks odd: the backs of leaves, normal maps, normals that were
//! averaged over an edge and so are shorter.

use super::projection::{self, Projection, Seen};
use super::space::vectors;
use deepshade_shaders::{Attribute, GBuffer, MissingAttribute};
use glam::{DVec2, Vec3};
use std::fmt;

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
/// By how much a length may differ from 1, and how many may differ by more; being averaged lengthens none.
const OFF_UNIT: f32 = 0.05;
const MOST_OFF_UNIT: f32 = 0.5;
const MOST_LONGER: f32 = 0.1;
/// The least cosine between a normal and the surface that the positions make, and how much may have less.
const ALONG: f32 = 0.7;
const MOST_ASKEW: f32 = 0.4;
/// By how much depth may differ from the positions', and how much of what is seen may differ by more.
const OFF_DEPTH: f32 = 0.05;
const MOST_OFF_DEPTH: f32 = 0.25;

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
    /// Normals are all within 0 to 1, and are unit ones if that stands for -1 to 1.
    UnsignedNormals,
    /// This share of the normals is not of length 1, and the median length.
    NotUnit(f32, f32),
    /// This share of the normals faces away from the eye.
    FacingAway(f32),
    /// This share of the normals does not stand on the surface that the positions make.
    OtherNormals(f32),
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
    /// Neither.
    Unknown,
}

impl Contradiction {
    /// Whether the image could not be right. Else it is worth a word.
    pub fn is_grave(&self) -> bool {
        !matches!(self, Self::FacingAway(share) if *share <= MOST_AWAY)
    }
}

impl fmt::Display for Contradiction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let percent = |share: f32| (100.0 * share).round();
        match *self {
            Self::LooksForward(share) => write!(
                f,
                "{} % of what is seen has a positive z, which is behind the camera: it looks like a camera \
                 that looks down +z (--forward z)",
                percent(share)
            ),
            Self::OtherSpace(share) => write!(
                f,
                "positions do not lie where their pixels see them, and {} % have a positive z, which is \
                 behind the camera: it looks like world space (--space world, with --camera FILE where the \
                 file has no `worldToCamera`)",
                percent(share)
            ),
            Self::UpsideDown => f.write_str("y grows downwards (--up -y)"),
            Self::Mirrored => f.write_str("x grows to the left: the image or its space is mirrored"),
            Self::UnsignedNormals => f.write_str(
                "no component of a normal is negative: it looks like normals of which 0 to 1 stands for -1 \
                 to 1 (--normals unsigned)",
            ),
            Self::NotUnit(share, median) => write!(
                f,
                "{} % of the normals are not of length 1, their median length is {median} \
                 (--normals normalised)",
                percent(share)
            ),
            Self::FacingAway(share) => write!(
                f,
                "{} % of the normals face away from the camera (--normals turned, where these are backs of \
                 surfaces)",
                percent(share)
            ),
            Self::OtherNormals(share) => write!(
                f,
                "{} % of the normals do not stand on the surface that the positions make: it looks like \
                 normals of another space than the positions'",
                percent(share)
            ),
            Self::Depth(ratio, DepthKind::OtherUnit) => {
                write!(f, "the layer `depth` is {ratio} times what the positions say: the units differ")
            }
            Self::Depth(_, DepthKind::Distance) => f.write_str(
                "the layer `depth` is the distance from the camera and not along its viewing direction, \
                 -position.Z",
            ),
            Self::Depth(ratio, DepthKind::Unknown) => {
                write!(f, "the layer `depth` is not -position.Z, in the middle {ratio} times that")
            }
        }
    }
}

/// In which ways a g-buffer contradicts what it should be, as far as its positions, normals and depth say. A
/// way that follows from another one is not named.
///
/// # Errors
/// If it has no `valid`.
pub fn contradictions(gbuffer: &GBuffer) -> Result<Vec<Contradiction>, MissingAttribute> {
    let seen: Vec<usize> =
        gbuffer.seen()?.iter().enumerate().filter(|(_, seen)| **seen).map(|(at, _)| at).collect();
    if seen.len() < FEWEST {
        return Ok(Vec::new());
    }
    let positions = vectors(gbuffer, Attribute::Position);
    let normals = vectors(gbuffer, Attribute::Normal);
    let mut found = positions.as_ref().map_or_else(Vec::new, |at| of_positions(gbuffer, at, &seen));
    let of_their_own = normals.as_ref().and_then(|normals| of_normals(normals, &seen));
    found.extend(of_their_own);
    // What follows is only sound where space and normals are right as such.
    if let (true, Some(positions)) = (found.is_empty(), &positions) {
        found.extend(normals.and_then(|normals| of_both(gbuffer, positions, &normals, &seen)));
        found.extend(of_depth(gbuffer, positions, &seen));
    }
    Ok(found)
}

/// How positions fall on their pixels.
pub fn projection(width: usize, height: usize, positions: &[Vec3], seen: &[usize]) -> Option<Projection> {
    let middle = 0.5 * DVec2::new(width as f64 - 1.0, height as f64 - 1.0);
    let pixel = |at: usize| {
        let (column, row) = ((at % width) as f64, (at / width) as f64);
        DVec2::new(column - middle.x, middle.y - row)
    };
    let points = seen.iter().map(|at| Seen { pixel: pixel(*at), point: positions[*at].as_dvec3() });
    projection::of(&points.collect::<Vec<_>>())
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

fn of_normals(normals: &[Vec3], seen: &[usize]) -> Option<Contradiction> {
    let is_off = |normal: Vec3| (normal.length() - 1.0).abs() > OFF_UNIT;
    let is_unsigned = |normal: Vec3| {
        normal.min_element() >= 0.0 && normal.max_element() <= 1.0 && !is_off(2.0 * normal - 1.0)
    };
    let off = share(seen, |at| is_off(normals[at]));
    if off > MOST_OFF_UNIT && share(seen, |at| is_unsigned(normals[at])) > 0.5 {
        return Some(Contradiction::UnsignedNormals);
    }
    let longer = share(seen, |at| normals[at].length() > 1.0 + OFF_UNIT);
    let lengths = || median(seen.iter().map(|at| normals[*at].length()).collect());
    (off > MOST_OFF_UNIT || longer > MOST_LONGER).then(|| Contradiction::NotUnit(off, lengths()))
}

fn of_both(gbuffer: &GBuffer, positions: &[Vec3], normals: &[Vec3], seen: &[usize]) -> Option<Contradiction> {
    let cosine = |at: usize| normals[at].normalize_or_zero().dot(positions[at].normalize_or_zero());
    let away = share(seen, |at| cosine(at) > AWAY);
    if away > MOST_AWAY {
        return Some(Contradiction::FacingAway(away));
    }
    let surfaces: Vec<(usize, Vec3)> =
        seen.iter().filter_map(|at| Some((*at, surface(gbuffer, positions, *at)?))).collect();
    let askew = |(at, surface): &&(usize, Vec3)| normals[*at].normalize_or_zero().dot(*surface).abs() < ALONG;
    let share = surfaces.iter().filter(askew).count() as f32 / surfaces.len().max(1) as f32;
    if surfaces.len() >= FEWEST.max(seen.len() / 20) && share > MOST_ASKEW {
        return Some(Contradiction::OtherNormals(share));
    }
    (away > SOME_AWAY).then_some(Contradiction::FacingAway(away))
}

/// The unit normal of the surface that positions make around a pixel, of either sign; none where they make
/// none.
fn surface(gbuffer: &GBuffer, positions: &[Vec3], at: usize) -> Option<Vec3> {
    let (width, height) = (gbuffer.width(), gbuffer.height());
    let (x, y) = (at % width, at / width);
    if x == 0 || y == 0 || x + 1 == width || y + 1 == height {
        return None;
    }
    // Across an edge, or where numbers are too coarse, the middle one is not between the others.
    let step = |before: usize, after: usize| {
        let step = positions[after] - positions[before];
        let bend = positions[after] + positions[before] - 2.0 * positions[at];
        (bend.length() < 0.1 * step.length()).then_some(step)
    };
    step(at - 1, at + 1)?.cross(step(at - width, at + width)?).try_normalize()
}

fn of_depth(gbuffer: &GBuffer, positions: &[Vec3], seen: &[usize]) -> Option<Contradiction> {
    let depth = gbuffer.planes().plane(gbuffer.first_plane(Attribute::Depth).ok()?);
    let seen: Vec<usize> =
        seen.iter().copied().filter(|at| positions[*at].z < 0.0 && depth[*at] != 0.0).collect();
    if seen.len() < FEWEST {
        return None;
    }
    let ratio = |at: usize| depth[at] / -positions[at].z;
    if share(&seen, |at| (ratio(at) - 1.0).abs() > OFF_DEPTH) <= MOST_OFF_DEPTH {
        return None;
    }
    let middle = median(seen.iter().map(|at| ratio(*at)).collect());
    let is_mostly = |agrees: &dyn Fn(usize) -> bool| share(&seen, agrees) > 1.0 - MOST_OFF_DEPTH;
    let kind = if is_mostly(&|at| (ratio(at) / middle - 1.0).abs() < 0.02) {
        DepthKind::OtherUnit
    } else if is_mostly(&|at| (depth[at] / positions[at].length() - 1.0).abs() < 0.02) {
        DepthKind::Distance
    } else {
        DepthKind::Unknown
    };
    Some(Contradiction::Depth(middle, kind))
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
