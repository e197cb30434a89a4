//! From a binary hierarchy to an eight-wide one of least expected cost (surface area heuristic), by dynamic
//! programming over the binary tree: for each of its subtrees, the cheapest forest of at most 1 to 7 roots
//! (Ylitie, Karras and Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs",
//! 2017, 3.1).

use super::eight::LANES;
use super::{Child, Node};
use obvhs::bvh2::Bvh2;
use std::ops::Range;

/// Cost of testing a leaf's triangles, where that of a node's boxes is 1. From 0.5 to 2, rays are equally
/// fast.
const LEAF_COST: f32 = 1.0;

/// How a subtree becomes a forest.
#[derive(Clone, Copy, Default)]
struct CollapseCosts {
    /// Cost of the best forest of at most i + 1 roots.
    cost: [f32; LANES - 1],
    /// How many of at most i + 2 roots come from the first child; 0 where fewer roots do as well.
    first_takes: [u8; LANES - 1],
    /// Triangles, at most 255.
    triangles: u8,
    /// Whether one root is a leaf.
    leaf: bool,
}

/// An eight-wide tree.
pub struct Tree<'a> {
    binary: &'a Bvh2,
    plans: Vec<CollapseCosts>,
    /// The first is the root.
    pub nodes: Vec<Node>,
    /// Where the triangles of each leaf are in `order`, at most [`LANES`] of them.
    pub leaves: Vec<Range<usize>>,
    /// Indices of triangles.
    pub order: Vec<u32>,
}

/// The costs of each node of a binary hierarchy with one triangle a leaf.
fn plans(binary: &Bvh2) -> Vec<CollapseCosts> {
    let mut plans = vec![CollapseCosts::default(); binary.nodes.len()];
    for index in children_first(binary) {
        let node = &binary.nodes[index];
        let area = node.aabb.half_area();
        plans[index] = if node.is_leaf() {
            let cost = [area * LEAF_COST; LANES - 1];
            CollapseCosts {
                cost,
                triangles: node.prim_count.min(255) as u8,
                leaf: true,
                ..CollapseCosts::default()
            }
        } else {
            let first = node.first_index as usize;
            joined(area, &plans[first], &plans[first + 1])
        };
    }
    plans
}

/// The costs of a node from those of its children.
fn joined(area: f32, first: &CollapseCosts, second: &CollapseCosts) -> CollapseCosts {
    let triangles = first.triangles.saturating_add(second.triangles);
    let mut plan = CollapseCosts { triangles, ..CollapseCosts::default() };
    for roots in 2..=LANES {
        let split = |takes: usize| first.cost[takes - 1] + second.cost[roots - takes - 1];
        let fewest = 1.max(roots.saturating_sub(LANES - 1));
        let takes = (fewest..=roots - fewest).min_by(|a, b| split(*a).total_cmp(&split(*b))).unwrap_or(1);
        plan.first_takes[roots - 2] = takes as u8;
        if roots < LANES {
            plan.cost[roots - 1] = split(takes);
        } else {
            plan.cost[0] = area + split(takes);
        }
    }
    let leaf = area * LEAF_COST;
    if usize::from(triangles) <= LANES && leaf <= plan.cost[0] {
        plan.leaf = true;
        plan.cost[0] = leaf;
    }
    for roots in 2..LANES {
        if plan.cost[roots - 2] <= plan.cost[roots - 1] {
            plan.cost[roots - 1] = plan.cost[roots - 2];
            plan.first_takes[roots - 2] = 0;
        }
    }
    plan
}

/// All nodes, children before their parents.
fn children_first(binary: &Bvh2) -> Vec<usize> {
    let mut order = Vec::with_capacity(binary.nodes.len());
    let mut stack = vec![0];
    while let Some(index) = stack.pop() {
        order.push(index);
        let node = &binary.nodes[index];
        if !node.is_leaf() {
            stack.extend([node.first_index as usize, node.first_index as usize + 1]);
        }
    }
    order.reverse();
    order
}

impl<'a> Tree<'a> {
    /// The tree of least cost from a binary one that has one triangle a leaf.
    pub fn new(binary: &'a Bvh2) -> Self {
        let order = Vec::with_capacity(binary.primitive_indices.len());
        let mut tree = Self { binary, plans: plans(binary), nodes: vec![Node::EMPTY], leaves: vec![], order };
        tree.grow();
        tree
    }

    fn grow(&mut self) {
        if self.plans[0].leaf {
            let leaf = self.leaf(0);
            self.nodes[0].set(0, &self.binary.nodes[0].aabb, leaf);
            return;
        }
        // Binary nodes that become wide ones, with the places of these.
        let mut stack = vec![(0, 0)];
        while let Some((binary, wide)) = stack.pop() {
            let roots = self.roots(binary);
            for (slot, root) in roots.iter().enumerate() {
                let child = if self.plans[*root].leaf {
                    self.leaf(*root)
                } else {
                    self.nodes.push(Node::EMPTY);
                    stack.push((*root, self.nodes.len() - 1));
                    Child::node(self.nodes.len() - 1)
                };
                self.nodes[wide].set(slot, &self.binary.nodes[*root].aabb, child);
            }
        }
    }

    /// The binary nodes that become children of a wide node.
    fn roots(&self, binary: usize) -> Vec<usize> {
        let mut roots = Vec::with_capacity(LANES);
        let first = self.binary.nodes[binary].first_index as usize;
        let takes = usize::from(self.plans[binary].first_takes[LANES - 2]);
        let mut forests = vec![(first + 1, LANES - takes), (first, takes)];
        while let Some((index, mut most)) = forests.pop() {
            let plan = &self.plans[index];
            while most > 1 && plan.first_takes[most - 2] == 0 {
                most -= 1;
            }
            if most == 1 {
                roots.push(index);
            } else {
                let takes = usize::from(plan.first_takes[most - 2]);
                let first = self.binary.nodes[index].first_index as usize;
                forests.extend([(first + 1, most - takes), (first, takes)]);
            }
        }
        roots
    }

    /// A leaf with all triangles below a binary node.
    fn leaf(&mut self, binary: usize) -> Child {
        let first = self.order.len();
        let mut stack = vec![binary];
        while let Some(index) = stack.pop() {
            let node = &self.binary.nodes[index];
            let children = node.first_index as usize;
            if node.is_leaf() {
                self.order
                    .extend(&self.binary.primitive_indices[children..children + node.prim_count as usize]);
            } else {
                stack.extend([children + 1, children]);
            }
        }
        self.leaves.push(first..self.order.len());
        Child::leaf(self.leaves.len() - 1)
    }
}
