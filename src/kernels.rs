//! The fastest kernels for a network on a graphics card: measured when a network first runs there, then
//! remembered with the compiled kernels in the user's cache folder.

use deepshade_infer::Model;
use deepshade_infer::forward::{ForwardError, Network, Options, Precision, Tuning};
use deepshade_shaders::gpu::{Gpu, PipelineCache};
use etcetera::BaseStrategy;
use std::path::PathBuf;

/// A network from buffers to buffers with its fastest kernels for images of about `[height, width]`, in
/// 32-bit floats where no kernel in half floats works. What cannot be remembered is measured again next time.
/// On software adapters nothing is measured: they have kernels made for them, and measuring all others takes
/// minutes.
///
/// # Errors
/// If the device refuses the network; [`ForwardError::NoKernel`] if no kernel works there.
pub fn fastest(
    gpu: &Gpu,
    model: &Model,
    precision: Precision,
    size: [usize; 2],
) -> Result<Network, ForwardError> {
    let Model { spec, weights } = model;
    let Some(folder) = folder().filter(|_| !gpu.is_software()) else {
        return Network::with(&gpu.device, spec, weights, &Options { precision, ..Options::default() });
    };
    let (cache, note) = PipelineCache::open(&gpu.device, &folder.join("pipelines.bin"));
    let path = folder.join("kernels.json");
    let (mut tuning, other) = Tuning::load(&gpu.device, &path);
    for note in note.into_iter().chain(other) {
        note!("{note}");
    }
    let options = Options { precision, cache: Some(&cache), ..Options::default() };
    if let Ok(None) = tuning.variant(spec, &options, size) {
        note!("measuring which kernels are fastest on {}, once", gpu.info.name);
    }
    let made = tuning.network(gpu, model, &options, size);
    // Where no kernel works, too.
    remember(&path, tuning.save(&path));
    remember(&folder, cache.save());
    let (network, notes) = made?;
    notes.iter().for_each(|note| note!("{note}"));
    Ok(network)
}

fn remember(path: &std::path::Path, saved: std::io::Result<()>) {
    if let Err(error) = saved {
        note!("not remembered for the next time: {}: {error}", path.display());
    }
}

fn folder() -> Option<PathBuf> {
    Some(etcetera::choose_base_strategy().ok()?.cache_dir().join("deepshade"))
}
