//! How far an effect reaches in a g-buffer: as the file states, or else by what is seen.

use crate::arguments::positive;
use crate::radius::{self, Space};
use anyhow::{Context, Result, anyhow, ensure};
use deepshade_infer::NetSpec;
use deepshade_render::exr_file::ExrImage;
use deepshade_render::scene::Bounds;
use deepshade_shaders::{Attribute, GBuffer};
use glam::Vec3;

/// A stated radius below this share of what is seen looks like one in another unit than the positions.
const LEAST_SHARE: f32 = 0.0005;

/// The radius that the file states, or else the network's share of the diagonal of what is seen, metres.
///
/// # Errors
/// If what the file states is no radius, or what is seen has no size.
pub fn default_radius(file: &ExrImage, gbuffer: &GBuffer, spec: &NetSpec) -> Result<f32> {
    if let Some(radius) = file.metadata().get("radius_metres") {
        return positive(radius.trim()).map_err(|what| anyhow!("attribute `radius_metres`: {what}"));
    }
    let diagonal = visible_diagonal(gbuffer)
        .context("no radius is stated and no positions tell the size; use --radius")?;
    ensure!(
        diagonal > 0.0 && diagonal.is_finite(),
        "no radius is stated and what is seen has a diagonal of {diagonal} m; use --radius"
    );
    let space = Space { diagonal, depth: median_depth(gbuffer)? };
    Ok(radius::wanted(None, Some(spec.reach), &[spec.effect], space))
}

/// What is to be said of a radius that is tiny beside what is seen: the two may be in different units.
pub fn doubt(gbuffer: &GBuffer, radius: f32) -> Option<String> {
    let diagonal = visible_diagonal(gbuffer).ok()?;
    (radius < LEAST_SHARE * diagonal).then(|| {
        format!(
            "warning: what is seen is {diagonal} m across, the radius {radius} m. Are positions in another \
             unit? --metres-per-unit states it"
        )
    })
}

/// Diagonal of the bounds of all visible positions, metres.
fn visible_diagonal(gbuffer: &GBuffer) -> Result<f32> {
    let planes = gbuffer.select(&[Attribute::Position])?;
    let seen = gbuffer.seen()?;
    let seen = (0..planes.pixels()).filter(|pixel| seen[*pixel]);
    let position = |pixel| Vec3::from_array([0, 1, 2].map(|c| planes.plane(c)[pixel]));
    let bounds = seen.map(position).fold(Bounds::EMPTY, Bounds::grow);
    ensure!(bounds != Bounds::EMPTY, "no surface is seen");
    Ok(bounds.diagonal())
}

/// Median depth of what is seen, metres; none where nothing is in front of the camera.
fn median_depth(gbuffer: &GBuffer) -> Result<Option<f32>> {
    let planes = gbuffer.select(&[Attribute::Position])?;
    let seen = gbuffer.seen()?;
    let in_front = planes.plane(2).iter().zip(&seen).filter(|(z, seen)| **seen && **z < 0.0);
    let mut depths: Vec<f32> = in_front.map(|(z, _)| -z).collect();
    depths.sort_unstable_by(f32::total_cmp);
    Ok(depths.get(depths.len() / 2).copied())
}
