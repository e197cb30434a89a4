//! A g-buffer: some attributes of every pixel of a view.

use crate::{Attribute, Planes};
use thiserror::Error;

/// Attributes of every pixel of a view; which ones, the renderer or the file decides.
#[derive(Clone, Debug, PartialEq)]
pub struct GBuffer {
    attributes: Vec<Attribute>,
    planes: Planes,
}

/// A g-buffer lacks what somebody needs from it.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("the g-buffer has no `{wanted}`; it holds {held}")]
pub struct MissingAttribute {
    /// Name of what is missing.
    pub wanted: String,
    /// Names of what is there.
    pub held: String,
}

/// Whether a value of [`Attribute::Valid`] says that a surface is seen. It is 0 or 1, but files that were
/// scaled hold values between. `surface_valid` says the same in WGSL.
pub const fn shows_surface(valid: f32) -> bool {
    valid > 0.5
}

impl GBuffer {
    /// A g-buffer whose planes are the attributes' channels one after the other,
    /// `[sum of widths, height, width]`.
    ///
    /// # Panics
    /// If the number of planes is not the sum of the attributes' widths.
    pub fn new(attributes: Vec<Attribute>, planes: Planes) -> Self {
        let width: usize = attributes.iter().map(|a| a.width()).sum();
        assert_eq!(planes.channels(), width, "one plane a channel");
        Self { attributes, planes }
    }

    /// The attributes held, in the order of their planes.
    pub fn attributes(&self) -> &[Attribute] {
        &self.attributes
    }

    /// All planes, `[channels, height, width]`.
    pub const fn planes(&self) -> &Planes {
        &self.planes
    }

    /// Rows.
    pub const fn height(&self) -> usize {
        self.planes.height()
    }

    /// Columns.
    pub const fn width(&self) -> usize {
        self.planes.width()
    }

    /// Index of the first plane of an attribute.
    ///
    /// # Errors
    /// If the g-buffer does not hold it.
    pub fn first_plane(&self, attribute: Attribute) -> Result<usize, MissingAttribute> {
        let at = self.attributes.iter().position(|a| *a == attribute).ok_or_else(|| MissingAttribute {
            wanted: attribute.name().to_owned(),
            held: self.attributes.iter().map(|a| a.name()).collect::<Vec<_>>().join(", "),
        })?;
        Ok(self.attributes[..at].iter().map(|a| a.width()).sum())
    }

    /// Which pixels show a surface, row by row from the top left.
    ///
    /// # Errors
    /// If the g-buffer has no `valid`.
    pub fn seen(&self) -> Result<Vec<bool>, MissingAttribute> {
        let valid = self.planes.plane(self.first_plane(Attribute::Valid)?);
        Ok(valid.iter().map(|valid| shows_surface(*valid)).collect())
    }

    /// Distance in pixels, at depth 1, of two points one unit apart, as the positions have it: the one that
    /// fits best. 1 where they do not say.
    ///
    /// # Errors
    /// If the g-buffer has no positions or no `valid`.
    pub fn focal_length(&self) -> Result<f32, MissingAttribute> {
        let first = self.first_plane(Attribute::Position)?;
        let [x, y, z] = [0, 1, 2].map(|component| self.planes.plane(first + component));
        let (height, width) = (self.height(), self.width());
        // Least squares of pixels = focal length * slope over both axes, by the middles of pixels.
        let (mut squares, mut products) = (0.0f64, 0.0f64);
        for (index, seen) in self.seen()?.into_iter().enumerate() {
            let depth = -z[index];
            if !(seen && depth > 0.0 && depth.is_finite()) {
                continue;
            }
            let u = (index % width) as f32 + 0.5 - 0.5 * width as f32;
            let v = 0.5 * height as f32 - 0.5 - (index / width) as f32;
            for (pixels, slope) in [(u, x[index] / depth), (v, y[index] / depth)] {
                squares += f64::from(slope * slope);
                products += f64::from(slope * pixels);
            }
        }
        let found = (products / squares) as f32;
        Ok(if found.is_finite() && found > 0.0 { found } else { 1.0 })
    }

    /// The lens that `Blurriness`, which is `B (Ds - focus)`, is of: the radius in pixels of the circle of
    /// confusion of what is infinitely far away, and the distance in focus, metres, by least squares. None
    /// where all that is seen is at one depth or there is no such lens.
    ///
    /// # Errors
    /// If the g-buffer has no `Blurriness`, `Depth` or `valid`.
    pub fn blur_and_focus(&self) -> Result<Option<[f32; 2]>, MissingAttribute> {
        let of = self.select(&[Attribute::Depth, Attribute::Blurriness])?;
        let seen = self.seen()?;
        let is_finite = |pixel: usize| (0..2).all(|c| of.plane(c)[pixel].is_finite());
        let pixels = || (0..seen.len()).filter(|pixel| seen[*pixel] && is_finite(*pixel));
        let mean = |plane: usize| {
            let sum: f64 = pixels().map(|pixel| f64::from(of.plane(plane)[pixel])).sum();
            sum / pixels().count().max(1) as f64
        };
        let (depth, blurriness) = (mean(0), mean(1));
        let (mut squares, mut products) = (0.0f64, 0.0f64);
        for pixel in pixels() {
            let [off, blur] =
                [(0, depth), (1, blurriness)].map(|(c, mean)| f64::from(of.plane(c)[pixel]) - mean);
            squares += off * off;
            products += off * blur;
        }
        let blur = products / squares;
        let found = [blur, depth - blurriness / blur].map(|value| value as f32);
        Ok(Some(found).filter(|found| found.iter().all(|value| value.is_finite() && *value > 0.0)))
    }

    /// The g-buffer with these attributes, held before or not, whose planes `more` has one after the other.
    ///
    /// # Panics
    /// If the number of planes is not the sum of the attributes' widths, or the sizes differ.
    #[must_use]
    pub fn with(&self, attributes: &[Attribute], more: &[f32]) -> Self {
        let (mut kept, mut data) = (Vec::new(), Vec::with_capacity(self.planes.data().len() + more.len()));
        let mut first = 0;
        for attribute in &self.attributes {
            let planes = first..first + attribute.width();
            first = planes.end;
            if !attributes.contains(attribute) {
                kept.push(*attribute);
                planes.for_each(|plane| data.extend_from_slice(self.planes.plane(plane)));
            }
        }
        kept.extend_from_slice(attributes);
        data.extend_from_slice(more);
        let channels = kept.iter().map(|attribute| attribute.width()).sum();
        Self::new(kept, Planes::from_data(channels, self.height(), self.width(), data))
    }

    /// The planes of some attributes one after the other, `[sum of widths, height, width]`: what a network
    /// reads.
    ///
    /// # Errors
    /// If one of them is not there.
    pub fn select(&self, attributes: &[Attribute]) -> Result<Planes, MissingAttribute> {
        let mut data = Vec::new();
        let mut channels = 0;
        for attribute in attributes {
            let first = self.first_plane(*attribute)?;
            for plane in first..first + attribute.width() {
                data.extend_from_slice(self.planes.plane(plane));
            }
            channels += attribute.width();
        }
        Ok(Planes::from_data(channels, self.height(), self.width(), data))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn selection_is_in_the_order_asked_for() {
        let planes = Planes::from_fn(4, 1, 1, |c, _, _| c as f32);
        let gbuffer = GBuffer::new(vec![Attribute::Depth, Attribute::Normal], planes);
        let selected = gbuffer.select(&[Attribute::Normal, Attribute::Depth]).expect("both are there");
        assert_eq!(selected.data(), &[1.0, 2.0, 3.0, 0.0]);
    }

    #[test]
    fn the_focal_length_is_found_from_positions() {
        for (height, width, expected) in [(48, 64, 50.0), (31, 17, 400.0)] {
            let value = |c: usize, y: usize, x: usize| match c {
                0 => (x as f32 + 0.5 - 0.5 * width as f32) * 3.0 / expected,
                1 => (0.5 * height as f32 - 0.5 - y as f32) * 3.0 / expected,
                2 => -3.0,
                _ => f32::from(u8::from(2 * x < width)),
            };
            let attributes = vec![Attribute::Position, Attribute::Valid];
            let found = GBuffer::new(attributes, Planes::from_fn(4, height, width, value)).focal_length();
            assert!(found.is_ok_and(|found| (found / expected - 1.0).abs() < 1e-4), "{expected}");
        }
        let nothing = GBuffer::new(vec![Attribute::Position, Attribute::Valid], Planes::filled(4, 2, 2, 0.0));
        assert_eq!(nothing.focal_length(), Ok(1.0));
        let with = nothing.with(&[Attribute::Border], &[0.5; 4]);
        let border = |of: &GBuffer| of.select(&[Attribute::Border]).map(|border| border.data().to_vec());
        assert_eq!(border(&with), Ok(vec![0.5; 4]));
        let replaced = with.with(&[Attribute::Border], &[0.25; 4]);
        assert_eq!((border(&replaced), replaced.attributes().len()), (Ok(vec![0.25; 4]), 3));
    }

    #[test]
    fn a_lens_is_found_from_what_it_blurs() {
        let (blur, focus) = (12.0, 3.0);
        let frame = |depth: &dyn Fn(usize) -> f32, blur: f32| {
            let value = |c: usize, _: usize, x: usize| match c {
                0 => depth(x),
                1 => blur * (depth(x) - focus),
                _ => f32::from(u8::from(x < 5)),
            };
            let attributes = vec![Attribute::Depth, Attribute::Blurriness, Attribute::Valid];
            GBuffer::new(attributes, Planes::from_fn(3, 2, 6, value)).blur_and_focus().expect("all is there")
        };
        // The last but one is infinitely far away, the last shows nothing.
        let slope = |x: usize| [1.0, 2.0, 3.0, 4.0, f32::INFINITY, f32::NAN][x];
        let found = frame(&slope, blur).expect("a lens");
        assert!((found[0] - blur).abs() < 1e-4 && (found[1] - focus).abs() < 1e-4, "{found:?}");
        assert_eq!(frame(&|_| 2.0, blur), None, "all is at one depth");
        assert_eq!(frame(&slope, 0.0), None, "there is no lens");
    }

    #[test]
    fn a_surface_is_seen_where_most_of_the_pixel_is_valid() {
        let values = vec![0.0, 1.0, 0.49, 0.51, f32::NAN, -1.0];
        let gbuffer = GBuffer::new(vec![Attribute::Valid], Planes::from_data(1, 2, 3, values));
        assert_eq!(gbuffer.seen().expect("a mask"), [false, true, false, true, false, false]);
        let blind = GBuffer::new(vec![Attribute::Depth], Planes::filled(1, 1, 1, 1.0));
        assert!(blind.seen().is_err());
    }

    #[test]
    fn what_is_missing_is_named_with_what_is_there() {
        let gbuffer = GBuffer::new(vec![Attribute::Depth], Planes::filled(1, 1, 1, 0.0));
        let error = gbuffer.select(&[Attribute::Position]).expect_err("position is missing");
        assert_eq!(error.to_string(), "the g-buffer has no `position`; it holds depth");
    }
}
