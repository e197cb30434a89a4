//! Regressors without depth, which the thesis holds against deep networks (7.5.5): each predicts a pixel from the patch
//! around it, and is swept across the image. They read what a network reads ([`NetSpec::input`](deepshade_infer::NetSpec::input))
//! and learn the mean squared difference.

pub mod forest;
pub mod mlp;
mod patches;

pub use forest::Forest;
pub use mlp::Mlp;
pub use patches::Frames;
