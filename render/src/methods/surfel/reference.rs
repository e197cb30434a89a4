//! Shading by surfels in plain Rust: shells without a tree, and brute force without shells.

use super::{Parameters, occlusion, shells};
use crate::methods::{Surface, blur};
use crate::screen::View;
use crate::surfels::reference::Disk;
use deepshade_shaders::wgsl::uniforms;
use deepshade_shaders::{Effect, Planes};
use glam::{IVec2, UVec2, Vec3};
use rayon::prelude::*;

/// The form factor from a point with a normal to a disk, whichever side of it is seen (Wallace, Elmquist and Haines 1989);
/// `way` leads to the disk's middle.
pub fn form_factor(way: Vec3, normal: Vec3, disk_normal: Vec3, radius: f32) -> f32 {
    let squared = way.length_squared();
    let facing = way.dot(normal).max(0.0) * way.dot(disk_normal).abs();
    radius * radius * facing / (squared.max(1e-20) * (squared + radius * radius))
}

/// What all disks within `reach` metres occlude of each pixel's hemisphere, one by one: `[1, height, width]`.
pub fn occlusion(surface: &Surface, disks: &[Disk], reach: f32) -> Planes {
    surface.image(0.0, |pixel| {
        let (position, normal) = (surface.position_at(pixel), surface.normal_at(pixel));
        let ways = disks.iter().map(|disk| (disk, disk.place - position));
        let near = ways.filter(|(_, way)| way.length_squared() < reach * reach);
        [near.map(|(disk, way)| form_factor(way, normal, disk.normal, disk.radius)).sum()]
    })
}

/// What the disks of the shells of one level occlude, before the blur: `[1, height, width]`.
pub fn level_occlusion(surface: &Surface, disks: &[Disk], level: &uniforms::SplatLevel) -> Planes {
    let count = 1u32 << (2 * level.level);
    let mut image = Planes::filled(1, surface.height, surface.width, 0.0);
    let size = UVec2::new(level.width, level.height);
    let places = UVec2::new(size.x.div_ceil(1 << level.level), size.y.div_ceil(1 << level.level));
    let at_place = |(sub_buffer, place): (u32, UVec2)| {
        let pixel = shells::pixel(sub_buffer, place, level.level, level.seed);
        (pixel.cmplt(size).all()).then(|| (pixel, shell_occlusion(surface, disks, level, sub_buffer, pixel)))
    };
    let in_sub_buffer = |sub_buffer| {
        (0..places.x * places.y).map(move |i| (sub_buffer, UVec2::new(i % places.x, i / places.x)))
    };
    let sums: Vec<(UVec2, f32)> =
        (0..count).into_par_iter().flat_map_iter(in_sub_buffer).filter_map(at_place).collect();
    let width = surface.width;
    for (pixel, sum) in sums {
        image.data_mut()[pixel.y as usize * width + pixel.x as usize] = sum;
    }
    image
}

/// What a sub-buffer's disks occlude of one of its pixels.
fn shell_occlusion(
    surface: &Surface,
    disks: &[Disk],
    level: &uniforms::SplatLevel,
    sub_buffer: u32,
    pixel: UVec2,
) -> f32 {
    let at: IVec2 = pixel.as_ivec2();
    if !surface.valid_at(at) {
        return 0.0;
    }
    let (position, normal) = (surface.position_at(at), surface.normal_at(at));
    let its = disks.iter().skip(sub_buffer as usize).step_by(1 << (2 * level.level));
    let does = |disk: &Disk| {
        let way = disk.place - position;
        let outer = if level.last == 1 { level.reach } else { level.reach.min(disk.radius * level.farthest) };
        let distance = way.length_squared();
        let inside = distance >= (disk.radius * level.nearest).powi(2) && distance < outer * outer;
        if inside { form_factor(way, normal, disk.normal, disk.radius * level.enlarged) } else { 0.0 }
    };
    its.map(does).sum()
}

/// What is open of each pixel's hemisphere: [`Passes`](super::passes::Passes) in plain Rust, `[1, height, width]`.
pub fn openness(surface: &Surface, disks: &[Disk], parameters: &Parameters, view: &View) -> Planes {
    let mut sum = vec![0.0; surface.height * surface.width];
    for level in 0..parameters.levels {
        let shell = shells::level(parameters, occlusion::reach(parameters.threshold), level, view);
        let noisy = level_occlusion(surface, disks, &shell);
        let blurs = parameters.blur_of(level).settings(view, Effect::Ao);
        let blurs = blurs.map(|blur| uniforms::Blur { background: 0.0, ..blur });
        let [_, smooth] = blur::smooth(surface, &blurs, &noisy);
        sum.iter_mut().zip(smooth.data()).for_each(|(sum, value)| *sum += value);
    }
    let width = surface.width;
    surface.image(1.0, |at| [(1.0 - sum[at.y as usize * width + at.x as usize]).clamp(0.0, 1.0)])
}
