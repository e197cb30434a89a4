//! The slow, plain version of the passes, kept so close to them that both can be read side by side.

use crate::methods::LightImage;
use crate::methods::picture::every_pixel;
use crate::screen::Written;
use deepshade_shaders::{Attribute, GBuffer, MissingAttribute, Planes, random, wgsl::uniforms};
use glam::{IVec2, UVec2, Vec2, Vec3, Vec4};

/// What the passes read of a g-buffer.
#[derive(Clone, Debug)]
pub struct Moving {
    picture: LightImage,
    /// [`Attribute::Depth`] and [`Attribute::Motion`], `[3, height, width]`.
    movement: Planes,
}

impl Moving {
    /// The picture and how it moves.
    ///
    /// # Errors
    /// If the g-buffer lacks an attribute.
    pub fn of(gbuffer: &GBuffer) -> Result<Self, MissingAttribute> {
        let movement = gbuffer.select(&[Attribute::Depth, Attribute::Motion])?;
        Ok(Self { picture: LightImage::of(gbuffer)?, movement })
    }

    fn half_movement(&self, settings: &uniforms::Reconstruction, at: IVec2) -> Vec3 {
        let [direction, length] = [1, 2].map(|c| self.movement.at(c, at.y as usize, at.x as usize));
        let reach = (0.5 * length).min(settings.longest);
        reach * Vec3::new(direction.cos(), -direction.sin(), 1.0)
    }

    fn depth_of(&self, at: IVec2) -> f32 {
        if self.picture.valid_at(at) { self.movement.at(0, at.y as usize, at.x as usize) } else { 1e30 }
    }
}

/// What the passes write: the longest movements of tiles and of their neighbours, with a fourth number that
/// is 0, and at last radiance while the shutter is open, `[3, height, width]`.
pub fn shade(moving: &Moving, settings: &uniforms::Reconstruction) -> Written {
    let (wide, high) = (settings.tiles_wide as usize, settings.tiles_high as usize);
    let of_tiles = every_pixel(high, wide, |tile| longest_of_tile(moving, settings, tile.as_uvec2()));
    let around = every_pixel(high, wide, |tile| longest_of_neighbours(&of_tiles, settings, tile));
    let image = moving.picture.image(|pixel| expose(moving, &around, settings, pixel));
    let padded = |movements: &[Vec3]| movements.iter().flat_map(|m| m.extend(0.0).to_array()).collect();
    vec![padded(&of_tiles), padded(&around), image.data().to_vec()]
}

/// `tiles.wgsl`
fn longest_of_tile(moving: &Moving, settings: &uniforms::Reconstruction, tile: UVec2) -> Vec3 {
    let first = tile * settings.tile;
    let end = (first + settings.tile).min(UVec2::new(settings.width, settings.height));
    let mut longest = Vec3::ZERO;
    for y in first.y..end.y {
        for x in first.x..end.x {
            let at = IVec2::new(x as i32, y as i32);
            if !moving.picture.valid_at(at) {
                continue;
            }
            let movement = moving.half_movement(settings, at);
            if movement.z > longest.z {
                longest = movement;
            }
        }
    }
    longest
}

/// `neighbours.wgsl`
fn longest_of_neighbours(of_tiles: &[Vec3], settings: &uniforms::Reconstruction, tile: IVec2) -> Vec3 {
    let tiles = IVec2::new(settings.tiles_wide as i32, settings.tiles_high as i32);
    let mut longest = Vec3::ZERO;
    for y in -settings.reach..=settings.reach {
        for x in -settings.reach..=settings.reach {
            let at = tile + IVec2::new(x, y);
            if at.cmplt(IVec2::ZERO).any() || at.cmpge(tiles).any() {
                continue;
            }
            let movement = of_tiles[(at.y * tiles.x + at.x) as usize];
            let gap = settings.tile as f32 * (IVec2::new(x, y).abs() - 1).max(IVec2::ZERO).as_vec2();
            if movement.truncate().abs().cmpge(gap).all() && movement.z > longest.z {
                longest = movement;
            }
        }
    }
    longest
}

/// Whether a depth is in front of another, softly.
fn in_front(settings: &uniforms::Reconstruction, depth: f32, other: f32) -> f32 {
    ((other - depth) / (settings.depth_extent * depth.min(other))).clamp(0.0, 1.0)
}

fn sample_offset(settings: &uniforms::Reconstruction, step: u32, jitter: f32, line: Vec2) -> Vec2 {
    let share = (step as f32 + jitter) / settings.samples as f32;
    ((2.0 * share - 1.0) * line + 0.5).floor()
}

fn gather_behind(moving: &Moving, settings: &uniforms::Reconstruction, pixel: IVec2, jitter: f32) -> Vec3 {
    let movement = moving.half_movement(settings, pixel);
    let own = moving.picture.light_at(pixel);
    if !moving.picture.valid_at(pixel) || movement.z < 0.5 {
        return own;
    }
    let depth = moving.depth_of(pixel);
    let mut light = Vec3::ZERO;
    let mut weights = 0.0;
    for step in 0..settings.samples {
        let at = pixel + sample_offset(settings, step, jitter, movement.truncate()).as_ivec2();
        if !moving.picture.contains(at) {
            continue;
        }
        let weight = 1.0 - in_front(settings, moving.depth_of(at), depth);
        light += weight * moving.picture.light_at(at);
        weights += weight;
    }
    if weights == 0.0 { own } else { light / weights }
}

fn gather_before(
    moving: &Moving,
    around: &[Vec3],
    settings: &uniforms::Reconstruction,
    pixel: IVec2,
    jitter: f32,
) -> Vec4 {
    let tile = pixel / settings.tile as i32;
    let line = around[(tile.y * settings.tiles_wide as i32 + tile.x) as usize];
    if line.z < 0.5 {
        return Vec4::ZERO;
    }
    let direction = line.truncate() / line.z;
    let spacing = 2.0 * line.z / settings.samples as f32;
    let edge = spacing.max(1.0);
    let depth = moving.depth_of(pixel);
    let mut sum = Vec4::ZERO;
    for step in 0..settings.samples {
        let offset = sample_offset(settings, step, jitter, line.truncate());
        let at = pixel + offset.as_ivec2();
        if !moving.picture.contains(at) || !moving.picture.valid_at(at) {
            continue;
        }
        let movement = moving.half_movement(settings, at);
        let along = movement.truncate().dot(direction).abs();
        if along < 0.5 {
            continue;
        }
        let covers = ((along - offset.length()) / edge + 0.5).clamp(0.0, 1.0);
        let duration = (spacing / (2.0 * along)).min(1.0) * along / movement.z;
        let weight = in_front(settings, moving.depth_of(at), depth) * covers * duration;
        sum += weight * moving.picture.light_at(at).extend(1.0);
    }
    sum / sum.w.max(1.0)
}

/// `gather.wgsl`
fn expose(moving: &Moving, around: &[Vec3], settings: &uniforms::Reconstruction, pixel: IVec2) -> Vec3 {
    let jitter = random::random(pixel.x as u32, pixel.y as u32, settings.seed, 0);
    let behind = gather_behind(moving, settings, pixel, jitter);
    let before = gather_before(moving, around, settings, pixel, jitter);
    before.truncate() + (1.0 - before.w) * behind
}
