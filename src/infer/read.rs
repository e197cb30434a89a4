//! A file's g-buffer as a network reads it, or why it cannot be.

use super::contract::{Contradiction, contradictions};
use super::{sky, space};
use crate::learned;
use anyhow::{Result, bail};
use deepshade_infer::NetSpec;
use deepshade_render::exr_file::{self, ExrError, ExrImage, Windows};
use deepshade_shaders::{Attribute, GBuffer};
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
pub struct ReadRequest<'a> {
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
pub fn read(wanted: &ReadRequest<'_>, spec: &NetSpec) -> Result<Read> {
    let mut attributes = learned::reads(spec)?;
    attributes.retain(|attribute| *attribute != Attribute::Valid || spec.inputs.contains(attribute));
    wanted.space.check_use(&attributes)?;
    let for_check = for_check(&attributes);
    let estimates = learned::estimated(spec)?;
    let asked_for = [&attributes[..], &[Attribute::Valid], &for_check, &estimates.concat()].concat();
    let file = exr_file::read_gbuffer(wanted.path, &asked_for, wanted.layer).map_err(with_option)?;
    let held = |made: &&&[Attribute]| made.iter().all(|made| file.has(*made));
    attributes.extend(estimates.iter().filter(held).copied().flatten());
    if !attributes.contains(&Attribute::Valid) && file.has(Attribute::Valid) {
        attributes.push(Attribute::Valid);
    }
    let windows = file.windows(&attributes).map_err(with_option)?;
    let usable = for_check.into_iter().filter(|other| is_usable(&file, &attributes, *other, &windows));
    let all = [&attributes[..], &usable.collect::<Vec<_>>()].concat();
    let gbuffer = wanted.space.with_signs(file.gbuffer(&all).map_err(with_option)?);
    let gbuffer = with_validity(gbuffer, &attributes);
    if !attributes.contains(&Attribute::Valid) {
        attributes.push(Attribute::Valid);
    }
    let gbuffer = sky::without_normals_of_no_length(gbuffer, &attributes)?;
    let gbuffer = if wanted.trusted { gbuffer } else { without_sky(gbuffer, wanted)? };
    let converted = wanted.space.converted(gbuffer, file.world_to_camera())?;
    if !wanted.trusted {
        refuse_contradictions(&contradictions(&converted, &attributes)?, &attributes, wanted.path)?;
    }
    let gbuffer = GBuffer::new(attributes.clone(), converted.select(&attributes)?);
    Ok(Read { gbuffer, windows, file })
}

/// What the network does not read and tells, where a file has it, whether what it reads is right, or where
/// nothing is seen.
fn for_check(attributes: &[Attribute]) -> Vec<Attribute> {
    let reads = |attribute: Attribute| attributes.contains(&attribute);
    let checks = [
        (Attribute::Depth, true),
        (Attribute::Position, reads(Attribute::Normal) || reads(Attribute::Depth)),
        (Attribute::Normal, reads(Attribute::WorldNormal)),
    ];
    let others = checks.into_iter().filter(|(attribute, tells)| *tells && !reads(*attribute));
    others.map(|(attribute, _)| attribute).collect()
}

/// Whether a file has something for a check alone that can be read, is of the same pixels, and does not say
/// of all of them that nothing is seen.
fn is_usable(file: &ExrImage, attributes: &[Attribute], other: Attribute, windows: &Windows) -> bool {
    let both = [attributes, &[other]].concat();
    file.windows(&both).is_ok_and(|both| both.data == windows.data)
        && file.gbuffer(&[other]).is_ok_and(|other| other.planes().data().iter().any(|value| *value != 0.0))
}

/// The g-buffer without what stands for the sky in it, of which a note is made.
fn without_sky(gbuffer: GBuffer, wanted: &ReadRequest<'_>) -> Result<GBuffer> {
    let (gbuffer, skies) = sky::without_sky(gbuffer, wanted.space.sign_before())?;
    for sky in skies {
        note!("{}: {sky}; --trusted takes it for a surface", wanted.path.display());
    }
    Ok(gbuffer)
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

/// The g-buffer with a plane `valid`, if it has none: 1 where any of the channels that the network reads is
/// not 0.
fn with_validity(gbuffer: GBuffer, read: &[Attribute]) -> GBuffer {
    if read.contains(&Attribute::Valid) {
        return gbuffer;
    }
    let planes = gbuffer.planes();
    // What is read comes first.
    let channels: usize = read.iter().map(|attribute| attribute.width()).sum();
    let seen = |pixel: usize| (0..channels).any(|c| planes.plane(c)[pixel] != 0.0);
    let valid: Vec<f32> = (0..planes.pixels()).map(|pixel| if seen(pixel) { 1.0 } else { 0.0 }).collect();
    gbuffer.with(&[Attribute::Valid], &valid)
}

/// Refuses a g-buffer for what cannot be right in it, and warns of what may not be.
fn refuse_contradictions(found: &[Contradiction], read: &[Attribute], path: &Path) -> Result<()> {
    let (grave, light): (Vec<&Contradiction>, Vec<&Contradiction>) =
        found.iter().partition(|one| one.is_grave(read));
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
