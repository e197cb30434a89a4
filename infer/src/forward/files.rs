//! A network as files for any engine that has compute shaders: all passes from a g-buffer to the effect's
//! image, their weights, and what a host must do.
//!
//! The kernels are those that [`Network`](super::Network) runs on GPUs, of the shapes that are guessed to be
//! best within WebGPU's limits.

use super::ForwardError;
use super::Precision;
use super::host;
use crate::{Model, NetSpec};
use deepshade_shaders::Attribute;
use deepshade_shaders::host::{HostBuffer, HostPass, HostPasses};
use serde_json::json;

/// A file's name and what it holds.
pub type File = (String, Vec<u8>);

/// What a host must do, in words.
const HOST: &str = include_str!("host.md");

/// A network as files.
#[derive(Clone, Debug)]
pub struct WgslFiles {
    /// The files by their names.
    pub files: Vec<File>,
    /// The attributes of a g-buffer whose buffers a host fills.
    pub attributes: Vec<Attribute>,
}

/// The files of a network: a shader for each pass, weights and a table of what is read for each layer,
/// `network.json` with the passes, their buffers and their uniforms, and `HOST.md` with the same in words.
/// `estimates` are the passes of the methods that the spec names, as far as they are exported.
///
/// # Errors
/// If the weights are not the spec's.
pub fn wgsl_files(
    model: &Model,
    precision: Precision,
    estimates: &[HostPasses],
) -> Result<WgslFiles, ForwardError> {
    let Model { spec, weights } = model;
    if spec.validate().is_err() || !weights.fit(spec) {
        return Err(ForwardError::Unfit);
    }
    let mut all = HostPasses::default();
    estimates.iter().cloned().for_each(|estimate| all.extend(estimate));
    all.extend(host::input(spec));
    let network = host::network(model, precision)?;
    all.extend(network.passes);
    all.extend(host::image(spec));
    let mut files: Vec<File> = Vec::new();
    for (index, pass) in all.passes.iter_mut().enumerate() {
        pass.file = format!("{index:02}_{}.wgsl", pass.name);
        files.push((pass.file.clone(), shader(pass).into_bytes()));
    }
    files.extend(network.files);
    let attributes = filled(&all);
    files.push(("network.json".to_owned(), list(spec, precision, &all, &attributes)));
    files.push(("HOST.md".to_owned(), HOST.as_bytes().to_vec()));
    Ok(WgslFiles { files, attributes })
}

/// A pass' shader under a line that says what it is.
fn shader(pass: &HostPass) -> String {
    format!("// Pass `{}`, written by deepshade; HOST.md says how it is run.\n\n{}", pass.name, pass.source)
}

/// What no pass makes.
fn filled(all: &HostPasses) -> Vec<Attribute> {
    let is_filled =
        |attribute: &&Attribute| matches!(all.buffers.get(attribute.name()), Some(HostBuffer::Attribute(_)));
    Attribute::ALL.iter().chain(&Attribute::MADE).filter(is_filled).copied().collect()
}

/// `network.json`.
fn list(spec: &NetSpec, precision: Precision, all: &HostPasses, attributes: &[Attribute]) -> Vec<u8> {
    let names = |attributes: &[Attribute]| attributes.iter().map(|a| a.name()).collect::<Vec<_>>();
    let network = json!({
        "effect": spec.effect, "channels": spec.effect.channels(), "attributes": names(attributes),
        "lights": names(&spec.lights().collect::<Vec<_>>()), "brightness": spec.brightness(),
        "runs": spec.runs(), "reach": spec.reach, "half": precision == Precision::F16,
        "buffers": all.buffers, "passes": all.passes,
    });
    format!("{network:#}\n").into_bytes()
}
