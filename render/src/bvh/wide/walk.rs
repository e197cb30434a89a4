//! Rays on their way through an eight-wide hierarchy, to the nearest child first.

use super::eight::{Eight, LANES, WithEight};
use super::intersect::{Shear, Slabs, moved};
use super::{Child, Fan, Node, Ray, Wide};
use glam::Vec3;

/// Visits that wait on the stack, which is cleared for every walk; more of them go to the heap.
const WAITING: usize = 32;

/// A ray to the nearest triangle, or to any, through what moves or does not.
pub struct Walk<'a, T, const NEAREST: bool, const MOVING: bool> {
    pub wide: &'a Wide,
    pub ray: &'a Ray,
    /// Whether a triangle that must be asked is there.
    pub there: T,
}

impl<T: Fn(u32) -> bool, const NEAREST: bool, const MOVING: bool> WithEight for Walk<'_, T, NEAREST, MOVING> {
    type Output = Option<(f32, u32)>;

    #[inline(always)]
    fn with<E: Eight>(self, eight: E) -> Self::Output {
        let lines = Lines::new(eight, self.ray);
        let met = self.walk(eight, &lines, &mut Waiting::new());
        met.triangle.map(|triangle| (met.reach, triangle))
    }
}

/// Rays of a fan, each to any triangle. A ray first tries the leaf that the last one ended in: neighbours
/// often end at the same triangles, and which one it is does not matter.
pub struct WalkAll<'a, T> {
    pub wide: &'a Wide,
    pub fan: Fan<'a>,
    /// Whether a triangle that must be asked is there for the ray of a direction.
    pub there: T,
}

impl<T: Fn(u32, Vec3) -> bool> WithEight for WalkAll<'_, T> {
    type Output = u64;

    #[inline(always)]
    fn with<E: Eight>(self, eight: E) -> u64 {
        let Fan { origin, directions, reach } = self.fan;
        let mut waiting = Waiting::new();
        let (mut blocked, mut last) = (0, None);
        for (i, direction) in directions.iter().enumerate() {
            let ray = Ray { origin: origin.into(), direction: (*direction).into(), reach, time: 0.0 };
            let there = |triangle: u32| (self.there)(triangle, *direction);
            let walk = Walk::<_, false, false> { wide: self.wide, ray: &ray, there };
            let lines = Lines::new(eight, &ray);
            let mut met = Met::nothing(reach);
            let again = last.is_some_and(|leaf| walk.test(eight, &lines, leaf, &mut met));
            if !again {
                met = walk.walk(eight, &lines, &mut waiting);
            }
            if met.triangle.is_some() {
                blocked |= 1 << i;
                last = Some(met.leaf);
            }
        }
        blocked
    }
}

/// A ray as the tests need it.
struct Lines<E: Eight> {
    slabs: Slabs<E>,
    shear: Shear<E>,
}

impl<E: Eight> Lines<E> {
    #[inline(always)]
    fn new(eight: E, ray: &Ray) -> Self {
        let inverse = ray.inverse();
        Self { slabs: Slabs::new(eight, ray.origin, inverse), shear: Shear::new(eight, ray, inverse) }
    }
}

/// What a ray has met so far.
struct Met {
    reach: f32,
    triangle: Option<u32>,
    /// The leaf of that.
    leaf: usize,
}

impl Met {
    #[inline(always)]
    const fn nothing(reach: f32) -> Self {
        Self { reach, triangle: None, leaf: 0 }
    }
}

impl<T: Fn(u32) -> bool, const NEAREST: bool, const MOVING: bool> Walk<'_, T, NEAREST, MOVING> {
    #[inline(always)]
    fn walk<E: Eight>(&self, eight: E, lines: &Lines<E>, waiting: &mut Waiting) -> Met {
        let mut met = Met::nothing(self.ray.reach);
        let mut child = Child::node(0);
        waiting.clear();
        loop {
            if child.0 & Child::LEAF == 0 {
                let node = &self.wide.nodes[child.0 as usize];
                let (near, entered) = lines.slabs.enter(eight, node, met.reach);
                if entered != 0 {
                    child = waiting.all_but_nearest::<NEAREST>(node, &near, entered);
                    continue;
                }
            } else {
                let leaf = (child.0 ^ Child::LEAF) as usize;
                if self.test(eight, lines, leaf, &mut met) {
                    return met;
                }
            }
            match waiting.next(met.reach) {
                Some(next) => child = next,
                None => return met,
            }
        }
    }

    /// Cuts the ray off at the nearest triangle of a leaf that it meets. Whether that ends it.
    #[inline(always)]
    fn test<E: Eight>(&self, eight: E, lines: &Lines<E>, index: usize, met: &mut Met) -> bool {
        let leaf = &self.wide.leaves[index];
        let (distances, mut meets) = if MOVING {
            let now = moved(eight, &leaf.corners, &self.wide.ways[index], self.ray.time);
            lines.shear.meets(eight, &now, met.reach)
        } else {
            lines.shear.meets(eight, &leaf.corners, met.reach)
        };
        while meets != 0 {
            let lane = meets.trailing_zeros();
            meets &= meets - 1;
            let distance = distances[lane as usize % LANES];
            let triangle = leaf.first + lane;
            if distance < met.reach && (leaf.asked >> lane & 1 == 0 || (self.there)(triangle)) {
                *met = Met { reach: distance, triangle: Some(triangle), leaf: index };
                if !NEAREST {
                    return true;
                }
            }
        }
        false
    }
}

/// Children that a ray has yet to visit, the nearest of each node last. A visit is the bits of the distance,
/// then the child: distances are not negative, so that visits order as they do.
struct Waiting {
    visits: [u64; WAITING],
    count: usize,
    /// Older ones.
    more: Vec<u64>,
}

impl Waiting {
    #[inline(always)]
    fn new() -> Self {
        Self { visits: [0; WAITING], count: 0, more: Vec::new() }
    }

    #[inline(always)]
    fn clear(&mut self) {
        self.count = 0;
        self.more.clear();
    }

    /// The nearest child that is entered; the others wait.
    #[inline(always)]
    fn all_but_nearest<const NEAREST: bool>(
        &mut self,
        node: &Node,
        near: &[f32; LANES],
        mut entered: u32,
    ) -> Child {
        let mut nearest = visit(node, near, entered.trailing_zeros());
        entered &= entered - 1;
        if entered == 0 {
            return Child(nearest as u32);
        }
        if self.count + LANES > WAITING {
            self.more.extend(&self.visits[..self.count]);
            self.count = 0;
        }
        let first = self.count;
        while entered != 0 {
            let other = visit(node, near, entered.trailing_zeros());
            entered &= entered - 1;
            let farther = nearest.max(other);
            nearest = nearest.min(other);
            let mut place = self.count;
            while NEAREST && place > first && self.visits[place - 1] < farther {
                self.visits[place] = self.visits[place - 1];
                place -= 1;
            }
            self.visits[place] = farther;
            self.count += 1;
        }
        Child(nearest as u32)
    }

    /// The next child within reach.
    #[inline(always)]
    fn next(&mut self, reach: f32) -> Option<Child> {
        loop {
            let visit = if self.count > 0 {
                self.count -= 1;
                self.visits[self.count]
            } else {
                self.more.pop()?
            };
            if f32::from_bits((visit >> 32) as u32) <= reach {
                return Some(Child(visit as u32));
            }
        }
    }
}

#[inline(always)]
fn visit(node: &Node, near: &[f32; LANES], lane: u32) -> u64 {
    let lane = lane as usize % LANES;
    u64::from(near[lane].to_bits()) << 32 | u64::from(node.children[lane].0)
}
