//! `deepshade scene`: what a scene holds.

use crate::figures::Figures;
use anyhow::Result;
use deepshade_render::scene::SceneSource;
use deepshade_render::scene::procedural::{Family, Split};
use deepshade_render::scene::summary::{MaterialSummary, SceneSummary};
use serde_json::json;
use std::path::PathBuf;

/// Says what a scene holds, or lists the procedural families.
#[derive(clap::Args)]
#[command(after_help = "Examples:\n  deepshade scene sponza/sponza.gltf\n  deepshade scene stairs:7\n  \
    deepshade scene --list")]
pub struct Args {
    /// A scene file (.gltf, .glb, .obj, .ply) or a procedural family and a seed, such as stairs:7.
    #[arg(required_unless_present = "list")]
    scene: Option<SceneSource>,
    /// Moment of animations, skins and morph targets, seconds.
    #[arg(long, default_value_t = 0.0)]
    time: f32,
    /// Lists the procedural families and what they are for.
    #[arg(long)]
    list: bool,
    /// Writes the figures here as JSON.
    #[arg(long, value_parser = crate::arguments::written_file)]
    json: Option<PathBuf>,
}

/// Prints the summary or the list.
pub fn run(args: &Args) -> Result<()> {
    let mut figures = Figures::new("scene");
    let text = match &args.scene {
        Some(source) if !args.list => {
            let scene = source.scene(args.time)?;
            let summary = SceneSummary::of(&scene);
            figures.set("triangles", summary.triangles as f64);
            figures.set("meshes", summary.meshes as f64);
            figures.set("diagonal", f64::from(summary.bounds.diagonal()));
            figures.set("materials", summary.materials.len() as f64);
            figures.detail("scene", json!(source.to_string()));
            let material = |it: &MaterialSummary| json!({ "name": it.name, "triangles": it.triangles });
            figures.detail("materials", summary.materials.iter().map(material).collect());
            figures.detail("warnings", json!(scene.warnings));
            scene
                .warnings
                .iter()
                .fold(summary.to_string(), |text, warning| format!("{text}\nwarning: {warning}"))
        }
        _ => {
            figures.set("families", Family::ALL.len() as f64);
            let line =
                |family: Family| format!("{:<11} {:<9} {}", family.name(), purpose(family), family.about());
            Family::ALL.map(line).join("\n")
        }
    };
    figures.write(args.json.as_deref())?;
    say!("{text}")
}

fn purpose(family: Family) -> &'static str {
    match family.split() {
        Split::Train => "training",
        Split::Test => "testing",
    }
}
