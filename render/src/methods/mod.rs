//! The analytic methods, one folder each: `mod.rs` says what it is and which passes run on the GPU (of those
//! that march in random directions [`march`] does), `reference.rs` is the slow, plain version that the GPU is
//! checked against, pass by pass. What several share is in files beside them. [`all`] lists them.

pub mod aov;
pub mod blur;
pub mod bounced_z;
pub mod composed;
pub mod dials;
pub mod disks;
pub mod environment_map;
pub mod epipolar;
pub mod epipolar_sampling;
pub mod estimate;
pub mod fog_march;
pub mod froxel;
pub mod fxaa;
pub mod gather;
pub mod gpu_epipolar;
pub mod growing;
pub mod gtao;
pub mod hbao;
mod list;
pub mod lobe;
pub mod lpv;
pub mod march;
pub mod min_max;
pub mod occluded_gather;
pub mod occluded_prefiltered;
pub mod phosphor;
mod picture;
pub mod prefiltered;
pub mod ray_march;
pub mod reconstruction;
pub mod ring_gather;
pub mod screen_truth;
pub mod separable;
pub mod shafts;
pub mod single_scattering;
pub mod slices;
pub mod ssdo;
pub mod ssgi;
pub mod subsurface;
pub mod surfel;
mod translucent;
pub mod vectors;
pub mod volume_shell;

#[cfg(test)]
pub(crate) mod proving;

use crate::screen::{Written, surface};
use deepshade_shaders::Planes;
use deepshade_shaders::names::did_you_mean;

pub use list::{Entry, Opened, all};
pub use picture::LightImage;
pub use surface::Surface;
pub use translucent::Translucent;

/// Images as what passes write.
fn images<const COUNT: usize>(images: [Planes; COUNT]) -> Written {
    images.map(|image| image.data().to_vec()).into()
}

/// How much time a method may take for a better image. Each says in its `of` what that means to it.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, serde::Serialize, serde::Deserialize,
)]
#[serde(rename_all = "kebab-case")]
pub enum Quality {
    /// Fast.
    Low,
    /// Between.
    Medium,
    /// What its authors recommend, or what was found best on training scenes.
    #[default]
    High,
    /// Converged, as far as the method goes.
    Ultra,
}

impl Quality {
    /// All, the fastest first.
    pub const ALL: [Self; 4] = [Self::Low, Self::Medium, Self::High, Self::Ultra];

    /// Its name on the command line and in figures.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Low => "low",
            Self::Medium => "medium",
            Self::High => "high",
            Self::Ultra => "ultra",
        }
    }
}

impl std::str::FromStr for Quality {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        Self::ALL.into_iter().find(|quality| quality.name() == name).ok_or_else(|| {
            let known = Self::ALL.map(Self::name);
            format!("no quality `{name}`{}; there are {}", did_you_mean(name, known), known.join(", "))
        })
    }
}
