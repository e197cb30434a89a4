//! Propagation: equation (3) of Billeter et al. 2012, with the flights and lobes of this module.
//!
//! Kinds of light are kept apart by what they met, so that what is shown can leave out what other methods show sharper:
//! light that met no medium yet by how often surfaces have reflected it, and light that was scattered.

use super::lattice::{CLASSES, LINKS, SHARES, neighbours};
use super::lobe::MATTE;
use super::{Flight, LightGrid, Scheme};
use glam::{Vec3, Vec4};
use rayon::prelude::*;

/// Light of three colours in a cell, of each its flux and, last, its energy, watts.
pub type Light = [Vec4; 3];

/// Most kinds of light.
const MOST_KINDS: usize = 3;

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
    /// How light is handed on.
    pub scheme: Scheme,
}

/// Kinds of light that are kept apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kinds {
    /// Of light that met no medium: reflected once, and so on; the last of them more often, too, where there is
    /// scattered light, which is the last kind.
    pub unscattered: usize,
    /// Whether light goes on that was scattered.
    pub scattered: bool,
}

/// Light as it is shown: its flux and energy times the length of its way in each cell, watts times cells, summed over
/// all iterations.
#[derive(Clone, Debug)]
pub struct Shown {
    /// By the medium: the last kind that met no medium, and scattered light.
    pub by_medium: Vec<Light>,
    /// By surfaces: the last kind.
    pub by_surfaces: Vec<Light>,
}

/// Light on its way through a volume.
#[derive(Clone, Debug)]
pub struct Field {
    kinds: Kinds,
    scheme: Scheme,
    /// Of each kind, lobes of each cell.
    lobes: Vec<Vec<Light>>,
    /// What is shown of it.
    pub shown: Shown,
}

/// What arrives in a cell of one colour: flux and energy of each kind, and as it is shown.
#[derive(Clone, Copy)]
struct Arriving {
    kinds: [Vec4; MOST_KINDS],
    by_medium: Vec4,
    by_surfaces: Vec4,
}

impl Kinds {
    /// All of them.
    pub const fn count(self) -> usize {
        self.unscattered + self.scattered as usize
    }

    /// What becomes of a kind by reflection; none where that is not shown.
    const fn reflected(self, kind: usize) -> Option<usize> {
        match kind + 1 < self.unscattered {
            true => Some(kind + 1),
            false if self.scattered => Some(kind),
            false => None,
        }
    }

    /// Whether light of a kind is scattered light.
    const fn is_scattered(self, kind: usize) -> bool {
        kind == self.unscattered
    }
}

impl Arriving {
    const NONE: Self =
        Self { kinds: [Vec4::ZERO; MOST_KINDS], by_medium: Vec4::ZERO, by_surfaces: Vec4::ZERO };

    fn show(&mut self, kinds: Kinds, kind: usize, light: Vec4) {
        if kind + 1 >= kinds.unscattered {
            self.by_medium += light;
        }
        if kind + 1 == kinds.count() {
            self.by_surfaces += light;
        }
    }
}

impl Field {
    /// Before the first iteration: light that surfaces have reflected once and, if scattered light goes on too, that.
    pub fn new(scheme: Scheme, kinds: Kinds, reflected: &[Light], scattered: &[Light]) -> Self {
        let none = vec![Light::default(); reflected.len()];
        let light = |kind: usize| match kind {
            _ if kinds.is_scattered(kind) => scattered,
            0 => reflected,
            _ => &none,
        };
        let lobes = |kind: usize| light(kind).iter().map(|of| of.map(|of| scheme.lobes.of(of))).collect();
        let lobes = (0..kinds.count()).map(lobes).collect();
        Self { kinds, scheme, lobes, shown: Shown { by_medium: none.clone(), by_surfaces: none } }
    }

    /// Light that is all of the last kind.
    pub fn scattered(scheme: Scheme, light: &[Light]) -> Self {
        let none = vec![Light::default(); light.len()];
        Self::new(scheme, Kinds { unscattered: 0, scattered: true }, &none, light)
    }

    /// Of lobes of each kind, `[kinds, cells]`, which are not empty.
    pub fn of_lobes(scheme: Scheme, kinds: Kinds, lobes: Vec<Vec<Light>>) -> Self {
        let none = vec![Light::default(); lobes[0].len()];
        Self { kinds, scheme, lobes, shown: Shown { by_medium: none.clone(), by_surfaces: none } }
    }

    /// Energy of all light on its way, of all colours, watts.
    pub fn energy(&self) -> f64 {
        let all = self.lobes.iter().flatten().flatten();
        all.map(|kept| f64::from(self.scheme.lobes.moments(*kept).w)).sum()
    }

    /// What each cell sends out again of the light in it, in all directions.
    fn again(&self, volume: &Volume, cell: usize) -> [f32; 3] {
        if !self.kinds.scattered {
            return [0.0; 3];
        }
        let of = |colour: usize| {
            let flight = &volume.flights[cell][colour];
            let collides = |lobes: &Vec<Light>| -> f32 {
                let energies = self.scheme.lobes.by_class(lobes[cell][colour]);
                (0..CLASSES).map(|class| energies[class] * (1.0 - flight.streams[class])).sum()
            };
            flight.again * self.lobes.iter().map(collides).sum::<f32>()
        };
        [0, 1, 2].map(of)
    }

    /// So many iterations.
    pub fn iterate(&mut self, volume: &Volume, iterations: usize) {
        (0..iterations).for_each(|_| self.step(volume));
    }

    /// One iteration.
    pub fn step(&mut self, volume: &Volume) {
        let cells = volume.grid.cells();
        let again: Vec<[f32; 3]> = (0..cells).into_par_iter().map(|cell| self.again(volume, cell)).collect();
        let colours = |cell: usize| [0, 1, 2].map(|colour| self.arriving(volume, &again, cell, colour));
        let arrived: Vec<[Arriving; 3]> = (0..cells).into_par_iter().map(colours).collect();
        for (kind, lobes) in self.lobes.iter_mut().enumerate() {
            let lobe = |arrived: &[Arriving; 3]| arrived.map(|of| self.scheme.lobes.of(of.kinds[kind]));
            lobes.par_iter_mut().zip(&arrived).for_each(|(light, arrived)| *light = lobe(arrived));
        }
        for (cell, arrived) in arrived.iter().enumerate() {
            for (colour, of) in arrived.iter().enumerate() {
                self.shown.by_medium[cell][colour] += of.by_medium;
                self.shown.by_surfaces[cell][colour] += of.by_surfaces;
            }
        }
    }

    /// What arrives in a cell of one colour.
    fn arriving(&self, volume: &Volume, again: &[[f32; 3]], cell: usize, colour: usize) -> Arriving {
        let Volume { grid, flights, passing, reflectances, .. } = volume;
        let (kinds, scheme) = (self.kinds, self.scheme.lobes);
        let (here, at) = (&flights[cell][colour], grid.at(cell));
        let mut sums = Arriving::NONE;
        for kind in 0..kinds.count() {
            sums.show(kinds, kind, scheme.moments(self.lobes[kind][cell][colour]) * here.track_out);
        }
        if kinds.scattered {
            sums.show(kinds, kinds.unscattered, Vec4::W * (again[cell][colour] * here.track_again));
        }
        for (link, neighbour) in neighbours().enumerate() {
            let Some(from) = grid.index(at - neighbour.offset) else { continue };
            if self
                .lobes
                .iter()
                .all(|lobes| lobes[from][colour] == Vec4::ZERO && lobes[cell][colour] == Vec4::ZERO)
            {
                continue;
            }
            let passes =
                if link < LINKS { passing[cell][LINKS - 1 - link] } else { passing[from][link - LINKS] };
            let (class, flight) = (neighbour.class, &flights[from][colour]);
            let (share, scatters) = (SHARES[class] * passes, here.albedo * (1.0 - here.enters[class]));
            let along = |direction: Vec3, energy: f32| (direction * energy).extend(energy);
            let kept = neighbour.direction * scheme.kept_direction(class);
            let mut all = 0.0;
            for kind in 0..kinds.count() {
                let mut sent = share
                    * flight.streams[class]
                    * scheme.towards(self.lobes[kind][from][colour], &neighbour);
                if kinds.is_scattered(kind) {
                    sent += share * flight.scatters[class] * again[from][colour];
                }
                sums.kinds[kind] += along(kept, sent * here.enters[class]);
                sums.show(kinds, kind, along(kept, sent * here.tracks_in[class]));
                all += sent;
            }
            if kinds.scattered {
                sums.kinds[kinds.unscattered].w += all * scatters;
            }
            // What the cell itself sends there and surfaces on the way reflect comes back half a way later.
            let returns = SHARES[class] * (1.0 - passes) * reflectances[cell][colour];
            let (out, matte) = (here.streams[class], MATTE * neighbour.direction);
            let mut all = 0.0;
            for kind in 0..kinds.count() {
                let Some(into) = kinds.reflected(kind) else { continue };
                let opposite = neighbour.opposite();
                let mut sent = returns * out * scheme.towards(self.lobes[kind][cell][colour], &opposite);
                if kinds.is_scattered(kind) {
                    sent += returns * here.scatters[class] * again[cell][colour];
                }
                sums.kinds[into] += along(matte, sent * out);
                sums.show(kinds, into, along(matte, sent * here.tracks_back[class]));
                all += sent;
            }
            if kinds.scattered {
                sums.kinds[kinds.unscattered].w += all * here.albedo * (1.0 - out);
            }
        }
        sums
    }
}
