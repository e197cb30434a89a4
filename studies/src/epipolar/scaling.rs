//! How times grow with the resolution of everything (Baran et al. 2010, Figure 12).

use super::subject::{FogView, Kind, Setup, View};
use crate::slope::Slope;
use anyhow::Result;
use deepshade::shared::figures::Figures;
use deepshade::shared::plot::{Line, Plot};
use deepshade_render::methods::shafts::Integration;
use deepshade_render::methods::{Quality, epipolar, ray_march};
use rayon::ThreadPool;
use serde_json::{Value, json};

/// Resolutions, as shares of the finest.
const SHARES: [f64; 5] = [0.25, 0.35, 0.5, 0.7, 1.0];
/// Seconds at one resolution.
struct Point {
    setup: Setup,
    /// Slices, view rays and light rays, multiplied: pixels times light rays.
    work: f64,
    tree: f64,
    march: f64,
}

/// Times at several resolutions.
pub struct Scaling {
    points: Vec<Point>,
}

impl Scaling {
    /// Measures up to a resolution, in a pool of one thread. A march has as many steps as trees have light
    /// rays.
    ///
    /// # Errors
    /// If the scene cannot be traced.
    pub fn of(finest: Setup, pool: &ThreadPool) -> Result<Self> {
        let mut points = Vec::new();
        for share in SHARES {
            let setup = finest.scaled(share);
            let subject = FogView::new(Kind::Trees, View::Side, setup)?;
            let trees = epipolar::EpipolarParameters {
                light_rays: setup.light_rays,
                ..epipolar::EpipolarParameters::of(Quality::High)
            };
            let steps = setup.light_rays as u32;
            let march =
                ray_march::RayMarchParameters { steps, ..ray_march::RayMarchParameters::of(Quality::High) };
            let [(_, tree), (_, march)] = subject.timed(
                [&|lit, radiance| trees.add(lit, radiance), &|lit, radiance| march.add(lit, radiance)],
                pool,
            );
            let work = (setup.size[0] * setup.size[1] * setup.light_rays) as f64;
            points.push(Point { setup, work, tree, march });
        }
        Ok(Self { points })
    }

    fn slopes(&self) -> [Slope; 2] {
        [|point: &Point| point.tree, |point: &Point| point.march].map(|seconds| {
            let points: Vec<(f64, f64)> =
                self.points.iter().map(|point| (point.work.ln() / 3.0, seconds(point).ln())).collect();
            Slope::through(&points)
        })
    }

    /// Sets its figures.
    pub fn set(&self, figures: &mut Figures) {
        for (slope, name) in self.slopes().into_iter().zip(["tree", "march"]) {
            figures.set(&format!("slope_{name}"), slope.value);
            figures.set(&format!("slope_{name}_interval"), slope.half);
        }
    }

    /// Everything that was measured.
    pub fn to_json(&self) -> Value {
        let point = |point: &Point| {
            json!({
                "size": point.setup.size, "light_rays": point.setup.light_rays, "tree": point.tree, "march": point.march,
            })
        };
        self.points.iter().map(point).collect()
    }

    /// Rows of a table.
    pub fn rows(&self) -> Vec<Vec<String>> {
        let mut rows = vec![["size", "light rays", "tree s", "march s"].map(str::to_owned).to_vec()];
        for Point { setup: Setup { size: [height, width], light_rays, .. }, tree, march, .. } in &self.points
        {
            rows.push(vec![
                format!("{width}x{height}"),
                light_rays.to_string(),
                format!("{tree:.3}"),
                format!("{march:.2}"),
            ]);
        }
        let [tree, march] = self.slopes().map(|slope| slope.to_string());
        rows.push(vec!["slope".to_owned(), String::new(), tree, march]);
        rows
    }

    /// Seconds, as powers of 2, against resolution.
    pub fn plot(&self) -> Plot {
        let line = |name: &str, seconds: fn(&Point) -> f64| {
            Line::dotted(name, self.points.iter().map(|p| (p.work.cbrt(), seconds(p).log2())).collect())
        };
        Plot {
            x: "cube root of slices x view rays x light rays",
            is_logarithmic: true,
            y: "log2 of seconds, one thread",
            lines: vec![line("trees", |point| point.tree), line("march", |point| point.march)],
            level: None,
        }
    }
}
