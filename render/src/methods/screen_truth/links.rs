//! Which points of neighbouring pixels are of one surface.
//!
//! Depths say little: a floor seen along itself jumps more from pixel to pixel than a leaf before a wall. So
//! the scene is asked what is between: where a surface goes on, halving the distance in the image again and
//! again makes the difference of depths small, and where there is a gap it stays.

use super::layers::{Eye, LayerPoint, Screen};
use rayon::prelude::*;

/// How often the distance of two pixels is halved.
const HALVINGS: u32 = 5;

/// Share of two pixels' difference of depths that is left of a surface that goes on.
const LEFT: f32 = 0.125;

/// Surfaces that are looked at between two pixels: the one behind goes on where a wire is before it.
const BETWEEN: usize = 2;

/// From a pixel to the neighbours that come after it, row by row: columns to the right and rows down.
const NEIGHBOURS: [(isize, isize); 4] = [(1, 0), (-1, 1), (0, 1), (1, 1)];

/// A pixel's layer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Node {
    /// Column, in the image with its guard band.
    pub x: usize,
    /// Row.
    pub y: usize,
    /// Which surface of the pixel.
    pub layer: usize,
}

/// Pairs of points of neighbouring pixels that are of one surface.
#[derive(Clone, Debug)]
pub struct Links {
    width: usize,
    height: usize,
    layers: usize,
    /// Of each pixel a bit for each neighbour of [`NEIGHBOURS`], its own layer and the neighbour's.
    bits: Vec<u16>,
}

impl Links {
    /// Of all pixels that a screen shows, which has two layers at most.
    pub fn new(eye: &Eye<'_>, screen: &Screen) -> Self {
        let (height, width, layers) = (screen.height, screen.width, screen.layers);
        let mut links = Self { width, height, layers, bits: Vec::new() };
        let pixel = |pixel: usize| {
            let (x, y) = (pixel % width, pixel / width);
            let mut bits = 0;
            for (direction, (across, down)) in NEIGHBOURS.into_iter().enumerate() {
                let Some((right, below)) = links.neighbour(x, y, across, down) else { continue };
                for (layer, a) in screen.pixel(x, y).iter().enumerate() {
                    for (other, b) in screen.pixel(right, below).iter().enumerate() {
                        let linked = a.zip(*b).is_some_and(|(a, b)| is_one_surface(eye, a, b));
                        bits |= u16::from(linked) << links.bit(direction, layer, other);
                    }
                }
            }
            bits
        };
        links.bits = (0..height * width).into_par_iter().map(pixel).collect();
        links
    }

    /// Whether a point and one of a neighbouring pixel that comes after it, row by row, are of one surface.
    pub fn joins(&self, a: Node, b: Node) -> bool {
        let step = (b.x as isize - a.x as isize, b.y as isize - a.y as isize);
        NEIGHBOURS.iter().position(|neighbour| *neighbour == step).is_some_and(|direction| {
            self.bits[a.y * self.width + a.x] >> self.bit(direction, a.layer, b.layer) & 1 == 1
        })
    }

    /// Whether a point's surface goes on to the left and right, above and below.
    pub fn surround(&self, node: Node) -> bool {
        [(1, 0), (-1, 0), (0, 1), (0, -1)].into_iter().all(|(across, down)| {
            let Some((x, y)) = self.neighbour(node.x, node.y, across, down) else { return false };
            let other = |layer: usize| Node { x, y, layer };
            let is_before = across + down < 0;
            let pair = |layer| if is_before { [other(layer), node] } else { [node, other(layer)] };
            (0..self.layers).map(pair).any(|[a, b]| self.joins(a, b))
        })
    }

    fn neighbour(&self, x: usize, y: usize, across: isize, down: isize) -> Option<(usize, usize)> {
        let (x, y) = (x.checked_add_signed(across)?, y.checked_add_signed(down)?);
        (x < self.width && y < self.height).then_some((x, y))
    }

    const fn bit(&self, direction: usize, layer: usize, other: usize) -> usize {
        (direction * self.layers + layer) * self.layers + other
    }
}

/// Whether a surface goes on from one point to another of a neighbouring pixel.
fn is_one_surface(eye: &Eye<'_>, mut a: LayerPoint, mut b: LayerPoint) -> bool {
    let apart = |a: &LayerPoint, b: &LayerPoint| (a.depth - b.depth).abs();
    let near = eye.footprint(a.depth.min(b.depth)).max(LEFT * apart(&a, &b));
    for _ in 0..HALVINGS {
        if apart(&a, &b) <= near {
            return true;
        }
        let farthest = |between: &LayerPoint| apart(&a, between).max(apart(&b, between));
        let surfaces = eye.surfaces(0.5 * (a.at + b.at), BETWEEN).into_iter();
        let Some(middle) = surfaces.min_by(|one, other| farthest(one).total_cmp(&farthest(other))) else {
            return false;
        };
        if apart(&a, &middle) > apart(&b, &middle) { b = middle } else { a = middle }
    }
    apart(&a, &b) <= near
}
