//! The slow, plain version of the passes, kept so close to them that both can be read side by side.

use crate::methods::LightImage;
use crate::methods::picture::every_pixel;
use crate::screen::Written;
use deepshade_shaders::{Attribute, GBuffer, MissingAttribute, Planes, wgsl::TILE, wgsl::uniforms};
use glam::{IVec2, UVec2, Vec2, Vec3, Vec4};
use std::f32::consts::PI;

/// What the passes read of a g-buffer.
#[derive(Clone, Debug)]
pub struct Blurred {
    picture: LightImage,
    /// [`Attribute::Depth`] and [`Attribute::Blurriness`], `[2, height, width]`.
    optics: Planes,
}

impl Blurred {
    /// The picture and its blur.
    ///
    /// # Errors
    /// If the g-buffer lacks an attribute.
    pub fn of(gbuffer: &GBuffer) -> Result<Self, MissingAttribute> {
        let optics = gbuffer.select(&[Attribute::Depth, Attribute::Blurriness])?;
        Ok(Self { picture: LightImage::of(gbuffer)?, optics })
    }

    fn circle(&self, gather: &uniforms::RingGather, at: IVec2) -> f32 {
        if !self.picture.valid_at(at) {
            return gather.blur_at_infinity.min(gather.largest);
        }
        let [depth, blurriness] = [0, 1].map(|c| self.optics.at(c, at.y as usize, at.x as usize));
        (blurriness / depth).clamp(-gather.largest, gather.largest)
    }
}

/// What the passes write: the shrunk picture, the largest circles in front of tiles and of their neighbours,
/// the layers behind and before, and at last radiance through the lens, `[3, height, width]`.
pub fn shade(blurred: &Blurred, gather: &uniforms::RingGather) -> Written {
    let (wide, high) = (gather.low_width as usize, gather.low_height as usize);
    let low = every_pixel(high, wide, |pixel| shrink(blurred, gather, pixel.as_uvec2()));
    let tiles = |value: &(dyn Fn(IVec2) -> f32 + Sync)| {
        every_pixel(gather.tiles_high as usize, gather.tiles_wide as usize, value)
    };
    let largest_in_front = tiles(&|tile| largest_of_tile(&low, gather, tile.as_uvec2()));
    let largest_around = tiles(&|tile| largest_of_neighbours(&largest_in_front, gather, tile));
    let layers = every_pixel(high, wide, |pixel| gather_layers(&low, &largest_around, gather, pixel));
    let image = blurred.picture.image(|pixel| combine(blurred, &low, &layers, gather, pixel));
    let behind = layers.iter().flat_map(|(behind, _)| behind.extend(0.0).to_array());
    let before = layers.iter().flat_map(|(_, before)| before.to_array());
    let (behind, before) = (behind.collect(), before.collect());
    let low = low.iter().flat_map(Vec4::to_array).collect();
    vec![low, largest_in_front, largest_around, behind, before, image.data().to_vec()]
}

/// `shrink.wgsl`: radiance and radius, pixels of the image.
fn shrink(blurred: &Blurred, gather: &uniforms::RingGather, pixel: UVec2) -> Vec4 {
    let first = pixel * gather.scale;
    let end = (first + gather.scale).min(UVec2::new(gather.width, gather.height));
    let inside = || (first.y..end.y).flat_map(|y| (first.x..end.x).map(move |x| UVec2::new(x, y).as_ivec2()));
    let radius = inside().map(|at| blurred.circle(gather, at)).fold(gather.largest, f32::min);
    let mut light = Vec3::ZERO;
    let mut weights = 0.0;
    for at in inside() {
        let weight = (1.0 - (blurred.circle(gather, at) - radius) / gather.softness).max(0.0);
        light += weight * blurred.picture.light_at(at);
        weights += weight;
    }
    (light / weights).extend(radius)
}

/// `tiles.wgsl`
fn largest_of_tile(low: &[Vec4], gather: &uniforms::RingGather, tile: UVec2) -> f32 {
    let first = tile * TILE;
    let end = (first + TILE).min(UVec2::new(gather.low_width, gather.low_height));
    let mut largest = 0.0f32;
    for y in first.y..end.y {
        for x in first.x..end.x {
            largest = largest.max(-low[(y * gather.low_width + x) as usize].w);
        }
    }
    largest / gather.scale as f32
}

/// `neighbours.wgsl`
fn largest_of_neighbours(largest_in_front: &[f32], gather: &uniforms::RingGather, tile: IVec2) -> f32 {
    let tiles = IVec2::new(gather.tiles_wide as i32, gather.tiles_high as i32);
    let mut largest = 0.0f32;
    for y in -gather.reach..=gather.reach {
        for x in -gather.reach..=gather.reach {
            let at = tile + IVec2::new(x, y);
            if at.cmplt(IVec2::ZERO).any() || at.cmpge(tiles).any() {
                continue;
            }
            let radius = largest_in_front[(at.y * tiles.x + at.x) as usize];
            let gap = TILE as f32 * (IVec2::new(x, y).abs() - 1).max(IVec2::ZERO).as_vec2();
            if radius * radius >= gap.dot(gap) {
                largest = largest.max(radius);
            }
        }
    }
    largest
}

/// Whether a circle is in front of another, given signed radii.
fn in_front(gather: &uniforms::RingGather, radius: f32, other: f32) -> f32 {
    ((other - radius) / gather.softness).clamp(0.0, 1.0)
}

fn ring_count(gather: &uniforms::RingGather, radius: f32) -> u32 {
    gather.rings.min(radius.ceil() as u32)
}

fn sample_offset(ring: u32, step: u32, spacing: f32) -> Vec2 {
    let angle = step as f32 * (2.0 * PI / (8 * ring) as f32);
    (ring as f32 * spacing * Vec2::from_angle(angle) + 0.5).floor()
}

fn is_inside(gather: &uniforms::RingGather, at: IVec2) -> bool {
    at.cmpge(IVec2::ZERO).all() && at.x < gather.low_width as i32 && at.y < gather.low_height as i32
}

fn gather_behind(low: &[Vec4], gather: &uniforms::RingGather, pixel: IVec2, centre: Vec4) -> Vec3 {
    let radius = centre.w.abs() / gather.scale as f32;
    if radius < 0.5 {
        return centre.truncate();
    }
    let rings = ring_count(gather, radius);
    let spacing = radius / (rings as f32 + 0.5);
    let mut light = centre.truncate();
    let mut weights = 1.0;
    for ring in 1..=rings {
        for step in 0..8 * ring {
            let at = pixel + sample_offset(ring, step, spacing).as_ivec2();
            if !is_inside(gather, at) {
                continue;
            }
            let sample = low[(at.y * gather.low_width as i32 + at.x) as usize];
            let weight = 1.0 - in_front(gather, sample.w, centre.w);
            light += weight * sample.truncate();
            weights += weight;
        }
    }
    light / weights
}

fn gather_before(
    low: &[Vec4],
    gather: &uniforms::RingGather,
    pixel: IVec2,
    centre: Vec4,
    radius: f32,
) -> Vec4 {
    if radius < 0.5 {
        return Vec4::ZERO;
    }
    let rings = ring_count(gather, radius);
    let spacing = radius / (rings as f32 + 0.5);
    let edge = spacing.max(1.0);
    let mut sum = Vec4::ZERO;
    for ring in 1..=rings {
        for step in 0..8 * ring {
            let offset = sample_offset(ring, step, spacing);
            let at = pixel + offset.as_ivec2();
            if !is_inside(gather, at) {
                continue;
            }
            let sample = low[(at.y * gather.low_width as i32 + at.x) as usize];
            let circle = sample.w.abs() / gather.scale as f32;
            let covers = ((circle - offset.length()) / edge + 0.5).clamp(0.0, 1.0);
            let thinness = 0.5 * spacing / circle.max(0.5 * spacing);
            let weight = in_front(gather, sample.w, centre.w) * covers * thinness * thinness;
            sum += weight * sample.truncate().extend(1.0);
        }
    }
    sum / sum.w.max(1.0)
}

/// `gather.wgsl`: what is behind, and what is in front.
fn gather_layers(
    low: &[Vec4],
    largest_around: &[f32],
    gather: &uniforms::RingGather,
    pixel: IVec2,
) -> (Vec3, Vec4) {
    let centre = low[(pixel.y * gather.low_width as i32 + pixel.x) as usize];
    let tile = pixel / TILE as i32;
    let around = largest_around[(tile.y * gather.tiles_wide as i32 + tile.x) as usize];
    let radius = around.max(centre.w / gather.scale as f32);
    (gather_behind(low, gather, pixel, centre), gather_before(low, gather, pixel, centre, radius))
}

/// `combine.wgsl`
fn combine(
    blurred: &Blurred,
    low: &[Vec4],
    layers: &[(Vec3, Vec4)],
    gather: &uniforms::RingGather,
    pixel: IVec2,
) -> Vec3 {
    let radius = blurred.circle(gather, pixel);
    let place = (pixel.as_vec2() + 0.5) / gather.scale as f32 - 0.5;
    let corner = place.floor();
    let mut back = Vec3::ZERO;
    let mut front = Vec4::ZERO;
    let mut weights = 0.0;
    for i in 0..4u32 {
        let at = corner + Vec2::new((i & 1) as f32, (i >> 1) as f32);
        let shares = 1.0 - (place - at).abs();
        let low_size = IVec2::new(gather.low_width as i32, gather.low_height as i32);
        let inside = at.as_ivec2().clamp(IVec2::ZERO, low_size - 1);
        let from_low = (inside.y * low_size.x + inside.x) as usize;
        let weight = shares.x * shares.y / (0.25 + (low[from_low].w - radius).abs());
        back += weight * layers[from_low].0;
        front += weight * layers[from_low].1;
        weights += weight;
    }
    let sharp = blurred.picture.light_at(pixel);
    let share = ((radius.abs() - gather.sharp) / (gather.blurred - gather.sharp)).clamp(0.0, 1.0);
    let own = sharp + (back / weights - sharp) * share;
    let over = front / weights;
    over.truncate() + (1.0 - over.w) * own
}
