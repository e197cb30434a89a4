//! A file's g-buffer as a network reads it, or why it cannot be.

use super::contract::{Contradiction, contradictions};
use super::space;
use crate::learned;
use anyhow::{Result, bail};
use deepshade_infer::NetSpec;
use deepshade_render::exr_file::{self, ExrError, ExrImage, Windows};
use deepshade_shaders::{Attribute, GBuffer, Planes};
use std::path::Path;

/// A file that was read.
pub struct Read {
    /// What the network's inputs are made of, and validity.
    pub gbuffer: GBuffer,
    /// Where its pixels lie.
    pub windows: Windows,
    /// All else that the file says.
    pub file: ExrImage,
}

/// What of a file is asked for.
pub struct Wanted<'a> {
    /// Which file.
    pub path: &'a Path,
    /// Which of its layers, where it has several.
    pub layer: Option<&'a str>,
    /// How it is to be taken.
    pub space: &'a space::Args,
    /// Whether it is taken though it contradicts what it should be.
    pub trusted: bool,
}

/// Reads a g-buffer and brings it to what the network reads.
///
/// # Errors
/// If the file cannot be read, lacks something, or holds what is no g-buffer as the options have it.
pub fn read(wanted: &Wanted<'_>, spec: &NetSpec) -> Result<Read> {
    let mut attributes = learned::reads(spec)?;
    attributes.retain(|attribute| *attribute != Attribute::Valid || spec.inputs.contains(attribute));
    // Depth that the network does not read tells whether positions are right.
    let asked_for = [&attributes[..], &[Attribute::Valid, Attribute::Depth]].concat();
    let file = exr_file::read_gbuffer(wanted.path, &asked_for, wanted.layer).map_err(with_option)?;
    if !attributes.contains(&Attribute::Valid) && file.attributes().contains(&Attribute::Valid) {
        attributes.push(Attribute::Valid);
    }
    let gbuffer = file.gbuffer(&attributes).map_err(with_option)?;
    let windows = file.windows(&attributes)?;
    let gbuffer = wanted.space.with_signed_normals(gbuffer);
    let gbuffer = if attributes.contains(&Attribute::Valid) { gbuffer } else { with_validity(gbuffer) };
    let with_depth = with_depth(&gbuffer, &file, &attributes, &windows);
    let converted = wanted.space.converted(with_depth, file.world_to_camera())?;
    let gbuffer = without_depth(&converted, gbuffer.attributes())?;
    if !wanted.trusted {
        judge(&contradictions(&converted)?, gbuffer.attributes(), wanted.path)?;
    }
    Ok(Read { gbuffer, windows, file })
}

/// An error with the option that mends it.
fn with_option(error: ExrError) -> anyhow::Error {
    match error {
        ExrError::Ambiguous { .. } => {
            anyhow::anyhow!("{error}; --layer NAME chooses, by the part of the names that differs")
        }
        other => other.into(),
    }
}

/// The g-buffer with a plane `valid`: 1 where any of its channels is not 0.
fn with_validity(gbuffer: GBuffer) -> GBuffer {
    let planes = gbuffer.planes();
    let seen = |pixel: usize| (0..planes.channels()).any(|c| planes.plane(c)[pixel] != 0.0);
    let valid: Vec<f32> = (0..planes.pixels()).map(|pixel| if seen(pixel) { 1.0 } else { 0.0 }).collect();
    gbuffer.with(&[Attribute::Valid], &valid)
}

/// The g-buffer with the file's depth, if that is there, is of the same pixels and is not read anyway.
fn with_depth(gbuffer: &GBuffer, file: &ExrImage, attributes: &[Attribute], windows: &Windows) -> GBuffer {
    let is_of_these = file.windows(&[Attribute::Depth]).is_ok_and(|depth| depth.data == windows.data);
    let has_positions = attributes.contains(&Attribute::Position);
    if attributes.contains(&Attribute::Depth) || !is_of_these || !has_positions {
        return gbuffer.clone();
    }
    let depth: Option<Planes> = file.gbuffer(&[Attribute::Depth]).ok().map(|depth| depth.planes().clone());
    depth.map_or_else(|| gbuffer.clone(), |depth| gbuffer.with(&[Attribute::Depth], depth.data()))
}

/// Some attributes of a g-buffer.
fn without_depth(gbuffer: &GBuffer, attributes: &[Attribute]) -> Result<GBuffer> {
    Ok(GBuffer::new(attributes.to_vec(), gbuffer.select(attributes)?))
}

/// Refuses a g-buffer for what cannot be right in it, and warns of what may not be.
fn judge(found: &[Contradiction], read: &[Attribute], path: &Path) -> Result<()> {
    // A depth that nobody reads does no harm, whatever it is.
    let matters =
        |one: &Contradiction| !matches!(one, Contradiction::Depth(..)) || read.contains(&Attribute::Depth);
    let (grave, light): (Vec<&Contradiction>, Vec<&Contradiction>) =
        found.iter().partition(|one| one.is_grave() && matters(one));
    for one in light {
        note!("warning: {}: {one}", path.display());
    }
    if grave.is_empty() {
        return Ok(());
    }
    let reasons: Vec<String> = grave.iter().map(|one| format!("\n  {one}")).collect();
    bail!(
        "{}: not a g-buffer in camera space, y up, the camera looking down -z, with unit normals that face \
         it:{}\n\
         the options in brackets mend that; --trusted takes the file as it is",
        path.display(),
        reasons.concat()
    )
}
