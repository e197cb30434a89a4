//! What contradicts normals in world space: those in camera space, of which they are a rotation, and the
//! directions to the camera.

use super::normals::{of_camera, of_lengths};
use super::{AWAY, Contradiction, FEWEST, SOME_AWAY, pixel, share};
use deepshade_shaders::{Attribute, GBuffer};
use glam::{DVec2, Vec3};

/// By how much the cosine between two pixels' normals may differ between both spaces, and how many may
/// differ by more.
const OFF_COSINE: f32 = 0.2;
const MOST_OFF: f32 = 0.25;
/// How far from one plane three normals must be for their handedness to say something.
const SPREAD: f32 = 0.2;
/// The least turn of the directions to the camera over the image that tells a direction, cubed.
const LEAST_TURN: f64 = 1e-6;

/// What contradicts world normals and normals together: a rotation keeps angles, and no mirror image is one.
/// Normals that are none themselves say nothing.
pub fn of_both(normals: &[Vec3], world: &[Vec3], seen: &[usize]) -> Option<Contradiction> {
    let is_wrong =
        of_lengths(Attribute::Normal, normals, seen).is_some() || of_camera(normals, seen).is_some();
    if is_wrong {
        return None;
    }
    let units = |vectors: &[Vec3], at: usize| vectors[at].normalize_or_zero();
    // Pixels far from each other, each with each other one in turn. The steps are primes.
    let other = |index: usize, step: usize| seen[(index * step + step) % seen.len()];
    let indices: Vec<usize> = (0..seen.len()).collect();
    let off = share(&indices, |index| {
        let (a, b) = (seen[index], other(index, 7919));
        (units(normals, a).dot(units(normals, b)) - units(world, a).dot(units(world, b))).abs() > OFF_COSINE
    });
    if off > MOST_OFF {
        return Some(Contradiction::OtherWorldNormals(off));
    }
    let handed = |vectors: &[Vec3], index: usize| {
        let [a, b, c] = [seen[index], other(index, 7919), other(index, 104_729)].map(|at| units(vectors, at));
        a.cross(b).dot(c)
    };
    let told: Vec<f32> = indices
        .iter()
        .map(|index| (handed(normals, *index), handed(world, *index)))
        .filter(|(camera, world)| camera.abs().min(world.abs()) > SPREAD)
        .map(|(camera, world)| camera * world)
        .collect();
    let mirrored = told.iter().filter(|product| **product < 0.0).count();
    (told.len() >= FEWEST && mirrored * 4 > told.len() * 3).then_some(Contradiction::MirroredWorldNormals)
}

/// What contradicts world normals and the directions to the camera together.
pub fn of_directions(
    gbuffer: &GBuffer,
    world: &[Vec3],
    to_camera: &[Vec3],
    seen: &[usize],
) -> Option<Contradiction> {
    let pixels: Vec<DVec2> = seen.iter().map(|at| pixel(gbuffer.width(), gbuffer.height(), *at)).collect();
    if turn(&pixels, seen, to_camera).is_some_and(|turn| turn < -LEAST_TURN) {
        return Some(Contradiction::FromCamera);
    }
    let cosine = |at: usize| world[at].normalize_or_zero().dot(to_camera[at].normalize_or_zero());
    let away = share(seen, |at| cosine(at) < -AWAY);
    (away > SOME_AWAY).then_some(Contradiction::FacingAway(away))
}

/// How directions turn over the image, by least squares: the volume that their slope along the columns, that
/// along the rows and their mean make. For directions to a camera it is positive, as x, y and z of its axes
/// make a right hand and both slopes go against theirs; for those from it, it is negative. None where the
/// pixels lie on a line.
fn turn(pixels: &[DVec2], seen: &[usize], directions: &[Vec3]) -> Option<f64> {
    let count = seen.len() as f64;
    let middle = pixels.iter().sum::<DVec2>() / count;
    let mean = seen.iter().map(|at| directions[*at].as_dvec3()).sum::<glam::DVec3>() / count;
    let (mut columns, mut rows, mut both) = (0.0, 0.0, 0.0);
    let (mut with_column, mut with_row) = (glam::DVec3::ZERO, glam::DVec3::ZERO);
    for (pixel, at) in pixels.iter().zip(seen) {
        let (place, direction) = (*pixel - middle, directions[*at].as_dvec3() - mean);
        columns += place.x * place.x;
        rows += place.y * place.y;
        both += place.x * place.y;
        with_column += direction * place.x;
        with_row += direction * place.y;
    }
    let determinant = columns * rows - both * both;
    // In units of the pixels' spread, so that it does not depend on the resolution.
    let by_column = (with_column * rows - with_row * both) / determinant * (columns / count).sqrt();
    let by_row = (with_row * columns - with_column * both) / determinant * (rows / count).sqrt();
    (determinant > 0.01 * columns * rows).then(|| by_column.cross(by_row).dot(mean))
}
