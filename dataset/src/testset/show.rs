//! Frames of a test set to look at.

use super::{TestFrame, TestSet};
use crate::{DatasetError, Pair, Props, StagedScene};
use deepshade_shaders::Planes;
use deepshade_shaders::similarity::TILE;

impl TestSet {
    /// A frame as a pair: its g-buffer, rendered again, and as target the whole image where there is one,
    /// else the tiles on black.
    ///
    /// # Errors
    /// As [`TestSet::frame`], and if the scene cannot be had again.
    ///
    /// # Panics
    /// If there is no frame of that index.
    pub fn pair(&self, index: usize, props: &Props) -> Result<Pair, DatasetError> {
        let (record, recipe) = (&self.frames()[index], self.recipe());
        let (height, width) = (recipe.resolution.height, recipe.resolution.width);
        let TestFrame { tiles, truth, whole } = self.frame(index)?;
        let staged = StagedScene::load(&record.scene, recipe, props)?;
        let scene = staged.shown(&record.camera, record.variation.as_ref())?;
        let gbuffer = staged.gbuffer(&scene, &record.camera, record.seed);
        let target = whole.unwrap_or_else(|| scattered(&truth, &tiles, height, width));
        Ok(Pair { gbuffer, target, variance: None, radius: record.radius })
    }
}

/// An image with tiles at their places and black elsewhere: the reverse of [`gather`](super::gather).
fn scattered(strip: &Planes, tiles: &[usize], height: usize, width: usize) -> Planes {
    let columns = width / TILE;
    Planes::from_fn(strip.channels(), height, width, |channel, y, x| {
        let tile = y / TILE * columns + x / TILE;
        let place = tiles.binary_search(&tile).ok().filter(|_| x / TILE < columns);
        place.map_or(0.0, |place| strip.at(channel, y % TILE, place * TILE + x % TILE))
    })
}

#[cfg(test)]
mod tests {
    use super::super::gather;
    use super::*;

    #[test]
    fn tiles_are_put_where_they_are_from() {
        let image = Planes::from_fn(2, 20, 29, |c, y, x| (1 + c * 10_000 + y * 100 + x) as f32);
        let tiles = [1, 3, 5];
        let strip = gather(&image, &tiles);
        let scattered = scattered(&strip, &tiles, 20, 29);
        assert_eq!(gather(&scattered, &tiles), strip);
        let shown = scattered.data().iter().filter(|value| **value != 0.0).count();
        assert_eq!(shown, 2 * 3 * TILE * TILE, "black elsewhere");
    }
}
