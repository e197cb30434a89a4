//! What contradicts a depth: the positions, or its own values.

use super::{BEHIND, Contradiction, DepthKind, FEWEST, median, share};
use deepshade_shaders::{Attribute, GBuffer};
use glam::Vec3;

/// By how much depth may differ from the positions', and how much of what is seen may differ by more.
const OFF_DEPTH: f32 = 0.05;
const MOST_OFF_DEPTH: f32 = 0.25;
/// Above this a depth buffer has most of its values: those of all that is further away than some ten times
/// the near plane.
const NEARLY_ONE: f32 = 0.9;

/// What depth is that is not what it should be, by the positions where there are right ones.
pub fn of_depth(gbuffer: &GBuffer, positions: Option<&[Vec3]>, seen: &[usize]) -> Option<Contradiction> {
    let depth = gbuffer.planes().plane(gbuffer.first_plane(Attribute::Depth).ok()?);
    let negative = share(seen, |at| depth[at] < 0.0);
    match positions {
        Some(positions) => against(depth, positions, seen),
        None if negative > BEHIND => Some(Contradiction::Depth(-1.0, DepthKind::Negative)),
        None => is_buffer(depth, seen).then_some(Contradiction::Depth(1.0, DepthKind::Buffer)),
    }
}

/// What depth is that is not the positions'.
fn against(depth: &[f32], positions: &[Vec3], seen: &[usize]) -> Option<Contradiction> {
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
    let kind = if is_mostly(&|at| depth[at] < 0.0) {
        DepthKind::Negative
    } else if is_mostly(&|at| (ratio(at) / middle - 1.0).abs() < 0.02) {
        DepthKind::OtherUnit
    } else if is_mostly(&|at| (depth[at] / positions[at].length() - 1.0).abs() < 0.02) {
        DepthKind::Distance
    } else if is_buffer(depth, &seen) {
        DepthKind::Buffer
    } else {
        DepthKind::Unknown
    };
    Some(Contradiction::Depth(middle, kind))
}

/// Whether depths look like those of a depth buffer. Of one whose far plane is at 0 nothing can be said: a
/// small scene has such depths.
fn is_buffer(depth: &[f32], seen: &[usize]) -> bool {
    let is_within = seen.iter().all(|at| (0.0..=1.0).contains(&depth[*at]));
    is_within && share(seen, |at| depth[at] > NEARLY_ONE) > 0.5
}
