//! A distant lamp's rays in parallel projection: maps nested around what the view rays see of the medium, the
//! first of what is near (Zhang et al. 2006, "Parallel-Split Shadow Maps"). A light ray is one point of each
//! map, so that the finest that shows the point shows all of the light ray.

use super::view_rays::ViewRays;
use crate::bvh::TracedScene;
use glam::{Vec2, Vec3};

/// Maps of a distant lamp.
pub const CASCADES: usize = 4;
/// How many times as far each shows as the one before.
const GROWTH: f32 = 4.0;
/// Texels around what a map is to show: what is beside the scene's box reads those, which have no surface.
const MARGIN: f32 = 2.0;
/// Least width of what a map shows, as a share of the scene's diagonal.
const NARROWEST: f32 = 1e-4;
/// As good as without an end, metres; finite, so that arithmetic on it is.
const ENDLESS: f32 = 1e30;

/// For light of one direction.
#[derive(Clone, Debug)]
pub struct Parallel {
    /// Beside the eye, before the scene's box.
    origin: Vec3,
    /// Unit vectors: right, up and with the light.
    axes: [Vec3; 3],
    /// What each map shows, the finest first.
    pub cascades: Vec<Cascade>,
}

/// What a map shows, metres to the right and up.
#[derive(Clone, Copy, Debug)]
pub struct Cascade {
    low: Vec2,
    high: Vec2,
    /// Texels in a metre.
    scale: Vec2,
}

impl Parallel {
    /// For light that travels `forward` to what is seen, by so many maps of `size` texels a side.
    pub(super) fn new(scene: &TracedScene, rays: &ViewRays, forward: Vec3, [maps, size]: [usize; 2]) -> Self {
        let (right, up) = forward.any_orthonormal_pair();
        let across = |vector: Vec3| Vec2::new(vector.dot(right), vector.dot(up));
        let corners = scene.bounds().corners().map(|corner| corner - rays.eye);
        let nearest = corners.iter().fold(f32::INFINITY, |least, corner| least.min(corner.dot(forward)));
        let farthest = corners.iter().fold(0.0, |most: f32, corner| most.max(corner.length()));
        let before = nearest - 1e-3 * scene.diagonal();
        let places = corners.map(across);
        let low = places.into_iter().fold(Vec2::INFINITY, Vec2::min);
        let high = places.into_iter().fold(Vec2::NEG_INFINITY, Vec2::max);
        let narrowest = Vec2::splat(NARROWEST * scene.diagonal());
        let cascades = splits(rays, farthest, maps).map(|farthest| {
            let [first, last] = seen(rays, farthest, across);
            let low = first.min(high).max(low);
            let seen = (last.min(high).max(low) - low).max(narrowest);
            let scale = (size as f32 - 2.0 * MARGIN) / seen;
            Cascade { low: low - MARGIN / scale, high: low + seen + MARGIN / scale, scale }
        });
        let origin = rays.eye + forward * before;
        Self { origin, axes: [right, up, forward], cascades: cascades.collect() }
    }

    /// Metres of a point to the right, up and with the light.
    pub fn locate(&self, point: Vec3) -> [f32; 3] {
        self.along(point - self.origin)
    }

    /// By how much they change along a vector.
    pub fn along(&self, vector: Vec3) -> [f32; 3] {
        self.axes.map(|axis| axis.dot(vector))
    }

    /// The finest map that shows the light ray at a place; of those that are not seen the last.
    pub fn finest(&self, at: [f32; 2]) -> usize {
        self.cascades.iter().position(|cascade| cascade.holds(at)).unwrap_or(self.cascades.len() - 1)
    }

    /// Where the light ray at a point of a map, in texels, starts, and where it goes.
    pub(super) fn light_ray(&self, map: usize, texels: [f32; 2]) -> [Vec3; 2] {
        let Cascade { low, scale, .. } = self.cascades[map];
        let at = low + Vec2::from(texels) / scale;
        let [right, up, forward] = self.axes;
        [self.origin + right * at.x + up * at.y, forward]
    }
}

impl Cascade {
    /// Whether it shows the light ray at a place.
    #[inline(always)]
    pub fn holds(&self, [right, up]: [f32; 2]) -> bool {
        let Self { low, high, .. } = self;
        right > low.x && right < high.x && up > low.y && up < high.y
    }

    /// Texels of a place.
    #[inline(always)]
    pub fn texels(&self, [right, up]: [f32; 2]) -> [f32; 2] {
        [(right - self.low.x) * self.scale.x, (up - self.low.y) * self.scale.y]
    }

    /// The texels of a line, each coordinate having a value and a slope.
    #[inline(always)]
    pub fn line(&self, [right, up]: [[f32; 2]; 2]) -> [[f32; 2]; 2] {
        let [u, v] = self.texels([right[0], up[0]]);
        [[u, right[1] * self.scale.x], [v, up[1] * self.scale.y]]
    }
}

/// How far from the eye each map shows view rays, metres; the last shows all of them, of which those count
/// here that are no farther than the scene.
fn splits(rays: &ViewRays, of_scene: f32, maps: usize) -> impl Iterator<Item = f32> {
    let spans = rays.spans.iter().filter(|[near, far]| near < far);
    let [nearest, farthest] = spans.fold([of_scene, 0.0], |[nearest, farthest]: [f32; 2], [near, far]| {
        [nearest.min(*near), farthest.max(far.min(of_scene))]
    });
    (0..maps).rev().map(move |before_last| match before_last {
        0 => ENDLESS,
        before_last => nearest + (farthest - nearest).max(0.0) / GROWTH.powi(before_last as i32),
    })
}

/// Between which places view rays are in the medium, as far as a distance, and what is within a pixel of
/// them: slices lie between view rays.
fn seen(rays: &ViewRays, farthest: f32, across: impl Fn(Vec3) -> Vec2) -> [Vec2; 2] {
    let pixel = 1.0 / rays.focal_length();
    let mut seen = [Vec2::INFINITY, Vec2::NEG_INFINITY];
    for (direction, [near, far]) in rays.directions.iter().zip(&rays.spans) {
        if near >= far || *near > farthest {
            continue;
        }
        let direction = across(*direction);
        for distance in [*near, far.min(farthest)] {
            let (at, beside) = (direction * distance, Vec2::splat(distance * pixel));
            seen = [seen[0].min(at - beside), seen[1].max(at + beside)];
        }
    }
    seen
}
