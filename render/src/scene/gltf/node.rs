//! The node hierarchy: where each node is in the world, and which nodes the scene shows (glTF 2.0, 3.5).

use super::{super::SceneError, animation::Pose, document::File};
use glam::Mat4;
use gltf::Node;

/// The nodes of a file in the world.
#[derive(Debug)]
pub(super) struct Hierarchy {
    /// From each node of the file to the world.
    pub worlds: Vec<Mat4>,
    /// The nodes that the scene shows, parents before children.
    pub shown: Vec<usize>,
    /// The parent of each node.
    pub parents: Vec<Option<usize>>,
    /// All nodes, parents before children.
    pub order: Vec<usize>,
}

impl Hierarchy {
    /// Places all nodes of a file.
    pub fn new(file: &File<'_>, pose: &Pose) -> Result<Self, SceneError> {
        let nodes: Vec<_> = file.document.nodes().collect();
        let parents = parents(file, &nodes)?;
        let roots: Vec<_> = (0..nodes.len()).filter(|node| parents[*node].is_none()).collect();
        let order = depth_first(&nodes, &roots);
        if let Some(node) = (0..nodes.len()).find(|node| !order.contains_node(*node)) {
            return Err(file.invalid(format!("{} is its own ancestor", label(&nodes[node]))));
        }
        let worlds = worlds(&pose.locals, &parents, &order.nodes);
        let scene = file.document.default_scene().or_else(|| file.document.scenes().next());
        let roots = scene.map_or(roots, |scene| scene.nodes().map(|node| node.index()).collect());
        Ok(Self { worlds, shown: depth_first(&nodes, &roots).nodes, parents, order: order.nodes })
    }

    /// The nodes that the scene shows, with their places.
    pub fn nodes<'a>(&self, file: &'a File<'_>) -> impl Iterator<Item = (Node<'a>, Mat4)> {
        self.shown.iter().filter_map(|index| Some((file.document.nodes().nth(*index)?, self.worlds[*index])))
    }
}

/// From each node to the world, of what takes it to its parent. `order` has parents before children.
pub(super) fn worlds(locals: &[Mat4], parents: &[Option<usize>], order: &[usize]) -> Vec<Mat4> {
    let mut worlds = locals.to_vec();
    for node in order {
        if let Some(parent) = parents[*node] {
            worlds[*node] = worlds[parent] * worlds[*node];
        }
    }
    worlds
}

/// How errors and unnamed objects call a node.
pub(super) fn label(node: &Node<'_>) -> String {
    node.name()
        .map_or_else(|| format!("node {}", node.index()), |name| format!("node {} `{name}`", node.index()))
}

/// The parent of each node.
fn parents(file: &File<'_>, nodes: &[Node<'_>]) -> Result<Vec<Option<usize>>, SceneError> {
    let mut parents = vec![None; nodes.len()];
    for node in nodes {
        for child in node.children() {
            if parents[child.index()].replace(node.index()).is_some() {
                return Err(file.invalid(format!("{} has two parents", label(&child))));
            }
        }
    }
    Ok(parents)
}

/// Nodes in an order, each once.
struct Order {
    nodes: Vec<usize>,
    seen: Vec<bool>,
}

impl Order {
    fn contains_node(&self, node: usize) -> bool {
        self.seen[node]
    }
}

/// The nodes below `roots`, parents before children, each once.
fn depth_first(nodes: &[Node<'_>], roots: &[usize]) -> Order {
    let mut order = Order { nodes: Vec::new(), seen: vec![false; nodes.len()] };
    let mut waiting: Vec<usize> = roots.iter().rev().copied().collect();
    while let Some(node) = waiting.pop() {
        if !std::mem::replace(&mut order.seen[node], true) {
            order.nodes.push(node);
            let children: Vec<_> = nodes[node].children().map(|child| child.index()).collect();
            waiting.extend(children.into_iter().rev());
        }
    }
    order
}
