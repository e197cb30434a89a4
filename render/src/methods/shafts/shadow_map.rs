//! How far a lamp's light gets, by rays through a scene: for distant lamps in parallel projection by nested
//! maps of what is seen, for others in stereographic projection around the light (both hemispheres, or as
//! much of one as a spot lights).
//!
//! Texels lie in tiles of 4 x 4, a cache line each, so that a walk in any direction meets a new line every
//! few steps (as Baran et al. 2010, section 10, have it for their ray marcher).

use super::lamp::{Lamp, LampPosition};
use super::parallel::{Cascade, Parallel};
use super::view_rays::ViewRays;
use crate::bvh::TracedScene;
use glam::{Vec2, Vec3};
use rayon::prelude::*;

/// The distance, metres, of what nothing hides; finite, so that arithmetic on it is.
pub const FAR: f32 = 1e30;
/// Edge of the tiles, texels.
pub const TILE: usize = 4;
/// Points whose depths are read together, in vectors.
pub const TOGETHER: usize = 64;
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
#[derive(Clone, Debug)]
pub enum Projection {
    /// For distant lamps.
    Parallel(Parallel),
    /// For all others.
    Stereographic(Stereographic),
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
    /// The map of a lamp for view rays, of `size` texels a side (a multiple of [`TILE`]); of a distant lamp
    /// so many nested ones, which have as many texels together.
    pub fn new(scene: &TracedScene, lamp: &Lamp<'_>, rays: &ViewRays, [cascades, size]: [usize; 2]) -> Self {
        let (projection, size) = match lamp.position {
            LampPosition::Distant(towards) => {
                let size = (size as f32 / (cascades as f32).sqrt()) as usize;
                let size = size.next_multiple_of(TILE);
                (Projection::Parallel(Parallel::new(scene, rays, -towards, [cascades, size])), size)
            }
            LampPosition::Local(position) => {
                (Projection::Stereographic(Stereographic::new(position, lamp.cone(), size)), size)
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
        self.depths[self.texel(map, u, v) as usize]
    }

    /// Depths of parallel light rays at places of a line: each coordinate, metres, has a value and a slope.
    /// A block that the finest map shows is looked up there; of one that goes beyond a map, each place in the
    /// finest.
    #[inline(always)]
    pub fn depths_along(
        &self,
        parallel: &Parallel,
        line: [[f32; 2]; 2],
        points: &[f32; TOGETHER],
    ) -> [f32; TOGETHER] {
        let at = |point: f32| line.map(|[from, slope]| from + point * slope);
        let ends = [points[0], points[TOGETHER - 1]].map(at);
        let cascades = &parallel.cascades;
        let holds_all = |cascade: &Cascade| ends.iter().all(|end| cascade.holds(*end));
        let whole = cascades.iter().position(holds_all).unwrap_or(cascades.len() - 1);
        let mut texels = [0; TOGETHER];
        let [u, v] = cascades[whole].line(line);
        for (texel, point) in texels.iter_mut().zip(points) {
            *texel = self.texel(whole, u[0] + point * u[1], v[0] + point * v[1]);
        }
        for (map, cascade) in cascades[..whole].iter().enumerate().rev() {
            if !ends.iter().any(|end| cascade.holds(*end)) {
                continue;
            }
            let [u, v] = cascade.line(line);
            for (texel, point) in texels.iter_mut().zip(points) {
                let finer = self.texel(map, u[0] + point * u[1], v[0] + point * v[1]);
                *texel = if cascade.holds(at(*point)) { finer } else { *texel };
            }
        }
        texels.map(|texel| self.depths[texel as usize])
    }

    /// Which texel is at a point of a map.
    #[inline(always)]
    fn texel(&self, map: usize, u: f32, v: f32) -> u32 {
        let end = self.size as f32 - 0.5;
        // Added to `ROUND`, a number leaves its nearest whole one in the lowest bits: compilers put that into
        // vectors, which they do not with checked conversions.
        let [x, y] = [u, v].map(|at| (at.max(0.5).min(end) - 0.5 + ROUND).to_bits() & 0xffff);
        let tiles = (self.size / TILE) as u32;
        let tile = (map as u32 * tiles + y / TILE as u32) * tiles + x / TILE as u32;
        (tile * TILE as u32 + y % TILE as u32) * TILE as u32 + x % TILE as u32
    }

    /// Whether light reaches a point.
    pub fn reaches(&self, point: Vec3) -> bool {
        match &self.projection {
            Projection::Parallel(parallel) => {
                let [right, up, depth] = parallel.locate(point);
                let map = parallel.finest([right, up]);
                let [u, v] = parallel.cascades[map].texels([right, up]);
                depth < self.depth(map, u, v)
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
    fn maps(&self) -> usize {
        match self {
            Self::Parallel(parallel) => parallel.cascades.len(),
            Self::Stereographic(around) => 1 + around.both as usize,
        }
    }

    /// Fills a tile by a ray through the middle of each texel.
    fn trace(&self, scene: &TracedScene, map: usize, texel: impl Fn(usize) -> [usize; 2], tile: &mut [f32]) {
        let middle = |i: usize| texel(i).map(|at| at as f32 + 0.5);
        match self {
            Self::Parallel(parallel) => {
                for (i, depth) in tile.iter_mut().enumerate() {
                    let [start, forward] = parallel.light_ray(map, middle(i));
                    let hit = scene.hit(start, forward, f32::INFINITY);
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
