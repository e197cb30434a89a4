//! A hierarchy over what the pixels of an image show, to gather from near ones one by one and from far ones
//! together (Jensen and Buhler 2002, "A rapid hierarchical rendering technique for translucent materials").

use super::{Patch, SUPPORT, TOLERANCE, profile, within};
use crate::scene::Bounds;
use glam::Vec3;
use std::f32::consts::FRAC_1_PI;

/// Most patches of a leaf.
const LEAF: usize = 4;

/// Patches under a binary tree of boxes, split at the median.
pub(super) struct Tree {
    /// In the order of the leaves.
    patches: Vec<Patch>,
    /// Parents before children; the first is the root, of all patches.
    nodes: Vec<Node>,
}

/// Some patches as one.
#[derive(Clone, Copy, Debug)]
struct Node {
    /// Their middle, weighted by area.
    centre: Vec3,
    /// Of a sphere around `centre` that holds all their middles.
    radius: f32,
    /// Of all together.
    area: f32,
    /// Mean radiance, weighted by area.
    light: Vec3,
    /// The patches.
    first: usize,
    count: usize,
    /// Index of the first child, which the second follows; `None` of a leaf.
    children: Option<usize>,
}

impl Tree {
    /// A tree over patches; of none, it has a node without weight.
    pub fn new(patches: Vec<Patch>) -> Self {
        let count = patches.len();
        let mut tree = Self { patches, nodes: Vec::with_capacity(count) };
        let root = tree.arranged(0, count);
        tree.nodes.push(root);
        let mut next = 0;
        while let Some(Node { first, count, .. }) = tree.nodes.get(next).copied() {
            if count > LEAF {
                tree.nodes[next].children = Some(tree.nodes.len());
                let half = count / 2;
                let children = [tree.arranged(first, half), tree.arranged(first + half, count - half)];
                tree.nodes.extend(children);
            }
            next += 1;
        }
        tree
    }

    /// A node of some patches, which are put in order about their median.
    fn arranged(&mut self, first: usize, count: usize) -> Node {
        let patches = &mut self.patches[first..first + count];
        let area: f32 = patches.iter().map(|patch| patch.area).sum();
        let mean = |value: fn(&Patch) -> Vec3| {
            patches.iter().map(|patch| value(patch) * (patch.area / area)).sum::<Vec3>()
        };
        let (centre, light) = (mean(|patch| patch.position), mean(|patch| patch.light));
        let radius = patches.iter().map(|patch| patch.position.distance(centre)).fold(0.0, f32::max);
        let size = patches.iter().fold(Bounds::EMPTY, |bounds, patch| bounds.grow(patch.position)).size();
        let axis = size.max_position();
        if count > LEAF {
            patches.select_nth_unstable_by(count / 2, |a, b| a.position[axis].total_cmp(&b.position[axis]));
        }
        Node { centre, radius, area, light, first, count, children: None }
    }

    /// Light scattered to a patch, which is one of the tree's.
    pub fn gather(&self, receiver: &Patch) -> Vec3 {
        let channel = |c: usize| match receiver.mean_free_path[c] {
            d if d > 0.0 => self.gather_channel(receiver, c, d),
            _ => receiver.light[c],
        };
        Vec3::new(channel(0), channel(1), channel(2))
    }

    /// One colour, for the profile's scale `d`.
    fn gather_channel(&self, receiver: &Patch, channel: usize, d: f32) -> f32 {
        let (mut light, mut weights) = (0.0, 0.0);
        let mut add = |weight: f32, radiance: Vec3| {
            light += weight * radiance[channel];
            weights += weight;
        };
        let mut waiting = vec![0];
        while let Some(index) = waiting.pop() {
            let node = &self.nodes[index];
            let r = receiver.position.distance(node.centre);
            if r - node.radius > SUPPORT * d {
                continue;
            }
            let weight = node.area * profile(r, d);
            // The profile falls by at most 1 / r + 1 / d of itself a metre.
            if r > 2.0 * node.radius && weight * node.radius * (1.0 / r + 1.0 / d) < TOLERANCE {
                add(weight, node.light);
            } else if let Some(children) = node.children {
                waiting.extend([children, children + 1]);
            } else {
                for patch in &self.patches[node.first..][..node.count] {
                    add(weight_of(patch, receiver, d), patch.light);
                }
            }
        }
        light / weights
    }
}

/// The profile from a patch to another times its area; to itself, the share of a disc of that area.
pub(super) fn weight_of(patch: &Patch, receiver: &Patch, d: f32) -> f32 {
    let own = (patch.area * FRAC_1_PI).sqrt();
    let r = patch.position.distance(receiver.position);
    if r == 0.0 { within(own, d) } else { patch.area * profile(r.max(own), d) }
}
