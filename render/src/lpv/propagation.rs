//! Propagation: equation (3) of Billeter et al. 2012, with the flights and lobes of this module.
//!
//! Light that met no medium yet, `fresh`, is kept apart from what was scattered, so that what is shown can leave out
//! what other methods show sharper: single scattering, and surfaces lit by surfaces.

use super::lattice::{LINKS, SHARES, neighbours};
use super::lobe::{energy, flux, lobe, towards};
use super::{Flight, LightGrid};
use glam::{Vec3, Vec4};
use rayon::prelude::*;

/// Mean cosine of light that a matte surface sends.
pub const DIRECTED: f32 = 2.0 / 3.0;

/// Light of three colours in a cell, of each its flux and, last, its energy, watts.
pub type Light = [Vec4; 3];

/// A grid with what fills it.
#[derive(Clone, Debug)]
pub struct Volume {
    /// Its cells.
    pub grid: LightGrid,
    /// Of each cell and colour.
    pub flights: Vec<[Flight; 3]>,
    /// What passes between cells, `[cells, 13]`, as [`Blockers`](super::Blockers) has it.
    pub passing: Vec<[f32; LINKS]>,
    /// Of each cell and colour, what surfaces around it reflect of light that does not pass.
    pub reflectances: Vec<[f32; 3]>,
}

/// Light on its way through a volume.
#[derive(Clone, Debug)]
pub struct Field {
    /// Lobes of light that met no medium yet.
    pub fresh: Vec<Light>,
    /// Lobes of light that was scattered.
    pub scattered: Vec<Light>,
    /// Energy times the length of its way in each cell, watts times cells, summed over all iterations: what is shown.
    pub shown: Vec<Light>,
}

/// What is shown of a field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shown {
    /// Light that met no medium.
    Fresh,
    /// Light that was scattered.
    Scattered,
}

impl Field {
    /// Before the first iteration, from flux and energy.
    pub fn new(fresh: &[Light], scattered: &[Light]) -> Self {
        let lobes = |light: &[Light]| light.iter().map(|light| light.map(lobe)).collect();
        Self { fresh: lobes(fresh), scattered: lobes(scattered), shown: vec![[Vec4::ZERO; 3]; fresh.len()] }
    }

    /// Energy of all light on its way, of all colours, watts.
    pub fn energy(&self) -> f64 {
        let all = self.fresh.iter().chain(&self.scattered).flatten();
        all.map(|lobe| f64::from(energy(*lobe))).sum()
    }

    /// So many iterations.
    pub fn iterate(&mut self, volume: &Volume, shown: Shown, iterations: usize) {
        (0..iterations).for_each(|_| self.step(volume, shown));
    }

    /// One iteration.
    pub fn step(&mut self, volume: &Volume, shown: Shown) {
        let Self { fresh, scattered, .. } = &*self;
        let next: Vec<[Light; 3]> = (0..volume.grid.cells())
            .into_par_iter()
            .map(|cell| std::array::from_fn(|colour| arriving(volume, fresh, scattered, cell, colour, shown)))
            .map(|colours: [[Vec4; 3]; 3]| [0, 1, 2].map(|kind| colours.map(|of| of[kind])))
            .collect();
        for (cell, [fresh, scattered, tracks]) in next.into_iter().enumerate() {
            self.fresh[cell] = fresh.map(lobe);
            self.scattered[cell] = scattered.map(lobe);
            (0..3).for_each(|colour| self.shown[cell][colour] += tracks[colour]);
        }
    }
}

/// Flux and energy of one colour that arrive in a cell: fresh, scattered, and what is shown there.
fn arriving(
    volume: &Volume,
    fresh: &[Light],
    scattered: &[Light],
    cell: usize,
    colour: usize,
    shown: Shown,
) -> [Vec4; 3] {
    let Volume { grid, flights, passing, reflectances } = volume;
    let here = &flights[cell][colour];
    let own = [fresh, scattered].map(|light| light[cell][colour]);
    let again = here.scattered * own.map(energy).iter().sum::<f32>();
    let leaving = match shown {
        Shown::Fresh => flux(own[0]).extend(energy(own[0])),
        Shown::Scattered => flux(own[1]).extend(energy(own[1]) + again),
    };
    let mut sums = [Vec4::ZERO, Vec4::ZERO, leaving * here.track_out];
    let at = grid.at(cell);
    for (link, neighbour) in neighbours().enumerate() {
        let Some(from) = grid.index(at - neighbour.offset) else { continue };
        let passes = if link < LINKS { passing[cell][LINKS - 1 - link] } else { passing[from][link - LINKS] };
        if own == [Vec4::ZERO; 2] && [fresh, scattered].iter().all(|light| light[from][colour] == Vec4::ZERO)
        {
            continue;
        }
        let (class, direction, flight) = (neighbour.class, neighbour.direction, &flights[from][colour]);
        let lobes = [fresh, scattered].map(|light| light[from][colour]);
        let share = SHARES[class] * passes;
        let streams = |lobe: Vec4| share * flight.streams[class] * towards(lobe, direction);
        let again = share * flight.scatters[class] * lobes.map(energy).iter().sum::<f32>();
        let [first, second] = [streams(lobes[0]), streams(lobes[1]) + again];
        let enters = here.enters[class];
        let scatters = here.albedo * (1.0 - enters);
        let arrived = |energy: f32, direction: Vec3| (direction * energy).extend(energy);
        sums[0] += arrived(first * enters, direction);
        sums[1] += arrived(second * enters, direction) + Vec4::W * ((first + second) * scatters);
        let seen = if shown == Shown::Fresh { first } else { second };
        sums[2] += arrived(seen * here.tracks_in[class], direction);
        // What the cell itself sends there and surfaces on the way reflect comes back half a way later.
        let returns = SHARES[class] * (1.0 - passes) * reflectances[cell][colour];
        let [first, second] = own.map(|lobe| returns * here.streams[class] * towards(lobe, -direction));
        let second = second + returns * here.scatters[class] * own.map(energy).iter().sum::<f32>();
        let enters = here.streams[class];
        let reflected = |energy: f32| (DIRECTED * direction * energy).extend(energy);
        sums[0] += reflected(first * enters);
        sums[1] += reflected(second * enters) + Vec4::W * ((first + second) * here.albedo * (1.0 - enters));
        let seen = if shown == Shown::Fresh { first } else { second };
        sums[2] += reflected(seen * here.tracks_back[class]);
    }
    sums
}
