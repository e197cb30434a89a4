//! The sizes of a convolution on the CPU, and how its work is cut into stripes of rows of one group of one
//! image. The cut depends on the shapes only, never on the number of threads.

/// Rows in memory are padded to a multiple of this, so that no vector reaches beyond them.
const VECTOR: usize = 16;
/// Numbers that a stripe may read: they stay in the second-level cache.
const ROOM: usize = 256 * 1024;
/// Fewest and most rows of a stripe; even, as doubling and pooling are.
const ROWS: [usize; 2] = [4, 32];

/// The sizes of a convolution that keeps height and width (stride 1, zero padding, odd kernel).
#[derive(Clone, Copy, Debug)]
pub struct ConvShape {
    /// Number of images.
    pub batch: usize,
    /// Number of groups.
    pub groups: usize,
    /// Channels that a group reads.
    pub inputs: usize,
    /// Channels that a group makes.
    pub outputs: usize,
    /// Rows.
    pub height: usize,
    /// Columns.
    pub width: usize,
    /// Width and height of the kernel.
    pub kernel: usize,
}

impl ConvShape {
    /// Weights of a group.
    pub const fn group_weights(&self) -> usize {
        self.outputs * self.inputs * self.kernel * self.kernel
    }

    /// Numbers of what is made, `[batch, groups * outputs, height, width]`.
    pub const fn made(&self) -> usize {
        self.batch * self.groups * self.outputs * self.height * self.width
    }

    /// Length of a row in a stripe's buffer: the width rounded up to whole vectors, and the border.
    pub const fn stride(&self) -> usize {
        self.width.next_multiple_of(VECTOR) + 2 * (self.kernel / 2)
    }

    /// Rows of a stripe.
    pub fn stripe_rows(&self) -> usize {
        let row = self.inputs.max(self.outputs) * self.stride();
        let fitting = (ROOM / row).saturating_sub(self.kernel - 1) / 2 * 2;
        fitting.clamp(ROWS[0], ROWS[1])
    }

    /// The stripes of the work, without anything to write to.
    pub fn stripes<'a>(&self) -> Vec<Stripe<'a>> {
        let rows = self.stripe_rows();
        let tops = (0..self.height).step_by(rows);
        (0..self.batch * self.groups)
            .flat_map(|part| tops.clone().map(move |top| (part, top)))
            .map(|(part, top)| Stripe { part, top, rows: rows.min(self.height - top), planes: Vec::new() })
            .collect()
    }

    /// Distributes the rows of images `[batch, positions, height, width] * scale` among stripes whose groups
    /// have so many channels: `positions` says for each channel of an image which one of all groups' it is.
    pub fn distribute<'a>(
        &self,
        stripes: &mut [Stripe<'a>],
        channels: usize,
        image: &'a mut [f32],
        positions: &[usize],
        scale: Scale,
    ) {
        let rows = self.stripe_rows();
        let count = self.height.div_ceil(rows);
        stripes.iter_mut().for_each(|stripe| stripe.planes.resize_with(channels, Default::default));
        for (at, plane) in image.chunks_exact_mut(scale.area(self.height * self.width)).enumerate() {
            let (image, position) = (at / positions.len(), positions[at % positions.len()]);
            let first = (image * self.groups + position / channels) * count;
            for (stripe, rows) in
                stripes[first..].iter_mut().zip(plane.chunks_mut(scale.area(rows * self.width)))
            {
                stripe.planes[position % channels] = rows;
            }
        }
    }
}

/// The size of an image beside the frame of a convolution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Half as high and wide.
    Half,
    /// The same.
    Same,
    /// Twice as high and wide.
    Double,
}

impl Scale {
    /// Pixels of the image where the frame has `pixels`.
    pub const fn area(self, pixels: usize) -> usize {
        match self {
            Self::Half => pixels / 4,
            Self::Same => pixels,
            Self::Double => 4 * pixels,
        }
    }
}

/// A stripe of rows of one group of one image.
#[derive(Debug)]
pub struct Stripe<'a> {
    /// `image * groups + group`.
    pub part: usize,
    /// Its first row.
    pub top: usize,
    /// Its rows.
    pub rows: usize,
    /// Where the rows that it makes go, a slice a channel.
    pub planes: Vec<&'a mut [f32]>,
}
