//! A network as files for any engine that has compute shaders, with the methods whose images it reads, and a
//! frame to check the engine with.

use super::check;
use crate::learned::estimator;
use anyhow::Result;
use deepshade_infer::forward::{File, Precision, WgslFiles, wgsl_files};
use deepshade_infer::{Model, NetSpec};
use deepshade_shaders::host::HostPasses;

/// The files of [`wgsl_files`] and of [`check`].
///
/// # Errors
/// If a method that the network names is not known, or the network does not run.
pub fn files(model: &Model, precision: Precision) -> Result<Vec<File>> {
    let WgslFiles { files, attributes } = wgsl_files(model, precision, &estimates(&model.spec)?)?;
    Ok([files, check::files(model, &attributes)?].concat())
}

/// The passes of the methods of `ao` whose images a network reads.
fn estimates(spec: &NetSpec) -> Result<Vec<HostPasses>> {
    let made = spec.estimates.iter().map(|estimate| Ok(estimator(spec, estimate)?.host_passes()));
    Ok(made.collect::<Result<Vec<_>>>()?.into_iter().flatten().collect())
}
