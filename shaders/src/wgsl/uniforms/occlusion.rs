//! What the passes of ambient and directional occlusion read.

use super::{Field, Layout};

uniforms! {
    /// What `methods/hbao/occlusion` reads.
    Hbao {
        /// Columns of the image.
        width: u32,
        /// Rows of the image.
        height: u32,
        /// Directions that are marched.
        directions: u32,
        /// Most samples of a direction.
        steps: u32,
        /// Chooses the random numbers.
        seed: u32,
        /// Radius within which a sample can occlude, metres.
        radius: f32,
        /// Distance in pixels, at depth 1, of two points one unit apart.
        focal_length: f32,
        /// Sine of the angle bias.
        bias_sine: f32,
        /// Cosine of the angle bias.
        bias_cosine: f32,
        /// Factor of the occlusion.
        strength: f32,
    }

    /// What `methods/blur/smooth` reads.
    Blur {
        /// Columns of the image.
        width: u32,
        /// Rows of the image.
        height: u32,
        /// 1 to blur along rows, else 0.
        step_x: i32,
        /// 1 to blur along columns, else 0.
        step_y: i32,
        /// Pixels on either side that are blurred together.
        radius: i32,
        /// The Gaussian's exponent of a distance of one pixel.
        falloff: f32,
        /// Factor, one over metres, of a distance from the tangent plane before it is squared into the exponent.
        sharpness: f32,
        /// Value where no surface is seen.
        background: f32,
    }
    /// What `shared/slices` reads.
    Slices {
        /// Columns of the image.
        width: u32,
        /// Rows of the image.
        height: u32,
        /// Slices of a pixel.
        slices: u32,
        /// Most samples on either side of a slice.
        steps: u32,
        /// Chooses the random numbers.
        seed: u32,
        /// Radius within which a sample counts, metres.
        radius: f32,
        /// How thick everything is taken to be, metres.
        thickness: f32,
        /// Distance in pixels, at depth 1, of two points one unit apart.
        focal_length: f32,
    }
    /// What `methods/ssdo/light` reads.
    Ssdo {
        /// Columns of the image.
        width: u32,
        /// Rows of the image.
        height: u32,
        /// Directions of a pixel.
        directions: u32,
        /// Points along each.
        steps: u32,
        /// Chooses the random numbers.
        seed: u32,
        /// Radius up to which directions are marched, metres.
        radius: f32,
        /// How thick everything is taken to be, metres.
        thickness: f32,
        /// Distance in pixels, at depth 1, of two points one unit apart.
        focal_length: f32,
        /// Rows of the environment's map.
        environment_height: u32,
        /// The camera's x axis in world space, and so on.
        right_x: f32,
        /// Its y.
        right_y: f32,
        /// Its z.
        right_z: f32,
        /// The camera's y axis.
        up_x: f32,
        /// Its y.
        up_y: f32,
        /// Its z.
        up_z: f32,
        /// The camera's z axis, against the view.
        back_x: f32,
        /// Its y.
        back_y: f32,
        /// Its z.
        back_z: f32,
    }
}
