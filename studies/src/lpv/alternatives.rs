//! The paper's Figure 5: what could be shown of a scene in fog, and how far each is from all its light.

use super::scores::Row;
use super::subject::LpvFrame;
use anyhow::{Result, ensure};
use deepshade_render::lpv::Scheme;
use deepshade_render::lpv::lobe::Lobes;
use deepshade_render::methods::Quality;
use deepshade_render::methods::lpv::LpvParameters;
use deepshade_render::methods::lpv::passes::Pixel;
use deepshade_render::path::LightPart;
use deepshade_shaders::{Effect, Planes};
use serde_json::{Map, Value};

/// Cells along the scene, and iterations, at which multiple scattering is measured by itself.
const GRIDS: [usize; 2] = [32, 64];
const ITERATIONS: [usize; 7] = [1, 2, 4, 8, 16, 32, 64];

/// Cells along the scene of a grid with the paper's lobes, and as many iterations.
const BANDS_CELLS: usize = 32;

/// What is shown of a scene.
pub struct Alternatives {
    /// All light, path traced.
    pub truth: Planes,
    /// What the paper compares, by the names of figures.
    pub images: Vec<(&'static str, Planes)>,
    /// Scores of everything.
    pub rows: Vec<Row>,
}

/// The sum of images.
fn sum(images: &[&Planes]) -> Planes {
    let mut sum = images[0].clone();
    for image in &images[1..] {
        sum.data_mut().iter_mut().zip(image.data()).for_each(|(sum, value)| *sum += value);
    }
    sum
}

/// An image less another.
fn less(image: &Planes, other: &Planes) -> Planes {
    let mut left = image.clone();
    left.data_mut().iter_mut().zip(other.data()).for_each(|(left, value)| *left = (*left - value).max(0.0));
    left
}

impl Alternatives {
    /// Measures them against truth of so many samples a pixel. Light that the medium scatters once is that of
    /// the epipolar method, and in rows of their own truth's; light that surfaces send straight to the camera
    /// is truth's in all of them.
    ///
    /// # Errors
    /// If the device fails, or the camera sees no light.
    pub fn of(subject: &LpvFrame<'_>, samples: u32) -> Result<Self> {
        let truth = |effect, part| subject.truth(effect, part, samples);
        let all = truth(Effect::Path, LightPart::All);
        ensure!(all.data().iter().any(|value| *value > 0.0), "the camera sees no light");
        let traced_single = truth(Effect::FogDirect, LightPart::All);
        let shadowed = less(&truth(Effect::Path, LightPart::Direct), &traced_single);
        let single = subject.single()?;
        let lit = subject.lit()?;
        let parameters = LpvParameters::of(Quality::High);
        let shown = |medium, surface| subject.indirect(parameters, Pixel { medium, surface });
        let (on_surfaces, marched) = (shown(false, true)?, shown(true, false)?);
        let multiple = subject.multiple(parameters)?;
        let as_in_paper = LpvParameters { scheme: Scheme::PAPER, ..parameters };
        let paper = subject.multiple(as_in_paper)?;
        let papers_indirect = subject.indirect(as_in_paper, Pixel { medium: true, surface: true })?;
        let ours = |single| sum(&[&shadowed, single, &on_surfaces, &marched, &multiple]);
        let papers = |single| sum(&[&shadowed, single, &papers_indirect, &paper]);
        let images = vec![
            ("shadow_map", sum(&[&shadowed])),
            ("plain", sum(&[&shadowed, &on_surfaces])),
            ("single", sum(&[&shadowed, &single])),
            ("marched", sum(&[&shadowed, &on_surfaces, &marched])),
            ("sum", sum(&[&shadowed, &single, &on_surfaces, &marched])),
            ("lpv", ours(&single)),
            ("paper", papers(&single)),
        ];
        let mut rows: Vec<Row> =
            images.iter().map(|(name, image)| Row::new(name, image, &all, &lit)).collect();
        for (name, image) in [
            ("lpv_traced_single", ours(&traced_single)),
            ("paper_traced_single", papers(&traced_single)),
            ("black", less(&all, &all)),
        ] {
            rows.push(Row::new(name, &image, &all, &lit));
        }
        let wanted = truth(Effect::FogMultiple, LightPart::All);
        let mut score = |name: &str, image: &Planes| rows.push(Row::new(name, image, &wanted, &lit));
        score("multiple", &multiple);
        score("multiple_paper", &paper);
        for cells in GRIDS {
            for iterations in ITERATIONS {
                let image = subject.multiple(LpvParameters { cells, iterations, ..parameters })?;
                score(&format!("multiple_{cells}_{iterations}"), &image);
            }
        }
        let scheme = Scheme { lobes: Lobes::TwoBands, ..Scheme::OURS };
        let (cells, iterations) = (BANDS_CELLS, BANDS_CELLS);
        let image = subject.multiple(LpvParameters { cells, iterations, scheme, ..parameters })?;
        score("multiple_two_bands", &image);
        Ok(Self { truth: all, images, rows })
    }

    /// Scores by the names of figures.
    pub fn figures(&self) -> Map<String, Value> {
        self.rows.iter().flat_map(Row::figures).map(|(name, score)| (name, score.into())).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use deepshade::shared::arguments::Size;
    use deepshade_shaders::gpu::Gpu;

    #[test]
    fn light_that_the_medium_scatters_once_is_as_bright_as_in_truth() {
        let gpu = Gpu::new().expect("an adapter");
        let source = "colonnade:1".parse().expect("a scene");
        let subject = LpvFrame::new(&gpu, &source, Size { width: 64, height: 36 }).expect("a frame");
        let mean = |image: &Planes| image.data().iter().sum::<f32>();
        let truth = subject.truth(Effect::FogDirect, LightPart::All, 256);
        let brightness = mean(&subject.single().expect("an image")) / mean(&truth);
        assert!((brightness - 1.0).abs() < 0.1, "{brightness}");
    }

    /// Where the frame has no shadow maps, the lamp shines through vaults and columns, and there is three
    /// times as much.
    #[test]
    fn surfaces_throw_as_much_light_into_fog_as_in_truth() {
        let gpu = Gpu::new().expect("an adapter");
        let source = "colonnade:1".parse().expect("a scene");
        let subject = LpvFrame::new(&gpu, &source, Size { width: 64, height: 36 }).expect("a frame");
        let parameters = LpvParameters { cells: 32, iterations: 32, ..LpvParameters::of(Quality::Low) };
        let pixel = Pixel { medium: true, surface: false };
        let image = subject.indirect(parameters, pixel).expect("an image");
        let truth = subject.truth(Effect::FogIndirect, LightPart::All, 256);
        let mean = |image: &Planes| image.data().iter().sum::<f32>();
        let brightness = mean(&image) / mean(&truth);
        assert!((0.6..1.6).contains(&brightness), "{brightness}");
    }
}
