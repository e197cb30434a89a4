//! `deepshade phosphor materials`: what materials there are.

use crate::table;
use anyhow::{Context, Result};
use deepshade_glow::file::MaterialFile;
use deepshade_glow::material::Material;
use std::path::{Path, PathBuf};

/// Lists the materials that are known by name, or those of a file.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  deepshade phosphor materials\n  deepshade phosphor materials fitted.toml"
)]
pub struct Args {
    /// A file of materials, as `fit` writes it; by default those that the thesis measured (Tables 8.1 and
    /// A.1).
    file: Option<PathBuf>,
}

/// The materials of a file, or those that are known by name.
///
/// # Errors
/// If the file cannot be read or a material makes no sense.
pub fn of(file: Option<&Path>) -> Result<MaterialFile> {
    Ok(file.map_or_else(|| Ok(MaterialFile::presets()), MaterialFile::read)?)
}

/// One by its name.
///
/// # Errors
/// If there is none of that name; those that there are, are listed.
pub fn named<'a>(materials: &'a MaterialFile, name: &str) -> Result<&'a Material> {
    materials.named(name).with_context(|| {
        let known: Vec<&str> = materials.materials.iter().map(|material| material.name.as_str()).collect();
        format!("no material `{name}`; there are {}", known.join(", "))
    })
}

/// Prints the list.
///
/// # Errors
/// If the file cannot be read or a material makes no sense.
pub fn run(args: &Args) -> Result<()> {
    let file = of(args.file.as_deref())?;
    let mut rows = vec![
        ["material", "half lives, s", "charged by light", "what is not certain"].map(str::to_owned).to_vec(),
    ];
    rows.extend(file.materials.iter().map(row));
    say!("{}", table::aligned(&rows))
}

fn row(material: &Material) -> Vec<String> {
    let half_lives: Vec<String> =
        material.states.iter().map(|state| format!("{:.1}", std::f64::consts::LN_2 / state.decay)).collect();
    let known = if material.excitation_is_known() { "yes" } else { "was not measured" };
    vec![
        material.name.clone(),
        half_lives.join(", "),
        known.to_owned(),
        material.doubt.clone().unwrap_or_default(),
    ]
}
