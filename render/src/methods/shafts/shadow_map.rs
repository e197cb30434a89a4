//! How far a lamp's light gets, by rays through a scene: for distant lamps in parallel projection over the
//! scene's box, for others in stereographic projection around the light (both hemispheres, or as much of one
//! as a spot lights).
//!
//! Texels lie in tiles of 4 x 4, a cache line each, so that a walk in any direction meets a new line every
//! few steps (as Baran et al. 2010, section 10, have it for their ray marcher).

use super::lamp::{Lamp, LampPosition};
use crate::bvh::TracedScene;
use glam::{Vec2, Vec3};
use rayon::prelude::*;

/// The distance, metres, of what nothing hides; finite, so that arithmetic on it is.
pub const FAR: f32 = 1e30;
/// Edge of the tiles, texels.
pub const TILE: usize = 4;
/// Points whose depths are read together, in vectors.
pub const TOGETHER: usize = 64;
/// Texels without a surface around the scene's box: what is beside the map reads them.
const MARGIN: f32 = 1.5;
/// Numbers from here on, 2^23, are whole.
const ROUND: f32 = 8_388_608.0;
/// By how much a spot's cone is widened, in parts of its radius in the map.
const RIM: f32 = 1.01;

/// Distances at which a lamp's light meets the first surface.
#[derive(Clone, Debug)]
pub struct ShadowMap {
    /// Which texel is where.
    pub projection: Projection,
    size: usize,
    /// Maps one after the other, tiles row by row.
    depths: Vec<f32>,
}

/// How world space becomes a map.
#[derive(Clone, Copy, Debug)]
pub enum Projection {
    /// For distant lamps.
    Parallel(Parallel),
    /// For all others.
    Stereographic(Stereographic),
}

/// Rows are the gradients of the map's coordinates in texels and of the depth in metres.
#[derive(Clone, Copy, Debug)]
pub struct Parallel {
    origin: Vec3,
    rows: [Vec3; 3],
}

/// A stereographic projection from the point opposite to an axis: the direction `d` is at
/// `(d.x, d.y) / (1 + d.z)`.
#[derive(Clone, Copy, Debug)]
pub struct Stereographic {
    position: Vec3,
    /// Columns: right, up, axis.
    axes: [Vec3; 3],
    /// Half the texels along an edge over the radius that the map shows.
    scale: f32,
    /// Half the texels along an edge.
    middle: f32,
    /// Whether there is a second map for the other hemisphere.
    both: bool,
}

impl ShadowMap {
    /// The map of a lamp, of `size` texels a side (a multiple of [`TILE`]).
    pub fn new(scene: &TracedScene, lamp: &Lamp<'_>, size: usize) -> Self {
        let projection = match lamp.position {
            LampPosition::Distant(towards) => Projection::Parallel(Parallel::around(scene, -towards, size)),
            LampPosition::Local(position) => {
                Projection::Stereographic(Stereographic::new(position, lamp.cone(), size))
            }
        };
        let tiles = size / TILE;
        let mut depths = vec![FAR; size * size * projection.maps()];
        depths.par_chunks_mut(TILE * TILE * tiles).enumerate().for_each(|(row, depths)| {
            for (column, tile) in depths.chunks_mut(TILE * TILE).enumerate() {
                let texel = |i: usize| [column * TILE + i % TILE, row % tiles * TILE + i / TILE];
                projection.trace(scene, row / tiles, texel, tile);
            }
        });
        Self { projection, size, depths }
    }

    /// The same map with nothing that hides anything.
    #[must_use]
    pub fn emptied(&self) -> Self {
        Self { depths: vec![FAR; self.depths.len()], ..self.clone() }
    }

    /// Depth at a point of a map, in texels; what is outside has that of the nearest edge.
    #[inline(always)]
    pub fn depth(&self, map: usize, u: f32, v: f32) -> f32 {
        self.depths[map * self.size * self.size + self.texel(u, v) as usize]
    }

    /// Depths of the first map at points of a line: each coordinate has a value and a slope.
    #[inline(always)]
    pub fn depths_along(&self, [u, v]: [[f32; 2]; 2], points: &[f32; TOGETHER]) -> [f32; TOGETHER] {
        let mut texels = [0; TOGETHER];
        for (texel, at) in texels.iter_mut().zip(points) {
            *texel = self.texel(u[0] + at * u[1], v[0] + at * v[1]);
        }
        texels.map(|texel| self.depths[texel as usize])
    }

    /// Which texel is at a point of a map.
    #[inline(always)]
    fn texel(&self, u: f32, v: f32) -> u32 {
        let end = self.size as f32 - 0.5;
        // Added to `ROUND`, a number leaves its nearest whole one in the lowest bits: compilers put that into
        // vectors, which they do not with checked conversions.
        let [x, y] = [u, v].map(|at| (at.max(0.5).min(end) - 0.5 + ROUND).to_bits() & 0xffff);
        let tile = y / TILE as u32 * (self.size / TILE) as u32 + x / TILE as u32;
        (tile * TILE as u32 + y % TILE as u32) * TILE as u32 + x % TILE as u32
    }

    /// Whether light reaches a point.
    pub fn reaches(&self, point: Vec3) -> bool {
        match &self.projection {
            Projection::Parallel(parallel) => {
                let [u, v, depth] = parallel.locate(point);
                depth < self.depth(0, u, v)
            }
            Projection::Stereographic(around) => {
                let offset = point - around.position;
                let distance = offset.length();
                distance < self.towards(around, offset / distance.max(f32::MIN_POSITIVE))
            }
        }
    }

    /// Distance of the first surface in a unit direction from a local light.
    pub fn towards(&self, around: &Stereographic, direction: Vec3) -> f32 {
        let (map, u, v) = around.locate(direction);
        self.depth(map, u, v)
    }
}

impl Projection {
    /// How many maps it takes.
    const fn maps(&self) -> usize {
        match self {
            Self::Parallel(_) => 1,
            Self::Stereographic(around) => 1 + around.both as usize,
        }
    }

    /// Fills a tile by a ray through the middle of each texel.
    fn trace(&self, scene: &TracedScene, map: usize, texel: impl Fn(usize) -> [usize; 2], tile: &mut [f32]) {
        let middle = |i: usize| texel(i).map(|at| at as f32 + 0.5);
        match self {
            Self::Parallel(parallel) => {
                let forward = parallel.rows[2];
                for (i, depth) in tile.iter_mut().enumerate() {
                    let hit = scene.hit(parallel.start(middle(i)), forward, f32::INFINITY);
                    *depth = hit.map_or(FAR, |hit| hit.distance);
                }
            }
            Self::Stereographic(around) => {
                let directions: Vec<Vec3> =
                    (0..tile.len()).map(|i| around.direction(map, middle(i))).collect();
                let hits = scene.hit_bundle(around.position, &directions);
                for (depth, hit) in tile.iter_mut().zip(hits) {
                    *depth = hit.map_or(FAR, |hit| hit.distance);
                }
            }
        }
    }
}

impl Parallel {
    /// Over the box around a scene, for light that travels `forward`.
    fn around(scene: &TracedScene, forward: Vec3, size: usize) -> Self {
        let (right, up) = forward.any_orthonormal_pair();
        let corners = scene.bounds().corners();
        let extent = |axis: Vec3| {
            let along = corners.map(|corner| corner.dot(axis));
            let low = along.into_iter().fold(f32::INFINITY, f32::min);
            (low, along.into_iter().fold(f32::NEG_INFINITY, f32::max) - low)
        };
        let texels = size as f32 - 2.0 * MARGIN;
        let least = f32::EPSILON * scene.diagonal();
        let fitted = |axis: Vec3| {
            let (low, length) = extent(axis);
            let scale = texels / length.max(least);
            (axis * scale, axis * (low - MARGIN / scale))
        };
        let ((u, left), (v, bottom)) = (fitted(right), fitted(up));
        // Rays start before the box.
        let before = forward * (extent(forward).0 - 1e-3 * scene.diagonal());
        Self { origin: left + bottom + before, rows: [u, v, forward] }
    }

    /// Texel coordinates and depth of a point.
    pub fn locate(&self, point: Vec3) -> [f32; 3] {
        self.along(point - self.origin)
    }

    /// By how much they change along a vector.
    pub fn along(&self, vector: Vec3) -> [f32; 3] {
        self.rows.map(|row| row.dot(vector))
    }

    /// Where light starts that ends at a point of the map.
    fn start(&self, [u, v]: [f32; 2]) -> Vec3 {
        let [right, up, _] = self.rows;
        self.origin + right * (u / right.length_squared()) + up * (v / up.length_squared())
    }
}

impl Stereographic {
    fn new(position: Vec3, cone: Option<(Vec3, f32)>, size: usize) -> Self {
        let (axis, cosine) = cone.unwrap_or((Vec3::Y, -1.0));
        let (right, up) = axis.any_orthonormal_pair();
        let both = cosine < 0.0;
        // tan of half the angle to the axis.
        let radius = if both { 1.0 } else { RIM * ((1.0 - cosine) / (1.0 + cosine)).sqrt() };
        let middle = 0.5 * size as f32;
        Self { position, axes: [right, up, axis], scale: middle / radius.max(1e-4), middle, both }
    }

    /// Which map, and where in it, shows a unit direction.
    #[inline(always)]
    pub fn locate(&self, direction: Vec3) -> (usize, f32, f32) {
        let [x, y, z] = self.axes.map(|axis| axis.dot(direction));
        let behind = self.both && z < 0.0;
        let scale = self.scale / (1.0 + if behind { -z } else { z }).max(1e-3);
        (usize::from(behind), self.middle + x * scale, self.middle + y * scale)
    }

    /// The unit direction at a point of a map.
    fn direction(&self, map: usize, [u, v]: [f32; 2]) -> Vec3 {
        let at = (Vec2::new(u, v) - self.middle) / self.scale;
        let z = (1.0 - at.length_squared()) / (1.0 + at.length_squared());
        let [right, up, axis] = self.axes;
        let forward = if map == 1 { -axis * z } else { axis * z };
        (right * at.x + up * at.y) * (1.0 + z) + forward
    }
}
