//! Indirect light by surfels on the processor, as the paper has it: each disk is splatted to those pixels of
//! its sub-buffer that its shell may reach, some sixty on every level. Sums are added up in the order of
//! disks, as [`reference`](mod@super::reference) adds them, so that both are the same to the last bit.

use super::reference::{LIGHT, Receiver, done, plus};
use super::{SurfelParameters, shells};
use crate::methods::{Surface, blur};
use crate::screen::View;
use crate::surfels::reference::Disk;
use deepshade_shaders::wgsl::uniforms::{self, SplatLevel};
use deepshade_shaders::{Effect, Planes};
use glam::{IVec2, UVec2, Vec3};
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
        rows.map(|(y, splats)| Band::new(surface, level, y as u32).sums(disks, splats)).collect();
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

/// The blocks of a level along both axes: each has a pixel of every sub-buffer.
fn blocks(level: &SplatLevel) -> UVec2 {
    let size = 1 << level.level;
    UVec2::new(level.width.div_ceil(size), level.height.div_ceil(size))
}

/// The disks that may reach each row of blocks.
fn splats_by_row(disks: &[Disk], level: &SplatLevel, focal_length: f32) -> Vec<Vec<Splat>> {
    let blocks = blocks(level);
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

/// How far a disk reaches on a level, metres.
fn outer(disk: &Disk, level: &SplatLevel) -> f32 {
    if level.last == 1 { level.reach } else { level.reach.min(disk.radius * level.farthest) }
}

/// The first and the last block, in columns and in rows, that a ball around a disk as large as its shell may
/// cover on the screen; none where it is outside.
fn reached_blocks(disk: &Disk, level: &SplatLevel, focal_length: f32, blocks: UVec2) -> Option<[UVec2; 2]> {
    if disk.sent == [Vec3::ZERO; 2] {
        return None;
    }
    let reach = outer(disk, level);
    let (nearest, farthest) = (-disk.place.z - reach, -disk.place.z + reach);
    if farthest <= 0.0 {
        return None;
    }
    // Over depth, the bounds of the box around the ball; without end where the camera is within.
    let bound = |side: f32, at: f32| match nearest > 1e-3 * reach {
        true => at / if (at < 0.0) == (side < 0.0) { nearest } else { farthest },
        false => side * f32::INFINITY,
    };
    let bounds = |at: f32, size: u32| {
        let [low, high] = [bound(-1.0, at - reach), bound(1.0, at + reach)];
        [low, high].map(|slope| 0.5 * size as f32 + focal_length * slope)
    };
    let [left, right] = bounds(disk.place.x, level.width);
    let [top, bottom] = bounds(-disk.place.y, level.height);
    // A pixel more, for rounding.
    let [left, top, right, bottom] = [left - 1.0, top - 1.0, right + 1.0, bottom + 1.0];
    let inside = right >= 0.0 && bottom >= 0.0 && left < level.width as f32 && top < level.height as f32;
    let block = |x: f32, y: f32| (UVec2::new(x as u32, y as u32) >> level.level).min(blocks - 1);
    inside.then(|| [block(left.max(0.0), top.max(0.0)), block(right, bottom)])
}

/// A row of blocks.
struct Band<'a> {
    surface: &'a Surface,
    level: &'a SplatLevel,
    /// The first row of the image, and how many.
    top: u32,
    height: u32,
    /// Of each block: what its pixels' order follows from, and the box around what they show.
    blocks: Vec<(u32, [Vec3; 2])>,
}

impl<'a> Band<'a> {
    fn new(surface: &'a Surface, level: &'a SplatLevel, row: u32) -> Self {
        let top = row << level.level;
        let height = (level.height - top).min(1 << level.level);
        let block = |column: u32| {
            let left = column << level.level;
            let columns = left..level.width.min(left + (1 << level.level));
            let pixels = (top..top + height)
                .flat_map(|y| columns.clone().map(move |x| IVec2::new(x as i32, y as i32)));
            let shown = pixels.filter(|at| surface.valid_at(*at)).map(|at| surface.position_at(at));
            let empty = [Vec3::INFINITY, Vec3::NEG_INFINITY];
            let bounds = shown.fold(empty, |[low, high], at| [low.min(at), high.max(at)]);
            (shells::key(UVec2::new(column, row), level.level, level.seed), bounds)
        };
        Self { surface, level, top, height, blocks: (0..blocks(level).x).map(block).collect() }
    }

    /// What disks send to its pixels, in the order of the image's.
    fn sums(&self, disks: &[Disk], splats: &[Splat]) -> Vec<[f32; 3]> {
        let width = self.level.width;
        let mut sums = vec![[0.0; 3]; (self.height * width) as usize];
        for Splat { disk: index, first, last } in splats {
            let disk = &disks[*index as usize];
            let shell = [disk.radius * self.level.nearest, outer(disk, self.level)];
            for column in *first..=*last {
                let (key, bounds) = self.blocks[column as usize];
                if !shell_meets(disk.place, shell, bounds) {
                    continue;
                }
                let level = self.level.level;
                let sub_buffer = index & ((1 << (2 * level)) - 1);
                let place = UVec2::new(column, self.top >> level);
                let pixel = shells::pixel_of(sub_buffer, place, level, key);
                let at = pixel.as_ivec2();
                if pixel.x < width && pixel.y < self.level.height && self.surface.valid_at(at) {
                    let receiver = Receiver { pixel: at, normal: self.surface.normal_at(at) };
                    let sum = &mut sums[((pixel.y - self.top) * width + pixel.x) as usize];
                    *sum = plus(*sum, done(disk, self.surface.position_at(at), receiver, LIGHT, self.level));
                }
            }
        }
        sums
    }
}

/// Whether a shell around a point may meet a box, of which rounding takes nothing.
fn shell_meets(point: Vec3, [inner, outer]: [f32; 2], [low, high]: [Vec3; 2]) -> bool {
    const ROUNDED: f32 = 1e-4;
    let nearest = (low - point).max(point - high).max(Vec3::ZERO).length_squared();
    let farthest = (point - low).abs().max((high - point).abs()).length_squared();
    nearest <= outer * outer * (1.0 + ROUNDED) && farthest >= inner * inner * (1.0 - ROUNDED)
}
