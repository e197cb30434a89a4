//! What the passes read that are made of the finished picture.

use super::{Field, Layout};

uniforms! {
    /// What `methods/fxaa/luma` and `methods/fxaa/smooth` read.
    Fxaa {
        /// Columns of the image.
        width: u32,
        /// Rows of the image.
        height: u32,
        /// Steps of the search for an edge's end, at most 12.
        steps: u32,
        /// Contrast, as a share of the brightest luma around, below which there is no edge.
        contrast: f32,
        /// Contrast of luma below which there is no edge.
        least_contrast: f32,
        /// How much of what is smaller than a pixel is blurred, 0 to 1.
        subpixel: f32,
    }

    /// What the passes of `methods/ring_gather` read.
    RingGather {
        /// Columns of the image.
        width: u32,
        /// Rows of the image.
        height: u32,
        /// Pixels of the image along the edge of one that is gathered.
        scale: u32,
        /// Columns of what is gathered.
        low_width: u32,
        /// Rows of what is gathered.
        low_height: u32,
        /// Columns of tiles.
        tiles_wide: u32,
        /// Rows of tiles.
        tiles_high: u32,
        /// Tiles on either side whose circles may reach a tile.
        reach: i32,
        /// Most rings around a pixel.
        rings: u32,
        /// Radius of the circle of what is infinitely far away, pixels of the image.
        blur_at_infinity: f32,
        /// Radii beyond this are taken for this, pixels of the image.
        largest: f32,
        /// Circles up to this radius are points, pixels of the image.
        sharp: f32,
        /// Circles from this radius on are gathered and nothing else, pixels of the image.
        blurred: f32,
        /// How much nearer in radius one is that is fully in front, pixels of the image.
        softness: f32,
    }

    /// What the passes of `methods/reconstruction` read.
    Reconstruction {
        /// Columns of the image.
        width: u32,
        /// Rows of the image.
        height: u32,
        /// Edge of a tile, pixels.
        tile: u32,
        /// Columns of tiles.
        tiles_wide: u32,
        /// Rows of tiles.
        tiles_high: u32,
        /// Tiles on either side whose movements may reach a tile.
        reach: i32,
        /// Samples along a line.
        samples: u32,
        /// Chooses the random numbers.
        seed: u32,
        /// Longest half of a movement, pixels.
        longest: f32,
        /// How much nearer, as a share of the depth, what is fully in front.
        depth_extent: f32,
    }

    /// What `methods/separable/blur` reads.
    Separable {
        /// Columns of the image.
        width: u32,
        /// Rows of the image.
        height: u32,
        /// 1 to blur along rows, else 0.
        step_x: i32,
        /// 1 to blur along columns, else 0.
        step_y: i32,
        /// Taps on one side, the middle among them.
        taps: u32,
        /// Distance in pixels, at depth 1, of two points one unit apart.
        focal_length: f32,
        /// The exponent of what is a mean free path farther away in space than on the screen.
        follow: f32,
    }

    /// What the passes of `methods/gather` read.
    Gather {
        /// Columns of the image.
        width: u32,
        /// Rows of the image.
        height: u32,
        /// Samples of each colour of a pixel.
        samples: u32,
        /// Chooses the random numbers.
        seed: u32,
        /// Distance in pixels, at depth 1, of two points one unit apart.
        focal_length: f32,
    }
}
