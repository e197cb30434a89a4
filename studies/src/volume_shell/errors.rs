//! Errors against path-traced truth: of thresholds (Nalbach, Ritschel and Seidel 2014, Figure 11), and with
//! and without what is done in another way than in the paper.

use super::subject::{ShellFrame, error};
use crate::stages::Stage;
use anyhow::Result;
use deepshade::shared::figures::Figures;
use deepshade_render::methods::volume_shell::{Improvement, Improvements, VolumeShellParameters};
use serde_json::{Value, json};

/// The paper's thresholds.
const THRESHOLDS: [f32; 4] = [1.0, 0.35, 0.06, 0.035];

/// What is varied.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Variant {
    /// As the method runs.
    Ours,
    /// As in the paper.
    Paper,
    /// Without one improvement.
    Without(Improvement),
    /// With another threshold.
    Threshold(f32),
}

/// A variant, its error, and the milliseconds of its splats.
struct Row {
    variant: Variant,
    error: f64,
    splat: f64,
}

/// Errors of all variants.
pub struct Errors(Vec<Row>);

impl Variant {
    fn all() -> impl Iterator<Item = Self> {
        let without = Improvement::ALL.into_iter().map(Self::Without);
        [Self::Ours, Self::Paper].into_iter().chain(without).chain(THRESHOLDS.map(Self::Threshold))
    }

    fn parameters(self, usual: VolumeShellParameters) -> VolumeShellParameters {
        match self {
            Self::Ours => usual,
            Self::Paper => VolumeShellParameters { improvements: Improvements::NONE, ..usual },
            Self::Without(improvement) => {
                VolumeShellParameters { improvements: usual.improvements.without(improvement), ..usual }
            }
            Self::Threshold(threshold) => VolumeShellParameters { threshold, ..usual },
        }
    }

    /// What its figures end with.
    fn suffix(self) -> String {
        match self {
            Self::Ours => String::new(),
            Self::Paper => "_paper".to_owned(),
            Self::Without(improvement) => format!("_without_{}", improvement.name()),
            Self::Threshold(threshold) => format!("_epsilon_{threshold}"),
        }
    }
}

impl std::fmt::Display for Variant {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Ours => f.write_str("ours"),
            Self::Paper => f.write_str("as in the paper"),
            Self::Without(improvement) => write!(f, "without {}", improvement.name()),
            Self::Threshold(threshold) => write!(f, "epsilon {threshold}"),
        }
    }
}

impl Errors {
    /// Measures them against truth of so many samples a pixel.
    ///
    /// # Errors
    /// If the device fails.
    pub fn of(
        subject: &ShellFrame<'_>,
        usual: VolumeShellParameters,
        samples: u32,
        runs: usize,
    ) -> Result<Self> {
        let truth = subject.truth(samples);
        let row = |variant: Variant| {
            let shaded = subject.shaded(variant.parameters(usual), runs)?;
            let splat = shaded.cost.of_stage(Stage::Splat);
            Ok(Row { variant, error: error(&shaded.image, &truth), splat })
        };
        Ok(Self(Variant::all().map(row).collect::<Result<_>>()?))
    }

    /// Sets its figures.
    pub fn set(&self, figures: &mut Figures) {
        for Row { variant, error, splat } in &self.0 {
            figures.set(&format!("relmse{}", variant.suffix()), *error);
            if *variant != Variant::Ours {
                figures.set(&format!("ms_splat{}", variant.suffix()), *splat);
            }
        }
    }

    /// Everything that was measured.
    pub fn to_json(&self) -> Value {
        let row = |Row { variant, error, splat }: &Row| json!({ "variant": variant.to_string(), "relmse": error, "ms_splat": splat });
        self.0.iter().map(row).collect()
    }

    /// Rows of a table.
    pub fn rows(&self) -> Vec<Vec<String>> {
        let head = ["indirect light", "relMSE", "splat ms"].map(str::to_owned).to_vec();
        let row = |Row { variant, error, splat }: &Row| {
            vec![variant.to_string(), format!("{error:.4}"), format!("{splat:.1}")]
        };
        std::iter::once(head).chain(self.0.iter().map(row)).collect()
    }
}
