//! What propagation does in a medium that is the same everywhere, beside what is known of it.

use super::lattice::LINKS;
use super::lobe::Lobes;
use super::propagation::{Field, Light, Volume};
use super::{Flight, LightGrid, Scheme};
use glam::{DVec3, IVec3, Vec3, Vec4, Vec4Swizzles};
use rayon::prelude::*;

/// Cells of one metre, all alike, with nothing between them.
pub fn alike(scheme: Scheme, size: IVec3, flight: Flight) -> Volume {
    let grid = LightGrid { low: Vec3::ZERO, cell: 1.0, size };
    Volume {
        grid,
        flights: vec![[flight; 3]; grid.cells()],
        passing: vec![[1.0; LINKS]; grid.cells()],
        reflectances: vec![[0.0; 3]; grid.cells()],
        scheme,
    }
}

/// Scattered light of one colour in one cell, of a flux and, last, an energy.
pub fn lit(volume: &Volume, at: IVec3, moments: Vec4) -> Field {
    let mut light = vec![Light::default(); volume.grid.cells()];
    if let Some(index) = volume.grid.index(at) {
        light[index][0] = moments;
    }
    Field::scattered(volume.scheme, &light)
}

/// Light of a point that sends alike in all directions, after so many iterations, in a grid of `2 half + 1`
/// cells to a side of a medium of such an extinction per cell.
pub fn around_a_point(
    scheme: Scheme,
    [extinction, albedo]: [f32; 2],
    half: i32,
    iterations: usize,
) -> (Volume, Field) {
    let flight = Flight::by(scheme.factors, extinction, albedo);
    let volume = alike(scheme, IVec3::splat(2 * half + 1), flight);
    let mut field = lit(&volume, IVec3::splat(half), Vec4::W);
    field.iterate(&volume, iterations);
    (volume, field)
}

/// By how much collisions are too far from a point source, squared: over the mean free path `l`, in cells,
/// that of exponential flights whose collisions have the mean squared distance measured, in a cube of the
/// same size. Where the cube is large, that is the distance over `2 l^2 / (1 - albedo)`; where little light
/// stays in it the distance itself tells next to nothing.
pub fn moment_ratio(scheme: Scheme, path: f32, flights: &Flights, half: i32) -> f64 {
    let albedo = flights.albedo as f32;
    let (volume, field) = around_a_point(scheme, [1.0 / path, albedo], half, 4 * half as usize);
    let (mut all, mut second) = (0.0, 0.0);
    for (index, shown) in field.shown.by_medium.iter().enumerate() {
        let squared = (volume.grid.at(index) - half).as_dvec3().length_squared();
        all += f64::from(shown[0].w);
        second += f64::from(shown[0].w) * squared;
    }
    (flights.path(second / all, f64::from(half) + 0.5) / f64::from(path)).powi(2)
}

/// Exponential flights in all directions from the middle of a cube, beyond which nothing comes back; the mean
/// free path is 1.
#[derive(Clone, Debug)]
pub struct Flights {
    /// What is left of light after a collision.
    pub albedo: f64,
    /// Of cubes of growing half edges, [`CUBES`] to a mean free path, the collisions in each: their weights,
    /// and these times squared distances.
    within: Vec<[f64; 2]>,
}

/// Photons that are followed.
const PHOTONS: usize = 1_000_000;
/// Batches of them, each with random numbers of its own.
const BATCHES: u64 = 64;
/// Photons of less weight end.
const LEAST_WEIGHT: f64 = 1e-4;
/// Cubes for each mean free path of their half edges.
const CUBES: usize = 64;
/// Half an edge of the largest cube, mean free paths.
const LARGEST: usize = 128;

impl Flights {
    /// Follows photons.
    pub fn new(albedo: f64) -> Self {
        let batches: Vec<Vec<[f64; 2]>> =
            (1..=BATCHES).into_par_iter().map(|seed| Self::batch(albedo, seed)).collect();
        let sum = |of: &dyn Fn(&Vec<[f64; 2]>) -> f64| batches.iter().map(of).sum::<f64>();
        let mut so_far = [0.0; 2];
        let within = (0..CUBES * LARGEST).map(|cube| {
            so_far = [0, 1].map(|i| so_far[i] + sum(&|batch| batch[cube][i]));
            so_far
        });
        Self { albedo, within: within.collect() }
    }

    /// Collisions by the least cube that holds them and all before them.
    fn batch(albedo: f64, seed: u64) -> Vec<[f64; 2]> {
        let mut random = Xorshift::new(seed);
        let mut by_cube = vec![[0.0; 2]; CUBES * LARGEST];
        for _ in 0..PHOTONS / BATCHES as usize {
            let (mut at, mut farthest, mut weight) = (DVec3::ZERO, 0.0f64, 1.0);
            while weight > LEAST_WEIGHT {
                let (z, angle) = (2.0 * random.number() - 1.0, std::f64::consts::TAU * random.number());
                let across = (1.0 - z * z).sqrt();
                at -=
                    DVec3::new(across * angle.cos(), across * angle.sin(), z) * (1.0 - random.number()).ln();
                farthest = farthest.max(at.abs().max_element());
                let Some(sums) = by_cube.get_mut((farthest * CUBES as f64) as usize) else { break };
                *sums = [sums[0] + weight, sums[1] + weight * at.length_squared()];
                weight *= albedo;
            }
        }
        by_cube
    }

    /// Mean squared distance of collisions from the middle of a cube of such half edges, of a mean free path
    /// in the same unit.
    pub fn moment(&self, path: f64, half: f64) -> f64 {
        // Sums are those at the far ends of cubes.
        let at = (half / path * CUBES as f64 - 1.0).clamp(0.0, (self.within.len() - 1) as f64);
        let (cube, part) = (at as usize, at.fract());
        let next = self.within[(cube + 1).min(self.within.len() - 1)];
        let [weight, squared] = [0, 1].map(|i| self.within[cube][i] * (1.0 - part) + next[i] * part);
        path * path * squared / weight
    }

    /// The mean free path for which [`Self::moment`] is so much, up to half an edge of the cube.
    pub fn path(&self, moment: f64, half: f64) -> f64 {
        let (mut low, mut high) = (half / LARGEST as f64, half);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if self.moment(middle, half) < moment { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }
}

/// Random numbers (Marsaglia 2003), the same on every machine.
pub struct Xorshift(u64);

impl Xorshift {
    /// Those of a seed.
    pub const fn new(seed: u64) -> Self {
        Self(0x2545_f491_4f6c_dd1d ^ seed.wrapping_mul(0x9e37_79b9_7f4a_7c15))
    }

    /// The next, from 0 to below 1.
    pub fn number(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// Largest share of its energy that light loses in an iteration where nothing is absorbed, before any leaves
/// the grid.
pub fn energy_loss(scheme: Scheme, extinction: f32) -> f64 {
    let volume = alike(scheme, IVec3::splat(25), Flight::by(scheme.factors, extinction, 1.0));
    let mut field = lit(&volume, IVec3::splat(12), Vec4::new(0.5, -0.3, 0.8, 2.0));
    let mut worst = 0.0f64;
    for _ in 0..11 {
        let before = field.energy();
        field.step(&volume);
        worst = worst.max((1.0 - field.energy() / before).abs());
    }
    worst
}

/// How fast fluence falls far from a point source, per mean free path: the root `k` of `albedo artanh(k) = k`
/// (Case and Zweifel 1967).
pub fn decay(albedo: f64) -> f64 {
    let (mut low, mut high) = (1e-6, 1.0 - 1e-12);
    for _ in 0..100 {
        let middle: f64 = 0.5 * (low + high);
        if albedo * middle.atanh() < middle { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Fluence at each distance along an axis, cells, over that of a monopole `exp(-k r) / r` which is what it is
/// three mean free paths from the source.
pub fn over_monopole(scheme: Scheme, path: f32, albedo: f32, half: i32) -> Vec<(f64, f64)> {
    let (volume, field) = around_a_point(scheme, [1.0 / path, albedo], half, 4 * half as usize);
    let middle = IVec3::splat(half);
    let shown = &field.shown.by_medium;
    let at =
        |r: i32| volume.grid.index(middle + r * IVec3::X).map_or(0.0, |index| f64::from(shown[index][0].w));
    let decay = decay(f64::from(albedo)) / f64::from(path);
    let monopole = |r: f64| (-decay * r).exp() / r;
    let first = (3.0 * path).ceil() as i32;
    let scale = monopole(f64::from(first)) / at(first);
    (first..=half / 2).map(|r| (f64::from(r), scale * at(r) / monopole(f64::from(r)))).collect()
}

/// Flux of a point source without a medium, times `4 pi r^2`, along an axis, across an edge and across a
/// corner: 1 where light goes alike everywhere. Fluence, which is the flux where light goes straight, is
/// after it.
pub fn flux_by_direction(scheme: Scheme, half: i32) -> [[f64; 2]; 3] {
    let (volume, field) = around_a_point(scheme, [0.0, 0.0], half, 3 * half as usize);
    by_direction(&volume.grid, &field, half)
}

fn by_direction(grid: &LightGrid, field: &Field, half: i32) -> [[f64; 2]; 3] {
    let r = f64::from(half) * 0.6;
    [IVec3::X, IVec3::new(1, 1, 0), IVec3::ONE].map(|way| {
        let offset = (way.as_dvec3().normalize() * r).round().as_ivec3();
        let shown = grid.index(half + offset).map_or(Vec4::ZERO, |index| field.shown.by_medium[index][0]);
        let spread = 4.0 * std::f64::consts::PI * offset.as_dvec3().length_squared();
        [shown.xyz().length(), shown.w].map(|of| spread * f64::from(of))
    })
}

/// What light of a point has come to without a medium.
#[derive(Clone, Copy, Debug)]
pub struct Ringing {
    /// Of all light that was handed on, the share that is less than nothing.
    pub negative: f64,
    /// Flux as [`flux_by_direction`] has it.
    pub flux: [f64; 3],
}

/// How lobes ring in a grid of `2 half + 1` cells to a side: bands are negative where light is directed.
pub fn ringing(lobes: Lobes, half: i32) -> Ringing {
    let scheme = Scheme { lobes, ..Scheme::OURS };
    let (volume, mut field) = around_a_point(scheme, [0.0, 0.0], half, 0);
    let (mut negative, mut all) = (0.0, 0.0);
    for _ in 0..3 * half {
        let handed = field.handed_on(&volume.grid);
        negative += handed[0];
        all += handed[1];
        field.step(&volume);
    }
    let flux = by_direction(&volume.grid, &field, half).map(|[flux, _]| flux);
    Ringing { negative: negative / all, flux }
}
