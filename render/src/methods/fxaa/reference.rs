//! The slow, plain version of `luma.wgsl` and `smooth.wgsl`, kept so close to them that both can be read side
//! by side.

use super::FxaaUniforms;
use crate::methods::LightImage;
use deepshade_shaders::{Planes, colour};
use glam::{IVec2, Vec3};

/// Luma, `[1, height, width]`, and the picture with smooth edges, radiance, `[3, height, width]`.
pub fn shade(picture: &LightImage, settings: &FxaaUniforms) -> [Planes; 2] {
    let luma = luma(picture);
    let image = picture.image(|pixel| smooth_edges(picture, &luma, settings, pixel));
    [luma, image]
}

/// Luma, `[1, height, width]`: `luma.wgsl`.
fn luma(picture: &LightImage) -> Planes {
    Planes::from_fn(1, picture.height, picture.width, |_, y, x| {
        let light = picture.light_at(IVec2::new(x as i32, y as i32));
        colour::luminance(light.to_array()).max(0.0).sqrt()
    })
}

/// The pixel with this offset from another, or the nearest inside the image.
fn neighbour(luma: &Planes, pixel: IVec2, offset: IVec2) -> IVec2 {
    (pixel + offset).clamp(IVec2::ZERO, IVec2::new(luma.width() as i32, luma.height() as i32) - 1)
}

fn luma_at(luma: &Planes, pixel: IVec2, offset: IVec2) -> f32 {
    let at = neighbour(luma, pixel, offset);
    luma.at(0, at.y as usize, at.x as usize)
}

/// Luma halfway between a pixel and its neighbour across the edge, `distance` pixels along the edge from it.
fn luma_between(luma: &Planes, pixel: IVec2, across: IVec2, along: IVec2, distance: f32) -> f32 {
    let whole = distance.floor();
    let part = distance - whole;
    let near = pixel + whole as i32 * along;
    let first = luma_at(luma, near, IVec2::ZERO) + luma_at(luma, near, across);
    let second = luma_at(luma, near, along) + luma_at(luma, near, along + across);
    0.5 * (first * (1.0 - part) + second * part)
}

/// Of two numbers that are alike but for rounding, every processor takes the first for the greater.
fn is_first_more(first: f32, second: f32) -> bool {
    first >= 0.9999 * second
}

/// How far an edge goes on in one direction, and by how much luma differs there from that of the edge.
fn edge_end(lengths: &[f32], difference_at: impl Fn(f32) -> f32, threshold: f32) -> (f32, f32) {
    let mut distance = 0.0;
    let mut difference = 0.0;
    for length in lengths {
        distance += length;
        difference = difference_at(distance);
        if is_first_more(difference.abs(), threshold) {
            break;
        }
    }
    (distance, difference)
}

fn smooth_edges(picture: &LightImage, luma: &Planes, settings: &FxaaUniforms, pixel: IVec2) -> Vec3 {
    let fxaa = &settings.fxaa;
    let light = picture.light_at(pixel);
    let at = |x: i32, y: i32| luma_at(luma, pixel, IVec2::new(x, y));

    let (m, n, s, w, e) = (at(0, 0), at(0, -1), at(0, 1), at(-1, 0), at(1, 0));
    let brightest = m.max(n.max(s).max(w.max(e)));
    let range = brightest - m.min(n.min(s).min(w.min(e)));
    if range <= fxaa.least_contrast.max(fxaa.contrast * brightest) {
        return light;
    }
    let (nw, ne, sw, se) = (at(-1, -1), at(1, -1), at(-1, 1), at(1, 1));

    // How much the pixel stands out from the mean of its neighbours.
    let mean = (2.0 * (n + s + w + e) + nw + ne + sw + se) / 12.0;
    let outstanding = smoothstep((mean - m).abs() / range);
    let subpixel = fxaa.subpixel * outstanding * outstanding;

    // Which way the edge runs, and on which side of the pixel it is.
    let up_down = (nw + sw - 2.0 * w).abs() + 2.0 * (n + s - 2.0 * m).abs() + (ne + se - 2.0 * e).abs();
    let left_right = (nw + ne - 2.0 * n).abs() + 2.0 * (w + e - 2.0 * m).abs() + (sw + se - 2.0 * s).abs();
    let horizontal = is_first_more(up_down, left_right);
    let (before, after) = if horizontal { (n, s) } else { (w, e) };
    let side = if is_first_more((before - m).abs(), (after - m).abs()) { -1 } else { 1 };
    let across = side * if horizontal { IVec2::Y } else { IVec2::X };
    let along = if horizontal { IVec2::X } else { IVec2::Y };
    let beyond = if side < 0 { before } else { after };
    let middle = 0.5 * (m + beyond);
    let threshold = 0.25 * (beyond - m).abs();

    // The nearer end says how far the edge has come towards the pixel.
    let lengths = &settings.lengths[..fxaa.steps as usize];
    let end = |along: IVec2| {
        let difference = |distance: f32| luma_between(luma, pixel, across, along, distance) - middle;
        edge_end(lengths, difference, threshold)
    };
    let (backward, forward) = (end(-along), end(along));
    let nearer = if backward.0 < forward.0 { backward } else { forward };
    let crossing = (nearer.1 < 0.0) != (m < middle);
    let slope = if crossing { 0.5 - nearer.0 / (backward.0 + forward.0) } else { 0.0 };
    let blend = slope.max(subpixel);

    light + (picture.light_at(neighbour(luma, pixel, across)) - light) * blend
}

fn smoothstep(x: f32) -> f32 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}
