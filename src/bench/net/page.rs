//! The table of measurements as a page that needs nothing else.

use super::layers::Row;
use super::measurement::Measurement;
use crate::figures::Figures;
use anyhow::Result;
use askama::Template;
use deepshade_shaders::gpu::Gpu;

/// The page as HTML.
///
/// # Errors
/// If the template fails.
pub fn render(figures: &Figures, made: &[Measurement], layers: &[Row], gpu: &Gpu) -> Result<String> {
    let mut groups: Vec<Group<'_>> = Vec::new();
    for row in made {
        let [network, weights] = [&row.network.replace('_', "-"), row.weights()];
        let name = format!("{network}, {weights} weights, {} x {}", row.size[0], row.size[1]);
        match groups.last_mut().filter(|group| group.name == name) {
            Some(group) => group.rows.push(row),
            None => groups.push(Group { name, rows: vec![row] }),
        }
    }
    let machine = figures.to_json()["machine"].clone();
    let text = |key: &str| machine[key].as_str().map_or_else(|| machine[key].to_string(), str::to_owned);
    let peak = |engine: &str| {
        let figure = |name: &str| figures.get(&format!("peak_{name}_{engine}")).unwrap_or(f64::NAN);
        format!("{:.1} GFLOP/s, {:.1} GB/s", figure("gflops"), figure("gigabytes"))
    };
    let page = Page {
        groups,
        layers,
        facts: [
            ("adapter", gpu.info.name.clone()),
            ("driver", gpu.info.driver_info.clone()),
            ("its peak", peak("wgsl")),
            ("processor", text("processor")),
            ("its peak", peak("cpu")),
            ("threads", text("threads")),
            ("deepshade", text("version")),
        ],
    };
    Ok(page.render()?)
}

#[derive(Template)]
#[template(path = "bench/net/page.html")]
struct Page<'a> {
    groups: Vec<Group<'a>>,
    layers: &'a [Row],
    facts: [(&'static str, String); 7],
}

/// One network at one size.
struct Group<'a> {
    name: String,
    rows: Vec<&'a Measurement>,
}

impl Group<'_> {
    /// A row's time as a share of the group's longest, per cent.
    fn share(&self, row: &Measurement) -> f64 {
        let longest = self.rows.iter().fold(0.0f64, |longest, row| longest.max(row.milliseconds));
        100.0 * row.milliseconds / longest
    }
}
