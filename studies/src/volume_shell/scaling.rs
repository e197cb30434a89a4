//! How the time of splatting grows with surfels, pixels and intervals.

use super::subject::ShellFrame;
use crate::slope::Slope;
use crate::stages::Stage;
use anyhow::Result;
use deepshade::shared::arguments::Size;
use deepshade::shared::figures::Figures;
use deepshade::shared::plot::{Line, Plot};
use deepshade_render::methods::volume_shell::VolumeShellParameters;
use deepshade_render::surfels;
use deepshade_shaders::gpu::Gpu;
use serde_json::{Value, json};

/// Radii of surfels, over the usual one.
const RADII: [f32; 5] = [2.0, 1.4, 1.0, 0.7, 0.5];
/// Edges of the image, over that of the finest.
const EDGES: [f32; 5] = [0.25, 0.35, 0.5, 0.7, 1.0];
/// Samples of a ray.
const SAMPLES: [u32; 5] = [8, 12, 16, 24, 32];

/// How often there is something, and the milliseconds of splatting.
type Point = (f64, f64);

/// Times with different numbers of one thing each.
pub struct Scaling([(&'static str, [Point; 5]); 3]);

impl Scaling {
    /// Measures on images of up to a size.
    ///
    /// # Errors
    /// If the device fails.
    pub fn of(gpu: &Gpu, finest: Size, usual: VolumeShellParameters, runs: usize) -> Result<Self> {
        let subject = ShellFrame::new(gpu, finest.scaled(0.5))?;
        let surfels = measured(RADII, |radius| {
            let surfels = surfels::SurfelDensity { scale: radius * usual.surfels.scale, ..usual.surfels };
            let cost = subject.shaded(VolumeShellParameters { surfels, ..usual }, runs)?.cost;
            Ok((f64::from(cost.surfels[0]), cost.of_stage(Stage::Splat)))
        })?;
        let pixels = measured(EDGES, |edge| {
            let size = finest.scaled(edge);
            let cost = ShellFrame::new(gpu, size)?.shaded(usual, runs)?.cost;
            Ok(((size.width * size.height) as f64, cost.of_stage(Stage::Splat)))
        })?;
        let intervals = measured(SAMPLES, |samples| {
            let cost = subject.shaded(VolumeShellParameters { samples, ..usual }, runs)?.cost;
            Ok((f64::from(samples - 1), cost.of_stage(Stage::Splat)))
        })?;
        Ok(Self([("surfels", surfels), ("pixels", pixels), ("intervals", intervals)]))
    }

    fn slopes(&self) -> [(&'static str, Slope); 3] {
        self.0.map(|(name, points)| (name, Slope::through(&points.map(|(count, ms)| (count.ln(), ms.ln())))))
    }

    /// Sets its figures.
    pub fn set(&self, figures: &mut Figures) {
        for (name, slope) in self.slopes() {
            figures.set(&format!("slope_{name}"), slope.value);
            figures.set(&format!("slope_{name}_interval"), slope.half);
        }
    }

    /// Everything that was measured.
    pub fn to_json(&self) -> Value {
        self.0.iter().map(|(name, points)| json!({ "of": name, "count_and_ms": points })).collect()
    }

    /// Rows of a table.
    pub fn rows(&self) -> Vec<Vec<String>> {
        let head = ["splatting grows with", "from", "to", "ms", "power"].map(str::to_owned).to_vec();
        let row = |((name, points), (_, slope)): (&(&str, [Point; 5]), (&str, Slope))| {
            let [(few, fast), .., (many, slow)] = points;
            let times = format!("{fast:.1} to {slow:.1}");
            vec![(*name).to_owned(), few.to_string(), many.to_string(), times, slope.to_string()]
        };
        std::iter::once(head).chain(self.0.iter().zip(self.slopes()).map(row)).collect()
    }

    /// Milliseconds, as powers of 2, against how often there is something.
    pub fn plot(&self) -> Plot {
        let line = |(name, points): &(&str, [Point; 5])| {
            let [(fewest, _), ..] = points;
            Line::dotted(*name, points.map(|(count, ms)| (count / fewest, ms.log2())).to_vec())
        };
        Plot {
            x: "how many, over the fewest",
            is_logarithmic: true,
            y: "log2 of milliseconds of splatting",
            lines: self.0.iter().map(line).collect(),
            level: None,
        }
    }
}

fn measured<T>(settings: [T; 5], point: impl Fn(T) -> Result<Point>) -> Result<[Point; 5]> {
    let mut points = [(0.0, 0.0); 5];
    for (setting, found) in settings.into_iter().zip(&mut points) {
        *found = point(setting)?;
    }
    Ok(points)
}
