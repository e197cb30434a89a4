//! Propagation in a medium that is the same everywhere, beside what is known of it.

use deepshade::shared::figures::Figures;
use deepshade::shared::plot::{Line, Plot};
use deepshade_render::lpv::Scheme;
use deepshade_render::lpv::lobe::Lobes;
use deepshade_render::lpv::studies::{
    Flights, Ringing, energy_loss, flux_by_direction, moment_ratio, over_monopole, ringing,
};

/// Mean free paths, cells, and half of the cells of the cube that is looked at.
const PATHS: [(f32, i32); 4] = [(0.5, 12), (1.0, 14), (2.0, 18), (4.0, 20)];
const ALBEDOS: [f32; 2] = [0.5, 0.9];
/// Mean free paths, and half of the cells of a cube in which light is looked at that has gone three of them
/// and farther.
const FAR: [(f32, i32); 4] = [(0.5, 14), (1.0, 18), (2.0, 24), (4.0, 30)];
/// Half of the cells of a grid in which light goes without a medium.
const HALF: i32 = 15;

/// A ratio for each mean free path and albedo, by our scheme.
struct MomentRatio {
    path: f32,
    albedo: f32,
    ratio: f64,
}

/// Fluence over a monopole's where it is farthest from 1, by our scheme.
struct Monopole {
    path: f32,
    albedo: f32,
    ratio: f64,
}

impl Monopole {
    fn new(albedo: f32, (path, half): (f32, i32)) -> Self {
        let ratios = over_monopole(Scheme::OURS, path, albedo, half).into_iter().map(|(_, ratio)| ratio);
        let farther = |a: f64, b: f64| if (b - 1.0).abs() > (a - 1.0).abs() { b } else { a };
        Self { path, albedo, ratio: ratios.fold(1.0, farther) }
    }

    fn error(&self) -> f64 {
        (self.ratio - 1.0).abs()
    }
}

/// All that is measured.
pub struct Studies {
    energy_loss: f64,
    moments: Vec<MomentRatio>,
    monopoles: Vec<Monopole>,
    /// Flux and fluence along an axis, across an edge and across a corner, with our lobes and the paper's.
    directions: [(&'static str, [[f64; 2]; 3]); 2],
    /// Of two bands.
    ringing: Ringing,
}

impl Studies {
    /// Measures.
    pub fn new() -> Self {
        let flights = ALBEDOS.map(|albedo| (albedo, Flights::new(f64::from(albedo))));
        let moment = |(albedo, flights): &(f32, Flights), (path, half)| {
            let ratio = moment_ratio(Scheme::OURS, path, flights, half);
            MomentRatio { path, albedo: *albedo, ratio }
        };
        let far = |albedo| FAR.map(|path| Monopole::new(albedo, path));
        let largest = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
        Self {
            energy_loss: largest(
                &[0.0, 0.3, 2.0, 40.0].map(|extinction| energy_loss(Scheme::OURS, extinction)),
            ),
            moments: flights.iter().flat_map(|flights| PATHS.map(|path| moment(flights, path))).collect(),
            monopoles: ALBEDOS.into_iter().flat_map(far).collect(),
            directions: [("", Scheme::OURS), ("paper_", Scheme::PAPER)]
                .map(|(name, scheme)| (name, flux_by_direction(scheme, HALF))),
            ringing: ringing(Lobes::TwoBands, HALF),
        }
    }

    /// Sets its figures.
    pub fn set(&self, figures: &mut Figures) {
        figures.set("energy_loss_iteration", self.energy_loss);
        figures.set("monopole_error", self.monopole(1.0, 0.9).map_or(f64::NAN, Monopole::error));
        for monopole in &self.monopoles {
            let Monopole { path, albedo, .. } = monopole;
            figures.set(&format!("monopole_error_{path}_{albedo}"), monopole.error());
        }
        for (scheme, directions) in &self.directions {
            for (name, [flux, fluence]) in ["axis", "edge", "corner"].into_iter().zip(directions) {
                figures.set(&format!("flux_{scheme}{name}"), *flux);
                figures.set(&format!("fluence_{scheme}{name}"), *fluence);
            }
            figures.set(&format!("axis_over_diagonal_{scheme}flux"), directions[0][0] / directions[2][0]);
        }
        let Ringing { negative, flux } = self.ringing;
        figures.set("ringing_2_bands", negative);
        figures.set("axis_over_diagonal_2_bands", flux[0] / flux[2]);
        for MomentRatio { path, albedo, ratio } in &self.moments {
            figures.set(&format!("moment_ratio_{path}_{albedo}"), *ratio);
        }
    }

    fn monopole(&self, path: f32, albedo: f32) -> Option<&Monopole> {
        self.monopoles.iter().find(|of| (of.path, of.albedo) == (path, albedo))
    }

    /// Ratios against mean free paths.
    pub fn plot(&self) -> Plot {
        let line = |of: &[MomentRatio]| {
            let points = of.iter().map(|moment| (f64::from(moment.path), moment.ratio)).collect();
            Line::dotted(format!("squared distance, albedo {}", of[0].albedo), points)
        };
        let far = |of: &[Monopole]| {
            let points = of.iter().map(|monopole| (f64::from(monopole.path), monopole.ratio)).collect();
            Line::dotted(format!("fluence far away, albedo {}", of[0].albedo), points)
        };
        let far = self.monopoles.chunk_by(|a, b| a.albedo == b.albedo).map(far);
        let lines = self.moments.chunk_by(|a, b| a.albedo == b.albedo).map(line).chain(far);
        Plot {
            x: "mean free path, cells",
            is_logarithmic: true,
            y: "over what theory has",
            lines: lines.collect(),
            level: Some(("right", 1.0)),
        }
    }

    /// Rows of a table.
    pub fn rows(&self) -> Vec<Vec<String>> {
        let row = |moment: &MomentRatio| {
            let MomentRatio { path, albedo, ratio } = moment;
            let far = self.monopole(*path, *albedo);
            vec![
                path.to_string(),
                albedo.to_string(),
                format!("{ratio:.3}"),
                far.map_or(String::new(), |far| format!("{:.3}", far.ratio)),
            ]
        };
        let head = ["mean free path", "albedo", "squared distance", "fluence far away"];
        let head = head.map(str::to_owned).to_vec();
        let ([(_, [axis, _, corner]), _], two) = (&self.directions, &self.ringing);
        let others = [
            ("energy lost", self.energy_loss),
            ("flux along axes over corners", axis[0] / corner[0]),
            ("flux along axes over corners in two bands", two.flux[0] / two.flux[2]),
            ("less than nothing in two bands", two.negative),
        ];
        let other = |(name, value): (&str, f64)| {
            vec![name.to_owned(), String::new(), format!("{value:.2e}"), String::new()]
        };
        std::iter::once(head).chain(self.moments.iter().map(row)).chain(others.map(other)).collect()
    }
}
