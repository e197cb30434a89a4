//! The plain version: the same texels by rays and closed forms.

use super::RateEquationParameters;
use super::cells::{PlainCells, edge};
use super::tile::{Tiles, texel_weights, texels_around, weights_of};
use crate::bvh::{Hit, TracedScene};
use crate::methods::picture::every_pixel;
use crate::path::phosphor::Afterglow;
use crate::raster::geometry::draws_of;
use crate::scene::Glow;
use crate::screen::{View, Written};
use deepshade_glow::paint::{MOST_STATES, Steps};
use deepshade_shaders::Planes;
use deepshade_shaders::wgsl::uniforms::GlowTile;
use glam::{Vec2, Vec3};
use rayon::prelude::*;
use std::collections::HashMap;

/// States of all texels, `[texels, states]`, and the image, `[3, height, width]`.
pub fn shade(scene: &TracedScene, view: &View, parameters: RateEquationParameters) -> Written {
    let tiles = Tiles::new(&scene.scene().clone().into(), &draws_of(scene.scene()), parameters.texels);
    let afterglow = Afterglow::new(scene).by_lamps().by(Steps::of(parameters.euler));
    let shares = shares(&afterglow, &tiles);
    let cells = PlainCells::new(scene, &afterglow, edge(scene.scene(), parameters.texels));
    let glow = Glow::of(scene.scene());
    let room = glow.most_states();
    let states = shares.iter().flat_map(|shares| shares[..room].iter().copied()).collect();
    let index: HashMap<[u32; 2], usize> =
        tiles.origins.iter().enumerate().map(|(index, origin)| (*origin, index)).collect();
    let sent = |found: &Found| {
        let tile = &tiles.tiles[*index.get(&[found.mesh, found.triangle])?];
        let (mesh, triangle) = (found.mesh as usize, found.triangle as usize);
        let of_texel = |(texel, weight): (usize, f32)| {
            let paint = afterglow.paint_at(mesh, triangle, weights_of(tile.divisions, texel))?;
            Some(weight * paint.emission(&shares[tile.first as usize + texel]))
        };
        Some(texels_around(tile.divisions, found.place).into_iter().filter_map(of_texel).sum())
    };
    let image = image(view, |at| {
        let found = found(scene, view, at);
        let surface = found.as_ref().and_then(sent).unwrap_or(Vec3::ZERO);
        let reach = found.map_or(f32::INFINITY, |found| found.reach);
        let ray = (view.camera.position, view.camera.direction(at, view.height, view.width), reach);
        Some(cells.as_ref().map_or(surface, |cells| cells.seen(ray, surface)))
    });
    vec![states, image]
}

/// The triangle that a pixel shows, and where on it.
pub(super) struct Found {
    pub(super) mesh: u32,
    pub(super) triangle: u32,
    /// Weights of the second and third corner.
    pub(super) place: Vec2,
    /// How far it is from the camera, metres.
    reach: f32,
}

/// What is seen at the middle of a pixel.
pub(super) fn found(scene: &TracedScene, view: &View, at: Vec2) -> Option<Found> {
    let direction = view.camera.direction(at, view.height, view.width);
    let hit = scene.hit(view.camera.position, direction, f32::INFINITY)?;
    let Hit { mesh, triangle, barycentric: place, distance: reach } = hit;
    Some(Found { mesh, triangle, place, reach })
}

/// An image of what each pixel's middle sends, `[3, height, width]`; black where that is nothing.
pub(super) fn image(view: &View, sent: impl Fn(Vec2) -> Option<Vec3> + Sync) -> Vec<f32> {
    let pixels = every_pixel(view.height, view.width, |at| sent(at.as_vec2() + 0.5).unwrap_or(Vec3::ZERO));
    let planes = Planes::from_fn(3, view.height, view.width, |c, y, x| pixels[y * view.width + x][c]);
    planes.data().to_vec()
}

/// The excited shares of all texels.
fn shares(afterglow: &Afterglow<'_>, tiles: &Tiles) -> Vec<[f32; MOST_STATES]> {
    let of_tile = |(tile, [mesh, triangle]): (&GlowTile, &[u32; 2])| {
        let share =
            |weights| afterglow.shares(*mesh as usize, *triangle as usize, weights).unwrap_or_default();
        texel_weights(tile.divisions).map(share).collect::<Vec<_>>()
    };
    tiles.tiles.par_iter().zip(&tiles.origins).flat_map_iter(of_tile).collect()
}
