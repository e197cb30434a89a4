//! Finer grids in coarser ones (Kaplanyan and Dachsbacher 2010, section 5): as many cells around the camera
//! that are half as large, and so on.
//!
//! The coarsest grid holds all of the scene and is done first, as if it were alone. What it shows is the sum
//! of all iterations, so what has gone through each of its cells is known, and a finer grid begins with all
//! of that at once in the cells along its border, beside the light of its own surfaces. From then on the
//! border takes what arrives. Nothing has to be handed back: light that leaves the finer grid is in the
//! coarser one, as is what comes back of it.
//!
//! That holds where lobes are linear, as two bands are: then any number of grids shows what one as fine
//! would, on a wall to an eighth. Squared lobes are not linear. Light that sets out from all of the border at once
//! meets in the middle, becomes one lobe without a direction there, and stays too long. In a closed room
//! fluence is up to half too high, and a third grid inherits that. So of squared lobes there are two grids.
//! A medium shows fluence, and has none. Beside the border, and so on the walls of a scene that the grid ends
//! at, the coarser one lights alone.

use super::propagation::Light;
use super::{Flight, LightGrid, Scheme, Volume};
use glam::Vec4;

impl Flight {
    /// Fluence of light of a cell, such as to make it so bright in all iterations, over the energy that
    /// arrives there: as if as much went through the cells beside it.
    fn way_of(&self, scheme: Scheme, light: Vec4) -> f32 {
        let energies = scheme.lobes.by_class(scheme.lobes.begins(light)).map(|energy| energy / light.w);
        let goes_on = |class: usize| energies[class] * self.streams[class] * self.tracks_in[class];
        self.track_out + (0..energies.len()).map(goes_on).sum::<f32>()
    }
}

/// Light in a cell at the border of a finer volume, by what a coarser grid shows around it.
pub fn at_border((coarse, shown): (&LightGrid, &[Light]), volume: &Volume, cell: usize) -> Light {
    let fine = &volume.grid;
    let around = coarse.index(coarse.in_cells(fine.middle(fine.at(cell))).floor().as_ivec3());
    let Some(around) = around else { return Light::default() };
    let area = (fine.cell / coarse.cell).powi(2);
    std::array::from_fn(|colour| {
        let light = shown[around][colour] * area;
        // Bands may show less than nothing.
        if light.w > 0.0 {
            light / volume.flights[cell][colour].way_of(volume.scheme, light)
        } else {
            Vec4::ZERO
        }
    })
}
