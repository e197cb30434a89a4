//! Indirect light by surfels on the processor, as the paper has it: each disk is splatted to those pixels of its
//! sub-buffer that its shell may reach, some sixty on every level. Sums are added up in the order of disks,
//! as [`reference`](mod@super::reference) adds them, so that both are the same to the last bit.

use super::reference::{LIGHT, Receiver, done, plus};
use super::{SurfelParameters, shells};
use crate::methods::{Surface, blur};
use crate::screen::View;
use crate::surfels::reference::Disk;
use deepshade_shaders::wgsl::uniforms::{self, SplatLevel};
use deepshade_shaders::{Effect, Planes};
use glam::{UVec2, Vec3};
use rayon::prelude::*;

/// Light that disks send, irradiance over pi, `[3, height, width]`: what [`indirect`](super::indirect) makes,
/// for machines without a graphics card.
pub fn light(surface: &Surface, disks: &[Disk], parameters: &SurfelParameters, view: &View) -> Planes {
    let mut sum = Planes::filled(3, surface.height, surface.width, 0.0);
    for level in 0..parameters.levels {
        let settings = shells::level(parameters, level, view);
        let noisy = level_sums(surface, disks, &settings, view.focal_length());
        let blurs = parameters.blur_of(level).settings(view, Effect::Gi);
        let blurs = blurs.map(|blur| uniforms::Blur { background: 0.0, ..blur });
        let [_, smooth] = blur::vector::smooth(surface, &blurs, &noisy);
        sum.data_mut().iter_mut().zip(smooth.data()).for_each(|(sum, value)| *sum += value);
    }
    sum
}

/// What the disks of the shells of one level send, before the blur: `[3, height, width]`.
pub fn level_sums(surface: &Surface, disks: &[Disk], level: &SplatLevel, focal_length: f32) -> Planes {
    let rows = splats_by_row(disks, level, focal_length);
    let rows = rows.par_iter().enumerate();
    let bands: Vec<Vec<[f32; 3]>> =
        rows.map(|(y, splats)| band(surface, disks, level, y as u32, splats)).collect();
    let mut image = Planes::filled(3, surface.height, surface.width, 0.0);
    for channel in 0..3 {
        let pixels = bands.iter().flatten().map(|sum| sum[channel] * level.stands_for);
        image.plane_mut(channel).iter_mut().zip(pixels).for_each(|(value, sum)| *value = sum);
    }
    image
}

/// A disk in a row of blocks, and from which block to which it may reach.
#[derive(Clone, Copy, Debug)]
struct Splat {
    disk: u32,
    first: u32,
    last: u32,
}

/// The disks that may reach each row of a level's blocks, a pixel of each sub-buffer a block.
fn splats_by_row(disks: &[Disk], level: &SplatLevel, focal_length: f32) -> Vec<Vec<Splat>> {
    let size = UVec2::new(level.width, level.height);
    let blocks = UVec2::new(size.x.div_ceil(1 << level.level), size.y.div_ceil(1 << level.level));
    let mut rows = vec![Vec::new(); blocks.y as usize];
    let reached: Vec<_> =
        disks.par_iter().map(|disk| reached_blocks(disk, level, focal_length, blocks)).collect();
    for (disk, reached) in (0..).zip(reached) {
        let Some([low, high]) = reached else { continue };
        let splat = Splat { disk, first: low.x, last: high.x };
        (low.y..=high.y).for_each(|y| rows[y as usize].push(splat));
    }
    rows
}

/// The first and the last block, in columns and in rows, that a ball around a disk as large as its shell may
/// cover on the screen; none where it is outside.
fn reached_blocks(disk: &Disk, level: &SplatLevel, focal_length: f32, blocks: UVec2) -> Option<[UVec2; 2]> {
    if disk.sent == [Vec3::ZERO; 2] {
        return None;
    }
    let reach = if level.last == 1 { level.reach } else { level.reach.min(disk.radius * level.farthest) };
    let (nearest, farthest) = (-disk.place.z - reach, -disk.place.z + reach);
    if farthest <= 0.0 {
        return None;
    }
    // Over depth, the bounds of the box around the ball; without end where the camera is within.
    let bound = |least: f32, at: f32| match nearest > 1e-3 * reach {
        true => at / if (at < 0.0) == (least < 0.0) { nearest } else { farthest },
        false => least * f32::INFINITY,
    };
    let bounds = |at: f32, size: u32| {
        let middle = 0.5 * size as f32;
        let [low, high] = [bound(-1.0, at - reach), bound(1.0, at + reach)];
        [middle + focal_length * low - 1.0, middle + focal_length * high + 1.0]
    };
    let [left, right] = bounds(disk.place.x, level.width);
    let [top, bottom] = bounds(-disk.place.y, level.height);
    let inside = right >= 0.0 && bottom >= 0.0 && left < level.width as f32 && top < level.height as f32;
    let block = |x: f32, y: f32| (UVec2::new(x as u32, y as u32) >> level.level).min(blocks - 1);
    inside.then(|| [block(left.max(0.0), top.max(0.0)), block(right, bottom)])
}

/// The sums of a row of blocks, in the order of the image's pixels.
fn band(surface: &Surface, disks: &[Disk], level: &SplatLevel, row: u32, splats: &[Splat]) -> Vec<[f32; 3]> {
    let size = UVec2::new(level.width, level.height);
    let top = row << level.level;
    let height = (size.y - top).min(1 << level.level);
    let mut sums = vec![[0.0; 3]; (height * size.x) as usize];
    let sub_buffers = 1u32 << (2 * level.level);
    for Splat { disk, first, last } in splats {
        for column in *first..=*last {
            let pixel = shells::pixel(disk % sub_buffers, UVec2::new(column, row), level.level, level.seed);
            let at = pixel.as_ivec2();
            if pixel.cmplt(size).all() && surface.valid_at(at) {
                let receiver = Receiver { pixel: at, normal: surface.normal_at(at) };
                let sum = &mut sums[((pixel.y - top) * size.x + pixel.x) as usize];
                let position = surface.position_at(at);
                *sum = plus(*sum, done(&disks[*disk as usize], position, receiver, LIGHT, level));
            }
        }
    }
    sums
}
