//! Where an image lies in the plane of pixels that all parts of a file share.

use deepshade_shaders::Planes;
use std::fmt;

/// A rectangle of pixels, x to the right and y down, from anywhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// Column of its first pixel.
    pub left: i32,
    /// Row of its first pixel.
    pub top: i32,
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
}

/// The two rectangles of an image: where its pixels lie, and what of the plane is to be seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Windows {
    /// OpenEXR's `dataWindow`: the pixels that the file holds.
    pub data: Window,
    /// OpenEXR's `displayWindow`: the frame, which is black where the data window does not reach.
    pub display: Window,
}

impl Window {
    /// A rectangle from the origin.
    pub const fn of_size(height: usize, width: usize) -> Self {
        Self { left: 0, top: 0, width, height }
    }

    /// Whether all of another rectangle lies in this one.
    pub fn contains(&self, other: &Self) -> bool {
        let [left, top, right, bottom] = self.edges();
        let [other_left, other_top, other_right, other_bottom] = other.edges();
        left <= other_left && top <= other_top && other_right <= right && other_bottom <= bottom
    }

    /// Whether the two have a pixel in common.
    pub fn meets(&self, other: &Self) -> bool {
        let [left, top, right, bottom] = self.edges();
        let [other_left, other_top, other_right, other_bottom] = other.edges();
        left < other_right && other_left < right && top < other_bottom && other_top < bottom
    }

    /// Left, top, right and bottom; the last two are the first column and row beyond it.
    fn edges(&self) -> [i64; 4] {
        let (left, top) = (i64::from(self.left), i64::from(self.top));
        [left, top, left + self.width as i64, top + self.height as i64]
    }

    /// A plane that lies in this rectangle as another rectangle shows it: 0 where the plane does not reach.
    pub(super) fn placed(&self, plane: &[f32], onto: &Self) -> Vec<f32> {
        let mut placed = vec![0.0; onto.width * onto.height];
        let [left, top, right, bottom] = self.edges();
        let [onto_left, onto_top, onto_right, onto_bottom] = onto.edges();
        let (first, last) = (left.max(onto_left), right.min(onto_right));
        if first >= last {
            return placed;
        }
        for y in top.max(onto_top)..bottom.min(onto_bottom) {
            let from = (y - top) as usize * self.width + (first - left) as usize;
            let to = (y - onto_top) as usize * onto.width + (first - onto_left) as usize;
            let count = (last - first) as usize;
            placed[to..to + count].copy_from_slice(&plane[from..from + count]);
        }
        placed
    }
}

impl fmt::Display for Window {
    /// The first and the last pixel, as OpenEXR's tools print them.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [left, top, right, bottom] = self.edges();
        write!(f, "({left}, {top}) to ({}, {})", right - 1, bottom - 1)
    }
}

impl Windows {
    /// Those of an image that is all there is to be seen.
    pub fn of(planes: &Planes) -> Self {
        let whole = Window::of_size(planes.height(), planes.width());
        Self { data: whole, display: whole }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_plane_is_placed_where_it_lies() {
        let plane: Vec<f32> = (1..=6).map(|value| value as f32).collect();
        let window = Window { left: -1, top: 2, width: 3, height: 2 };
        let around = Window { left: -2, top: 1, width: 5, height: 4 };
        let expected = [[0.0; 5], [0.0, 1.0, 2.0, 3.0, 0.0], [0.0, 4.0, 5.0, 6.0, 0.0], [0.0; 5]];
        assert_eq!(window.placed(&plane, &around), expected.concat());
        let corner = Window { left: 1, top: 3, width: 2, height: 2 };
        assert_eq!(window.placed(&plane, &corner), [6.0, 0.0, 0.0, 0.0]);
        let elsewhere = Window { left: 2, top: 3, width: 1, height: 1 };
        assert_eq!(window.placed(&plane, &elsewhere), [0.0]);
        assert!(around.contains(&window) && !window.contains(&around) && !window.contains(&corner));
        assert!(window.meets(&corner) && !window.meets(&elsewhere));
        assert_eq!(window.to_string(), "(-1, 2) to (1, 3)");
    }
}
