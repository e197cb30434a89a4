//! The slow, plain version of `reproject.wgsl`, and what it is measured by.

use deepshade_shaders::Planes;
use deepshade_shaders::wgsl::uniforms;
use glam::{IVec2, Vec2};

/// What two frames show of the same surfaces.
#[derive(Clone, Copy, Debug)]
pub struct Two<'a> {
    /// How far each pixel's surface moved since the frame before (x to the right, y up, pixels), its depth, and the depth
    /// that it had then; 0 where nothing is seen: `[4, height, width]`.
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

/// How much an image flickers: the mean, over the pixels whose surface was seen before and over channels, of how far
/// they are from what the frame before showed of it. 0 where a surface keeps what it shows.
pub fn flicker(two: Two<'_>, current: &Planes, before: &Planes, depth_tolerance: f32) -> f64 {
    let (mut sum, mut count) = (0.0, 0u64);
    for y in 0..current.height() {
        for x in 0..current.width() {
            for c in 0..current.channels() {
                if let Some(was) = two.carried(before, c, [y, x], depth_tolerance) {
                    sum += f64::from((current.at(c, y, x) - was).abs());
                    count += 1;
                }
            }
        }
    }
    if count == 0 { 0.0 } else { sum / count as f64 }
}

impl Two<'_> {
    /// What a channel of the frame before showed of the surface of a pixel; `None` where that was not seen.
    fn carried(self, history: &Planes, channel: usize, [y, x]: [usize; 2], tolerance: f32) -> Option<f32> {
        let depth = self.since_before.at(3, y, x);
        let movement = Vec2::new(self.since_before.at(0, y, x), -self.since_before.at(1, y, x));
        let at = Vec2::new(x as f32, y as f32) - movement;
        let (corner, part) = (at.floor(), at - at.floor());
        let (mut value, mut sum) = (0.0, 0.0);
        for i in 0..4 {
            let tap = corner.as_ivec2() + IVec2::new(i & 1, i >> 1);
            let inside = tap.cmpge(IVec2::ZERO).all()
                && (tap.x as usize) < history.width()
                && (tap.y as usize) < history.height();
            if !inside {
                continue;
            }
            let (row, column) = (tap.y as usize, tap.x as usize);
            let was = self.since_before_that.at(2, row, column);
            if was <= 0.0 || (was - depth).abs() > tolerance * depth {
                continue;
            }
            let across = if i & 1 == 1 { part.x } else { 1.0 - part.x };
            let down = if i >> 1 == 1 { part.y } else { 1.0 - part.y };
            if across * down > 0.0 {
                value += across * down * history.at(channel, row, column);
            }
            sum += across * down;
        }
        (depth > 0.0 && sum > 0.01).then(|| value / sum)
    }
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
