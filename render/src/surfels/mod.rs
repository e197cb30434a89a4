//! Deep screen space: a scene as disks that all look equally large to the camera. There are disks of what it
//! does not see, too.
//!
//! Nalbach, Ritschel and Seidel, "Deep Screen Space", I3D 2014 (thesis 4.2.1). Surfels are to surfaces what
//! pixels are to an image: near ones are small and far ones large, but those behind others, behind the camera
//! and seen from their edge are there too, so that shading by them misses nothing.
//!
//! - [`patches`](crate::raster::patches) are the parts of a scene's surface, cut once.
//! - [`vertices`] moves a scene's vertices to camera space.
//! - [`cloud`] lays [surfels](Surfel) out on them, each frame, on the GPU, and puts a tree over them;
//!   [`light`] lights them, or lets them give back light that they kept.
//! - [`frame`] has all of these passes in order, with what they read.
//! - [`reference`](mod@reference) is the slow, plain version.
//!
//! Unlike the paper's, no tessellation hardware is needed and no surfel is made that is thrown away. Disks
//! outside of what is seen are larger. Surfels neither jump nor pop up when the camera moves, as each stays
//! where it is and grows, in all frames at the same place.
//!
//! Limits. Where more than [`MOST`] are wanted, which of them stand for all changes with their number.
//! Surfels have the normals of their triangles, not those that smooth meshes are shaded with. Lamps light
//! them; emissive triangles and the environment do not, though surfels may send what they emit.

pub mod cloud;
pub mod frame;
mod kept;
pub mod light;
pub mod reference;
mod surfel;
#[cfg(test)]
mod tests;
pub mod vertices;

pub use cloud::{Cloud, Tree};
pub use light::SurfelLight;
pub use surfel::Surfel;

use crate::screen::View;
use deepshade_shaders::wgsl::uniforms;

/// Surfels below a leaf of the tree.
pub const LEAF: usize = 16;
/// Levels of the tree above its leaves; each node has four children.
pub const HEIGHT: u32 = 8;
/// Most surfels of a frame. Where more are wanted each stands for more area.
pub const MOST: usize = LEAF << (2 * HEIGHT);

/// How finely a scene is laid out.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
pub struct SurfelDensity {
    /// The papers' s: radius of a surfel over half the height of what is seen at its distance.
    #[schemars(range(min = 0.002, max = 0.5))]
    pub scale: f32,
    /// Distance from the camera below which surfels get no smaller, over the effect's radius.
    #[schemars(range(min = 0.0, max = 4.0), extend("unit" = "radii"))]
    pub near: f32,
}

impl SurfelDensity {
    /// What the passes read.
    pub fn settings(&self, view: &View) -> uniforms::Surfels {
        let [slope_x, slope_y] =
            [view.width, view.height].map(|edge| 2.0 * view.focal_length() / edge as f32);
        uniforms::Surfels {
            slope_x,
            slope_y,
            slope: self.scale * (0.5 * view.camera.vertical_fov).tan(),
            near: self.near * view.radius,
            reach: view.radius,
        }
    }
}
