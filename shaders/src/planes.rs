//! A planar image `[channels, height, width]` of f32, the one image type of the project.

/// A planar image: channel after channel, each row by row from the top left.
#[derive(Clone, Debug, PartialEq)]
pub struct Planes {
    channels: usize,
    height: usize,
    width: usize,
    data: Vec<f32>,
}

impl Planes {
    /// An image of one value.
    pub fn filled(channels: usize, height: usize, width: usize, value: f32) -> Self {
        Self { channels, height, width, data: vec![value; channels * height * width] }
    }

    /// An image around `data`, `[channels, height, width]`.
    ///
    /// # Panics
    /// If the length of `data` is not the product of the three.
    pub fn from_data(channels: usize, height: usize, width: usize, data: Vec<f32>) -> Self {
        assert_eq!(
            data.len(),
            channels * height * width,
            "length of a [{channels}, {height}, {width}] image"
        );
        Self { channels, height, width, data }
    }

    /// An image of `channels` planes computed pixel by pixel: `value(channel, y, x)`.
    pub fn from_fn(
        channels: usize,
        height: usize,
        width: usize,
        mut value: impl FnMut(usize, usize, usize) -> f32,
    ) -> Self {
        let mut data = Vec::with_capacity(channels * height * width);
        for channel in 0..channels {
            for y in 0..height {
                data.extend((0..width).map(|x| value(channel, y, x)));
            }
        }
        Self { channels, height, width, data }
    }

    /// Number of planes.
    pub const fn channels(&self) -> usize {
        self.channels
    }

    /// Rows.
    pub const fn height(&self) -> usize {
        self.height
    }

    /// Columns.
    pub const fn width(&self) -> usize {
        self.width
    }

    /// Pixels of a plane.
    pub const fn pixels(&self) -> usize {
        self.height * self.width
    }

    /// Everything, `[channels, height, width]`.
    pub fn data(&self) -> &[f32] {
        &self.data
    }

    /// Everything, to be changed.
    pub fn data_mut(&mut self) -> &mut [f32] {
        &mut self.data
    }

    /// One plane, `[height, width]`.
    pub fn plane(&self, channel: usize) -> &[f32] {
        &self.data[channel * self.pixels()..][..self.pixels()]
    }

    /// One plane, to be changed.
    pub fn plane_mut(&mut self, channel: usize) -> &mut [f32] {
        let pixels = self.pixels();
        &mut self.data[channel * pixels..][..pixels]
    }

    /// The value at a pixel.
    pub fn at(&self, channel: usize, y: usize, x: usize) -> f32 {
        self.data[(channel * self.height + y) * self.width + x]
    }

    /// The window of `height` x `width` pixels whose top left pixel is (`y`, `x`).
    ///
    /// # Panics
    /// If the window reaches outside.
    pub fn window(&self, y: usize, x: usize, height: usize, width: usize) -> Self {
        assert!(y + height <= self.height && x + width <= self.width, "window inside the image");
        Self::from_fn(self.channels, height, width, |c, dy, dx| self.at(c, y + dy, x + dx))
    }

    /// What a function makes of every value.
    #[must_use]
    pub fn map(&self, value: impl Fn(f32) -> f32) -> Self {
        let data = self.data.iter().map(|old| value(*old)).collect();
        Self { data, ..*self }
    }

    /// The mean of all values.
    pub fn mean(&self) -> f64 {
        self.data.iter().map(|value| f64::from(*value)).sum::<f64>() / self.data.len() as f64
    }

    /// Whether another image has the same channels, height and width.
    pub const fn same_shape(&self, other: &Self) -> bool {
        self.channels == other.channels && self.height == other.height && self.width == other.width
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn window_keeps_channel_and_offset() {
        let image = Planes::from_fn(2, 4, 5, |c, y, x| (c * 100 + y * 10 + x) as f32);
        let window = image.window(1, 2, 2, 3);
        assert_eq!(window.at(1, 0, 0), 112.0);
        assert_eq!(window.at(0, 1, 2), 24.0);
        assert_eq!(window.plane(1), &[112.0, 113.0, 114.0, 122.0, 123.0, 124.0]);
    }
}
