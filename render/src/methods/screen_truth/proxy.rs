//! What a screen shows as a scene: two triangles between four pixels of one surface, and where a surface
//! ends, a square of a pixel's footprint, so that it is not narrower than it is seen.

use super::layers::{Eye, LayerPoint, Screen};
use super::links::{Links, Node};
use crate::bvh::TracedScene;
use crate::sampler::frame;
use crate::scene::{Material, Mesh, Scene, SceneError};
use glam::Vec3;
use rayon::prelude::*;

/// The four pixels of a block, row by row.
const CORNERS: [(usize, usize); 4] = [(0, 0), (1, 0), (0, 1), (1, 1)];

/// The two ways to cut a block into triangles, each with its corners row by row.
const CUTS: [[[usize; 3]; 2]; 2] = [[[0, 1, 3], [0, 2, 3]], [[0, 1, 2], [1, 2, 3]]];

/// A mesh of all that a screen shows, opaque; `None` where it shows nothing.
///
/// # Errors
/// If there is more than memory holds.
pub fn scene(eye: &Eye<'_>, screen: &Screen) -> Result<Option<TracedScene>, SceneError> {
    let mut mesh = mesh(eye, screen);
    mesh.drop_degenerate_triangles();
    if mesh.triangles.is_empty() {
        return Ok(None);
    }
    let name = eye.scene.scene().name.clone();
    let materials = vec![Material::default()];
    TracedScene::new(Scene { name, meshes: vec![mesh].into(), materials, ..Scene::default() }).map(Some)
}

fn mesh(eye: &Eye<'_>, screen: &Screen) -> Mesh {
    let links = Links::new(eye, screen);
    let position = |point: &Option<LayerPoint>| point.map_or(Vec3::ZERO, |point| point.position);
    let blocks = screen.height.saturating_sub(1) * screen.width.saturating_sub(1);
    let block = |index: usize| {
        let (x, y) = (index % (screen.width - 1), index / (screen.width - 1));
        block(screen, &links, x, y)
    };
    let mut mesh = Mesh {
        positions: screen.points().iter().map(position).collect(),
        triangles: (0..blocks).into_par_iter().flat_map_iter(block).collect(),
        ..Mesh::default()
    };
    add_borders(eye, screen, &links, &mut mesh);
    mesh
}

/// Triangles between the four pixels that begin with (x, y), of all layers whose points are of one surface;
/// cut so that more of it is covered.
fn block(screen: &Screen, links: &Links, x: usize, y: usize) -> Vec<[u32; 3]> {
    let node = |corner: usize, layer: usize| {
        let (right, below) = CORNERS[corner];
        Node { x: x + right, y: y + below, layer }
    };
    let choices = screen.layers.pow(3);
    let layers = |choice: usize| [0, 1, 2].map(|digit| choice / screen.layers.pow(digit) % screen.layers);
    let cut = |triangles: [[usize; 3]; 2]| -> Vec<[u32; 3]> {
        let nodes = |corners: [usize; 3], choice: usize| {
            let layers = layers(choice);
            [0, 1, 2].map(|at| node(corners[at], layers[at]))
        };
        let all =
            triangles.into_iter().flat_map(|corners| (0..choices).map(move |choice| nodes(corners, choice)));
        let whole = all.filter(|[a, b, c]| links.joins(*a, *b) && links.joins(*a, *c) && links.joins(*b, *c));
        whole.map(|nodes| nodes.map(|node| screen.index(node.x, node.y, node.layer) as u32)).collect()
    };
    let [one, other] = CUTS.map(cut);
    if other.len() > one.len() { other } else { one }
}

/// Squares where a surface ends.
fn add_borders(eye: &Eye<'_>, screen: &Screen, links: &Links, mesh: &mut Mesh) {
    for (index, point) in screen.points().iter().enumerate() {
        let (pixel, layer) = (index / screen.layers, index % screen.layers);
        let node = Node { x: pixel % screen.width, y: pixel / screen.width, layer };
        let Some(point) = point.filter(|_| !links.surround(node)) else { continue };
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(square(&point, 0.5 * eye.footprint(point.depth)));
        mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    }
}

/// Corners of a square in a point's tangent plane, by half its edge.
fn square(point: &LayerPoint, half: f32) -> [Vec3; 4] {
    let axes = frame(point.normal);
    let (right, up) = (axes.x_axis * half, axes.y_axis * half);
    [-right - up, right - up, right + up, up - right].map(|corner| point.position + corner)
}
