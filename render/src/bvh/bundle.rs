//! Rays from one point to what is nearest.
//!
//! Rays of a camera share their origin. So most of the work of a ray is done once for a bundle of them: a
//! box's sides seen from the origin, a triangle's edge planes. What is left for a ray is a few
//! multiplications, a vector of rays an instruction. The bundle walks a binary hierarchy once (ray packets:
//! Wald et al. 2001). The triangle test is Plücker's in the form of Embree, whose edges are exact opposites
//! in two triangles that share them, so that no ray slips through between.

use glam::Vec3;
use obvhs::{
    bvh2::{Bvh2, node::Bvh2Node},
    triangle::Triangle,
};
use pulp::{Arch, Simd, WithSimd};

/// The most rays of a bundle.
pub const BUNDLE: usize = 64;
/// A direction's component nearer to zero is taken as this, so that zero times infinity never occurs.
const SMALLEST: f32 = 1e-18;
/// Reach where there is no ray.
const DONE: f32 = -1.0;
/// Index of the nearest triangle where none was met.
const NOTHING: u32 = u32::MAX;
/// A box's far side is moved away by this, more than the rounding of the distances (Ize 2013).
const FAR_SIDE: f32 = 1.000_001;

/// What a bundle is traced through.
pub struct World<'a, O, P> {
    /// Its leaves point to `triangles`.
    pub bvh: &'a Bvh2,
    /// World space, metres.
    pub triangles: &'a [Triangle],
    /// Whether nothing passes through a triangle.
    pub opaque: O,
    /// Whether another triangle stops the ray of a direction.
    pub stops: P,
}

impl<O: Fn(u32) -> bool, P: Fn(u32, Vec3) -> bool> World<'_, O, P> {
    /// The distance and the index of the nearest triangle that stops each ray, of at most [`BUNDLE`].
    pub fn nearest(&self, origin: Vec3, directions: &[Vec3]) -> Vec<Option<(f32, u32)>> {
        let directions = &directions[..directions.len().min(BUNDLE)];
        let mut rays = Rays::new(directions);
        Arch::new().dispatch(Walk { world: self, origin, directions, rays: &mut rays });
        let met = |i: usize| (rays.nearest[i] != NOTHING).then_some((rays.reach[i], rays.nearest[i]));
        (0..directions.len()).map(met).collect()
    }
}

/// The rays of a bundle, components apart.
#[repr(align(64))]
struct Rays {
    direction: [[f32; BUNDLE]; 3],
    inverse: [[f32; BUNDLE]; 3],
    /// How far each ray goes; [`DONE`] where there is none.
    reach: [f32; BUNDLE],
    /// The triangle at `reach`.
    nearest: [u32; BUNDLE],
}

impl Rays {
    fn new(directions: &[Vec3]) -> Self {
        let mut rays = Self {
            direction: [[0.0; BUNDLE]; 3],
            inverse: [[0.0; BUNDLE]; 3],
            reach: [DONE; BUNDLE],
            nearest: [NOTHING; BUNDLE],
        };
        for (i, direction) in directions.iter().enumerate() {
            for axis in 0..3 {
                let component = direction[axis];
                let safe = if component.abs() < SMALLEST { SMALLEST } else { component };
                rays.direction[axis][i] = component;
                rays.inverse[axis][i] = safe.recip();
            }
            rays.reach[i] = f32::INFINITY;
        }
        rays
    }
}

/// A bundle on its way.
struct Walk<'a, 'b, O, P> {
    world: &'a World<'b, O, P>,
    origin: Vec3,
    directions: &'a [Vec3],
    rays: &'a mut Rays,
}

/// A node, with the packs of rays that enter it: bit `i` for vector `i`.
#[derive(Clone, Copy)]
struct Visit {
    node: u32,
    packs: u64,
}

impl<O: Fn(u32) -> bool, P: Fn(u32, Vec3) -> bool> WithSimd for Walk<'_, '_, O, P> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        let all = !0u64 >> (64 - self.directions.len().div_ceil(S::F32_LANES).max(1));
        let mut stack = Vec::with_capacity(64);
        stack.push(Visit { node: 0, packs: all });
        while let Some(Visit { node, packs }) = stack.pop() {
            let Bvh2Node { prim_count, first_index, .. } = self.world.bvh.nodes[node as usize];
            if prim_count > 0 {
                for leaf in first_index..first_index + prim_count {
                    self.test(simd, self.world.bvh.primitive_indices[leaf as usize], packs);
                }
                continue;
            }
            let [(near, a), (far, b)] = self.children(simd, first_index, packs);
            // The nearer one last, so that it is taken first.
            let visits = if near <= far { [b, a] } else { [a, b] };
            for visit in visits {
                if visit.packs != 0 {
                    stack.push(visit);
                }
            }
        }
    }
}

impl<O: Fn(u32) -> bool, P: Fn(u32, Vec3) -> bool> Walk<'_, '_, O, P> {
    /// Both children of an inner node, with their squared distances.
    #[inline(always)]
    fn children<S: Simd>(&self, simd: S, first: u32, packs: u64) -> [(f32, Visit); 2] {
        let (near, a) = self.entering(simd, first, packs);
        let (far, b) = self.entering(simd, first + 1, packs);
        [(near, Visit { node: first, packs: a }), (far, Visit { node: first + 1, packs: b })]
    }

    /// Squared distance of a node's box from the origin, and those of `packs` that meet it.
    #[inline(always)]
    fn entering<S: Simd>(&self, simd: S, node: u32, packs: u64) -> (f32, u64) {
        let bounds = &self.world.bvh.nodes[node as usize].aabb;
        let (low, high) = (Vec3::from(bounds.min) - self.origin, Vec3::from(bounds.max) - self.origin);
        let squared = low.max(-high).max(Vec3::ZERO).length_squared();
        let (low, high) = (splat(simd, low), splat(simd, high));
        let (mut rest, mut entering) = (packs, 0);
        while rest != 0 {
            let pack = rest.trailing_zeros();
            rest &= rest - 1;
            entering |= u64::from(self.meets_box(simd, pack as usize, &low, &high)) << pack;
        }
        (squared, entering)
    }

    #[inline(always)]
    fn meets_box<S: Simd>(&self, simd: S, pack: usize, low: &[S::f32s; 3], high: &[S::f32s; 3]) -> bool {
        let mut near = simd.splat_f32s(0.0);
        let mut far = simd.splat_f32s(f32::INFINITY);
        for axis in 0..3 {
            let inverse = S::as_simd_f32s(&self.rays.inverse[axis]).0[pack];
            let a = simd.mul_f32s(low[axis], inverse);
            let b = simd.mul_f32s(high[axis], inverse);
            near = simd.max_f32s(near, simd.min_f32s(a, b));
            far = simd.min_f32s(far, simd.max_f32s(a, b));
        }
        let reach = S::as_simd_f32s(&self.rays.reach).0[pack];
        let far = simd.min_f32s(simd.mul_f32s(far, simd.splat_f32s(FAR_SIDE)), reach);
        simd.first_true_m32s(simd.less_than_or_equal_f32s(near, far)) < S::F32_LANES
    }

    /// Cuts the rays of `packs` off that meet a triangle.
    #[inline(always)]
    fn test<S: Simd>(&mut self, simd: S, index: u32, packs: u64) {
        let Triangle { v0, v1, v2 } = self.world.triangles[index as usize];
        let origin = self.origin;
        let (a, b, c) = (Vec3::from(v0) - origin, Vec3::from(v1) - origin, Vec3::from(v2) - origin);
        // Normals of the planes through the origin and an edge each, and the triangle's own.
        let normal = (b - a).cross(c - a);
        let offset = normal.dot(a);
        let normals = [
            splat(simd, edge_plane(a, b)),
            splat(simd, edge_plane(b, c)),
            splat(simd, edge_plane(c, a)),
            splat(simd, normal),
        ];
        let opaque = (self.world.opaque)(index);
        let mut rest = packs;
        while rest != 0 {
            let pack = rest.trailing_zeros() as usize;
            rest &= rest - 1;
            let (meets, towards) = self.meets_triangle(simd, pack, &normals, offset);
            let distance = simd.div_f32s(simd.splat_f32s(offset), towards);
            if opaque {
                self.end(simd, index, pack, meets, distance);
            } else if simd.first_true_m32s(meets) < S::F32_LANES {
                let stopped = self.stopped(simd, index, pack, meets);
                self.end(simd, index, pack, stopped, distance);
            }
        }
    }

    /// Sets the reach of some rays of a pack.
    #[inline(always)]
    fn end<S: Simd>(&mut self, simd: S, triangle: u32, pack: usize, rays: S::m32s, reach: S::f32s) {
        let reaches = &mut S::as_mut_simd_f32s(&mut self.rays.reach).0[pack];
        *reaches = simd.select_f32s(rays, reach, *reaches);
        let nearest = &mut S::as_mut_simd_u32s(&mut self.rays.nearest).0[pack];
        *nearest = simd.select_u32s(rays, simd.splat_u32s(triangle), *nearest);
    }

    /// Which rays of a pack meet a triangle within their reach, and how fast they near it: the distance is
    /// `offset` over that.
    #[inline(always)]
    fn meets_triangle<S: Simd>(
        &self,
        simd: S,
        pack: usize,
        normals: &[[S::f32s; 3]; 4],
        offset: f32,
    ) -> (S::m32s, S::f32s) {
        let [x, y, z] = &self.rays.direction;
        let direction = [S::as_simd_f32s(x).0[pack], S::as_simd_f32s(y).0[pack], S::as_simd_f32s(z).0[pack]];
        let (u, v) = (dot(simd, normals[0], direction), dot(simd, normals[1], direction));
        let (w, towards) = (dot(simd, normals[2], direction), dot(simd, normals[3], direction));
        let zero = simd.splat_f32s(0.0);
        let least = simd.min_f32s(u, simd.min_f32s(v, w));
        let most = simd.max_f32s(u, simd.max_f32s(v, w));
        let inside = simd
            .or_m32s(simd.greater_than_or_equal_f32s(least, zero), simd.less_than_or_equal_f32s(most, zero));
        // The distance, compared without the division.
        let offset = simd.splat_f32s(offset);
        let ahead = simd.greater_than_f32s(simd.mul_f32s(offset, towards), zero);
        let reach = S::as_simd_f32s(&self.rays.reach).0[pack];
        let within = simd.less_than_f32s(simd.abs_f32s(offset), simd.mul_f32s(reach, simd.abs_f32s(towards)));
        (simd.and_m32s(inside, simd.and_m32s(ahead, within)), towards)
    }

    /// Those rays of a pack that meet a triangle which its material stops there.
    #[inline(always)]
    fn stopped<S: Simd>(&self, simd: S, index: u32, pack: usize, meets: S::m32s) -> S::m32s {
        let zero = simd.splat_f32s(0.0);
        let mut lanes = [0.0; BUNDLE];
        S::as_mut_simd_f32s(&mut lanes).0[0] = simd.select_f32s(meets, simd.splat_f32s(1.0), zero);
        for (lane, meets) in lanes.iter_mut().enumerate().take(S::F32_LANES) {
            let ray = pack * S::F32_LANES + lane;
            if *meets > 0.0 && !(self.world.stops)(index, self.directions[ray]) {
                *meets = 0.0;
            }
        }
        simd.greater_than_f32s(S::as_simd_f32s(&lanes).0[0], zero)
    }
}

/// Normal of the plane through the origin and an edge.
#[inline(always)]
fn edge_plane(from: Vec3, to: Vec3) -> Vec3 {
    (to - from).cross(to + from)
}

#[inline(always)]
fn splat<S: Simd>(simd: S, v: Vec3) -> [S::f32s; 3] {
    [simd.splat_f32s(v.x), simd.splat_f32s(v.y), simd.splat_f32s(v.z)]
}

#[inline(always)]
fn dot<S: Simd>(simd: S, a: [S::f32s; 3], b: [S::f32s; 3]) -> S::f32s {
    simd.add_f32s(
        simd.add_f32s(simd.mul_f32s(a[0], b[0]), simd.mul_f32s(a[1], b[1])),
        simd.mul_f32s(a[2], b[2]),
    )
}
