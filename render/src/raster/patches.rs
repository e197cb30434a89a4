//! The parts of a scene's surface that surfels are laid out on.
//!
//! Surfels near the camera are small and far ones large, so a triangle as large as the scene needs both. Each
//! triangle is therefore cut into equal parts, once, by halving its edges until no part is larger than a
//! small share of all surface; the parts stay the same whatever the camera does, so that surfels do not jump
//! when it moves. They are ordered along a curve through space (Morton 1966), so that surfels that follow one
//! another lie together.

mod closed;
mod emission;
mod patch;

pub use emission::Emission;
pub use patch::Patch;

use super::geometry::{Draw, draws_of};
use crate::gbuffer::OBJECT_IDS;
use crate::path::bsdf::hemispherical_albedo;
use crate::scene::{Glow, Material, Mesh, Scene, Surface};
use closed::closed;
use deepshade_glow::paint::PaintFactors;
use glam::{Vec2, Vec3, Vec4};
use patch::MOST_HALVINGS;
use rayon::prelude::*;

/// The scene's surface is cut into about so many parts, beside triangles that are smaller than one.
const PARTS: f32 = (1 << 17) as f32;

/// Where on a part its material is asked: the middles of its four quarters.
const SAMPLES: [[f32; 3]; 4] = [
    [2.0 / 3.0, 1.0 / 6.0, 1.0 / 6.0],
    [1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0],
    [1.0 / 6.0, 1.0 / 6.0, 2.0 / 3.0],
    [1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0],
];

/// What of a surface's reflectance its patches know.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reflectance {
    /// Its diffuse colour.
    Diffuse,
    /// All that it reflects of even light: its hemispherical albedo.
    All,
}

/// The parts of all triangles of a scene whose meshes are drawn as `draws` says.
pub fn patches(scene: &Scene, draws: &[Draw], reflectance: Reflectance) -> Vec<Patch> {
    cut_into(scene, draws, PARTS, |part| painted(part, reflectance))
}

/// As [`patches`] of the diffuse colour, about `parts` of them beside triangles that are smaller than one.
pub fn cut(scene: &Scene, draws: &[Draw], parts: f32) -> Vec<Patch> {
    cut_into(scene, draws, parts, |part| painted(part, Reflectance::Diffuse))
}

/// Radiance that each of a scene's [`patches`] emits; empty where nothing does.
pub fn emissions(scene: &Scene, draws: &[Draw]) -> Vec<Emission> {
    if scene.emits() { cut_into(scene, draws, PARTS, emission) } else { Vec::new() }
}

/// The paint of each of a scene's [`patches`], as its [`Glow`] counts them, and what its middle has of it.
pub fn paints(scene: &Scene, draws: &[Draw]) -> Vec<(Option<usize>, Option<PaintFactors>)> {
    let glow = Glow::of(scene);
    let paints = glow.paints_of(scene);
    let paint = |part: &TrianglePart<'_>| {
        let mesh = &scene.meshes[part.mesh];
        let paint = paints[mesh.material.0 as usize];
        let middle = part.patch.weights().into_iter().sum::<Vec3>() / 3.0;
        let textures = paint.map(|paint| &glow.surfaces[paint].textures);
        (paint, textures.and_then(|own| own.factors(mesh, part.triangle, middle.to_array())))
    };
    cut_into(scene, draws, PARTS, paint)
}

/// Mesh and triangle of each of the [patches](of_scene) of a scene that stays.
pub fn origins(scene: &Scene) -> Vec<[usize; 2]> {
    cut_into(scene, &draws_of(scene), PARTS, |part| [part.mesh, part.triangle])
}

/// The [patches](of_scene) of a scene that stays, painted where `is_wanted` says so of a patch before that.
pub fn painted_where(
    scene: &Scene,
    reflectance: Reflectance,
    is_wanted: impl FnOnce(&[Patch]) -> Vec<bool>,
) -> Vec<Patch> {
    let cut = |part: &TrianglePart<'_>| (part.patch, [part.mesh, part.triangle]);
    let (mut patches, origins): (Vec<Patch>, Vec<_>) =
        cut_into(scene, &draws_of(scene), PARTS, cut).into_iter().unzip();
    let wanted = is_wanted(&patches);
    let all = patches.par_iter_mut().zip(origins).zip(wanted);
    all.filter(|(_, wanted)| *wanted).for_each(|((patch, [mesh, triangle]), _)| {
        *patch = painted(&TrianglePart { patch: *patch, scene, mesh, triangle }, reflectance);
    });
    patches
}

/// A part of a triangle.
struct TrianglePart<'a> {
    patch: Patch,
    scene: &'a Scene,
    mesh: usize,
    triangle: usize,
}

/// What `said` says of the parts of a scene, and of which triangle of which mesh they are.
fn cut_into<T: Send>(
    scene: &Scene,
    draws: &[Draw],
    parts: f32,
    said: impl Fn(&TrianglePart<'_>) -> T + Sync,
) -> Vec<T> {
    let bounds = scene.bounds();
    let size = bounds.size().max_element().max(f32::MIN_POSITIVE);
    let largest = area_of(scene) / parts;
    let closed: Vec<Vec<bool>> = scene.meshes.iter().map(closed).collect();
    let said = &said;
    let mut placed: Vec<(u64, T)> = draws
        .par_iter()
        .flat_map(|draw| {
            let mesh = &scene.meshes[draw.mesh as usize];
            (0..mesh.triangles.len()).into_par_iter().map(move |triangle| (draw, mesh, triangle))
        })
        .flat_map_iter(|(draw, mesh, triangle)| {
            let (closed, halvings) = (&closed, halvings(area(mesh.corners(triangle)) / largest));
            let corners = mesh.triangles[triangle].map(|vertex| draw.first_vertex + vertex);
            (0..1u32 << (2 * halvings)).map(move |quarters| {
                let patch = Patch::new(corners, draw.mesh % OBJECT_IDS, halvings, quarters);
                let patch = if closed[draw.mesh as usize][triangle] { patch } else { patch.opened() };
                let middle = patch.weights().into_iter().sum::<Vec3>() / 3.0;
                let at = mixed(mesh.corners(triangle), middle);
                let part = TrianglePart { patch, scene, mesh: draw.mesh as usize, triangle };
                (morton((at - bounds.min) / size), said(&part))
            })
        })
        .collect();
    // A stable order: patches of one place stay in that of the scene.
    placed.par_sort_by_key(|(place, _)| *place);
    placed.into_iter().map(|(_, said)| said).collect()
}

/// The parts of a scene that stays.
pub fn of_scene(scene: &Scene, reflectance: Reflectance) -> Vec<Patch> {
    patches(scene, &draws_of(scene), reflectance)
}

/// About so many parts of a scene that stays.
pub fn cut_scene(scene: &Scene, parts: f32) -> Vec<Patch> {
    cut(scene, &draws_of(scene), parts)
}

/// A part of a triangle with what its material says.
fn painted(part: &TrianglePart<'_>, reflectance: Reflectance) -> Patch {
    let (coverage, colour) = part.mean(match reflectance {
        Reflectance::Diffuse => |surface| surface.diffuse,
        Reflectance::All => hemispherical_albedo,
    });
    part.patch.painted(colour, coverage)
}

/// Radiance that a part of a triangle emits.
fn emission(part: &TrianglePart<'_>) -> Emission {
    Emission::new(part.mean(|surface| surface.emission).1)
}

impl TrianglePart<'_> {
    /// The share of it that is there, and the mean over that share of something of its surface.
    fn mean(&self, of: fn(&Surface) -> Vec3) -> (f32, Vec3) {
        let Self { scene, triangle, .. } = *self;
        let mesh = &scene.meshes[self.mesh];
        let material = scene.material(mesh.material);
        let corners = self.patch.weights();
        let asked = SAMPLES.map(|sample| mixed(corners, Vec3::from_array(sample)));
        // Where nothing varies, one answer is enough.
        let asked = if varies(material, mesh) { &asked[..] } else { &asked[3..] };
        let (mut sum, mut coverage) = (Vec3::ZERO, 0.0);
        for at in asked {
            let (uvs, vertex_colour) = attributes(mesh, triangle, *at);
            let opacity = material.opacity(&scene.textures, uvs, vertex_colour);
            sum += opacity * of(&material.surface(&scene.textures, uvs, vertex_colour));
            coverage += opacity;
        }
        (coverage / asked.len() as f32, sum / f32::max(coverage, f32::MIN_POSITIVE))
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

/// The point of a triangle with these weights of its corners.
fn mixed(corners: [Vec3; 3], weights: Vec3) -> Vec3 {
    corners[0] * weights.x + corners[1] * weights.y + corners[2] * weights.z
}

/// How often a triangle's edges are halved so that no part is larger than wanted; `times` as large is the
/// whole.
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
        f64::from(whole * patch.coverage()) * (-2.0 * f64::from(patch.halvings())).exp2()
    };
    patches.iter().map(of_patch).sum()
}

/// The place of a point of the unit cube along Morton's curve: the bits of its coordinates, interleaved.
pub(crate) fn morton(at: Vec3) -> u64 {
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
    fn large_triangles_are_cut_until_they_fit() {
        assert_eq!([0.1, 1.0, 1.01, 4.0, 4.1, 1e30, f32::NAN].map(halvings), [0, 0, 1, 1, 2, 9, 0]);
    }

    #[test]
    fn neighbours_along_the_curve_are_neighbours_in_space() {
        assert_eq!(morton(Vec3::ZERO), 0);
        assert_eq!(morton(Vec3::ONE), (1 << 63) - 1);
        let mut cells: Vec<Vec3> = (0..4096u16)
            .map(|i| Vec3::from([i % 16, i / 16 % 16, i / 256].map(|cell| (f32::from(cell) + 0.5) / 16.0)))
            .collect();
        cells.sort_by_key(|cell| morton(*cell));
        // Sixteen that follow one another lie in 4 x 2 x 2 cells; of rows they would be one.
        let extent = |cells: &[Vec3]| {
            let low = cells.iter().copied().fold(Vec3::INFINITY, Vec3::min);
            let high = cells.iter().copied().fold(Vec3::NEG_INFINITY, Vec3::max);
            16.0 * (high - low).max_element()
        };
        assert!(cells.chunks(16).all(|sixteen| extent(sixteen) < 3.5));
    }
}
