//! [`super::smooth`], for as many neighbouring pixels as a vector has lanes.

use super::{Surface, uniforms};
use crate::methods::vectors::Lanes;
use deepshade_shaders::{Planes, shows_surface};
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

/// The blur of `image`, `[channels, height, width]`, along rows, and of that along columns.
pub fn smooth(surface: &Surface, [rows, columns]: &[uniforms::Blur; 2], image: &Planes) -> [Planes; 2] {
    let kinds = kinds(surface);
    let along_rows = along(surface, &kinds, rows, image);
    let along_both = along(surface, &kinds, columns, &along_rows);
    [along_rows, along_both]
}

/// What kind of surface each pixel shows, 0 for none: pixels are alike whose numbers are equal.
fn kinds(surface: &Surface) -> Vec<f32> {
    let kind = |valid: &f32| if shows_surface(*valid) { (valid + 0.5).floor() } else { 0.0 };
    surface.valid.data().par_iter().map(kind).collect()
}

fn along(surface: &Surface, kinds: &[f32], blur: &uniforms::Blur, noisy: &Planes) -> Planes {
    let (height, width) = (surface.height, surface.width);
    let mut image = vec![blur.background; noisy.channels() * height * width];
    let rows = image.par_chunks_mut(width.max(1)).enumerate();
    rows.for_each(|(row, out)| {
        let (noisy, y) = (noisy.plane(row / height), row % height);
        Arch::new().dispatch(Row { surface, kinds, blur, noisy, y, out });
    });
    Planes::from_data(noisy.channels(), height, width, image)
}

/// A row of the blurred image.
struct Row<'a> {
    surface: &'a Surface,
    kinds: &'a [f32],
    blur: &'a uniforms::Blur,
    noisy: &'a [f32],
    y: usize,
    out: &'a mut [f32],
}

impl WithSimd for Row<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        for x in (0..self.out.len()).step_by(S::F32_LANES) {
            let kind = self.load(simd, self.kinds, x as isize, self.y);
            let valid = kind.all(0.5).below(kind);
            if valid.any() {
                let blurred = self.blurred(simd, kind, x);
                valid.choose(blurred, kind.all(self.blur.background)).store(&mut self.out[x..]);
            }
        }
    }
}

impl Row<'_> {
    #[inline(always)]
    fn load<S: Simd>(&self, simd: S, plane: &[f32], x: isize, y: usize) -> Lanes<S> {
        let width = self.surface.width;
        Lanes::load(simd, &plane[y * width..][..width], x)
    }

    #[inline(always)]
    fn blurred<S: Simd>(&self, simd: S, kind: Lanes<S>, x: usize) -> Lanes<S> {
        let uniforms::Blur { step_x, step_y, radius, falloff, sharpness, .. } = *self.blur;
        let [px, py, pz] = self.surface.position_planes();
        let [nx, ny, nz] = self.surface.normal_planes();
        let x = x as isize;
        let [cx, cy, cz] =
            [self.load(simd, px, x, self.y), self.load(simd, py, x, self.y), self.load(simd, pz, x, self.y)];
        let [nx, ny, nz] =
            [self.load(simd, nx, x, self.y), self.load(simd, ny, x, self.y), self.load(simd, nz, x, self.y)];
        let zero = kind.all(0.0);
        let (mut sum, mut weights) = (zero, zero);
        for i in -radius..=radius {
            let column = x + (i * step_x) as isize;
            let Some(row) =
                self.y.checked_add_signed((i * step_y) as isize).filter(|row| *row < self.surface.height)
            else {
                continue;
            };
            let alike = self.load(simd, self.kinds, column, row).equals(kind);
            let dx = self.load(simd, px, column, row) - cx;
            let dy = self.load(simd, py, column, row) - cy;
            let dz = self.load(simd, pz, column, row) - cz;
            let off_plane = nx.mul_add(dx, ny.mul_add(dy, nz * dz)) * zero.all(sharpness);
            let exponent = off_plane.mul_add(off_plane, zero.all(falloff * (i * i) as f32));
            let weight = alike.choose(fading(exponent), zero);
            sum = weight.mul_add(self.load(simd, self.noisy, column, row), sum);
            weights = weights + weight;
        }
        sum / weights
    }
}

/// `exp(-x)` of what is not negative, within 3e-7 of itself; 0 where that is below 1e-37.
#[inline(always)]
fn fading<S: Simd>(x: Lanes<S>) -> Lanes<S> {
    // In powers of 2, whose whole part is the exponent of the result.
    let power = x.min(x.all(90.0)) * x.all(-std::f32::consts::LOG2_E);
    let whole = power.floor();
    let part = (power - whole) * x.all(std::f32::consts::LN_2);
    let mut series = x.all(1.0 / 5_040.0);
    for factor in [1.0 / 720.0, 1.0 / 120.0, 1.0 / 24.0, 1.0 / 6.0, 0.5, 1.0, 1.0] {
        series = series.mul_add(part, x.all(factor));
    }
    let bits = series.bits() + power.floor_to_words().shifted_left(series.bits().all(23));
    x.below(x.all(85.0)).choose(bits.as_float(), x.all(0.0))
}
