//! How images are seen.

use crate::view::zoom::Zoom;
use std::collections::BTreeMap;

/// How images lie in the window.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Arrangement {
    /// One over the other, each seen between two borders that can be dragged.
    #[default]
    Wipe,
    /// Beside each other.
    Tiles,
}

/// What is seen of an image.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Map {
    /// Itself.
    #[default]
    Image,
    /// How it differs from truth.
    Difference,
    /// FLIP.
    Flip,
}

impl Arrangement {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Wipe, Self::Tiles];

    /// Its name in the window.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Wipe => "wipe",
            Self::Tiles => "tiles",
        }
    }
}

impl Map {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Image, Self::Difference, Self::Flip];

    /// Its name in the window.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Image => "image",
            Self::Difference => "difference",
            Self::Flip => "flip",
        }
    }

    /// The one after it.
    pub fn next(self) -> Self {
        Self::ALL[(self as usize + 1) % Self::ALL.len()]
    }
}

/// How images are seen.
#[derive(Default)]
pub struct Look {
    /// How they lie in the window.
    pub arrangement: Arrangement,
    /// How they are enlarged.
    pub zoom: Zoom,
    /// What is seen of them.
    pub map: Map,
    /// How much brighter they are than suits the first one, stops.
    pub stops: f32,
    /// The method that the others are measured against; by default truth.
    pub against: Option<&'static str>,
    /// Where the user has put the right ends of images that lie over each other, as shares of the width.
    ends: BTreeMap<String, f32>,
}

impl Look {
    /// Where images that lie over each other end, but for the last one, as shares of the width: where the
    /// user has put it, as long as they have put all of it, and in this order; else evenly. One that is not
    /// there for a while leaves its room to the others.
    pub fn borders(&self, names: &[&str]) -> Vec<f32> {
        let inner = &names[..names.len().saturating_sub(1)];
        let put: Option<Vec<f32>> = inner.iter().map(|name| self.ends.get(*name).copied()).collect();
        let evenly = || (1..names.len()).map(|index| index as f32 / names.len() as f32).collect();
        put.filter(|put| put.is_sorted()).unwrap_or_else(evenly)
    }

    /// Moves one of these borders, between its neighbours; the others stay where they are seen.
    pub fn put_border(&mut self, names: &[&str], index: usize, share: f32) {
        let mut borders = self.borders(names);
        let low = if index == 0 { 0.0 } else { borders[index - 1] };
        let high = borders.get(index + 1).copied().unwrap_or(1.0);
        borders[index] = share.clamp(low, high);
        self.ends.extend(names.iter().map(|name| (*name).to_owned()).zip(borders));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn borders_stay_where_they_were_put_while_truth_is_away() {
        let mut look = Look::default();
        let (still, moving) = (["gtao", "hbao", "truth"], ["gtao", "hbao"]);
        assert!(look.borders(&[]).is_empty());
        assert_eq!(look.borders(&moving), [0.5f32]);
        look.put_border(&still, 0, 0.2);
        look.put_border(&still, 1, 0.1);
        assert_eq!(look.borders(&still), [0.2f32, 0.2], "none goes past another");
        look.put_border(&still, 1, 0.8);
        assert_eq!(look.borders(&moving), [0.2f32]);
        assert_eq!(look.borders(&still), [0.2f32, 0.8], "it comes back");
        assert_eq!(look.borders(&["hbao", "gtao", "truth"]), [1.0f32 / 3.0, 2.0 / 3.0], "another order");
        assert_eq!(look.borders(&["gtao", "ssao"]), [0.2f32], "the last one ends with the image");
    }
}
