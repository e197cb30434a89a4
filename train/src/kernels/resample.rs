//! Mean pooling, and bilinear doubling with concatenation, and their gradients, on the CPU. Planes are independent:
//! rayon over planes.

use rayon::prelude::*;

/// 2x2 means of planes `[height, width]`: `[height / 2, width / 2]` each.
pub fn halve(x: &[f32], height: usize, width: usize) -> Vec<f32> {
    let size = height * width;
    planes(x.len() / size, size / 4, |at, out| {
        let rows = x[at * size..][..size].chunks_exact(2 * width);
        for (rows, out) in rows.zip(out.chunks_exact_mut(width / 2)) {
            let (upper, lower) = rows.split_at(width);
            let pairs = upper.as_chunks::<2>().0.iter().zip(lower.as_chunks::<2>().0);
            for (out, (a, b)) in out.iter_mut().zip(pairs) {
                *out = 0.25 * (a[0] + a[1] + b[0] + b[1]);
            }
        }
    })
}

/// The gradient of [`halve`] of planes `[height, width]`, given that of its output.
pub fn halve_backward(dy: &[f32], height: usize, width: usize) -> Vec<f32> {
    let size = height * width;
    planes(4 * dy.len() / size, size, |at, out| {
        let dy = dy[at * size / 4..][..size / 4].chunks_exact(width / 2);
        for (dy, rows) in dy.zip(out.chunks_exact_mut(2 * width)) {
            let (upper, lower) = rows.split_at_mut(width);
            for (pair, dy) in upper.as_chunks_mut::<2>().0.iter_mut().zip(dy) {
                *pair = [0.25 * dy; 2];
            }
            lower.copy_from_slice(upper);
        }
    })
}

/// The sizes of a concatenation of a coarse image, doubled, with a fine one, group by group.
#[derive(Clone, Copy, Debug)]
pub struct JoinShape {
    /// Images times groups.
    pub parts: usize,
    /// Coarse channels of a group.
    pub coarse: usize,
    /// Fine channels of a group.
    pub fine: usize,
    /// Rows of the coarse image.
    pub height: usize,
    /// Columns of the coarse image.
    pub width: usize,
}

impl JoinShape {
    const fn coarse_pixels(&self) -> usize {
        self.height * self.width
    }

    const fn fine_pixels(&self) -> usize {
        4 * self.coarse_pixels()
    }

    /// The plane of the joined image that holds coarse plane `at`.
    const fn of_coarse(&self, at: usize) -> usize {
        at / self.coarse * (self.coarse + self.fine) + at % self.coarse
    }

    /// The plane of the joined image that holds fine plane `at`.
    const fn of_fine(&self, at: usize) -> usize {
        at / self.fine * (self.coarse + self.fine) + self.coarse + at % self.fine
    }
}

/// A coarse image doubled bilinearly (half-pixel centres, edges replicated) and a fine one:
/// `[parts, coarse + fine, 2 * height, 2 * width]`.
pub fn join(shape: JoinShape, coarse: &[f32], fine: &[f32]) -> Vec<f32> {
    let (small, large) = (shape.coarse_pixels(), shape.fine_pixels());
    let together = shape.coarse + shape.fine;
    planes(shape.parts * together, large, |at, out| {
        let (part, channel) = (at / together, at % together);
        match channel.checked_sub(shape.coarse) {
            None => double(&coarse[(part * shape.coarse + channel) * small..][..small], out, shape.width),
            Some(channel) => out.copy_from_slice(&fine[(part * shape.fine + channel) * large..][..large]),
        }
    })
}

/// The gradient of [`join`] for its coarse image, given that of its output.
pub fn join_backward_coarse(shape: JoinShape, dy: &[f32]) -> Vec<f32> {
    let large = shape.fine_pixels();
    planes(shape.parts * shape.coarse, shape.coarse_pixels(), |at, out| {
        double_backward(&dy[shape.of_coarse(at) * large..][..large], out, shape.width);
    })
}

/// The gradient of [`join`] for its fine image, given that of its output.
pub fn join_backward_fine(shape: JoinShape, dy: &[f32]) -> Vec<f32> {
    let large = shape.fine_pixels();
    planes(shape.parts * shape.fine, large, |at, out| {
        out.copy_from_slice(&dy[shape.of_fine(at) * large..][..large]);
    })
}

/// Doubles a plane of rows of `width`.
fn double(x: &[f32], out: &mut [f32], width: usize) {
    let height = x.len() / width;
    let mut blend = vec![0.0; width];
    for (y, out) in out.chunks_exact_mut(2 * width).enumerate() {
        let near = &x[y / 2 * width..][..width];
        let far = &x[neighbour(y, height) * width..][..width];
        for ((blend, near), far) in blend.iter_mut().zip(near).zip(far) {
            *blend = 0.75 * near + 0.25 * far;
        }
        widen(&blend, out.as_chunks_mut::<2>().0);
    }
}

/// The gradient of [`double`] into rows of `width`.
fn double_backward(dy: &[f32], out: &mut [f32], width: usize) {
    let last = dy.len() / (2 * width) - 1;
    let row = |y: usize| &dy[y * 2 * width..][..2 * width];
    let mut blend = vec![0.0; 2 * width];
    for (y, out) in out.chunks_exact_mut(width).enumerate() {
        let inner = row(2 * y).iter().zip(row(2 * y + 1));
        let outer = row((2 * y).saturating_sub(1)).iter().zip(row((2 * y + 2).min(last)));
        for ((blend, (a, b)), (c, d)) in blend.iter_mut().zip(inner).zip(outer) {
            *blend = 0.75 * (a + b) + 0.25 * (c + d);
        }
        narrow(&blend, out);
    }
}

/// The row or column that output row or column `at` blends in with a weight of 1/4.
fn neighbour(at: usize, size: usize) -> usize {
    match at % 2 {
        0 => (at / 2).saturating_sub(1),
        _ => (at / 2 + 1).min(size - 1),
    }
}

/// Doubles a row.
fn widen(row: &[f32], out: &mut [[f32; 2]]) {
    let last = row.len() - 1;
    let pair =
        |left: f32, centre: f32, right: f32| [0.75 * centre + 0.25 * left, 0.75 * centre + 0.25 * right];
    for (window, out) in row.windows(3).zip(&mut out[1..]) {
        *out = pair(window[0], window[1], window[2]);
    }
    out[0] = pair(row[0], row[0], row[last.min(1)]);
    out[last] = pair(row[last.saturating_sub(1)], row[last], row[last]);
}

/// The gradient of [`widen`].
fn narrow(row: &[f32], out: &mut [f32]) {
    let last = out.len() - 1;
    for (window, out) in row.windows(4).skip(1).step_by(2).zip(&mut out[1..]) {
        *out = 0.75 * (window[1] + window[2]) + 0.25 * (window[0] + window[3]);
    }
    for x in [0, last] {
        let (left, right) = ((2 * x).saturating_sub(1), (2 * x + 2).min(2 * last + 1));
        out[x] = 0.75 * (row[2 * x] + row[2 * x + 1]) + 0.25 * (row[left] + row[right]);
    }
}

/// Makes planes of `size` numbers each, by their index.
fn planes(count: usize, size: usize, make: impl Fn(usize, &mut [f32]) + Sync) -> Vec<f32> {
    let mut out = vec![0.0; count * size];
    out.par_chunks_exact_mut(size).enumerate().for_each(|(at, out)| {
        pulp::Arch::new().dispatch(
            #[inline(always)]
            || make(at, out),
        );
    });
    out
}
