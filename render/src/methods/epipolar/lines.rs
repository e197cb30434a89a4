//! The image's pixels by epipolar lines, each in the nearest, in the order in which they lie on it.

use super::super::shafts::ViewRays;
use super::geometry::{Geometry, beta};
use super::slices::Slices;
use rayon::prelude::*;

/// View rays sorted by lines, and along each from the light away.
#[derive(Debug)]
pub struct Lines {
    rays: Vec<u32>,
    /// Where each line's begin, and the end of all.
    starts: Vec<usize>,
}

impl Lines {
    /// Sorts all view rays.
    pub fn new(view: &ViewRays, geometry: &Geometry) -> Self {
        let slices = Slices::new(geometry.epipole(view), view.height(), view.width());
        let key = |ray: usize| {
            let (before, on) = slices.of(view.at(ray).as_dvec2());
            let direction = geometry.direction(view.directions[ray]);
            let slice = if on < 0.5 { before } else { slices.after(before) };
            (slice, beta(direction.along, direction.aside), ray as u32)
        };
        let mut keys: Vec<(usize, f32, u32)> = (0..view.count()).into_par_iter().map(key).collect();
        keys.par_sort_unstable_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
        let starts = (0..=slices.count()).map(|slice| keys.partition_point(|key| key.0 < slice)).collect();
        Self { rays: keys.into_iter().map(|key| key.2).collect(), starts }
    }

    /// The view rays of every line.
    pub fn all(&self) -> impl IndexedParallelIterator<Item = &[u32]> {
        self.starts.par_windows(2).map(|ends| &self.rays[ends[0]..ends[1]])
    }
}
