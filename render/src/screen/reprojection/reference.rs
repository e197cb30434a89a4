//! The slow, plain version of `reproject.wgsl`, and what it is measured by.

use crate::scene::Camera;
use deepshade_shaders::Planes;
use deepshade_shaders::wgsl::uniforms;
use glam::{IVec2, Vec2, Vec3};

/// What two frames show of the same surfaces.
#[derive(Clone, Copy, Debug)]
pub struct Two<'a> {
    /// How far each pixel's surface moved since the frame before (x to the right, y up, pixels), its depth,
    /// and the depth that it had then; 0 where nothing is seen: `[4, height, width]`.
    pub since_before: &'a Planes,
    /// The same of the frame before.
    pub since_before_that: &'a Planes,
}

/// This frame's image, mixed with what the frame before made: `[channels, height, width]` each.
pub fn mixed(two: Two<'_>, current: &Planes, history: &Planes, mixing: &uniforms::Reprojection) -> Planes {
    Planes::from_fn(current.channels(), current.height(), current.width(), |c, y, x| {
        let value = current.at(c, y, x);
        let was = two.carried(history, c, [y, x], mixing.depth_tolerance);
        let (Some(was), 0) = (was, mixing.first) else { return value };
        let (mean, deviation) = spread_around(current, c, [y, x]);
        let reach = mixing.clip * deviation;
        let clipped = was.max(mean - reach).min(mean + reach);
        clipped + mixing.share * (value - clipped)
    })
}

/// How much an image flickers: the mean, over the pixels whose surface was seen before and over channels, of
/// how far they are from what the frame before showed of it. 0 where a surface keeps what it shows.
pub fn flicker(two: Two<'_>, current: &Planes, before: &Planes, depth_tolerance: f32) -> f64 {
    let changes = changes(two, current, before, depth_tolerance);
    let sum: f64 = changes.iter().map(|change| f64::from(change.abs())).sum();
    sum / changes.len().max(1) as f64
}

/// How far an image is from what the frame before showed of the same surfaces: row by row, of the pixels
/// whose surface was seen before, of each channel.
pub fn changes(two: Two<'_>, current: &Planes, before: &Planes, depth_tolerance: f32) -> Vec<f32> {
    let pixels = (0..current.height()).flat_map(|y| (0..current.width()).map(move |x| [y, x]));
    let of_pixel = |at @ [y, x]: [usize; 2]| {
        let carried = move |c| Some(current.at(c, y, x) - two.carried(before, c, at, depth_tolerance)?);
        (0..current.channels()).filter_map(carried)
    };
    pixels.flat_map(of_pixel).collect()
}

impl Two<'_> {
    /// Where the frame before showed the surface of a pixel: pixels by their index, each with its weight, and
    /// the sum of these; `None` where it was not seen.
    pub fn taps(self, [y, x]: [usize; 2], tolerance: f32) -> Option<([(usize, f32); 4], f32)> {
        let depth = self.since_before.at(3, y, x);
        let movement = Vec2::new(self.since_before.at(0, y, x), -self.since_before.at(1, y, x));
        let at = Vec2::new(x as f32, y as f32) - movement;
        let (corner, part) = (at.floor(), at - at.floor());
        let [height, width] = [self.since_before.height(), self.since_before.width()];
        let mut taps = [(0, 0.0); 4];
        for (i, taken) in taps.iter_mut().enumerate() {
            let (right, below) = (i & 1, i >> 1);
            let tap = corner.as_ivec2() + IVec2::new(right as i32, below as i32);
            let inside =
                tap.cmpge(IVec2::ZERO).all() && (tap.x as usize) < width && (tap.y as usize) < height;
            if !inside {
                continue;
            }
            let (row, column) = (tap.y as usize, tap.x as usize);
            let was = self.since_before_that.at(2, row, column);
            if was <= 0.0 || (was - depth).abs() > tolerance * depth {
                continue;
            }
            let across = if right == 1 { part.x } else { 1.0 - part.x };
            let down = if below == 1 { part.y } else { 1.0 - part.y };
            *taken = (row * width + column, across * down);
        }
        let sum = taps.iter().map(|(_, weight)| weight).sum();
        (depth > 0.0 && sum > 0.01).then_some((taps, sum))
    }

    /// What a channel of the frame before showed of the surface of a pixel; `None` where that was not seen.
    fn carried(self, history: &Planes, channel: usize, at: [usize; 2], tolerance: f32) -> Option<f32> {
        let (taps, sum) = self.taps(at, tolerance)?;
        let plane = history.plane(channel);
        let weighted =
            taps.iter().filter(|(_, weight)| *weight > 0.0).map(|(at, weight)| weight * plane[*at]);
        Some(weighted.sum::<f32>() / sum)
    }
}

/// What [`Two`] knows of a frame: from positions in camera space, `[3, height, width]`, of what is seen, and
/// how far that has gone since the frame before, metres in world space.
pub fn since(positions: &Planes, seen: &[bool], gone: &[Vec3], camera: &Camera, before: &Camera) -> Planes {
    let [height, width] = [positions.height(), positions.width()];
    let mut since = Planes::filled(4, height, width, 0.0);
    for pixel in (0..height * width).filter(|pixel| seen[*pixel]) {
        let place = Vec3::from_array([0, 1, 2].map(|axis| positions.plane(axis)[pixel]));
        let then = before.to_camera(camera.position + camera.rotation * place - gone[pixel]);
        let at = Vec2::new((pixel % width) as f32, (pixel / width) as f32) + 0.5;
        // What was behind the camera had no positive depth, by which it counts as not seen.
        let movement = at - before.project(then, height, width).unwrap_or(at);
        let values = [movement.x, -movement.y, -place.z, -then.z];
        for (channel, value) in values.into_iter().enumerate() {
            since.plane_mut(channel)[pixel] = value;
        }
    }
    since
}

/// Mean and standard deviation of a channel over the pixels around one.
fn spread_around(image: &Planes, channel: usize, [y, x]: [usize; 2]) -> (f32, f32) {
    let (mut sum, mut squares, mut count) = (0.0, 0.0, 0.0);
    for row in y.saturating_sub(1)..(y + 2).min(image.height()) {
        for column in x.saturating_sub(1)..(x + 2).min(image.width()) {
            let value = image.at(channel, row, column);
            sum += value;
            squares += value * value;
            count += 1.0;
        }
    }
    let mean = sum / count;
    (mean, (squares / count - mean * mean).max(0.0).sqrt())
}
