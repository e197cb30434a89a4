//! `deepshade-studies embree`: rays a second through a scene beside Embree on the very same rays, traversal
//! alone.
//!
//! Embree traces single rays (`rtcIntersect1`, `rtcOccluded1`), and `ratio_primary`, `ratio_ao` and
//! `ratio_diffuse` are of our single rays. Rays that the program traces in bundles are measured so too, and
//! called so; Embree's packets and streams, their counterpart, are not.

mod library;

use anyhow::Result;
use deepshade::shared::rays;
use library::Embree;

/// Measures rays a second through a scene beside Embree 3, which is loaded at run time.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  deepshade-studies embree --scene sponza.gltf --json rays.json\n\n\
    On Debian 12 `apt-get install libembree-dev` brings Embree 3.\n\n\
    ratio_primary, ratio_ao and ratio_diffuse in the JSON file are our rate over Embree's, single rays \
    against single rays (rtcIntersect1, rtcOccluded1), one thread. ratio_*_bundles are bundles of 64 rays \
    that start together against Embree's single rays; Embree's packets are not measured.")]
pub struct Args {
    #[command(flatten)]
    rays: rays::Args,
}

/// Measures and prints.
///
/// # Errors
/// If the scene cannot be read, nothing of it is seen, or there is no Embree 3.
pub fn run(args: &Args) -> Result<()> {
    rays::run_beside(&args.rays, "embree", &|scene| Ok(Box::new(Embree::new(scene)?)))
}
