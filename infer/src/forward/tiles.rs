//! An image in tiles that together make the same as the whole.

use crate::NetSpec;
use deepshade_shaders::wgsl::uniforms::NetLayer;
use std::ops::Range;

/// A part of an image that is run by itself.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Tile {
    /// First row and column that it sees.
    pub origin: [usize; 2],
    /// Rows and columns of the image that it makes.
    pub keep: [Range<usize>; 2],
}

impl Tile {
    /// What a kernel is told, with where the tile lies.
    pub fn placed(&self, layer: NetLayer) -> NetLayer {
        let [top, left] = self.origin.map(|at| at as u32);
        let [rows, columns] = &self.keep;
        NetLayer {
            origin_x: left,
            origin_y: top,
            keep_left: columns.start as u32,
            keep_right: columns.end as u32,
            keep_top: rows.start as u32,
            keep_bottom: rows.end as u32,
            ..layer
        }
    }
}

/// What a kernel is told that writes its whole frame as an image of its own.
pub fn alone(layer: NetLayer) -> NetLayer {
    let NetLayer { width, height, .. } = layer;
    NetLayer { image_width: width, image_height: height, keep_right: width, keep_bottom: height, ..layer }
}

/// Tiles of one size that cover an image.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Tiling {
    /// Rows and columns that each sees: multiples of [`NetSpec::alignment`].
    pub frame: [usize; 2],
    /// The tiles, row by row.
    pub tiles: Vec<Tile>,
}

impl Tiling {
    /// The largest tiles of an image of `[height, width]` that `fits` accepts, the whole image if it can be;
    /// none if not even the smallest fit. The longer axis is cut first.
    pub fn new(spec: &NetSpec, size: [usize; 2], fits: impl Fn([usize; 2]) -> bool) -> Option<Self> {
        let mut pieces = [1, 1];
        loop {
            let frame = [0, 1].map(|axis| frame(spec, size[axis], pieces[axis]));
            if fits(frame) {
                let [rows, columns] = [0, 1].map(|axis| cuts(spec, size[axis], frame[axis]));
                let across = |(top, rows): (usize, Range<usize>)| {
                    let tile = move |(left, columns): &(usize, Range<usize>)| Tile {
                        origin: [top, *left],
                        keep: [rows.clone(), columns.clone()],
                    };
                    columns.iter().map(tile).collect::<Vec<_>>()
                };
                return Some(Self { frame, tiles: rows.into_iter().flat_map(across).collect() });
            }
            let cut = |axis: usize| frame[axis] > smallest(spec).min(frame_of(spec, size[axis]));
            let axis = [0, 1].into_iter().filter(|axis| cut(*axis)).max_by_key(|axis| frame[*axis])?;
            pieces[axis] += 1;
        }
    }
}

/// The overlap in whole steps of the alignment.
fn margin(spec: &NetSpec) -> usize {
    spec.overlap().next_multiple_of(spec.alignment())
}

/// The whole frame of an image's axis.
fn frame_of(spec: &NetSpec, size: usize) -> usize {
    size.next_multiple_of(spec.alignment())
}

/// The shortest tile that keeps anything between two others.
fn smallest(spec: &NetSpec) -> usize {
    2 * margin(spec) + spec.alignment()
}

/// Length of the tiles that an axis has where it is cut into pieces.
fn frame(spec: &NetSpec, size: usize, pieces: usize) -> usize {
    let whole = frame_of(spec, size);
    if pieces == 1 {
        return whole;
    }
    let length = (whole + 2 * margin(spec) * (pieces - 1)).div_ceil(pieces);
    length.next_multiple_of(spec.alignment()).max(smallest(spec)).min(whole)
}

/// Where tiles of a length begin along an axis, and what each keeps.
fn cuts(spec: &NetSpec, size: usize, length: usize) -> Vec<(usize, Range<usize>)> {
    let (whole, margin) = (frame_of(spec, size), margin(spec));
    let mut cuts = Vec::new();
    let mut done = 0;
    while done < size {
        let origin = done.saturating_sub(margin).min(whole - length);
        let end = if origin + length == whole { size } else { origin + length - margin };
        cuts.push((origin, done..end));
        done = end;
    }
    cuts
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ChannelOrder, Reach};

    const REACH: Reach = Reach { radius: 1.0, diagonal_share: 0.05, height: 512 };

    #[test]
    fn tiles_cover_the_image_once_and_see_enough() {
        let spec = NetSpec::ao(ChannelOrder::Interleaved, REACH).reshaped(|net| net.levels = 3);
        let (overlap, alignment) = (spec.overlap(), spec.alignment());
        for size in [[1, 1], [37, 203], [90, 91], [256, 255]] {
            for most in [1, 40, 64, 92, 128, 400] {
                let fits = |frame: [usize; 2]| frame.into_iter().max() <= Some(most);
                let Some(tiling) = Tiling::new(&spec, size, fits) else {
                    let frame = size.map(|size| frame_of(&spec, size)).into_iter().max();
                    assert!(most < smallest(&spec) && frame > Some(most), "{size:?} in {most}");
                    continue;
                };
                let mut covered = vec![0; size[0] * size[1]];
                for Tile { origin, keep } in &tiling.tiles {
                    for (axis, keep) in keep.iter().enumerate() {
                        let (begin, end) = (origin[axis], origin[axis] + tiling.frame[axis]);
                        assert!(begin % alignment == 0 && end <= frame_of(&spec, size[axis]));
                        assert!(begin == 0 || begin + overlap <= keep.start);
                        assert!(end == frame_of(&spec, size[axis]) || keep.end + overlap <= end);
                    }
                    for y in keep[0].clone() {
                        keep[1].clone().for_each(|x| covered[y * size[1] + x] += 1);
                    }
                }
                assert!(covered.iter().all(|times| *times == 1), "{size:?} in {most}");
            }
        }
    }

    #[test]
    fn what_fits_is_one_tile() {
        let spec = NetSpec::ao(ChannelOrder::Interleaved, REACH);
        let tiling = Tiling::new(&spec, [1080, 1920], |_| true).expect("fits");
        assert_eq!(tiling.frame, [1088, 1920]);
        assert_eq!(tiling.tiles, [Tile { origin: [0, 0], keep: [0..1080, 0..1920] }]);
        assert_eq!(Tiling::new(&spec, [1080, 1920], |_| false), None);
    }
}
