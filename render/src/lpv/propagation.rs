//! Propagation: equation (3) of Billeter et al. 2012, with the flights and lobes of this module.
//!
//! Kinds of light are kept apart by what they met, so that what is shown can leave out what other methods
//! show sharper: light that met no medium yet by how often surfaces have reflected it, and light that was
//! scattered.
//!
//! Light goes on as one pulse, whose iterations are summed up, or is [steady](Kinds::is_steady): what sends
//! it goes on sending it, and it is kept apart by [`sides`](super::sides). Lobes depend on all light in a
//! cell: where pulses of all walls of a room cross in its middle they become one without a direction, and
//! stay; steady light is even there.

use super::cascade::at_border;
use super::lattice::{CLASSES, LINKS, SHARES, neighbours};
use super::lobe::MATTE;
use super::series::{self, LOOKED_AT};
use super::sides::{Begun, SIDES};
use super::{Flight, LightGrid, Scheme};
use glam::Vec4;
use rayon::prelude::*;

/// Light of three colours in a cell, of each its flux and, last, its energy, watts.
pub type Light = [Vec4; 3];

/// What a cell keeps of light of three colours: lobes.
pub(crate) type Kept = [Vec4; 3];

/// Most kinds of light.
pub const MOST_KINDS: usize = SIDES;

/// Of each kind and colour, energy or what is like it.
pub type Energies = [[f32; 3]; MOST_KINDS];

/// What is shown of an iteration that stands for itself.
const ITSELF: Energies = [[1.0; 3]; MOST_KINDS];

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

impl Volume {
    /// Of light that surfaces send into a cell and that collides there, what goes in: the rest goes back to
    /// them and comes again, in their colour.
    pub fn goes_in(&self, cell: usize, colour: usize) -> f32 {
        let flight = &self.flights[cell][colour];
        let back = (1.0 - flight.opens) * flight.turns * self.reflectances[cell][colour];
        flight.opens / (1.0 - back).max(flight.opens)
    }
}

/// Kinds of light that are kept apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kinds {
    /// Of light that met no medium: reflected once, and so on; the last of them more often, too, where there
    /// is scattered light, which is the last kind.
    pub unscattered: usize,
    /// Whether light goes on that was scattered.
    pub scattered: bool,
    /// Whether what sends light goes on sending it; kinds, if there are several, are the sides to which it
    /// does.
    pub is_steady: bool,
    /// Whether surfaces reflect what met no medium on and on, without scattered light.
    pub is_reflected: bool,
}

/// Light as it is shown: its flux and energy times the length of its way in each cell, watts times cells, of
/// a pulse summed over all iterations.
#[derive(Clone, Debug)]
pub struct CellFluence {
    /// By the medium: the last kind that met no medium, and scattered light.
    pub by_medium: Vec<Light>,
    /// By surfaces: the last kind.
    pub by_surfaces: Vec<Light>,
}

impl CellFluence {
    fn none(cells: usize) -> Self {
        let none = vec![Light::default(); cells];
        Self { by_medium: none.clone(), by_surfaces: none }
    }
}

/// Light on its way through a volume.
#[derive(Clone, Debug)]
pub struct Field {
    kinds: Kinds,
    scheme: Scheme,
    /// Of each kind, lobes of each cell.
    lobes: Vec<Vec<Kept>>,
    /// Whether the first kind is as surfaces sent it.
    is_fresh: bool,
    /// Whether a coarser grid is around it: then cells at the border take what arrives.
    is_nested: bool,
    /// What each iteration adds to steady light.
    begun: Option<Begun>,
    /// What is shown of it.
    pub shown: CellFluence,
}

/// What cells keep of light.
fn lobes_of(scheme: Scheme, light: &[Light]) -> Vec<Kept> {
    light.iter().map(|of| of.map(|of| scheme.lobes.begins(of))).collect()
}

/// What arrives in a cell of one colour: moments of each kind, and flux and energy as they are shown.
#[derive(Clone, Copy)]
struct Arriving {
    kinds: [Vec4; MOST_KINDS],
    by_medium: Vec4,
    by_surfaces: Vec4,
    /// By how much to multiply what is shown of each kind.
    weights: [f32; MOST_KINDS],
}

impl Kinds {
    /// Light that met nothing yet, until it does.
    pub const ONE: Self = Self { unscattered: 1, scattered: false, is_steady: false, is_reflected: false };

    /// All of them.
    pub const fn count(self) -> usize {
        self.unscattered + self.scattered as usize
    }

    /// What becomes of a kind by reflection; none where that is not shown.
    const fn reflected(self, kind: usize) -> Option<usize> {
        match kind + 1 < self.unscattered {
            _ if self.is_steady => None,
            true => Some(kind + 1),
            false if self.goes_on() => Some(kind),
            false => None,
        }
    }

    /// Whether light of the last kind is reflected, or scattered, again and again.
    pub const fn goes_on(self) -> bool {
        self.scattered || self.is_reflected
    }

    /// Whether light of a kind is scattered light.
    pub const fn is_scattered(self, kind: usize) -> bool {
        kind == self.unscattered
    }
}

impl Arriving {
    const NONE: Self = Self {
        kinds: [Vec4::ZERO; MOST_KINDS],
        by_medium: Vec4::ZERO,
        by_surfaces: Vec4::ZERO,
        weights: [1.0; MOST_KINDS],
    };

    fn show(&mut self, kinds: Kinds, kind: usize, light: Vec4) {
        let light = self.weights[kind] * light;
        if kind + 1 >= kinds.unscattered || kinds.is_steady {
            self.by_medium += light;
        }
        if kind + 1 == kinds.count() {
            self.by_surfaces += light;
        }
    }
}

impl Field {
    /// Before the first iteration: light that surfaces send and, if scattered light goes on too, that.
    pub fn new(volume: &Volume, kinds: Kinds, sent: &[Light], scattered: &[Light]) -> Self {
        let scheme = volume.scheme;
        if kinds.is_steady {
            return Self::steady(scheme, Begun::new(volume, sent));
        }
        let none = vec![Light::default(); sent.len()];
        let light = |kind: usize| match kind {
            _ if kinds.is_scattered(kind) => scattered,
            0 => sent,
            _ => &none,
        };
        let lobes = (0..kinds.count()).map(|kind| lobes_of(scheme, light(kind))).collect();
        Self::of_lobes(scheme, kinds, lobes)
    }

    /// Before the first iteration: light that goes on beginning so.
    pub fn steady(scheme: Scheme, begun: Begun) -> Self {
        let kinds = Kinds { unscattered: begun.sources.len(), is_steady: true, ..Kinds::ONE };
        let lobes = begun.sources.iter().map(|light| lobes_of(scheme, light)).collect();
        Self { begun: Some(begun), ..Self::of_lobes(scheme, kinds, lobes) }
    }

    /// Light that is all of the last kind.
    pub fn scattered(scheme: Scheme, light: &[Light]) -> Self {
        let kinds = Kinds { unscattered: 0, scattered: true, ..Kinds::ONE };
        Self::of_lobes(scheme, kinds, vec![lobes_of(scheme, light)])
    }

    /// Of lobes of each kind, `[kinds, cells]`, which are not empty.
    pub(crate) fn of_lobes(scheme: Scheme, kinds: Kinds, lobes: Vec<Vec<Kept>>) -> Self {
        let cells = lobes[0].len();
        let shown = CellFluence::none(cells);
        Self { kinds, scheme, lobes, is_fresh: true, is_nested: false, begun: None, shown }
    }

    /// It, of [one kind](Kinds::ONE), in a finer grid, with light of what a coarser one shows along its
    /// border in place of its own there.
    #[must_use]
    pub fn nested(mut self, volume: &Volume, outside: (&LightGrid, &[Light])) -> Self {
        debug_assert_eq!(self.kinds, Kinds::ONE);
        self.is_nested = true;
        for cell in volume.grid.border() {
            let light = at_border(outside, volume, cell);
            self.lobes[0][cell] = light.map(|of| self.scheme.lobes.begins(of));
        }
        self
    }

    /// Energy of all light on its way, of all colours, watts.
    pub fn energy(&self) -> f64 {
        self.lobes.iter().flat_map(|lobes| self.energies_of(lobes)).sum()
    }

    /// That of each kind and colour.
    fn energies(&self) -> Energies {
        let mut energies = [[0.0; 3]; MOST_KINDS];
        for (energies, lobes) in energies.iter_mut().zip(&self.lobes) {
            *energies = self.energies_of(lobes).map(|energy| energy as f32);
        }
        energies
    }

    fn energies_of(&self, lobes: &[Kept]) -> [f64; 3] {
        let energy = |kept: &Kept, colour: usize| f64::from(self.scheme.lobes.light(kept[colour]).w);
        [0, 1, 2].map(|colour| lobes.iter().map(|kept| energy(kept, colour)).sum())
    }

    /// What cells would hand on to others where nothing blocks or collides, watts: of it what is less than
    /// nothing, and all, both without a sign.
    pub fn handed_on(&self, grid: &LightGrid) -> [f64; 2] {
        let mut sums = [0.0; 2];
        for (cell, kept) in self.lobes.iter().flat_map(|lobes| lobes.iter().enumerate()) {
            for neighbour in neighbours().filter(|n| grid.index(grid.at(cell) + n.offset).is_some()) {
                for kept in kept.iter().filter(|kept| **kept != Vec4::ZERO) {
                    let energy = SHARES[neighbour.class] * self.scheme.lobes.towards(*kept, &neighbour);
                    sums[0] += f64::from((-energy).max(0.0));
                    sums[1] += f64::from(energy.abs());
                }
            }
        }
        sums
    }

    /// What each cell sends out again of the light in it, in all directions.
    fn again(&self, volume: &Volume, cell: usize) -> [f32; 3] {
        if !self.kinds.scattered {
            return [0.0; 3];
        }
        let of = |colour: usize| {
            let flight = &volume.flights[cell][colour];
            let collides = |(kind, lobes): (usize, &Vec<Kept>)| -> f32 {
                let energies = self.scheme.lobes.by_class(lobes[cell][colour]);
                let all: f32 =
                    (0..CLASSES).map(|class| energies[class] * (1.0 - flight.streams[class])).sum();
                match self.is_fresh && !self.kinds.is_scattered(kind) {
                    true => all * volume.goes_in(cell, colour),
                    false => all,
                }
            };
            flight.again * self.lobes.iter().enumerate().map(collides).sum::<f32>()
        };
        [0, 1, 2].map(of)
    }

    /// So many iterations; of light that goes on and on the last stands for all that would follow.
    pub fn iterate(&mut self, volume: &Volume, iterations: usize) {
        let is_series = self.kinds.goes_on() && iterations > LOOKED_AT;
        let alike = if is_series { iterations - LOOKED_AT - 1 } else { iterations };
        (0..alike).for_each(|_| self.step(volume));
        if is_series {
            let after = [(); LOOKED_AT].map(|()| {
                self.step(volume);
                self.energies()
            });
            self.weighted_step(volume, &series::weights(self.kinds, &after));
        }
    }

    /// One iteration.
    pub fn step(&mut self, volume: &Volume) {
        self.weighted_step(volume, &ITSELF);
    }

    /// One iteration of which so much is shown.
    fn weighted_step(&mut self, volume: &Volume, weights: &Energies) {
        let cells = volume.grid.cells();
        let again: Vec<[f32; 3]> = (0..cells).into_par_iter().map(|cell| self.again(volume, cell)).collect();
        self.is_fresh = false;
        let of = |colour: usize| weights.map(|weights| weights[colour]);
        let colours =
            |cell: usize| [0, 1, 2].map(|colour| self.arriving(volume, (&again, of(colour)), cell, colour));
        let arrived: Vec<[Arriving; 3]> = (0..cells).into_par_iter().map(colours).collect();
        if let Some(begun) = &self.begun {
            (self.lobes, self.shown) = self.steadied(begun, &arrived);
            return;
        }
        for (kind, lobes) in self.lobes.iter_mut().enumerate() {
            let lobe = |arrived: &[Arriving; 3]| arrived.map(|of| self.scheme.lobes.begins(of.kinds[kind]));
            lobes.par_iter_mut().zip(&arrived).for_each(|(light, arrived)| *light = lobe(arrived));
        }
        if self.is_nested {
            volume.grid.border().for_each(|cell| self.lobes[0][cell] = Kept::default());
        }
        for (cell, arrived) in arrived.iter().enumerate() {
            for (colour, of) in arrived.iter().enumerate() {
                self.shown.by_medium[cell][colour] += of.by_medium;
                self.shown.by_surfaces[cell][colour] += of.by_surfaces;
            }
        }
    }

    /// Lobes of steady light, and what is shown of it, by what has arrived.
    fn steadied(&self, begun: &Begun, arrived: &[[Arriving; 3]]) -> (Vec<Vec<Kept>>, CellFluence) {
        let lobes = |kind: usize, cell: usize| {
            let source = begun.sources[kind][cell];
            let all = |colour: usize| source[colour] + arrived[cell][colour].kinds[kind];
            [0, 1, 2].map(|colour| self.scheme.lobes.begins(all(colour)))
        };
        let of_kind =
            |kind: usize| (0..arrived.len()).into_par_iter().map(|cell| lobes(kind, cell)).collect();
        let lobes = (0..self.kinds.count()).map(of_kind).collect();
        let shown = |(halfway, arrived): (&Light, &[Arriving; 3])| -> Light {
            std::array::from_fn(|colour| halfway[colour] + arrived[colour].by_medium)
        };
        let shown: Vec<Light> = begun.halfway.iter().zip(arrived).map(shown).collect();
        (lobes, CellFluence { by_medium: shown.clone(), by_surfaces: shown })
    }

    /// What arrives in a cell of one colour, where cells send so much out again; of each kind so much is
    /// shown.
    fn arriving(
        &self,
        volume: &Volume,
        (again, weights): (&[[f32; 3]], [f32; MOST_KINDS]),
        cell: usize,
        colour: usize,
    ) -> Arriving {
        let Volume { grid, flights, passing, reflectances, .. } = volume;
        let (kinds, scheme) = (self.kinds, self.scheme.lobes);
        let (here, at) = (&flights[cell][colour], grid.at(cell));
        let mut sums = Arriving { weights, ..Arriving::NONE };
        for kind in 0..kinds.count() {
            sums.show(kinds, kind, scheme.light(self.lobes[kind][cell][colour]) * here.track_out);
        }
        if kinds.scattered {
            sums.show(kinds, kinds.unscattered, Vec4::W * (again[cell][colour] * here.track_again));
        }
        let is_dark = |cell: usize| self.lobes.iter().all(|lobes| lobes[cell][colour] == Vec4::ZERO);
        let own_is_dark = is_dark(cell);
        for (link, neighbour) in neighbours().enumerate() {
            let Some(from) = grid.index(at - neighbour.offset) else { continue };
            if own_is_dark && is_dark(from) {
                continue;
            }
            let passes =
                if link < LINKS { passing[cell][LINKS - 1 - link] } else { passing[from][link - LINKS] };
            let (class, flight) = (neighbour.class, &flights[from][colour]);
            let goes_in = here.lets_in(flight, class);
            let scatters = here.albedo * (goes_in - here.enters[class]).max(0.0);
            let share = SHARES[class] * passes;
            let gone = scheme.gone(&neighbour);
            let mut all = 0.0;
            for kind in 0..kinds.count() {
                let mut sent = share
                    * flight.streams[class]
                    * scheme.towards(self.lobes[kind][from][colour], &neighbour);
                if kinds.is_scattered(kind) {
                    sent += share * flight.scatters[class] * again[from][colour];
                }
                sums.kinds[kind] += gone * (sent * here.enters[class]);
                sums.show(kinds, kind, gone * (sent * here.tracks_in[class]));
                all += sent;
            }
            if kinds.scattered {
                sums.kinds[kinds.unscattered].w += all * scatters;
            }
            // What the cell itself sends there and surfaces on the way reflect comes back half a way later.
            let returns = SHARES[class] * (1.0 - passes) * reflectances[cell][colour];
            let (out, matte) = (here.streams[class], (MATTE * neighbour.direction).extend(1.0));
            let opposite = neighbour.opposite();
            let (mut all, mut sets_out) = (0.0, 0.0);
            for kind in 0..kinds.count() {
                let mut sent = out * scheme.towards(self.lobes[kind][cell][colour], &opposite);
                if kinds.is_scattered(kind) {
                    sent += here.scatters[class] * again[cell][colour];
                }
                sets_out += sent;
                let Some(into) = kinds.reflected(kind) else { continue };
                sent *= returns;
                sums.kinds[into] += matte * (sent * out);
                sums.show(kinds, into, matte * (sent * here.tracks_back[class]));
                all += sent;
            }
            if kinds.scattered {
                let scattered = kinds.unscattered;
                sums.kinds[scattered].w += all * here.albedo * (1.0 - out);
                // What a denser medium there turns back comes as if from there.
                let turned = share * sets_out * flight.turns * (1.0 - flight.lets_in(here, class));
                sums.kinds[scattered] += gone * (turned * here.enters[class]);
                sums.kinds[scattered].w += turned * here.albedo * (1.0 - here.enters[class]);
                sums.show(kinds, scattered, gone * (turned * here.tracks_in[class]));
            }
        }
        sums
    }
}
