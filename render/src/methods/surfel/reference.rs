//! Shading by surfels in plain Rust: shells without a tree, and brute force without shells.

use super::{SurfelParameters, shells};
use crate::methods::{Surface, blur};
use crate::screen::View;
use crate::surfels::reference::Disk;
use deepshade_shaders::wgsl::uniforms;
use deepshade_shaders::{Effect, Planes};
use glam::{IVec2, UVec2, Vec3};
use rayon::prelude::*;

/// The form factor from a point with a normal to a disk (Wallace, Elmquist and Haines 1989); `way` leads to
/// the disk's middle. Of closed surfaces only fronts count.
pub fn form_factor(way: Vec3, normal: Vec3, disk: &Disk) -> f32 {
    let squared = way.length_squared();
    let area = disk.radius * disk.radius;
    area * way.dot(normal).max(0.0) * facing(way, disk) / (squared.max(1e-20) * (squared + area))
}

/// By how much a disk faces where a way to its middle comes from: its cosine times the way's length.
pub fn facing(way: Vec3, disk: &Disk) -> f32 {
    let towards = -way.dot(disk.normal);
    if disk.open { towards.abs() } else { towards.max(0.0) }
}

/// The radiance that a disk sends against a way to its middle.
pub fn sent(way: Vec3, disk: &Disk) -> Vec3 {
    disk.sent[usize::from(way.dot(disk.normal) >= 0.0)]
}

/// The surface of a pixel.
#[derive(Clone, Copy, Debug)]
pub struct Receiver {
    /// The pixel.
    pub pixel: IVec2,
    /// Its unit normal, camera space.
    pub normal: Vec3,
}

/// What a disk, which stands for so many, does to what a pixel shows; the way leads to its middle.
pub type Does<'a, const CHANNELS: usize> = dyn Fn(&Disk, f32, Vec3, Receiver) -> [f32; CHANNELS] + Sync + 'a;

/// What a disk does to a point.
#[derive(Clone, Copy)]
pub struct Shade<'a, const CHANNELS: usize> {
    /// How far disks do something to what a pixel shows, metres, if not as far as the effect reaches.
    pub reach: &'a (dyn Fn(IVec2) -> f32 + Sync + 'a),
    /// What it does there.
    pub of: &'a Does<'a, CHANNELS>,
}

/// Occlusion.
pub const OCCLUSION: Shade<'_, 1> = Shade {
    reach: &|_| f32::INFINITY,
    of: &|disk, _, way, receiver| [form_factor(way, receiver.normal, disk)],
};

/// Light, irradiance over pi.
pub const LIGHT: Shade<'_, 3> = Shade {
    reach: &|_| f32::INFINITY,
    of: &|disk, _, way, receiver| (sent(way, disk) * form_factor(way, receiver.normal, disk)).to_array(),
};

/// What all disks within `reach` metres do to each pixel, one by one: `[channels, height, width]`.
pub fn brute_force<const CHANNELS: usize>(
    surface: &Surface,
    disks: &[Disk],
    shade: Shade<'_, CHANNELS>,
    reach: f32,
) -> Planes {
    surface.image(0.0, |pixel| {
        let receiver = Receiver { pixel, normal: surface.normal_at(pixel) };
        let (position, reach) = (surface.position_at(pixel), reach.min((shade.reach)(pixel)));
        let ways = disks.iter().map(|disk| (disk, disk.place - position));
        let near = ways.filter(|(_, way)| way.length_squared() < reach * reach);
        near.map(|(disk, way)| (shade.of)(disk, 1.0, way, receiver)).fold([0.0; CHANNELS], plus)
    })
}

/// What the disks of the shells of one level do, before the blur: `[channels, height, width]`.
pub fn level_sums<const CHANNELS: usize>(
    surface: &Surface,
    disks: &[Disk],
    shade: Shade<'_, CHANNELS>,
    level: &uniforms::SplatLevel,
) -> Planes {
    let mut image = Planes::filled(CHANNELS, surface.height, surface.width, 0.0);
    let size = UVec2::new(level.width, level.height);
    let places = UVec2::new(size.x.div_ceil(1 << level.level), size.y.div_ceil(1 << level.level));
    let at_place = |(sub_buffer, place): (u32, UVec2)| {
        let pixel = shells::pixel(sub_buffer, place, level.level, level.seed);
        pixel.cmplt(size).all().then(|| (pixel, shell_sum(surface, disks, shade, level, sub_buffer, pixel)))
    };
    let in_sub_buffer = |sub_buffer| {
        (0..places.x * places.y).map(move |i| (sub_buffer, UVec2::new(i % places.x, i / places.x)))
    };
    let sub_buffers = (0..1u32 << (2 * level.level)).into_par_iter();
    let sums: Vec<_> = sub_buffers.flat_map_iter(in_sub_buffer).filter_map(at_place).collect();
    for (pixel, sum) in sums {
        for (channel, value) in sum.into_iter().enumerate() {
            image.plane_mut(channel)[pixel.y as usize * surface.width + pixel.x as usize] = value;
        }
    }
    image
}

/// What a sub-buffer's disks do to one of its pixels.
fn shell_sum<const CHANNELS: usize>(
    surface: &Surface,
    disks: &[Disk],
    shade: Shade<'_, CHANNELS>,
    level: &uniforms::SplatLevel,
    sub_buffer: u32,
    pixel: UVec2,
) -> [f32; CHANNELS] {
    let at = pixel.as_ivec2();
    if !surface.valid_at(at) {
        return [0.0; CHANNELS];
    }
    let receiver = Receiver { pixel: at, normal: surface.normal_at(at) };
    let position = surface.position_at(at);
    let its = disks.iter().skip(sub_buffer as usize).step_by(1 << (2 * level.level));
    let sum = its.map(|disk| done(disk, position, receiver, shade, level)).fold([0.0; CHANNELS], plus);
    sum.map(|sum| sum * level.stands_for)
}

/// What a disk does to a pixel on a level: nothing outside its shell.
pub fn done<const CHANNELS: usize>(
    disk: &Disk,
    position: Vec3,
    receiver: Receiver,
    shade: Shade<'_, CHANNELS>,
    level: &uniforms::SplatLevel,
) -> [f32; CHANNELS] {
    let (way, reaches) = (disk.place - position, disk.radius);
    let reach = level.reach.min((shade.reach)(receiver.pixel));
    let outer = if level.last == 1 { reach } else { reach.min(reaches * level.farthest) };
    let distance = way.length_squared();
    let inside = distance >= (reaches * level.nearest).powi(2) && distance < outer * outer;
    if inside { (shade.of)(disk, level.stands_for, way, receiver) } else { [0.0; CHANNELS] }
}

/// The sum of two.
pub fn plus<const CHANNELS: usize>(a: [f32; CHANNELS], b: [f32; CHANNELS]) -> [f32; CHANNELS] {
    std::array::from_fn(|channel| a[channel] + b[channel])
}

/// The sum of all levels, each blurred: `[channels, height, width]`, 0 where no surface is seen.
pub fn sums<const CHANNELS: usize>(
    surface: &Surface,
    disks: &[Disk],
    shade: Shade<'_, CHANNELS>,
    parameters: &SurfelParameters,
    view: &View,
) -> Planes {
    let mut sum = Planes::filled(CHANNELS, surface.height, surface.width, 0.0);
    for level in 0..parameters.levels {
        let noisy = level_sums(surface, disks, shade, &shells::level(parameters, level, view));
        let blurs = parameters.blur_of(level).settings(view, Effect::Ao);
        let blurs = blurs.map(|blur| uniforms::Blur { background: 0.0, ..blur });
        let [_, smooth] = blur::smooth(surface, &blurs, &noisy);
        sum.data_mut().iter_mut().zip(smooth.data()).for_each(|(sum, value)| *sum += value);
    }
    sum
}

/// What is open of each pixel's hemisphere, `[1, height, width]`.
pub fn openness(surface: &Surface, disks: &[Disk], parameters: &SurfelParameters, view: &View) -> Planes {
    let sum = sums(surface, disks, OCCLUSION, parameters, view);
    surface.image(1.0, |at| [(1.0 - sum.at(0, at.y as usize, at.x as usize)).clamp(0.0, 1.0)])
}
