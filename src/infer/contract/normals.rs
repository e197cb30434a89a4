//! What contradicts normals: their lengths, the eye, and the surface that positions make.

use super::rotation;
use super::{AWAY, Contradiction, FEWEST, SOME_AWAY, median, share};
use deepshade_shaders::{Attribute, GBuffer};
use glam::Vec3;

/// By how much a length may differ from 1, and how many may differ by more; being averaged lengthens none.
const OFF_UNIT: f32 = 0.05;
const MOST_OFF_UNIT: f32 = 0.5;
const MOST_LONGER: f32 = 0.1;
/// The least cosine between a normal and the surface that the positions make, and how much may have less.
const ALONG: f32 = 0.7;
const MOST_ASKEW: f32 = 0.4;
/// How much of the surface normals must stand on for their axes to be named, by how much their mean cosine
/// must exceed that of the normals as they are, and what two means may differ by that say the same.
const NAMED: f32 = 0.75;
const BETTER: f32 = 0.05;
const ALIKE: f32 = 0.005;
/// By how much a rotation must raise the mean cosine to be told: that of some fourteen degrees about an axis.
const TURNED: f32 = 0.02;
/// Which axes may be reversed, the fewest first. The first are none and the last are all.
const REVERSED: [[bool; 3]; 8] = [
    [false, false, false],
    [true, false, false],
    [false, true, false],
    [false, false, true],
    [true, true, false],
    [true, false, true],
    [false, true, true],
    [true, true, true],
];

/// A normal and, of unit length and towards the camera, that of the surface which positions make there.
type Pair = (Vec3, Vec3);

/// What vectors of a layer are that are not unit ones.
pub fn of_lengths(attribute: Attribute, vectors: &[Vec3], seen: &[usize]) -> Option<Contradiction> {
    let is_off = |vector: Vec3| (vector.length() - 1.0).abs() > OFF_UNIT;
    let is_unsigned = |vector: Vec3| {
        vector.min_element() >= 0.0 && vector.max_element() <= 1.0 && !is_off(2.0 * vector - 1.0)
    };
    let off = share(seen, |at| is_off(vectors[at]));
    if off > MOST_OFF_UNIT && share(seen, |at| is_unsigned(vectors[at])) > 0.5 {
        return Some(Contradiction::UnsignedNormals(attribute));
    }
    let longer = share(seen, |at| vectors[at].length() > 1.0 + OFF_UNIT);
    let lengths = || median(seen.iter().map(|at| vectors[*at].length()).collect());
    (off > MOST_OFF_UNIT || longer > MOST_LONGER).then(|| Contradiction::NotUnit(attribute, off, lengths()))
}

/// What contradicts normals in camera space without positions: few surfaces that are seen point away from
/// the viewing direction, and only towards the border of the image.
pub fn of_camera(normals: &[Vec3], seen: &[usize]) -> Option<Contradiction> {
    let away = share(seen, |at| normals[at].normalize_or_zero().z < -AWAY);
    (away > SOME_AWAY).then_some(Contradiction::FacingAway(away))
}

/// What contradicts normals where positions are right.
pub fn of_both(
    gbuffer: &GBuffer,
    positions: &[Vec3],
    normals: &[Vec3],
    seen: &[usize],
) -> Option<Contradiction> {
    let cosine = |at: usize| normals[at].normalize_or_zero().dot(positions[at].normalize_or_zero());
    let away = share(seen, |at| cosine(at) > AWAY);
    let pairs = pairs(gbuffer, positions, normals, seen);
    if let Some(axes) = reversed(&pairs) {
        return Some(Contradiction::Reversed(axes));
    }
    let askew = 1.0 - along(&pairs);
    if !pairs.is_empty() && askew > MOST_ASKEW {
        return Some(Contradiction::OtherNormals(askew));
    }
    if away > SOME_AWAY {
        return Some(Contradiction::FacingAway(away));
    }
    turned(&pairs).map(Contradiction::Turned)
}

/// By how many degrees all normals must be turned to stand on their surface, where that takes most of what
/// they are off it. Relief, soft edges and rounding are off in all directions, so that no rotation does.
fn turned(pairs: &[Pair]) -> Option<f32> {
    let rotation = rotation::nearest(pairs)?;
    let mean = pairs.iter().map(|(normal, surface)| normal.dot(*surface)).sum::<f32>() / pairs.len() as f32;
    let explained = rotation.mean_cosine - mean;
    (explained > TURNED && explained > 0.5 * (1.0 - mean)).then_some(rotation.degrees)
}

/// Whether most normals stand on the surface that positions make, in whatever space both are.
pub fn stand_on(gbuffer: &GBuffer, positions: &[Vec3], normals: &[Vec3], seen: &[usize]) -> bool {
    along(&pairs(gbuffer, positions, normals, seen)) >= NAMED
}

/// Normals and surfaces wherever positions make one; none at all where that is too little to judge by.
fn pairs(gbuffer: &GBuffer, positions: &[Vec3], normals: &[Vec3], seen: &[usize]) -> Vec<Pair> {
    let pair = |at: &usize| {
        let surface = surface(gbuffer, positions, *at)?;
        let towards = if surface.dot(positions[*at]) > 0.0 { -surface } else { surface };
        Some((normals[*at].normalize_or_zero(), towards))
    };
    let pairs: Vec<Pair> = seen.iter().filter_map(pair).collect();
    if pairs.len() >= FEWEST.max(seen.len() / 20) { pairs } else { Vec::new() }
}

/// The share of normals that stand on their surface, on either side.
fn along(pairs: &[Pair]) -> f32 {
    let count = pairs.iter().filter(|(normal, surface)| normal.dot(*surface).abs() >= ALONG).count();
    count as f32 / pairs.len().max(1) as f32
}

/// The axes that must be reversed for normals to stand on the surface, if that is some and not all. Where
/// normals fit as well as they are, or with all of them reversed, nothing is said.
fn reversed(pairs: &[Pair]) -> Option<[bool; 3]> {
    if pairs.is_empty() {
        return None;
    }
    let cosines = |axes: [bool; 3]| {
        let signs = Vec3::from_array(axes.map(|is_reversed| if is_reversed { -1.0 } else { 1.0 }));
        pairs.iter().map(move |(normal, surface)| (signs * *normal).dot(*surface))
    };
    let count = pairs.len() as f32;
    let means = REVERSED.map(|axes| cosines(axes).sum::<f32>() / count);
    let best = means.iter().copied().fold(f32::MIN, f32::max);
    let is_alike = |mean: f32| mean > best - ALIKE;
    let is_clear = best > means[0] + BETTER && !is_alike(means[7]);
    let axes = REVERSED[means.iter().position(|mean| is_alike(*mean))?];
    let standing = cosines(axes).filter(|cosine| *cosine >= ALONG).count() as f32 / count;
    (is_clear && standing >= NAMED).then_some(axes)
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
