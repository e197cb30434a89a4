//! Shadow maps: depths seen from the lights. Spots have one map, points and wide spots the six faces of a
//! cube, directional lights four cascades, each a slice of what the camera sees (Engel 2006; Zhang et al.
//! 2006, "Parallel-Split Shadow Maps"), moved by whole texels so that shadows do not crawl.
//!
//! All maps are layers of one texture. Where there are more lights than layers, the strongest have maps
//! first, and then those whose maps still fit: some of the fainter lights cast no shadow.

mod pass;
mod plan;

pub use pass::ShadowPass;
pub use plan::{CASCADES, CameraView, MapPlan, views};
