//! Finer grids in coarser ones (Kaplanyan and Dachsbacher 2010, section 5): as many cells around the camera
//! that are half as large, and so on.
//!
//! The coarsest grid holds all of the scene and is done first, as if it were alone. What it shows is the sum
//! of all iterations, so what has gone through each of its cells is known, and a finer grid begins with all
//! of that at once (steady light: in each iteration) in the cells along its border, beside the light of its
//! own surfaces and medium. From then
//! on the border takes what arrives. Nothing has to be handed back: light that leaves the finer grid is in
//! the coarser one, as is what comes back of it.

use super::lattice::mean;
use super::lobe::Lobes;
use super::propagation::{CellFluence, Kinds, Light};
use super::{Flight, LightGrid, Volume};
use glam::Vec4;

impl Flight {
    /// Fluence of light of a cell, such as to make it so bright in all iterations, over the energy that
    /// arrives there: as if as much went through the cells beside it. Of scattered light, or else of light
    /// that met no medium.
    fn way_of(&self, lobes: Lobes, light: Vec4, is_scattered: bool) -> f32 {
        let energies = lobes.by_class(lobes.begins(light)).map(|energy| energy / light.w.max(1e-37));
        let along = |of: &dyn Fn(usize) -> f32| {
            (0..energies.len()).map(|class| energies[class] * of(class)).sum::<f32>()
        };
        let again = if is_scattered { self.again * along(&|class| 1.0 - self.streams[class]) } else { 0.0 };
        let again_in = mean(|class| self.scatters[class] * self.tracks_in[class]);
        let straight = self.track_out + along(&|class| self.streams[class] * self.tracks_in[class]);
        straight + again * (self.track_again + again_in)
    }
}

/// Light of each kind in a cell at the border of a finer volume, by what a coarser grid shows around it.
pub fn at_border(
    outside: (&LightGrid, &CellFluence),
    volume: &Volume,
    cell: usize,
    kinds: Kinds,
) -> Vec<Light> {
    let ((coarse, shown), fine) = (outside, &volume.grid);
    let around = coarse.index(coarse.in_cells(fine.middle(fine.at(cell))).floor().as_ivec3());
    let area = (fine.cell / coarse.cell).powi(2);
    let of_kind = |kind: usize| {
        let Some(around) = around else { return Light::default() };
        let light = shown.of_kind(kinds, kind, around);
        std::array::from_fn(|colour| {
            let (light, flight) = (light[colour] * area, &volume.flights[cell][colour]);
            // Bands may show less than nothing.
            if light.w <= 0.0 {
                return Vec4::ZERO;
            }
            light / flight.way_of(volume.scheme.lobes, light, kinds.is_scattered(kind)).max(LEAST)
        })
    };
    (0..kinds.count()).map(of_kind).collect()
}

/// The shortest way, cells: of light that is hardly there.
const LEAST: f32 = 1e-6;
