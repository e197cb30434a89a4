//! Propagation in a medium that is the same everywhere, beside what is known of it.

use crate::figures::Figures;
use crate::plot::{Line, Plot};
use deepshade_render::lpv::flight::Factors;
use deepshade_render::lpv::studies::{energy_loss, fluence_by_direction, moment_ratio, over_monopole};

/// Mean free paths, cells, and half of the cells of a grid that is large enough for each.
const PATHS: [(f32, i32); 4] = [(0.5, 12), (1.0, 14), (2.0, 18), (4.0, 22)];
const ALBEDOS: [f32; 2] = [0.5, 0.9];

/// A ratio for each way to count collisions, mean free path and albedo.
struct Moment {
    factors: Factors,
    path: f32,
    albedo: f32,
    ratio: f64,
}

/// All that is measured.
pub struct Studies {
    energy_loss: f64,
    moments: Vec<Moment>,
    monopole_error: f64,
    fluence: [f64; 3],
}

impl Studies {
    /// Measures.
    pub fn new() -> Self {
        let moment = |factors, albedo, (path, half)| {
            let ratio = moment_ratio(factors, path, albedo, half);
            Moment { factors, path, albedo, ratio }
        };
        let of = |factors| {
            ALBEDOS.into_iter().flat_map(move |albedo| PATHS.map(|path| moment(factors, albedo, path)))
        };
        let error = |(_, ratio): (f64, f64)| (ratio - 1.0).abs();
        Self {
            energy_loss: [0.0, 0.3, 2.0, 40.0]
                .map(|e| energy_loss(Factors::Placed, e))
                .into_iter()
                .fold(0.0, f64::max),
            moments: [Factors::Placed, Factors::Exponential].into_iter().flat_map(of).collect(),
            monopole_error: over_monopole(Factors::Placed, 1.0, 0.9, 18)
                .into_iter()
                .map(error)
                .fold(0.0, f64::max),
            fluence: fluence_by_direction(15),
        }
    }

    /// Sets its figures.
    pub fn set(&self, figures: &mut Figures) {
        figures.set("energy_loss_iteration", self.energy_loss);
        figures.set("monopole_error", self.monopole_error);
        for (name, fluence) in ["axis", "edge", "corner"].into_iter().zip(self.fluence) {
            figures.set(&format!("fluence_{name}"), fluence);
        }
        for Moment { factors, path, albedo, ratio } in &self.moments {
            let factors =
                if *factors == Factors::Placed { String::new() } else { format!("{}_", factors.name()) };
            figures.set(&format!("moment_ratio_{factors}{path}_{albedo}"), *ratio);
        }
    }

    /// Ratios against mean free paths.
    pub fn plot(&self) -> Plot {
        let line = |of: &[Moment]| {
            let points = of.iter().map(|moment| (f64::from(moment.path), moment.ratio)).collect();
            Line::dotted(format!("{}, albedo {}", of[0].factors.name(), of[0].albedo), points)
        };
        let alike = |a: &Moment, b: &Moment| (a.factors, a.albedo) == (b.factors, b.albedo);
        let lines = self.moments.chunk_by(alike).map(line);
        Plot {
            x: "mean free path, cells",
            is_logarithmic: true,
            y: "over that in an infinite medium",
            lines: lines.collect(),
            level: Some(("right", 1.0)),
        }
    }

    /// Rows of a table.
    pub fn rows(&self) -> Vec<Vec<String>> {
        let row = |moment: &Moment| {
            let Moment { factors, path, albedo, ratio } = moment;
            vec![factors.name().to_owned(), path.to_string(), albedo.to_string(), format!("{ratio:.3}")]
        };
        let head = ["collisions", "mean free path", "albedo", "squared distance"].map(str::to_owned).to_vec();
        let others = [("energy lost", self.energy_loss), ("off a monopole", self.monopole_error)];
        let other = |(name, value): (&str, f64)| {
            vec![name.to_owned(), String::new(), String::new(), format!("{value:.2e}")]
        };
        std::iter::once(head).chain(self.moments.iter().map(row)).chain(others.map(other)).collect()
    }
}
