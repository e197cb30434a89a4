//! A ray against eight boxes, and against eight triangles.
//!
//! Boxes by the slab test, conservative about rounding (Ize, "Robust BVH Ray Traversal", 2013). Triangles by
//! the test of Woop, Benthin and Wald ("Watertight Ray/Triangle Intersection", 2013): seen along the ray and
//! sheared to it, edges that two triangles share are exact opposites, and a difference of two products never
//! has the wrong sign, so that no ray slips through between. Their fallback to f64 serves the rule that only
//! one of the two is met, which we do not need: an edge belongs to both.

use super::eight::{Eight, LANES};
use super::{Corners, Node, Ray};
use glam::Vec3A;

/// A direction's component nearer to zero is taken as this, so that zero times infinity never occurs.
const SMALLEST: f32 = 1e-18;
/// A box's far side is moved away by this, more than the rounding of the distances.
const FAR_SIDE: f32 = 1.000_001;

/// Where corners are at a moment of their ways.
#[inline(always)]
pub fn moved<E: Eight>(eight: E, corners: &Corners, ways: &Corners, time: f32) -> Corners {
    let time = eight.splat(time);
    let mut now = *corners;
    for axis in 0..3 {
        for corner in 0..3 {
            let (from, way) = (eight.load(&corners[axis][corner]), eight.load(&ways[axis][corner]));
            now[axis][corner] = eight.store(eight.mul_add(time, way, from));
        }
    }
    now
}

impl Ray {
    /// One over each component of the direction.
    #[inline(always)]
    pub fn inverse(&self) -> Vec3A {
        let [x, y, z] = self.direction.to_array();
        Vec3A::new(safe(x).recip(), safe(y).recip(), safe(z).recip())
    }
}

#[inline(always)]
fn safe(component: f32) -> f32 {
    if component.abs() < SMALLEST { SMALLEST } else { component }
}

/// A ray as the test with boxes needs it.
pub struct Slabs<E: Eight> {
    origin: [E::Numbers; 3],
    inverse: [E::Numbers; 3],
    /// Which side of a box is the near one: 0 for the low one, 1 for the high one.
    near_side: [usize; 3],
}

impl<E: Eight> Slabs<E> {
    #[inline(always)]
    pub fn new(eight: E, origin: Vec3A, inverse: Vec3A) -> Self {
        let [x, y, z] = inverse.to_array();
        Self {
            origin: [eight.splat(origin.x), eight.splat(origin.y), eight.splat(origin.z)],
            inverse: [eight.splat(x), eight.splat(y), eight.splat(z)],
            near_side: [usize::from(x < 0.0), usize::from(y < 0.0), usize::from(z < 0.0)],
        }
    }

    /// Where the ray enters the boxes of a node, and those that it enters within its reach.
    #[inline(always)]
    pub fn enter(&self, eight: E, node: &Node, reach: f32) -> ([f32; LANES], u32) {
        let (x0, x1) = self.slab(eight, node, 0);
        let (y0, y1) = self.slab(eight, node, 1);
        let (z0, z1) = self.slab(eight, node, 2);
        let near = eight.max(eight.max(x0, y0), eight.max(z0, eight.splat(0.0)));
        let far = eight.mul(eight.min(eight.min(x1, y1), z1), eight.splat(FAR_SIDE));
        let entered = eight.at_most(near, eight.min(far, eight.splat(reach)));
        (eight.store(near), entered)
    }

    /// Where the ray crosses the near and the far sides of boxes along an axis.
    #[inline(always)]
    fn slab(&self, eight: E, node: &Node, axis: usize) -> (E::Numbers, E::Numbers) {
        let sides = &node.bounds[axis];
        let near = eight.load(&sides[self.near_side[axis]]);
        let far = eight.load(&sides[1 - self.near_side[axis]]);
        (
            eight.mul(eight.sub(near, self.origin[axis]), self.inverse[axis]),
            eight.mul(eight.sub(far, self.origin[axis]), self.inverse[axis]),
        )
    }
}

/// A ray as the test with triangles needs it: axes in an order that ends with its direction's largest
/// component, and the shear and scale that make that axis of the direction.
pub struct Shear<E: Eight> {
    axes: [usize; 3],
    origin: [E::Numbers; 3],
    x: E::Numbers,
    y: E::Numbers,
    z: f32,
}

impl<E: Eight> Shear<E> {
    #[inline(always)]
    pub fn new(eight: E, ray: &Ray, inverse: Vec3A) -> Self {
        let size = ray.direction.abs();
        let axes = if size.x > size.y && size.x > size.z {
            [1, 2, 0]
        } else if size.y > size.z {
            [2, 0, 1]
        } else {
            [0, 1, 2]
        };
        let z = inverse[axes[2]];
        Self {
            axes,
            origin: [
                eight.splat(ray.origin[axes[0]]),
                eight.splat(ray.origin[axes[1]]),
                eight.splat(ray.origin[axes[2]]),
            ],
            x: eight.splat(-ray.direction[axes[0]] * z),
            y: eight.splat(-ray.direction[axes[1]] * z),
            z,
        }
    }

    /// Distances of eight triangles, and those that the ray meets within its reach.
    #[inline(always)]
    pub fn meets(&self, eight: E, corners: &Corners, reach: f32) -> ([f32; LANES], u32) {
        let [x, y, z] = [&corners[self.axes[0]], &corners[self.axes[1]], &corners[self.axes[2]]];
        let (ax, ay, az) = self.seen(eight, &x[0], &y[0], &z[0]);
        let (bx, by, bz) = self.seen(eight, &x[1], &y[1], &z[1]);
        let (cx, cy, cz) = self.seen(eight, &x[2], &y[2], &z[2]);
        // Weights of the corners: areas of which the edges opposite are sides.
        let u = eight.sub(eight.mul(cx, by), eight.mul(cy, bx));
        let v = eight.sub(eight.mul(ax, cy), eight.mul(ay, cx));
        let w = eight.sub(eight.mul(bx, ay), eight.mul(by, ax));
        let zero = eight.splat(0.0);
        let least = eight.min(u, eight.min(v, w));
        let most = eight.max(u, eight.max(v, w));
        let inside = eight.at_most(zero, least) | eight.at_most(most, zero);
        let area = eight.add(eight.add(u, v), w);
        let depth = eight.mul_add(u, az, eight.mul_add(v, bz, eight.mul(w, cz)));
        let distance = eight.div(eight.mul(depth, eight.splat(self.z)), area);
        // A triangle without area gives a distance that is not a number.
        let within = eight.below(zero, distance) & eight.below(distance, eight.splat(reach));
        (eight.store(distance), inside & within)
    }

    /// A corner of all triangles, seen along the ray: beside it, beside it, and along the axis.
    #[inline(always)]
    fn seen(
        &self,
        eight: E,
        x: &[f32; LANES],
        y: &[f32; LANES],
        z: &[f32; LANES],
    ) -> (E::Numbers, E::Numbers, E::Numbers) {
        let z = eight.sub(eight.load(z), self.origin[2]);
        let x = eight.mul_add(self.x, z, eight.sub(eight.load(x), self.origin[0]));
        let y = eight.mul_add(self.y, z, eight.sub(eight.load(y), self.origin[1]));
        (x, y, z)
    }
}
