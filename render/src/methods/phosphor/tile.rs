//! Tiles: the texels of each triangle that keeps light. A triangle's texels are a lattice of rows of n + 1,
//! n, ... 1 points, drawn in from its edges by half a step: a texel on an edge would be in two surfaces, of
//! which one may be in the shadow.

use crate::gbuffer::OBJECT_IDS;
use crate::raster::geometry::Draw;
use crate::raster::glow::keeper_words;
use crate::raster::patches::morton;
use crate::scene::{AnimatedScene, Glow, Scene};
use deepshade_shaders::wgsl::uniforms::GlowTile;
use glam::{Vec2, Vec3};
use rayon::prelude::*;

/// Most texels of a scene, and most states of all of them; where there were more, all are farther apart. A
/// state is two numbers, and software Vulkan binds 128 MB at once.
const MOST_TEXELS: usize = 1 << 23;
const MOST_TEXTURED_TEXELS: usize = MOST_TEXELS / 2;
const MOST_STATES_OF_ALL: usize = 1 << 24;

/// Most steps along an edge: square roots of their numbers are exact enough in 32 bits.
const MOST_DIVISIONS: u32 = 1023;

/// Poses of an animation by which triangles are measured, from its beginning to its end.
const POSES: u16 = 9;

/// All tiles of a scene.
#[derive(Clone, Debug)]
pub struct Tiles {
    /// In an order in which neighbours lie together.
    pub tiles: Vec<GlowTile>,
    /// Mesh and triangle of each.
    pub origins: Vec<[u32; 2]>,
    /// How many texels there are.
    pub texels: usize,
}

/// Three texels of a tile around a place, and their weights.
pub type Around = [(usize, f32); 3];

impl Tiles {
    /// The tiles of what keeps light of a scene whose meshes are drawn as `draws` says, with `texels` along
    /// its diagonal. Those of what grows are for its largest size.
    pub fn new(animated: &AnimatedScene, draws: &[Draw], texels: u32) -> Self {
        let scene = &animated.scene;
        let bounds = scene.bounds();
        let mut spacing = bounds.diagonal() / texels as f32;
        let mut tiles = placed(scene, draws);
        for pose in poses(animated) {
            tiles.par_iter_mut().for_each(|(_, _, [mesh, triangle], longest)| {
                let corners = pose.meshes[*mesh as usize].corners(*triangle as usize);
                *longest = longest.max(longest_edge(corners));
            });
        }
        let count = |spacing: f32| -> usize {
            tiles.par_iter().map(|(_, _, _, longest)| texels_of(divisions(*longest, spacing))).sum()
        };
        let states = Glow::of(scene).most_states();
        let room = if Glow::of(scene).has_textures() { MOST_TEXTURED_TEXELS } else { MOST_TEXELS };
        let most = room.min(MOST_STATES_OF_ALL / states).max(3 * tiles.len());
        while count(spacing) > most {
            spacing *= 1.25;
        }
        let mut first = 0;
        for (_, tile, _, longest) in &mut tiles {
            (tile.first, tile.divisions) = (first as u32, divisions(*longest, spacing));
            first += texels_of(tile.divisions);
        }
        let origins = tiles.iter().map(|(_, _, origin, _)| *origin).collect();
        Self { tiles: tiles.into_iter().map(|(_, tile, ..)| tile).collect(), origins, texels: first }
    }

    /// The tile of each texel, and what the texel has of its paint's numbers where any paint has textures:
    /// [`keeper_words`] numbers each.
    pub fn owners(&self, scene: &Scene) -> Vec<u32> {
        let glow = Glow::of(scene);
        let of_tile = |(index, (tile, [mesh, triangle])): (usize, (&GlowTile, &[u32; 2]))| {
            let (mesh, surface) = (&scene.meshes[*mesh as usize], &glow.surfaces[tile.paint as usize]);
            let of_texel = |weights| {
                let factors = move || surface.textures.factors(mesh, *triangle as usize, weights);
                keeper_words(glow, index as u32, factors)
            };
            texel_weights(tile.divisions).flat_map(of_texel).collect::<Vec<_>>()
        };
        self.tiles.par_iter().zip(&self.origins).enumerate().flat_map_iter(of_tile).collect()
    }
}

/// Tiles without texels, along a curve through space: where on it they are, mesh and triangle, the longest
/// edge.
fn placed(scene: &Scene, draws: &[Draw]) -> Vec<(u64, GlowTile, [u32; 2], f32)> {
    let paints = Glow::of(scene).paints_of(scene);
    let bounds = scene.bounds();
    let size = bounds.size().max_element().max(f32::MIN_POSITIVE);
    let painted = draws.iter().filter_map(|draw| Some((draw, paints[draw.material as usize]?)));
    let of_draw = |(draw, paint): (&Draw, usize)| {
        let mesh = &scene.meshes[draw.mesh as usize];
        let of_triangle = |triangle: usize| {
            let [corner_0, corner_1, corner_2] =
                mesh.triangles[triangle].map(|vertex| draw.first_vertex + vertex);
            let corners = mesh.corners(triangle);
            let middle = corners.iter().sum::<Vec3>() / 3.0;
            let (paint, object) = (paint as u32, draw.mesh % OBJECT_IDS);
            let tile =
                GlowTile { corner_0, corner_1, corner_2, first: 0, divisions: 1, paint, object, padding: 0 };
            let at = morton((middle - bounds.min) / size);
            (at, tile, [draw.mesh, triangle as u32], longest_edge(corners))
        };
        (0..mesh.triangles.len()).map(of_triangle).collect::<Vec<_>>()
    };
    let mut tiles: Vec<_> = painted.flat_map(of_draw).collect();
    tiles.par_sort_by_key(|(place, ..)| *place);
    tiles
}

/// What moves, at moments of its animation; those at which a vertex is nowhere say nothing.
fn poses(animated: &AnimatedScene) -> impl Iterator<Item = Scene> {
    let part = |index: u16| f32::from(index) / f32::from(POSES - 1);
    let moments = animated
        .span()
        .into_iter()
        .flat_map(move |[from, to]| (0..POSES).map(move |index| from + (to - from) * part(index)));
    moments.filter_map(|moment| animated.at(moment, 0.0).ok())
}

fn longest_edge([a, b, c]: [Vec3; 3]) -> f32 {
    a.distance(b).max(b.distance(c)).max(c.distance(a))
}

fn divisions(longest: f32, spacing: f32) -> u32 {
    ((longest / spacing).ceil() as u32).clamp(1, MOST_DIVISIONS)
}

/// Texels of a tile.
pub const fn texels_of(divisions: u32) -> usize {
    ((divisions + 1) * (divisions + 2) / 2) as usize
}

fn row_start(row: u32, divisions: u32) -> u32 {
    row * (2 * divisions + 3 - row) / 2
}

/// How far a lattice is drawn in.
fn drawn_in(divisions: u32) -> f32 {
    3.0 / (2 * divisions + 3) as f32
}

/// The weights of a tile's corners at each of its texels, in order.
pub fn texel_weights(divisions: u32) -> impl Iterator<Item = [f32; 3]> {
    (0..=divisions)
        .flat_map(move |row| (0..=divisions - row).map(move |column| lattice(divisions, row, column)))
}

/// The same at one of them.
pub fn weights_of(divisions: u32, texel: usize) -> [f32; 3] {
    let texel = texel as u32;
    let row = (0..=divisions).rev().find(|row| row_start(*row, divisions) <= texel).unwrap_or(0);
    lattice(divisions, row, texel - row_start(row, divisions))
}

/// The weights of a tile's corners at a place of its lattice.
fn lattice(divisions: u32, row: u32, column: u32) -> [f32; 3] {
    let inwards = drawn_in(divisions);
    let place = Vec2::new(column as f32, row as f32) / divisions as f32;
    let Vec2 { x, y } = place * (1.0 - inwards) + inwards / 3.0;
    [1.0 - x - y, x, y]
}

/// The texels around a place in a tile, from its first on; `place` are the weights of its second and third
/// corner. Beyond the outermost texels it is as at those.
pub fn texels_around(divisions: u32, place: Vec2) -> Around {
    let inwards = drawn_in(divisions);
    let inside = ((place - inwards / 3.0) / (1.0 - inwards)).max(Vec2::ZERO);
    let at = inside * (divisions as f32 / inside.element_sum().max(1.0));
    let column = (at.x as u32).min(divisions - 1);
    let row = (at.y as u32).min(divisions - 1 - column);
    let part = at - Vec2::new(column as f32, row as f32);
    let here = (row_start(row, divisions) + column) as usize;
    let above = (row_start(row + 1, divisions) + column) as usize;
    if part.element_sum() > 1.0 && column + row + 2 <= divisions {
        return [(above + 1, part.element_sum() - 1.0), (here + 1, 1.0 - part.y), (above, 1.0 - part.x)];
    }
    [(here, 1.0 - part.element_sum()), (here + 1, part.x), (above, part.y)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::geometry::draws_of;
    use crate::scene::glow::tests::glow;
    use crate::scene::procedural::Family;
    use proptest::prelude::*;
    use std::sync::Arc;

    #[test]
    fn texels_lie_inside_and_stand_for_places_alike() {
        for divisions in [1, 2, 7, 40] {
            let weights: Vec<[f32; 3]> = texel_weights(divisions).collect();
            assert_eq!(weights.len(), texels_of(divisions));
            let one_by_one = (0..weights.len()).map(|texel| weights_of(divisions, texel));
            assert!(one_by_one.eq(weights.iter().copied()));
            let nearest = weights.iter().flatten().copied().fold(1.0, f32::min);
            let step = (1.0 - drawn_in(divisions)) / divisions as f32;
            assert!((nearest - 0.5 * step).abs() < 1e-6, "half a step from the edge: {nearest}");
            let mean: Vec3 = weights.iter().copied().map(Vec3::from).sum::<Vec3>() / weights.len() as f32;
            assert!((mean - 1.0 / 3.0).abs().max_element() < 1e-5, "{mean}");
        }
    }

    #[test]
    fn a_texel_finds_itself() {
        for divisions in [1, 2, 7, 40] {
            for (index, weights) in texel_weights(divisions).enumerate() {
                let around = texels_around(divisions, Vec2::new(weights[1], weights[2]));
                let own: f32 = around.iter().filter(|(at, _)| *at == index).map(|(_, weight)| weight).sum();
                assert!((own - 1.0).abs() < 1e-3, "{index} of {divisions}: {around:?}");
            }
        }
    }

    proptest! {
        #[test]
        fn what_is_linear_stays_so_between_texels(divisions in 1u32..60, a in 0.0f32..1.0, b in 0.0f32..1.0) {
            let place = if a + b > 1.0 { Vec2::new(1.0 - a, 1.0 - b) } else { Vec2::new(a, b) };
            let weights: Vec<[f32; 3]> = texel_weights(divisions).collect();
            let around = texels_around(divisions, place);
            prop_assert!(around.iter().all(|(at, weight)| *at < weights.len() && (-1e-4..=1.0001).contains(weight)));
            let found: Vec3 = around.iter().map(|(at, weight)| Vec3::from(weights[*at]) * *weight).sum();
            let outermost = 0.5 * (1.0 - drawn_in(divisions)) / divisions as f32;
            let third = 1.0 - place.x - place.y;
            if place.min_element().min(third) > outermost {
                prop_assert!((found - Vec3::new(third, place.x, place.y)).abs().max_element() < 1e-4);
            }
        }
    }

    #[test]
    fn texels_are_as_fine_as_asked_and_no_more_than_there_is_room_for() {
        let mut scene = Family::StillLife.scene(2);
        scene.glow = Some(Arc::new(glow(&[1.0], &[], 0.0)));
        let draws = draws_of(&scene);
        let spacing = scene.bounds().diagonal() / 100.0;
        let tiles = |scene: &Scene, texels| Tiles::new(&scene.clone().into(), &draws, texels);
        let fine = tiles(&scene, 100);
        assert_eq!(fine.tiles.len(), scene.triangle_count());
        for (tile, [mesh, triangle]) in fine.tiles.iter().zip(&fine.origins) {
            let longest = longest_edge(scene.meshes[*mesh as usize].corners(*triangle as usize));
            assert!(longest / tile.divisions as f32 <= spacing * 1.001);
        }
        assert_eq!(fine.owners(&scene).len(), fine.texels);
        assert!(tiles(&scene, 1 << 20).texels <= MOST_TEXELS);
        let mut none = glow(&[1.0], &[], 0.0);
        none.surfaces[0].material = Some("no such material".to_owned());
        scene.glow = Some(Arc::new(none));
        assert_eq!(tiles(&scene, 100).texels, 0);
    }
}
