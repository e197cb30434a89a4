//! What the passes of indirect light and of light from the environment read.

use super::{Field, Layout};

uniforms! {
    /// What `methods/prefiltered/shade` reads.
    Prefiltered {
        /// Columns of the image.
        width: u32,
        /// Rows of the image.
        height: u32,
    }
}
