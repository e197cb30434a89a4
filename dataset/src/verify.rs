//! Checking a dataset: every file is the one that was written, and what it holds makes sense.

use crate::manifest::MANIFEST;
use crate::origin::recipe_hash;
use crate::recipe::file_hash;
use crate::shard::merge::list_fault;
use crate::{Dataset, DatasetError, Manifest, Pair, SceneOrCapture, Shard, progress};
use deepshade_render::scene::SceneSource;
use deepshade_shaders::{Attribute, Effect, GBuffer};
use glam::Vec3;
use rayon::prelude::*;
use serde::Serialize;
use std::collections::HashSet;
use std::f32::consts::PI;
use std::path::Path;

/// Half floats round the components of a unit vector by up to 2.5e-4 each.
const UNIT_TOLERANCE: f32 = 1e-3;

/// Something wrong with a file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Fault {
    /// Which file, relative to the dataset's folder.
    pub file: String,
    /// What is wrong.
    pub what: String,
}

/// The outcome of a check.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Report {
    /// Pairs that the manifest, or a shard's list, has.
    pub pairs: usize,
    /// What is wrong, in the manifest's order; empty for a sound dataset.
    pub faults: Vec<Fault>,
}

/// Checks all files of a dataset against its manifest, and their contents; those of a shard against its list.
///
/// # Errors
/// If the manifest or the list cannot be read; faults of other files are in the report.
pub fn verify(folder: &Path) -> Result<Report, DatasetError> {
    let shard = Shard::in_folder(folder);
    let dataset = match shard {
        Some(shard) => Dataset::open_shard(folder, shard)?,
        None => Dataset::open(folder)?,
    };
    let bar = progress::bar("pairs checked", dataset.len(), 0);
    let check = |index: usize| {
        let fault = pair_fault(&dataset, index).map(|what| (dataset.record(index).file.clone(), what));
        bar.inc(1);
        fault
    };
    let mut faults: Vec<(String, String)> = match shard {
        Some(shard) => list_fault(folder).into_iter().map(|what| (shard.file_name(), what)).collect(),
        None => manifest_faults(&dataset),
    };
    faults.extend((0..dataset.len()).into_par_iter().filter_map(check).collect::<Vec<_>>());
    bar.finish_and_clear();
    let faults = faults.into_iter().map(|(file, what)| Fault { file, what }).collect();
    Ok(Report { pairs: dataset.len(), faults })
}

/// Faults of the manifest itself: a changed recipe, pairs listed twice or too few of them, files that it does
/// not list.
fn manifest_faults(dataset: &Dataset) -> Vec<(String, String)> {
    let manifest = dataset.manifest();
    let fault = |what: String| (MANIFEST.to_owned(), what);
    let mut faults = Vec::new();
    if stated_recipe_hash(manifest).as_ref() != Some(&manifest.origin.recipe_hash) {
        faults.push(fault("the recipe does not have the hash that is stated".to_owned()));
    }
    let recipe = &manifest.origin.recipe;
    let expected = recipe.scene_count().saturating_mul(recipe.views_per_scene);
    if expected != manifest.pairs.len() {
        faults
            .push(fault(format!("{} pairs listed where the recipe makes {expected}", manifest.pairs.len())));
    }
    let mut listed = HashSet::new();
    let twice = manifest.pairs.iter().filter(|pair| !listed.insert(pair.file.clone()));
    faults.extend(twice.map(|pair| fault(format!("lists {} twice", pair.file))));
    for folder in
        manifest.pairs.iter().filter_map(|pair| Path::new(&pair.file).parent()).collect::<HashSet<_>>()
    {
        let entries = std::fs::read_dir(dataset.folder().join(folder)).into_iter().flatten().flatten();
        let names =
            entries.map(|entry| format!("{}/{}", folder.display(), entry.file_name().to_string_lossy()));
        let mut strangers: Vec<String> = names.filter(|name| !listed.contains(name)).collect();
        strangers.sort();
        faults.extend(strangers.into_iter().map(|name| (name, "the manifest does not list it".to_owned())));
    }
    faults
}

/// The hash of the recipe with the scene files and captures that the pairs say they are of, and the other
/// files as stated.
fn stated_recipe_hash(manifest: &Manifest) -> Option<String> {
    let recipe = &manifest.origin.recipe;
    let stated = |source: SceneOrCapture| {
        manifest.pairs.iter().find(|pair| pair.scene.source == source)?.scene.blake3.as_deref()
    };
    let files = recipe.files.iter().map(|file| SceneOrCapture::Scene(SceneSource::File(file.clone())));
    let captures = recipe.captures.iter().map(|folder| SceneOrCapture::Capture(folder.clone()));
    let props = manifest.origin.props.values().map(String::as_str);
    recipe_hash(recipe, files.chain(captures).filter_map(stated).chain(props)).ok()
}

/// What is wrong with a pair, if something is.
fn pair_fault(dataset: &Dataset, index: usize) -> Option<String> {
    let record = dataset.record(index);
    match file_hash(&dataset.folder().join(&record.file)) {
        Err(error) => return Some(error.to_string()),
        Ok(hash) if hash != record.blake3 => {
            return Some(format!("its hash is {hash}, not {}", record.blake3));
        }
        Ok(_) => {}
    }
    match dataset.pair(index) {
        Err(error) => Some(error.to_string()),
        Ok(pair) => content_fault(&pair, dataset.recipe().effect),
    }
}

/// What in a pair's pixels makes no sense.
fn content_fault(pair: &Pair, effect: Effect) -> Option<String> {
    let Pair { gbuffer, target, variance, radius } = pair;
    if !(radius.is_finite() && *radius > 0.0) {
        return Some(format!("radius {radius}"));
    }
    if let Some(value) = target.data().iter().find(|value| !in_range(**value, effect)) {
        return Some(format!("a target of {value}"));
    }
    let is_variance = |value: f32| value.is_finite() && value >= 0.0;
    let mut variances = variance.iter().flat_map(|variance| variance.data());
    if let Some(value) = variances.find(|value| !is_variance(**value)) {
        return Some(format!("a variance of {value}"));
    }
    let Some(valid) = plane(gbuffer, Attribute::Valid) else { return Some("no validity mask".to_owned()) };
    if valid.iter().all(|value| *value == 0.0) {
        return Some("no surface is seen".to_owned());
    }
    for (pixel, seen) in valid.iter().enumerate() {
        let at = || format!("at pixel {}, {}", pixel % gbuffer.width(), pixel / gbuffer.width());
        if *seen != 0.0 && *seen != 1.0 {
            return Some(format!("a validity of {seen} {}", at()));
        }
        let background = effect.background().filter(|_| *seen == 0.0);
        if let Some(background) = background
            && let Some(value) =
                (0..target.channels()).map(|c| target.plane(c)[pixel]).find(|value| *value != background)
        {
            return Some(format!("a target of {value} where nothing is seen, {}", at()));
        }
        if *seen == 0.0 && (0..gbuffer.planes().channels()).any(|c| gbuffer.planes().plane(c)[pixel] != 0.0) {
            return Some(format!("values where nothing is seen, {}", at()));
        }
        if *seen == 1.0
            && let Some(what) = surface_fault(gbuffer, pixel)
        {
            return Some(format!("{what} {}", at()));
        }
    }
    None
}

/// Whether an effect can have a value.
const fn in_range(value: f32, effect: Effect) -> bool {
    let [least, most] = effect.range();
    value >= least && value <= most && value.is_finite()
}

/// Half floats round pi up by so much.
const LARGEST_DIRECTION: f32 = PI + 1e-3;

/// Whether a component of an attribute is a value that surfaces can have.
fn possible(attribute: Attribute, component: usize, value: f32) -> bool {
    match attribute {
        Attribute::Diffuse | Attribute::Specular | Attribute::Glossiness => (0.0..=1.0).contains(&value),
        Attribute::Depth => value > 0.0,
        Attribute::CircleOfConfusion
        | Attribute::MeanFreePath
        | Attribute::Light
        | Attribute::DiffuseLight
        | Attribute::ObjectId
        | Attribute::Estimate
        | Attribute::Emission => value >= 0.0,
        Attribute::Motion => value >= 0.0 && (component == 1 || value <= LARGEST_DIRECTION),
        Attribute::FocalDistance | Attribute::Blurriness => value.is_finite(),
        // Vectors are checked as such, and the mask before everything else.
        Attribute::Position
        | Attribute::Normal
        | Attribute::WorldNormal
        | Attribute::ToCamera
        | Attribute::Valid
        | Attribute::Openness
        | Attribute::RawOpenness
        | Attribute::Relief
        | Attribute::PixelRadius
        | Attribute::Border
        | Attribute::SignedCircle
        | Attribute::Movement
        | Attribute::FreePathPixels => true,
    }
}

/// What makes no sense where a surface is seen.
fn surface_fault(gbuffer: &GBuffer, pixel: usize) -> Option<String> {
    let vector = |attribute| {
        let first = gbuffer.first_plane(attribute).ok()?;
        Some(Vec3::from_array(std::array::from_fn(|c| gbuffer.planes().plane(first + c)[pixel])))
    };
    let position = vector(Attribute::Position);
    if let Some(position) = position.filter(|position| !(position.is_finite() && position.z < 0.0)) {
        return Some(format!("position {position}, which is not in front of the camera,"));
    }
    for attribute in [Attribute::Normal, Attribute::WorldNormal, Attribute::ToCamera] {
        let length = vector(attribute).map(Vec3::length);
        if let Some(length) =
            length.filter(|length| length.is_nan() || (length - 1.0).abs() >= UNIT_TOLERANCE)
        {
            return Some(format!("{} of length {length}", attribute.name()));
        }
    }
    let channels = gbuffer.attributes().iter().flat_map(|attribute| attribute.channels());
    channels.enumerate().find_map(|(plane, channel)| {
        let value = gbuffer.planes().plane(plane)[pixel];
        let fault = !possible(channel.attribute, channel.component, value);
        fault.then(|| format!("{channel} of {value}"))
    })
}

fn plane(gbuffer: &GBuffer, attribute: Attribute) -> Option<&[f32]> {
    gbuffer.first_plane(attribute).ok().map(|first| gbuffer.planes().plane(first))
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade_shaders::Planes;

    /// Two pixels: a surface 2 m ahead that faces the camera, and nothing.
    fn pair() -> Pair {
        let attributes = vec![Attribute::Position, Attribute::Normal, Attribute::Valid];
        let surface = [0.0, 0.0, -2.0, 0.0, 0.0, 1.0, 1.0];
        let planes = Planes::from_fn(7, 1, 2, |c, _, x| if x == 0 { surface[c] } else { 0.0 });
        let target = Planes::from_data(1, 1, 2, vec![0.5, 1.0]);
        Pair { gbuffer: GBuffer::new(attributes, planes), target, variance: None, radius: 0.1 }
    }

    #[test]
    fn a_sound_pair_has_no_fault_and_each_damage_has_its_own() {
        assert_eq!(content_fault(&pair(), Effect::Ao), None);
        let damages = [
            (2, 0, 2.0, "position [0, 0, 2], which is not in front of the camera, at pixel 0, 0"),
            (5, 0, 0.9, "normal of length 0.9 at pixel 0, 0"),
            (6, 0, 0.5, "a validity of 0.5 at pixel 0, 0"),
            (6, 0, 0.0, "no surface is seen"),
            (3, 1, 0.1, "values where nothing is seen, at pixel 1, 0"),
            (4, 0, f32::NAN, "normal of length NaN at pixel 0, 0"),
        ];
        for (channel, pixel, value, expected) in damages {
            let sound = pair();
            let mut planes = sound.gbuffer.planes().clone();
            planes.plane_mut(channel)[pixel] = value;
            let gbuffer = GBuffer::new(sound.gbuffer.attributes().to_vec(), planes);
            let damaged = Pair { gbuffer, ..sound };
            assert_eq!(content_fault(&damaged, Effect::Ao).as_deref(), Some(expected));
        }
        let target = Planes::from_data(1, 1, 2, vec![0.5, 0.75]);
        let fault = content_fault(&Pair { target, ..pair() }, Effect::Ao);
        assert_eq!(fault.as_deref(), Some("a target of 0.75 where nothing is seen, at pixel 1, 0"));
        for value in [-0.1, 1.1, f32::NAN] {
            let target = Planes::from_data(1, 1, 2, vec![0.5, value]);
            let fault = content_fault(&Pair { target, ..pair() }, Effect::Ao).expect("a fault");
            assert_eq!(fault, format!("a target of {value}"));
        }
    }

    #[test]
    fn a_variance_is_finite_and_not_below_zero() {
        for (value, expected) in
            [(0.0, None), (-1e-6, Some("a variance of -0.000001")), (f32::NAN, Some("a variance of NaN"))]
        {
            let variance = Some(Planes::from_data(1, 1, 2, vec![value, 0.0]));
            assert_eq!(content_fault(&Pair { variance, ..pair() }, Effect::Ao).as_deref(), expected);
        }
    }

    #[test]
    fn every_attribute_has_a_range_that_damage_leaves() {
        for effect in Effect::ALL {
            let attributes = effect.attributes().to_vec();
            let channels: Vec<_> = attributes.iter().flat_map(|attribute| attribute.channels()).collect();
            let sound = |channel: usize| match channels[channel].attribute {
                Attribute::Position => [0.0, 0.0, -2.0][channels[channel].component],
                Attribute::Normal | Attribute::WorldNormal | Attribute::ToCamera => {
                    [0.0, 0.6, 0.8][channels[channel].component]
                }
                Attribute::Blurriness => -3.0,
                _ => 1.0,
            };
            let faults = |damaged: Option<usize>| {
                let value = |c: usize| if damaged == Some(c) { f32::NAN } else { sound(c) };
                let planes = Planes::from_fn(channels.len(), 1, 1, |c, _, _| value(c));
                let target = Planes::filled(effect.channels(), 1, 1, 0.5);
                let pair = Pair {
                    gbuffer: GBuffer::new(attributes.clone(), planes),
                    target,
                    variance: None,
                    radius: 0.1,
                };
                content_fault(&pair, effect)
            };
            assert_eq!(faults(None), None, "{effect}");
            for (index, channel) in channels.iter().enumerate() {
                assert!(faults(Some(index)).is_some(), "{effect}: {channel}");
            }
        }
        assert!(!possible(Attribute::Motion, 0, 3.2) && possible(Attribute::Motion, 1, 3.2));
        assert!(!possible(Attribute::Diffuse, 0, 1.1) && !possible(Attribute::Light, 2, -0.1));
    }
}
