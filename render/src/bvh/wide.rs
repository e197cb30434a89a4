//! An eight-wide hierarchy for single rays. A node holds the boxes of its eight children, a leaf the corners
//! of up to eight triangles, components apart, so that a ray is tested against eight of them an instruction
//! (Wald, Benthin and Boulos, "Getting Rid of Packets", 2008).
//!
//! What each step brought, nearest hits of diffuse bounces in Sponza, one thread of a Xeon at 2.5 GHz under
//! other load, in parts of Embree 3.13's rate: `obvhs`' compressed eight-wide hierarchy 0.53; this one 1.12;
//! a stack of 32 visits instead of 96, which is cleared for each ray, 1.2. What brought nothing and is left
//! out: ending a leaf's test where no triangle is in the ray's line, other costs of leaves, twenty times as
//! much reinsertion. Slabs of one fused multiply-add are 3 % faster and lose rays that run along a box's
//! side.

mod collapse;
mod eight;
mod intersect;
mod walk;

use collapse::Tree;
use eight::{LANES, Processor};
use glam::{Vec3, Vec3A};
use obvhs::{aabb::Aabb, bvh2::Bvh2};
use walk::{Walk, WalkAll};

/// The hierarchy.
pub struct Wide {
    processor: Processor,
    /// The first is the root.
    nodes: Vec<Node>,
    leaves: Vec<Leaf>,
    /// Displacements of the corners of each leaf during the exposure; none where nothing moves.
    ways: Vec<Corners>,
    order: Vec<u32>,
}

/// A ray. Its vectors are written to memory whole: where a processor reads together what was written in
/// parts, it waits.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Where it starts, metres.
    pub origin: Vec3A,
    /// Not zero.
    pub direction: Vec3A,
    /// How far it goes, in lengths of its direction.
    pub reach: f32,
    /// The moment of the exposure, from -0.5 to 0.5, at which it meets what moves.
    pub time: f32,
}

/// Rays with one start, in the middle of the exposure.
#[derive(Clone, Copy, Debug)]
pub struct Fan<'a> {
    /// Where they start, metres.
    pub origin: Vec3,
    /// At most 64, none of them zero.
    pub directions: &'a [Vec3],
    /// How far they go, in lengths of their directions.
    pub reach: f32,
}

/// Eight boxes, and what is in them.
#[repr(C, align(64))]
struct Node {
    /// x, y and z of all low corners, and of all high corners.
    bounds: [[[f32; LANES]; 2]; 3],
    children: [Child; LANES],
}

/// A node or, with the highest bit set, a leaf.
#[derive(Clone, Copy)]
struct Child(u32);

/// x, y and z of all three corners of eight triangles; where there is no triangle, of one point.
type Corners = [[[f32; LANES]; 3]; 3];

/// Up to eight triangles, one after the other in the order of the leaves.
#[repr(C, align(64))]
struct Leaf {
    corners: Corners,
    /// Place of the first.
    first: u32,
    /// Bit i is set where the i-th must be asked whether it is there.
    asked: u32,
}

impl Wide {
    /// An eight-wide hierarchy from a binary one that has one triangle a leaf. `corners` are those of a
    /// triangle, `asked` says whether it is not simply there.
    pub fn new(binary: &Bvh2, corners: impl Fn(u32) -> [Vec3; 3], asked: impl Fn(u32) -> bool) -> Self {
        let Tree { nodes, leaves, order, .. } = Tree::new(binary);
        let leaf = |range: &std::ops::Range<usize>| {
            let triangles = &order[range.clone()];
            let bits = triangles.iter().enumerate();
            Leaf {
                corners: side_by_side(triangles, &corners),
                first: range.start as u32,
                asked: bits.fold(0, |bits, (lane, index)| bits | u32::from(asked(*index)) << lane),
            }
        };
        let leaves = leaves.iter().map(leaf).collect();
        Self { processor: Processor::new(), nodes, leaves, ways: vec![], order }
    }

    /// The same over triangles that move; the boxes of the binary hierarchy hold their whole ways. `ways` are
    /// the displacements of a triangle's corners during the exposure, in whose middle they are where they
    /// are.
    #[must_use]
    pub fn moving(mut self, ways: impl Fn(u32) -> [Vec3; 3]) -> Self {
        let ends = self.leaves.iter().skip(1).map(|leaf| leaf.first as usize).chain([self.order.len()]);
        let ranges = self.leaves.iter().zip(ends).map(|(leaf, end)| leaf.first as usize..end);
        self.ways = ranges.map(|range| side_by_side(&self.order[range], &ways)).collect();
        self
    }

    /// The triangles in the order of the leaves: rays are told places in it.
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// Distance and place of the nearest triangle within a ray's reach; of those that must be asked, only
    /// where they are `there`.
    #[inline(always)]
    pub fn nearest(&self, ray: &Ray, there: impl Fn(u32) -> bool) -> Option<(f32, u32)> {
        if self.ways.is_empty() {
            return self.processor.run(Walk::<_, true, false> { wide: self, ray, there });
        }
        self.processor.run(Walk::<_, true, true> { wide: self, ray, there })
    }

    /// Whether any triangle is within a ray's reach; of those that must be asked, only where they are
    /// `there`. Each is asked once.
    #[inline(always)]
    pub fn blocked(&self, ray: &Ray, there: impl Fn(u32) -> bool) -> bool {
        if self.ways.is_empty() {
            return self.processor.run(Walk::<_, false, false> { wide: self, ray, there }).is_some();
        }
        self.processor.run(Walk::<_, false, true> { wide: self, ray, there }).is_some()
    }

    /// Bit `i` is set where any triangle is within the reach of the ray of direction `i`; of those that must
    /// be asked, only where they are `there` for that direction. The nearer neighbours are to each other, the
    /// faster it goes.
    pub fn all_blocked(&self, fan: Fan<'_>, there: impl Fn(u32, Vec3) -> bool) -> u64 {
        self.processor.run(WalkAll { wide: self, fan, there })
    }
}

/// Three vectors each of up to eight triangles, components apart.
fn side_by_side(triangles: &[u32], vectors: impl Fn(u32) -> [Vec3; 3]) -> Corners {
    let mut corners = [[[0.0; LANES]; 3]; 3];
    for (lane, triangle) in triangles.iter().enumerate() {
        for (corner, vector) in vectors(*triangle).into_iter().enumerate() {
            for axis in 0..3 {
                corners[axis][corner][lane] = vector[axis];
            }
        }
    }
    corners
}

impl Child {
    const LEAF: u32 = 1 << 31;

    const fn node(index: usize) -> Self {
        Self(index as u32)
    }

    const fn leaf(index: usize) -> Self {
        Self(index as u32 | Self::LEAF)
    }
}

impl Node {
    /// Boxes that no ray meets. One whose direction is not a number enters them all: that must not lead back
    /// to a node, or it would never end.
    const EMPTY: Self = Self {
        bounds: [[[f32::INFINITY; LANES], [f32::NEG_INFINITY; LANES]]; 3],
        children: [Child::leaf(0); LANES],
    };

    fn set(&mut self, slot: usize, bounds: &Aabb, child: Child) {
        for axis in 0..3 {
            self.bounds[axis][0][slot] = bounds.min[axis];
            self.bounds[axis][1][slot] = bounds.max[axis];
        }
        self.children[slot] = child;
    }
}

#[cfg(test)]
mod tests;
