//! Rays from one point: which directions are blocked.
//!
//! Rays that ask how much of the world a point sees share their origin and stay above the point's surface, so most of
//! the work of a ray is done once for a bundle of them: whether a box or a triangle is out of reach or below the
//! surface, a box's sides seen from the origin, a triangle's edge planes. What is left for a ray is a few
//! multiplications, eight rays an instruction. The bundle walks a binary hierarchy once (ray packets: Wald et al.
//! 2001); the triangle test is Plücker's in the form of Embree, whose edges are exact opposites in the two triangles
//! that share them, so that no ray slips through between.

use glam::Vec3;
use obvhs::{bvh2::Bvh2, triangle::Triangle};

/// The most rays of a bundle.
pub const BUNDLE: usize = 64;
/// Rays of a pack, which are treated by the same instructions.
const LANES: usize = 8;
/// A direction's component nearer to zero is taken as this, so that zero times infinity never occurs.
const SMALLEST: f32 = 1e-18;
/// Reach of a ray that is no longer asked for.
const DONE: f32 = -1.0;

/// One number for each ray of a pack.
type Lanes = [f32; LANES];

/// Up to eight rays, components apart.
#[derive(Clone, Copy)]
struct Pack {
    direction: [Lanes; 3],
    inverse: [Lanes; 3],
    /// How far each ray goes; [`DONE`] once it is blocked, and where there is no ray.
    reach: Lanes,
}

/// Where the rays of a bundle start and where they may go.
#[derive(Clone, Copy)]
pub struct Start {
    /// World space, metres.
    pub origin: Vec3,
    /// No direction has a negative component along this one.
    pub above: Vec3,
    /// How far every ray goes, in lengths of its direction, which is 1.
    pub reach: f32,
}

/// Bit `i` of the result is set where a triangle blocks `directions[i]`, unit vectors, at most [`BUNDLE`] of them.
/// `present` decides for triangles whose material is not opaque, which `opaque` tells from the others.
pub fn blocked(
    bvh: &Bvh2,
    triangles: &[Triangle],
    start: Start,
    directions: &[Vec3],
    opaque: impl Fn(u32) -> bool,
    present: impl Fn(u32, Vec3) -> bool,
) -> u64 {
    let mut walk = Walk { start, packs: [Pack::NONE; BUNDLE / LANES] };
    for (i, direction) in directions.iter().enumerate().take(BUNDLE) {
        walk.packs[i / LANES].set(i % LANES, *direction, start.reach);
    }
    pulp::Arch::new().dispatch(
        #[inline(always)]
        || walk.run(bvh, triangles, directions, &opaque, &present),
    );
    directions
        .iter()
        .enumerate()
        .take(BUNDLE)
        .fold(0, |bits, (i, _)| bits | u64::from(walk.packs[i / LANES].reach[i % LANES] == DONE) << i)
}

impl Pack {
    const NONE: Self =
        Self { direction: [[0.0; LANES]; 3], inverse: [[0.0; LANES]; 3], reach: [DONE; LANES] };

    fn set(&mut self, lane: usize, direction: Vec3, reach: f32) {
        for axis in 0..3 {
            let component = direction[axis];
            let safe = if component.abs() < SMALLEST { SMALLEST } else { component };
            self.direction[axis][lane] = component;
            self.inverse[axis][lane] = safe.recip();
        }
        self.reach[lane] = reach;
    }

    /// Whether any ray meets the box from `low` to `high`, relative to the origin.
    #[inline(always)]
    fn meets_box(&self, low: Vec3, high: Vec3) -> bool {
        let mut meets = [0u32; LANES];
        for lane in 0..LANES {
            let (mut near, mut far) = (0.0, self.reach[lane]);
            for axis in 0..3 {
                let inverse = self.inverse[axis][lane];
                let (a, b) = (low[axis] * inverse, high[axis] * inverse);
                near = larger(near, smaller(a, b));
                far = smaller(far, larger(a, b));
            }
            meets[lane] = u32::from(near <= far);
        }
        meets.iter().fold(0, |any, meets| any | meets) != 0
    }

    /// Which rays meet a triangle within their reach.
    #[inline(always)]
    fn meets_triangle(&self, edges: &Edges) -> [bool; LANES] {
        let mut meets = [false; LANES];
        for lane in 0..LANES {
            let [x, y, z] = self.direction.map(|component| component[lane]);
            let along = |normal: Vec3| normal.x * x + normal.y * y + normal.z * z;
            let [u, v, w] = edges.planes.map(along);
            let inside = smaller(u, smaller(v, w)) >= 0.0 || larger(u, larger(v, w)) <= 0.0;
            let towards = along(edges.normal);
            // The distance is offset / towards, compared without the division.
            let within =
                edges.offset * towards > 0.0 && edges.offset.abs() < self.reach[lane] * towards.abs();
            meets[lane] = inside && within;
        }
        meets
    }

    fn is_done(&self) -> bool {
        self.reach.iter().all(|reach| *reach == DONE)
    }
}

/// A triangle seen from a bundle's origin.
struct Edges {
    /// Normals of the planes through the origin and an edge each.
    planes: [Vec3; 3],
    /// Normal of the triangle, not of unit length.
    normal: Vec3,
    /// Distance of its plane along `normal`.
    offset: f32,
}

impl Edges {
    /// `corners` are relative to the origin.
    #[inline(always)]
    fn new([a, b, c]: [Vec3; 3]) -> Self {
        let plane = |from: Vec3, to: Vec3| (to - from).cross(to + from);
        let normal = (b - a).cross(c - a);
        Self { planes: [plane(a, b), plane(b, c), plane(c, a)], normal, offset: normal.dot(a) }
    }
}

struct Walk {
    start: Start,
    packs: [Pack; BUNDLE / LANES],
}

impl Walk {
    #[inline(always)]
    fn run(
        &mut self,
        bvh: &Bvh2,
        triangles: &[Triangle],
        directions: &[Vec3],
        opaque: &impl Fn(u32) -> bool,
        present: &impl Fn(u32, Vec3) -> bool,
    ) {
        let mut alive = (0..self.packs.len())
            .filter(|pack| !self.packs[*pack].is_done())
            .fold(0u8, |bits, i| bits | 1 << i);
        let mut stack: Vec<(u32, u8)> = Vec::with_capacity(64);
        stack.push((0, alive));
        while let Some((index, packs)) = stack.pop() {
            let node = &bvh.nodes[index as usize];
            let packs = self.entering(Vec3::from(node.aabb.min), Vec3::from(node.aabb.max), packs & alive);
            if packs == 0 {
                continue;
            }
            if node.prim_count == 0 {
                stack.push((node.first_index, packs));
                stack.push((node.first_index + 1, packs));
                continue;
            }
            for leaf in node.first_index..node.first_index + node.prim_count {
                let triangle = bvh.primitive_indices[leaf as usize];
                self.test(triangle, &triangles[triangle as usize], packs, directions, opaque, present);
            }
            for pack in bits(packs) {
                alive &= !(u8::from(self.packs[pack].is_done()) << pack);
            }
            if alive == 0 {
                break;
            }
        }
    }

    /// Those of `packs` that meet the box.
    #[inline(always)]
    fn entering(&self, min: Vec3, max: Vec3, packs: u8) -> u8 {
        let (low, high) = (min - self.start.origin, max - self.start.origin);
        let nearest = low.max(-high).max(Vec3::ZERO);
        let highest = (low * self.start.above).max(high * self.start.above).element_sum();
        if nearest.length_squared() > self.start.reach * self.start.reach || highest < 0.0 {
            return 0;
        }
        bits(packs)
            .fold(0, |entering, pack| entering | u8::from(self.packs[pack].meets_box(low, high)) << pack)
    }

    #[inline(always)]
    fn test(
        &mut self,
        index: u32,
        triangle: &Triangle,
        packs: u8,
        directions: &[Vec3],
        opaque: &impl Fn(u32) -> bool,
        present: &impl Fn(u32, Vec3) -> bool,
    ) {
        let corners =
            [triangle.v0, triangle.v1, triangle.v2].map(|corner| Vec3::from(corner) - self.start.origin);
        if corners.iter().all(|corner| corner.dot(self.start.above) < 0.0) {
            return;
        }
        let edges = Edges::new(corners);
        let opaque = opaque(index);
        for pack in bits(packs) {
            let meets = self.packs[pack].meets_triangle(&edges);
            for lane in 0..LANES {
                if meets[lane] && (opaque || present(index, directions[pack * LANES + lane])) {
                    self.packs[pack].reach[lane] = DONE;
                }
            }
        }
    }
}

/// The places of the bits that are set.
#[inline(always)]
fn bits(mut set: u8) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lowest = set.trailing_zeros() as usize;
        let found = set != 0;
        set &= set.wrapping_sub(1);
        found.then_some(lowest)
    })
}

/// `f32::min` without its care for NaN: one instruction.
#[inline(always)]
fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// `f32::max` likewise.
#[inline(always)]
fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}
