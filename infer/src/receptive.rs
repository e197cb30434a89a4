//! How far a network looks: what a tile of an image must see around what it keeps.

use crate::{BlockSource, NetSpec};

/// Pixels along one axis, both ends included.
type Span = [isize; 2];

impl NetSpec {
    /// Pixels around an image's part that decide what the network makes of that part, at most, where the part
    /// begins and ends at multiples of [`NetSpec::alignment`]: exact, for a pixel further away changes
    /// nothing and one at that distance does, if the weights let it.
    pub fn overlap(&self) -> usize {
        let part = self.alignment() as isize;
        let [first, last] = self.needed([0, part - 1]);
        (-first).max(last - (part - 1)).max(0) as usize
    }

    /// The pixels of the input that a part of the image depends on.
    fn needed(&self, part: Span) -> Span {
        let layers = self.layers();
        // What is needed of each layer's image; nothing yet, but of the last.
        let mut needed: Vec<Option<Span>> = vec![None; layers.len()];
        let square = 1 << self.last_level();
        needed[layers.len() - 1] = Some([part[0].div_euclid(square), part[1].div_euclid(square)]);
        let mut input = part;
        for (index, layer) in layers.iter().enumerate().rev() {
            let Some([first, last]) = needed[index] else { continue };
            let radius = (layer.kernel / 2) as isize;
            let seen = [first - radius, last + radius];
            match layer.source {
                BlockSource::Input => input = [input[0].min(seen[0]), input[1].max(seen[1])],
                BlockSource::Folded => input = [input[0].min(2 * seen[0]), input[1].max(2 * seen[1] + 1)],
                BlockSource::Plain(from) => add(&mut needed[from], seen),
                BlockSource::Pooled(from) => add(&mut needed[from], [2 * seen[0], 2 * seen[1] + 1]),
                BlockSource::Joined { coarse, skip, .. } => {
                    add(&mut needed[coarse], before_doubling(seen));
                    add(&mut needed[skip], seen);
                }
            }
        }
        input
    }
}

/// Widens a span so that it covers another one.
fn add(span: &mut Option<Span>, other: Span) {
    *span = Some(span.map_or(other, |[first, last]| [first.min(other[0]), last.max(other[1])]));
}

/// The pixels that a doubled span is blended from: an even pixel lies at the near end of a coarse one and has
/// some of the coarse one before it, an odd pixel some of the one after.
const fn before_doubling([first, last]: Span) -> Span {
    [(first - 1).div_euclid(2), (last + 1).div_euclid(2)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parity::noise;
    use crate::{ChannelOrder, Reach, Weights, reference};

    const REACH: Reach = Reach { radius: 1.0, diagonal_share: 0.05, height: 512 };

    /// Columns of the image that change with one column of the input, first and last.
    fn changed(spec: &NetSpec, weights: &Weights, width: usize, column: usize) -> Option<(usize, usize)> {
        let input = noise(spec.input_channels(), spec.alignment(), width, 1);
        let mut other = input.clone();
        for (c, y) in (0..input.channels()).flat_map(|c| (0..input.height()).map(move |y| (c, y))) {
            other.plane_mut(c)[y * width + column] += 1e3;
        }
        let [a, b] = [input, other].map(|input| reference::forward(spec, weights, &input));
        let differs = |x: &usize| (0..a.height()).any(|y| a.at(0, y, *x) != b.at(0, y, *x));
        let columns: Vec<usize> = (0..width).filter(differs).collect();
        columns.first().copied().zip(columns.last().copied())
    }

    #[test]
    fn the_overlap_is_exact() {
        let ao = NetSpec::ao(ChannelOrder::Interleaved, REACH);
        for (levels, kernel) in [(1, 3), (1, 5), (2, 1), (2, 3), (3, 3), (3, 5), (4, 3), (5, 1)] {
            let spec = ao.clone().reshaped(|net| (net.levels, net.kernel) = (levels, kernel));
            let (weights, overlap, part) = (Weights::random(&spec, 3), spec.overlap(), spec.alignment());
            // The part in the middle of a row that is wide enough on either side.
            let begin = overlap.next_multiple_of(part) + part;
            let width = 2 * begin + part;
            let touches = |column: usize| {
                let (first, last) = changed(&spec, &weights, width, column).expect("something changes");
                first < begin + part && last >= begin
            };
            let what = format!("{levels} levels, kernel {kernel}, overlap {overlap}");
            let ends = [begin - overlap, begin + part - 1 + overlap];
            assert!(ends.into_iter().any(touches), "{what}: it could be less");
            let beyond = [begin - overlap - 1, begin + part + overlap];
            assert!(!beyond.into_iter().any(touches), "{what}: it must be more");
        }
    }

    #[test]
    fn the_papers_network_sees_far() {
        assert_eq!(NetSpec::ao(ChannelOrder::Interleaved, REACH).overlap(), 127);
    }
}
