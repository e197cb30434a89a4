//! A training run as a network: what `deepshade train` has in its folder so far.

use crate::complete::sky;
use anyhow::{Context, Result};
use deepshade_dataset::{Manifest, Recipe};
use deepshade_infer::{Model, NetSpec};
use deepshade_train::TrainConfig;
use deepshade_train::checkpoint::{CHECKPOINT_FILE, Checkpoint};
use deepshade_train::config::CONFIG_FILE;
use deepshade_train::metrics::METRICS_FILE;
use std::path::Path;

/// Files by which its weights are told from others.
pub const FILES: [&str; 2] = [CONFIG_FILE, CHECKPOINT_FILE];

/// What is said of a run that has no weights yet.
pub const NOTHING_YET: &str = "nothing was trained yet, the first checkpoint is still to come";

/// Whether a folder holds a run, be it one that has no checkpoint yet.
pub fn is_run(folder: &Path) -> bool {
    let is_there = |name: &str| folder.join(name).is_file();
    is_there(CONFIG_FILE) && (is_there(METRICS_FILE) || is_there(CHECKPOINT_FILE))
}

/// What the network of a run is, with the environment of its training where its data are there.
///
/// # Errors
/// If the run's config is damaged.
pub fn spec(folder: &Path) -> Result<NetSpec> {
    let config = TrainConfig::load(folder)?;
    let recipe = match config.stream {
        Some(_) => Recipe::load(&config.dataset).ok(),
        None => Manifest::load(&config.dataset).ok().map(|manifest| manifest.origin.recipe),
    };
    Ok(NetSpec { environment: recipe.as_ref().and_then(sky::of_recipe), ..config.spec })
}

/// The network of a run with the newest weights that it has saved.
///
/// # Errors
/// If it has saved none yet, or a file is damaged.
pub fn newest(folder: &Path) -> Result<Model> {
    let spec = spec(folder)?;
    let checkpoint = Checkpoint::load(folder, &spec)?;
    let nothing = || format!("{}: {NOTHING_YET}", folder.display());
    let weights = checkpoint.with_context(nothing)?.mean;
    Ok(Model { spec, weights })
}

#[cfg(test)]
mod tests {
    use super::super::network;
    use super::*;
    use deepshade_infer::{ChannelOrder, Reach, TrainedUnder, Weights};
    use deepshade_shaders::Effect;
    use deepshade_train::Endless;
    use deepshade_train::checkpoint::Progress;

    #[test]
    fn a_run_knows_the_environment_of_its_recipe() {
        let folder = tempfile::tempdir().expect("a folder");
        let recipe = |name: &str| Path::new(env!("CARGO_MANIFEST_DIR")).join("dataset/recipes").join(name);
        let environment = |data: &Path| {
            let reach = Reach { radius: 0.25, diagonal_share: 0.1, height: 64 };
            let net = NetSpec::ao(ChannelOrder::Interleaved, reach);
            let stream = Some(Endless { uses: 1, window: 8 });
            let config = TrainConfig { stream, ..TrainConfig::new(net, data.to_owned()) };
            let json = serde_json::to_vec(&config).expect("plain");
            std::fs::write(folder.path().join(CONFIG_FILE), json).expect("written");
            spec(folder.path()).expect("a spec").environment
        };
        assert_eq!(environment(&recipe("ibl.toml")), Some(TrainedUnder::Sky(1)));
        assert_eq!([recipe("ao.toml"), recipe("gone.toml")].map(|data| environment(&data)), [None, None]);
    }

    #[test]
    fn a_run_is_its_newest_weights_once_it_has_some() {
        let folder = tempfile::tempdir().expect("a folder");
        let folder = folder.path();
        let reach = Reach { radius: 0.25, diagonal_share: 0.1, height: 64 };
        let spec =
            NetSpec::ao(ChannelOrder::Interleaved, reach).reshaped(|net| (net.levels, net.u0) = (2, 4));
        let error = network(folder, None).expect_err("no network").to_string();
        assert!(error.starts_with("no network in"), "{error}");
        let config = TrainConfig::new(spec.clone(), "data".into());
        std::fs::write(folder.join(CONFIG_FILE), serde_json::to_vec(&config).expect("plain"))
            .expect("written");
        assert!(!is_run(folder), "any program's config");
        std::fs::write(folder.join(METRICS_FILE), "").expect("written");
        assert!(is_run(folder));
        let error = network(folder, None).expect_err("no weights").to_string();
        assert!(error.contains("nothing was trained yet"), "{error}");
        let progress = Progress {
            step: 40,
            best_step: 20,
            best_loss: Some(0.1),
            waited: 1,
            stopped: false,
            pause_loss: None,
        };
        let [newest, best] = [1, 2].map(|seed| Weights::random(&spec, seed));
        let checkpoint = Checkpoint {
            progress,
            weights: best.clone(),
            mean: newest.clone(),
            best: Some(best),
            optimiser: Vec::new(),
        };
        checkpoint.save(folder, &spec).expect("saves");
        let model = network(folder, Some(Effect::Ao)).expect("a network");
        assert_eq!((model.spec, model.weights), (spec, newest));
        let error = network(folder, Some(Effect::Gi)).expect_err("another effect").to_string();
        assert!(error.contains("is for ao, not for gi"), "{error}");
    }
}
