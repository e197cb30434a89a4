//! Mean pooling and bilinear doubling, and their gradients, on the CPU. Planes are independent: rayon over planes.

use rayon::prelude::*;

/// 2x2 means of planes `[height, width]`: `[height / 2, width / 2]` each.
pub fn halve(x: &[f32], height: usize, width: usize) -> Vec<f32> {
    planes(x, height * width, height * width / 4, |x, out| {
        for (rows, out) in x.chunks_exact(2 * width).zip(out.chunks_exact_mut(width / 2)) {
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
    planes(dy, height * width / 4, height * width, |dy, out| {
        for (dy, rows) in dy.chunks_exact(width / 2).zip(out.chunks_exact_mut(2 * width)) {
            let (upper, lower) = rows.split_at_mut(width);
            for (pair, dy) in upper.as_chunks_mut::<2>().0.iter_mut().zip(dy) {
                *pair = [0.25 * dy; 2];
            }
            lower.copy_from_slice(upper);
        }
    })
}

/// Planes `[height, width]` doubled bilinearly: half-pixel centres, edges replicated.
pub fn double(x: &[f32], height: usize, width: usize) -> Vec<f32> {
    planes(x, height * width, 4 * height * width, |x, out| {
        let mut blend = vec![0.0; width];
        for (y, out) in out.chunks_exact_mut(2 * width).enumerate() {
            let near = &x[y / 2 * width..][..width];
            let far = &x[neighbour(y, height) * width..][..width];
            for ((blend, near), far) in blend.iter_mut().zip(near).zip(far) {
                *blend = 0.75 * near + 0.25 * far;
            }
            widen(&blend, out.as_chunks_mut::<2>().0);
        }
    })
}

/// The gradient of [`double`] of planes `[height, width]`, given that of its output.
pub fn double_backward(dy: &[f32], height: usize, width: usize) -> Vec<f32> {
    planes(dy, 4 * height * width, height * width, |dy, out| {
        let row = |y: usize| &dy[y * 2 * width..][..2 * width];
        let mut blend = vec![0.0; 2 * width];
        for (y, out) in out.chunks_exact_mut(width).enumerate() {
            let above = row((2 * y).saturating_sub(1));
            let below = row((2 * y + 2).min(2 * height - 1));
            let inner = row(2 * y).iter().zip(row(2 * y + 1));
            for ((blend, (a, b)), (c, d)) in blend.iter_mut().zip(inner).zip(above.iter().zip(below)) {
                *blend = 0.75 * (a + b) + 0.25 * (c + d);
            }
            narrow(&blend, out);
        }
    })
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
    let pair = |left: f32, centre: f32, right: f32| {
        [0.75 * centre + 0.25 * left, 0.75 * centre + 0.25 * right]
    };
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

/// Makes planes of `after` numbers from planes of `before` numbers.
fn planes(x: &[f32], before: usize, after: usize, make: impl Fn(&[f32], &mut [f32]) + Sync) -> Vec<f32> {
    let mut out = vec![0.0; x.len() / before * after];
    out.par_chunks_exact_mut(after).zip(x.par_chunks_exact(before)).for_each(|(out, x)| {
        pulp::Arch::new().dispatch(
            #[inline(always)]
            || make(x, out),
        );
    });
    out
}
