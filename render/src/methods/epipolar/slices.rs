//! Which epipolar slices there are: lines through the epipole, so close that no pixel is more than half a
//! pixel from one (Baran et al. 2010, section 8).
//!
//! Neighbouring slices are farthest from each other where they leave the image. Along an edge that is `h`
//! pixels from the epipole, a step of one in `h asinh(x / h)` is one pixel across the slices, `x` being the
//! distance from the foot of the epipole. Only edges through which slices leave count: all four around an
//! epipole in the image, those on the far side of another.

use glam::DVec2;

/// The slices of an image.
#[derive(Clone, Debug)]
pub struct Slices {
    epipole: DVec2,
    /// Edges through which slices leave, in order.
    edges: Vec<Edge>,
    count: usize,
    closed: bool,
}

/// An edge of the image.
#[derive(Clone, Copy, Debug)]
struct Edge {
    /// Along the edge, with the image to the right.
    along: DVec2,
    /// Away from the image.
    outwards: DVec2,
    /// Distance of the epipole, pixels; positive on the image's side.
    height: f64,
    /// `h asinh(x / h)` of the edge's beginning and end.
    ends: [f64; 2],
    /// Number of the slice through its beginning.
    first: f64,
    /// Slices for a unit of `h asinh(x / h)`, at least 1.
    density: f64,
}

/// Edges that are nearer to the epipole, pixels, are none through which slices leave.
const NEAREST: f64 = 1e-6;

impl Slices {
    /// Those of an image around an epipole in pixels from the top left corner.
    pub fn new(epipole: DVec2, height: usize, width: usize) -> Self {
        let (right, bottom) = (width as f64, height as f64);
        let corners =
            [(0.0, 0.0), (right, 0.0), (right, bottom), (0.0, bottom)].map(|(x, y)| DVec2::new(x, y));
        let all: [Option<Edge>; 4] =
            std::array::from_fn(|i| Edge::new(epipole, corners[i], corners[(i + 1) % 4]));
        let closed = all.iter().all(Option::is_some);
        // The first edge after one that does not count, so that those that do follow each other.
        let start = (0..4).find(|i| all[(i + 3) % 4].is_none() && all[*i].is_some()).unwrap_or(0);
        let mut edges: Vec<Edge> = (0..4).filter_map(|i| all[(start + i) % 4]).collect();
        let mut first = 0.0;
        for edge in &mut edges {
            let length = edge.ends[1] - edge.ends[0];
            edge.first = first;
            edge.density = length.ceil().max(1.0) / length.max(f64::MIN_POSITIVE);
            first += length.ceil().max(1.0);
        }
        Self { epipole, edges, count: first as usize + usize::from(!closed), closed }
    }

    /// How many there are.
    pub const fn count(&self) -> usize {
        self.count
    }

    /// The slice after another; the last one has itself after it if the epipole is outside.
    pub const fn after(&self, slice: usize) -> usize {
        if slice + 1 < self.count {
            slice + 1
        } else if self.closed {
            0
        } else {
            slice
        }
    }

    /// Where a slice leaves the image, pixels.
    pub fn end(&self, slice: usize) -> DVec2 {
        let number = slice as f64;
        let edge = self.edges.iter().rev().find(|edge| edge.first <= number).unwrap_or(&self.edges[0]);
        let Edge { height, along, outwards, .. } = *edge;
        let at = edge.ends[0] + (number - edge.first) / edge.density;
        self.epipole + outwards * height + along * (height * (at / height).sinh())
    }

    /// Between which slices a point of the image is: the number of the one before, and how far on to the
    /// next.
    #[inline]
    pub fn of(&self, point: DVec2) -> (usize, f32) {
        let number = self.number(point - self.epipole);
        let before = (number as usize).min(self.count - 1);
        (before, (number - before as f64).clamp(0.0, 1.0) as f32)
    }

    /// A direction from the epipole as a fractional slice.
    fn number(&self, direction: DVec2) -> f64 {
        // The edge that is reached first: the least height over speed.
        let (mut fastest, mut leaves) = (0.0, &self.edges[0]);
        for edge in &self.edges {
            let speed = direction.dot(edge.outwards);
            if speed * leaves.height > fastest * edge.height {
                (fastest, leaves) = (speed, edge);
            }
        }
        if fastest == 0.0 {
            return 0.0;
        }
        let at = leaves.height * asinh(direction.dot(leaves.along) / fastest);
        (leaves.first + (at - leaves.ends[0]) * leaves.density).max(0.0)
    }

    /// As many as there would be with one pixel between them along the edges through which they leave
    /// (Engelhardt and Dachsbacher 2010).
    pub fn count_by_perimeter(&self) -> usize {
        let length = |edge: &Edge| {
            edge.height * ((edge.ends[1] / edge.height).sinh() - (edge.ends[0] / edge.height).sinh())
        };
        self.edges.iter().map(length).sum::<f64>().round() as usize + usize::from(!self.closed)
    }
}

impl Edge {
    fn new(epipole: DVec2, from: DVec2, to: DVec2) -> Option<Self> {
        let along = (to - from).normalize();
        let outwards = DVec2::new(along.y, -along.x);
        let height = (from - epipole).dot(outwards);
        let end = |corner: DVec2| height * asinh((corner - epipole).dot(along) / height);
        (height > NEAREST).then(|| Self {
            along,
            outwards,
            height,
            ends: [end(from), end(to)],
            first: 0.0,
            density: 1.0,
        })
    }
}

/// Faster than the standard library's, which is exact to the last bit near 0.
fn asinh(x: f64) -> f64 {
    (x.abs() + (x * x + 1.0).sqrt()).ln().copysign(x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const HEIGHT: usize = 96;
    const WIDTH: usize = 128;

    fn distance_to_line(point: DVec2, from: DVec2, to: DVec2) -> f64 {
        (to - from).perp_dot(point - from).abs() / (to - from).length()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(40))]
        #[test]
        fn no_pixel_is_farther_than_half_a_pixel_from_a_slice(x in -400f64..600.0, y in -400f64..500.0, far in 0..4) {
            // Some epipoles far away, where slices are almost parallel.
            let epipole = DVec2::new(x, y) * [1.0, 1.0, 1e3, 1e6][far as usize];
            let slices = Slices::new(epipole, HEIGHT, WIDTH);
            for i in 0..HEIGHT * WIDTH {
                let pixel = DVec2::new((i % WIDTH) as f64 + 0.5, (i / WIDTH) as f64 + 0.5);
                let (before, on) = slices.of(pixel);
                prop_assert!((0.0..=1.0).contains(&on));
                let nearest = if on < 0.5 { before } else { slices.after(before) };
                let off = distance_to_line(pixel, epipole, slices.end(nearest));
                prop_assert!(off < 0.501, "{off} pixels at {pixel}");
            }
        }
    }

    #[test]
    fn the_spacing_is_not_wasteful() {
        // With an eighth of the slices left out the guarantee would be broken.
        let epipole = DVec2::new(40.0, 30.0);
        let slices = Slices::new(epipole, HEIGHT, WIDTH);
        let gaps = (0..slices.count()).map(|slice| {
            let (a, b) = (slices.end(slice), slices.end(slices.after(slice)));
            distance_to_line(b, epipole, a)
        });
        let mean = gaps.sum::<f64>() / slices.count() as f64;
        assert!((0.95..1.0).contains(&mean), "{mean}");
    }

    #[test]
    fn fewer_slices_than_pixels_around_the_image() {
        let saved = |x: f64, y: f64| {
            let slices = Slices::new(DVec2::new(x, y), 960, 1280);
            1.0 - slices.count() as f64 / slices.count_by_perimeter() as f64
        };
        // Baran et al. 2010, section 8: 15 % in the middle, half near a corner.
        let (middle, corner) = (saved(640.0, 480.0), saved(20.0, 20.0));
        assert!((0.13..0.17).contains(&middle), "{middle}");
        assert!((0.4..0.6).contains(&corner), "{corner}");
    }
}
