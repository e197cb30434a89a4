//! The parts of a scene's surface that surfels are laid out on.
//!
//! Surfels near the camera are small and far ones large, so a triangle as large as the scene needs both. Each triangle is
//! therefore cut into equal parts, once, by halving its edges until no part is larger than a small share of all surface; the
//! parts stay the same whatever the camera does, so that surfels do not jump when it moves. They are ordered along a curve
//! through space (Morton 1966), so that surfels that follow one another lie together.

use super::closed::closed;
use crate::gbuffer::OBJECT_IDS;
use crate::raster::geometry::{Draw, draws_of};
use crate::scene::{Material, Mesh, Scene};
use bytemuck::{Pod, Zeroable};
use glam::{Vec2, Vec3, Vec4};
use rayon::prelude::*;

/// A part of a triangle, as `shared/surfel_patch.wgsl` has it.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct Patch {
    /// Vertices of the triangle, among those of all meshes on the GPU.
    pub corners: [u32; 3],
    /// Halvings in the upper four bits; [`OPEN`]; in the lowest bits, two a halving: which quarter.
    pub part: u32,
    /// Diffuse reflectance, the mean over the part.
    pub colour: [f32; 3],
    /// Share of the part that is there: alpha.
    pub coverage: f32,
    /// The mesh that it is part of, as [`Attribute::ObjectId`](deepshade_shaders::Attribute::ObjectId) counts them.
    pub object: u32,
}

/// The bit of a part that is set where the surface is no closed one.
pub const OPEN: u32 = 1 << 27;

/// The scene's surface is cut into about so many parts, beside triangles that are smaller than one.
const PARTS: f32 = (1 << 17) as f32;
/// Edges are halved no more often.
const MOST_HALVINGS: u32 = 9;

/// Where on a part its material is asked: the middles of its four quarters.
const SAMPLES: [[f32; 3]; 4] = [
    [2.0 / 3.0, 1.0 / 6.0, 1.0 / 6.0],
    [1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0],
    [1.0 / 6.0, 1.0 / 6.0, 2.0 / 3.0],
    [1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0],
];

/// The parts of all triangles of a scene whose meshes are drawn as `draws` says.
pub fn patches(scene: &Scene, draws: &[Draw]) -> Vec<Patch> {
    let bounds = scene.bounds();
    let size = bounds.size().max_element().max(f32::MIN_POSITIVE);
    let largest = area_of(scene) / PARTS;
    let closed: Vec<Vec<bool>> = scene.meshes.iter().map(closed).collect();
    let mut placed: Vec<(u64, Patch)> = draws
        .par_iter()
        .flat_map(|draw| {
            let mesh = &scene.meshes[draw.mesh as usize];
            (0..mesh.triangles.len()).into_par_iter().map(move |triangle| (draw, mesh, triangle))
        })
        .flat_map_iter(|(draw, mesh, triangle)| {
            let (closed, halvings) = (&closed, halvings(area(mesh.corners(triangle)) / largest));
            (0..1u32 << (2 * halvings)).map(move |quarters| {
                let open = if closed[draw.mesh as usize][triangle] { 0 } else { OPEN };
                let part = halvings << 28 | open | quarters;
                let middle = weights(part).into_iter().sum::<Vec3>() / 3.0;
                let at = mixed(mesh.corners(triangle), middle);
                (morton((at - bounds.min) / size), patch(scene, draw, triangle, part))
            })
        })
        .collect();
    // A stable order: patches of one place stay in that of the scene.
    placed.par_sort_by_key(|(place, _)| *place);
    placed.into_iter().map(|(_, patch)| patch).collect()
}

/// The parts of a scene that stays.
pub fn of_scene(scene: &Scene) -> Vec<Patch> {
    patches(scene, &draws_of(scene))
}

fn patch(scene: &Scene, draw: &Draw, triangle: usize, part: u32) -> Patch {
    let mesh = &scene.meshes[draw.mesh as usize];
    let material = scene.material(mesh.material);
    let corners = weights(part);
    let asked = SAMPLES.map(|sample| mixed(corners, Vec3::from_array(sample)));
    // Where nothing varies, one answer is enough.
    let asked = if varies(material, mesh) { &asked[..] } else { &asked[3..] };
    let (mut colour, mut coverage) = (Vec3::ZERO, 0.0);
    for at in asked {
        let (uvs, vertex_colour) = attributes(mesh, triangle, *at);
        let opacity = material.opacity(&scene.textures, uvs, vertex_colour);
        colour += opacity * material.surface(&scene.textures, uvs, vertex_colour).diffuse;
        coverage += opacity;
    }
    Patch {
        corners: mesh.triangles[triangle].map(|vertex| draw.first_vertex + vertex),
        part,
        colour: (colour / f32::max(coverage, f32::MIN_POSITIVE)).to_array(),
        coverage: coverage / asked.len() as f32,
        object: draw.mesh % OBJECT_IDS,
    }
}

/// Whether a material says different things of different points of a triangle.
fn varies(material: &Material, mesh: &Mesh) -> bool {
    material.textures().next().is_some() || !mesh.colours.is_empty()
}

/// Texture coordinates and vertex colour at a point of a triangle.
fn attributes(mesh: &Mesh, triangle: usize, at: Vec3) -> ([Vec2; 2], Vec4) {
    let vertices = mesh.triangles[triangle].map(|vertex| vertex as usize);
    let uv = |set: usize| {
        let corner = |vertex: usize| mesh.uvs[set].get(vertex).copied().unwrap_or(Vec2::ZERO);
        corner(vertices[0]) * at.x + corner(vertices[1]) * at.y + corner(vertices[2]) * at.z
    };
    let colour = |vertex: usize| mesh.colours.get(vertex).copied().unwrap_or(Vec4::ONE);
    let colour = colour(vertices[0]) * at.x + colour(vertices[1]) * at.y + colour(vertices[2]) * at.z;
    ([uv(0), uv(1)], colour)
}

/// Of a part, how its corners are mixed of the triangle's.
pub fn weights(part: u32) -> [Vec3; 3] {
    let mut corners = [Vec3::X, Vec3::Y, Vec3::Z];
    let halvings = part >> 28;
    for halving in (0..halvings).rev() {
        let [a, b, c] = corners;
        let middles = [0.5 * (b + c), 0.5 * (c + a), 0.5 * (a + b)];
        corners = match part >> (2 * halving) & 3 {
            0 => [a, middles[2], middles[1]],
            1 => [middles[2], b, middles[0]],
            2 => [middles[1], middles[0], c],
            _ => middles,
        };
    }
    corners
}

/// The point of a triangle with these weights of its corners.
fn mixed(corners: [Vec3; 3], weights: Vec3) -> Vec3 {
    corners[0] * weights.x + corners[1] * weights.y + corners[2] * weights.z
}

/// How often a triangle's edges are halved so that no part is larger than wanted; `times` as large is the whole.
fn halvings(times: f32) -> u32 {
    let levels = (0.5 * times.log2()).ceil();
    if levels > 0.0 { (levels as u32).min(MOST_HALVINGS) } else { 0 }
}

fn area([a, b, c]: [Vec3; 3]) -> f32 {
    0.5 * (b - a).cross(c - a).length()
}

/// The area of all triangles, m².
pub fn area_of(scene: &Scene) -> f32 {
    let of_mesh =
        |mesh: &Mesh| (0..mesh.triangles.len()).map(|t| f64::from(area(mesh.corners(t)))).sum::<f64>();
    scene.meshes.iter().map(of_mesh).sum::<f64>() as f32
}

/// The area of what is there of all patches, m²; `vertices` are those of the scene.
pub fn covered_area(patches: &[Patch], vertices: &[Vec3]) -> f64 {
    let of_patch = |patch: &Patch| {
        let whole = area(patch.corners.map(|corner| vertices[corner as usize]));
        f64::from(whole * patch.coverage) * (-2.0 * f64::from(patch.part >> 28)).exp2()
    };
    patches.iter().map(of_patch).sum()
}

/// The place of a point of the unit cube along Morton's curve: the bits of its coordinates, interleaved.
fn morton(at: Vec3) -> u64 {
    let spread = |coordinate: f32| {
        let mut bits = (coordinate.clamp(0.0, 1.0) * ((1 << 21) - 1) as f32) as u64;
        for (shift, mask) in [
            (32, 0x001f_0000_0000_ffff),
            (16, 0x001f_0000_ff00_00ff),
            (8, 0x100f_00f0_0f00_f00f),
            (4, 0x10c3_0c30_c30c_30c3),
            (2, 0x1249_2492_4924_9249),
        ] {
            bits = (bits | bits << shift) & mask;
        }
        bits
    };
    spread(at.x) | spread(at.y) << 1 | spread(at.z) << 2
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quarters_tile_a_triangle() {
        let triangle = [Vec3::ZERO, Vec3::new(3.0, 1.0, 0.0), Vec3::new(0.5, 2.0, 1.0)];
        let laid = |part: u32| weights(part).map(|corner| mixed(triangle, corner));
        for halvings in 0..5u32 {
            let parts: Vec<_> =
                (0..1 << (2 * halvings)).map(|quarters| laid(halvings << 28 | quarters)).collect();
            let wanted = area(triangle) / parts.len() as f32;
            assert!(parts.iter().all(|part| (area(*part) - wanted).abs() < 1e-5 * wanted));
            let normal = |part: [Vec3; 3]| (part[1] - part[0]).cross(part[2] - part[0]).normalize();
            assert!(parts.iter().all(|part| normal(*part).dot(normal(triangle)) > 0.999), "turned over");
            let mean =
                parts.iter().map(|part| part.iter().sum::<Vec3>() / 3.0).sum::<Vec3>() / parts.len() as f32;
            assert!(mean.distance(triangle.iter().sum::<Vec3>() / 3.0) < 1e-5);
        }
    }

    #[test]
    fn large_triangles_are_cut_until_they_fit() {
        assert_eq!([0.1, 1.0, 1.01, 4.0, 4.1, 1e30, f32::NAN].map(halvings), [0, 0, 1, 1, 2, 9, 0]);
    }

    #[test]
    fn neighbours_along_the_curve_are_neighbours_in_space() {
        assert_eq!(morton(Vec3::ZERO), 0);
        assert_eq!(morton(Vec3::ONE), (1 << 63) - 1);
        assert!(morton(Vec3::new(0.1, 0.2, 0.3)) < morton(Vec3::new(0.1, 0.2, 0.7)));
    }
}
