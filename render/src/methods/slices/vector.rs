//! The march of [`super::gather`] for as many neighbouring pixels of a row as a vector has lanes: what is
//! open, without light.
//!
//! It is the same arithmetic, written for what vectors are good at. A pixel has a frame of its own: to the
//! right and up as the eye sees it, and towards the eye. There a direction across is two numbers, and the
//! plane of a sample holds its front, its back and the normal's projection as pairs: across, towards the eye.
//! What is a fraction of the length across is not divided by it, as that cancels between a place and the
//! extent of its slice. Positions in the image are rounded as there, so that samples are the same ones.

use super::{Surface, uniforms};
use crate::methods::vectors::{Lanes, Mask, Words, random, random_row};
use deepshade_shaders::{Planes, shows_surface};
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;
use std::f32::consts::{FRAC_PI_2, PI};

/// Openness, `[1, height, width]`, 1 where no surface is seen: [`super::Gathered::open`] of each pixel.
pub fn openness(surface: &Surface, slices: &uniforms::Slices) -> Planes {
    let (height, width) = (surface.height, surface.width);
    let [x, y, z] = surface.position_planes();
    let valid = surface.valid.data();
    let mut points = vec![[f32::NAN; 4]; height * width];
    points.par_iter_mut().enumerate().for_each(|(at, point)| {
        if shows_surface(valid[at]) {
            *point = [x[at], y[at], z[at], 0.0];
        }
    });
    let step = PI / slices.slices as f32;
    let turns: Vec<(f32, f32)> = (0..slices.slices).map(|k| (k as f32 * step).sin_cos()).collect();
    let mut image = vec![1.0; height * width];
    let bands = image.par_chunks_mut((width * BAND).max(1)).enumerate();
    bands.for_each(|(band, open)| {
        let march = March { surface, slices, points: &points, turns: &turns };
        Arch::new().dispatch(Band { march, top: band * BAND, open });
    });
    Planes::from_data(1, height, width, image)
}

/// Rows that are made by one task, and columns that it makes before the next ones: what they read of the
/// table stays in the cache of a core.
const BAND: usize = 16;
const BLOCK: usize = 64;

/// What all pixels read.
#[derive(Clone, Copy)]
struct March<'a> {
    surface: &'a Surface,
    slices: &'a uniforms::Slices,
    /// Where surfaces are; not a number where there is none, which is within no radius.
    points: &'a [[f32; 4]],
    /// Sine and cosine of how far each slice is turned from the first.
    turns: &'a [(f32, f32)],
}

/// Rows of the image.
struct Band<'a> {
    march: March<'a>,
    top: usize,
    open: &'a mut [f32],
}

/// Pixels beside each other, with what is theirs whatever the sample.
#[derive(Clone, Copy)]
struct Pixels<S: Simd> {
    column: Lanes<S>,
    row: Lanes<S>,
    /// The same, to draw random numbers by.
    columns: Words<S>,
    /// Where each stands in the table of points.
    index: Words<S>,
    point: [Lanes<S>; 3],
    right: [Lanes<S>; 3],
    up: [Lanes<S>; 3],
    to_eye: [Lanes<S>; 3],
    /// Distance to the eye.
    distance: Lanes<S>,
    /// The normal: to the right, up, towards the eye.
    normal: [Lanes<S>; 3],
    /// The last, but never away from the eye.
    upright: Lanes<S>,
    /// [`LOW`], or beyond all numbers for normals that look away from the eye, whose slices are not what is
    /// above them.
    low: Lanes<S>,
    valid: Mask<S>,
}

/// One side of a slice of each pixel.
#[derive(Clone, Copy)]
struct Side<S: Simd> {
    /// In the image, unit length.
    direction: [Lanes<S>; 2],
    reach: Lanes<S>,
    count: Lanes<S>,
    start: Lanes<S>,
    jitter: Lanes<S>,
}

impl WithSimd for Band<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { march, top, open } = self;
        let width = march.surface.width;
        let mut draws = Vec::new();
        for y in top..top + open.len() / width {
            for dimension in 0..=2 * march.slices.slices {
                draws.push(random_row(y as u32, march.slices.seed, dimension));
            }
        }
        let draws = draws.chunks_exact(2 * march.turns.len() + 1);
        for left in (0..width).step_by(BLOCK) {
            for ((y, row), draws) in open.chunks_exact_mut(width).enumerate().zip(draws.clone()) {
                let right = (left + BLOCK).min(width);
                march.stretch(simd, [left, top + y], &mut row[left..right], draws);
            }
        }
    }
}

#[inline(always)]
fn dot<S: Simd>(a: [Lanes<S>; 3], b: [Lanes<S>; 3]) -> Lanes<S> {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2] * b[2]))
}

/// As the scalar version has it, whose rounding decides where samples are.
#[inline(always)]
fn normalised<S: Simd>(vector: [Lanes<S>; 3]) -> [Lanes<S>; 3] {
    let [x, y, z] = vector;
    let scale = x.all(1.0) / (x * x + y * y + z * z).sqrt();
    [x * scale, y * scale, z * scale]
}

/// [`super::arc_cosine`].
#[inline(always)]
fn arc_cosine<S: Simd>(x: Lanes<S>) -> Lanes<S> {
    let one = x.all(1.0);
    let a = x.abs().min(one);
    let cubic = a.mul_add(a.all(-0.018_729_3), a.all(0.074_261_0));
    let cubic = cubic.mul_add(a, a.all(-0.212_114_4)).mul_add(a, a.all(1.570_728_8));
    let angle = (one - a).sqrt() * cubic;
    x.below(x.all(0.0)).choose(x.all(PI) - angle, angle)
}

/// The pixels of a row from a column on.
#[inline(always)]
fn load<S: Simd>(simd: S, [a, b, c]: [&[f32]; 3], start: usize, width: usize, x: usize) -> [Lanes<S>; 3] {
    [
        Lanes::load(simd, &a[start..][..width], x as isize),
        Lanes::load(simd, &b[start..][..width], x as isize),
        Lanes::load(simd, &c[start..][..width], x as isize),
    ]
}

impl<S: Simd> Pixels<S> {
    /// Where in the image, whose y points down, a point goes that moves across, in unit length.
    #[inline(always)]
    fn in_image(&self, along_right: Lanes<S>, along_up: Lanes<S>) -> [Lanes<S>; 2] {
        let ([rx, ry, rz], [ux, uy, uz]) = (self.right, self.up);
        let [x, y, z] = self.point;
        let fraction = (along_right * rz + along_up * uz) / z;
        let right = along_right * rx + along_up * ux - x * fraction;
        let down = y * fraction - (along_right * ry + along_up * uy);
        let [right, down, _] = normalised([right, down, x.all(0.0)]);
        [right, down]
    }
}

impl March<'_> {
    /// Openness of pixels beside each other, of which the first is at `x`, `y`.
    #[inline(always)]
    fn stretch<S: Simd>(&self, simd: S, [x, y]: [usize; 2], open: &mut [f32], draws: &[u32]) {
        for from in (0..open.len()).step_by(S::F32_LANES) {
            let pixels = self.pixels(simd, x + from, y);
            if pixels.valid.any() {
                let found = self.gather(&pixels, draws);
                pixels.valid.choose(found, found.all(1.0)).store(&mut open[from..]);
            }
        }
    }

    #[inline(always)]
    fn pixels<S: Simd>(&self, simd: S, x: usize, y: usize) -> Pixels<S> {
        let width = self.surface.width;
        let start = y * width;
        let point = load(simd, self.surface.position_planes(), start, width, x);
        let normal = load(simd, self.surface.normal_planes(), start, width, x);
        let valid = Lanes::load(simd, &self.surface.valid.data()[start..][..width], x as isize);
        let [ex, ey, ez] = normalised(point);
        let to_eye = [-ex, -ey, -ez];
        let zero = Lanes::splat(simd, 0.0);
        let right = normalised([to_eye[2], zero, -to_eye[0]]);
        let up = [to_eye[1] * right[2], to_eye[2] * right[0] - to_eye[0] * right[2], -(to_eye[1] * right[0])];
        let normal = [dot(normal, right), dot(normal, up), dot(normal, to_eye)];
        let columns = Words::count_from(simd, x as u32);
        Pixels {
            column: columns.to_float(),
            row: zero.all(y as f32),
            columns,
            index: columns + columns.all(start as u32),
            point,
            right,
            up,
            to_eye,
            distance: dot(point, point).sqrt(),
            normal,
            upright: normal[2].max(zero),
            low: normal[2].below(zero).choose(zero.all(f32::INFINITY), zero.all(LOW)),
            valid: zero.all(0.5).below(valid),
        }
    }

    /// Openness of some pixels.
    #[inline(always)]
    fn gather<S: Simd>(&self, pixels: &Pixels<S>, draws: &[u32]) -> Lanes<S> {
        let zero = pixels.column.all(0.0);
        let mut open = zero;
        let mut weights = zero;
        let turn = random(pixels.columns, draws[0]);
        let (sine, cosine) = sine_and_cosine(turn * turn.all(PI / self.slices.slices as f32));
        for ((s, c), draws) in self.turns.iter().zip(draws[1..].chunks_exact(2)) {
            let along_right = cosine * zero.all(*c) - sine * zero.all(*s);
            let along_up = sine.mul_add(zero.all(*c), cosine * zero.all(*s));
            let start = random(pixels.columns, draws[0]);
            let jitter = random(pixels.columns, draws[1]);
            let aside = along_right.mul_add(pixels.normal[0], along_up * pixels.normal[1]);
            let length = pixels.upright.mul_add(pixels.upright, aside * aside).sqrt().max(zero.all(1e-6));
            let tilt = zero.all(FRAC_PI_2) - arc_cosine(aside / length);
            let weight = tilt.mul_add(aside, pixels.upright);
            let [dx, dy] = pixels.in_image(along_right, along_up);
            let one_side = self.side(pixels, [dx, dy], start, jitter);
            let other_side = self.side(pixels, [-dx, -dy], start, jitter);
            let covered = self.covered(pixels, one_side) | self.covered(pixels, other_side).reverse_bits();
            open = weight.mul_add((!covered).count_ones() * zero.all(1.0 / super::SECTORS), open);
            weights = weights + weight;
        }
        open / weights
    }

    /// How far is marched on a side, as [`super::reach_of`] has it, and in how many steps.
    #[inline(always)]
    fn side<S: Simd>(
        &self,
        pixels: &Pixels<S>,
        direction: [Lanes<S>; 2],
        start: Lanes<S>,
        jitter: Lanes<S>,
    ) -> Side<S> {
        let uniforms::Slices { radius, focal_length, width, height, steps, .. } = *self.slices;
        let (zero, tiny) = (start.all(0.0), start.all(1e-6));
        let z = pixels.point[2];
        let squared = (z * z - z.all(radius * radius)).max(tiny * z * z);
        let [dx, dy] = direction;
        let row = pixels.row;
        let right = zero.below(dx).choose(z.all((width - 1) as f32) - pixels.column, pixels.column);
        let below = zero.below(dy).choose(z.all((height - 1) as f32) - row, row);
        let edge = (right / dx.abs().max(tiny)).min(below / dy.abs().max(tiny));
        let reach = edge.min(z.all(focal_length * radius) / squared.sqrt());
        // Whatever is not a number is not above.
        let marched = pixels.valid & zero.all(1.0).at_most(reach);
        let count = marched.choose(reach.floor().min(z.all(steps as f32)), zero);
        Side { direction, reach, count, start, jitter }
    }

    /// The sectors that one side of a slice covers, from the middle outwards.
    #[inline(always)]
    fn covered<S: Simd>(&self, pixels: &Pixels<S>, side: Side<S>) -> Words<S> {
        let mut covered = pixels.index.all(0);
        let most = side.count.largest() as u32;
        let one = side.start.all(1.0);
        let inverse = one / side.count;
        let farther = side.reach - one;
        for step in 0..most {
            let number = one.all(step as f32);
            let share = (number + side.start) * inverse;
            let away = one + farther * share * share;
            let at = self.sample(pixels, side.direction, away);
            let marched = number.below(side.count);
            covered = covered | self.covered_by(pixels, at.gather(self.points), marched, side.jitter);
        }
        covered
    }

    /// Which points are so many pixels away.
    #[inline(always)]
    fn sample<S: Simd>(&self, pixels: &Pixels<S>, direction: [Lanes<S>; 2], away: Lanes<S>) -> Words<S> {
        let half = away.all(0.5);
        let [dx, dy] = direction;
        let dx = (dx * away + half).floor_to_words();
        let dy = (dy * away + half).floor_to_words();
        let at = pixels.index + dy * dy.all(self.slices.width) + dx;
        at.min(at.all(self.points.len() as u32 - 1))
    }

    /// [`super::covered_by`].
    #[inline(always)]
    fn covered_by<S: Simd>(
        &self,
        pixels: &Pixels<S>,
        at: [Lanes<S>; 3],
        marched: Mask<S>,
        jitter: Lanes<S>,
    ) -> Words<S> {
        let (zero, half, one) = (jitter.all(0.0), jitter.all(0.5), jitter.all(1.0));
        let toward = [at[0] - pixels.point[0], at[1] - pixels.point[1], at[2] - pixels.point[2]];
        let near = dot(toward, pixels.to_eye);
        let right = toward[0].mul_add(pixels.right[0], toward[2] * pixels.right[2]);
        let up = dot(toward, pixels.up);
        let [normal_right, normal_up, normal_near] = pixels.normal;
        let aside = right.mul_add(normal_right, up * normal_up);
        let above = near.mul_add(normal_near, aside);
        let across_squared = right.mul_add(right, up * up);
        let squared = near.mul_add(near, across_squared);
        let radius_squared = one.all(self.slices.radius * self.slices.radius);
        // All that follows is times the length across.
        let across_squared = across_squared.max(one.all(1e-24));
        let upright = pixels.upright * pixels.upright * across_squared;
        let length = aside.mul_add(aside, upright).max(across_squared * one.all(1e-12));
        let seen = marched & zero.below(squared) & squared.below(radius_squared) & zero.below(above);
        let raised = above * above * across_squared * pixels.low;
        let high = ((jitter - one.all(1e-3)) * length * squared).below(raised);
        let inner = (pixels.upright * across_squared).below(near * aside);
        let seen = seen & (high | inner);
        if !seen.any() {
            return pixels.index.all(0);
        }
        let across = across_squared.sqrt();
        let upright = pixels.upright * across;
        let from_side = arc_cosine(aside / length.sqrt());
        let extent = aside.mul_add(one.all(FRAC_PI_2) - from_side, upright);
        let scale = one.all(super::SECTORS) / extent;
        let plane = Plane { upright: upright * scale, aside: aside * scale * half, from_side, jitter };
        let from_eye = near - pixels.distance;
        let ray = one / from_eye.mul_add(from_eye, across_squared).sqrt();
        let inward = near.mul_add(from_eye, across_squared) * ray;
        let left = inward.mul_add(inward, radius_squared - squared).max(zero);
        let deep = (left.sqrt() - inward).min(one.all(self.slices.thickness)) * ray;
        let back = [deep.mul_add(across, across), deep.mul_add(from_eye, near)];
        let back_above = deep.mul_add(above - pixels.distance * normal_near, above);
        let first = plane.sector(across, near);
        let last = plane.sector(back[0], back[1]);
        let last = zero.below(back_above).choose(last, one.all(ALL));
        seen.only(beyond(first) & !beyond(last))
    }
}

/// In the plane of a slice, sectors beyond a direction on the outer side of the normal are at most this times
/// the square of the sine of its angle with the horizon, as long as they are at most one:
/// `32 (1 - sqrt(1 - x)) < 16.5 x`, of an integrand that is at most the cosine and an extent that is at
/// least 1. Where they are fewer than the jitter, no sector begins there. Of surfaces that are nearly flat
/// that is all there is to know.
const LOW: f32 = 16.5;

/// What is added to a sector's number, so that it stands at the same bits of any.
const BASE: f32 = 64.0;
/// A number of sectors, all of them, with what is added.
const ALL: f32 = BASE + super::SECTORS;

/// A slice through a pixel.
#[derive(Clone, Copy)]
struct Plane<S: Simd> {
    /// Length of the normal towards the eye, in sectors an extent.
    upright: Lanes<S>,
    /// Half of it across.
    aside: Lanes<S>,
    /// Angle between the normal's projection and the direction across.
    from_side: Lanes<S>,
    jitter: Lanes<S>,
}

impl<S: Simd> Plane<S> {
    /// The sectors before a direction, [`BASE`] more.
    #[inline(always)]
    fn sector(self, across: Lanes<S>, near: Lanes<S>) -> Lanes<S> {
        let one = across.all(1.0);
        let scale = one / across.mul_add(across, near * near).sqrt();
        let cosine = near * scale;
        let sine = across * scale;
        let turned = arc_cosine(cosine) - self.from_side - sine * cosine;
        let straight = self.upright * (one - cosine * cosine * one.all(0.5));
        let before = turned.mul_add(self.aside, straight).max(one.all(0.0));
        (before + (self.jitter + one.all(BASE))).min(one.all(ALL))
    }
}

/// The sectors from one on.
#[inline(always)]
fn beyond<S: Simd>(sector: Lanes<S>) -> Words<S> {
    // Numbers of [64, 128) have their whole part at bits 17 and higher, and only that below the sixth of
    // these.
    let bits = sector.bits();
    let from = bits.all(u32::MAX).shifted_left(bits.shifted_right(bits.all(17)));
    sector.below(sector.all(ALL)).only(from)
}

/// Of an angle in [0, pi].
#[inline(always)]
fn sine_and_cosine<S: Simd>(angle: Lanes<S>) -> (Lanes<S>, Lanes<S>) {
    // Taylor's series about the middle, whose next terms are below 6e-8.
    let t = angle - angle.all(FRAC_PI_2);
    let squared = t * t;
    let odd = series(
        squared,
        &[-1.0 / 39_916_800.0, 1.0 / 362_880.0, -1.0 / 5_040.0, 1.0 / 120.0, -1.0 / 6.0, 1.0],
    );
    let even = series(
        squared,
        &[1.0 / 479_001_600.0, -1.0 / 3_628_800.0, 1.0 / 40_320.0, -1.0 / 720.0, 1.0 / 24.0, -0.5, 1.0],
    );
    (even, -(odd * t))
}

/// A polynomial, the highest power's factor first.
#[inline(always)]
fn series<S: Simd>(x: Lanes<S>, factors: &[f32]) -> Lanes<S> {
    let mut sum = x.all(0.0);
    for factor in factors {
        sum = sum.mul_add(x, x.all(*factor));
    }
    sum
}
