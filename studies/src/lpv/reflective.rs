//! Light of surfaces injected from surfels, as the method does, and from a reflective shadow map, as the
//! paper does: how far each is from what a map of very many texels has, cell by cell, and what it takes.

use super::subject::LpvFrame;
use crate::stages::{Cost, Stage};
use anyhow::Result;
use deepshade::shared::figures::Figures;
use deepshade_render::lpv::LightGrid;
use deepshade_render::methods::Quality;
use deepshade_render::methods::lpv::LpvParameters;
use glam::Vec3;

/// Cells along the scene.
const CELLS: usize = 32;
/// Edges of maps, texels: the paper's, a larger one, and one that is taken for exact.
const SIZES: [usize; 2] = [256, 512];
const EXACT: usize = 1536;

/// How much light each way puts into other cells than it should, as a share of all, and milliseconds.
pub struct Injections(Vec<(String, f64, f64)>);

/// Texels of a map: places, normals and reflected power, red.
pub type Texels = Vec<(Vec3, Vec3, f32)>;

/// Watts of red light in each cell, from where surfels put it: half a cell before the surface.
fn injected(grid: &LightGrid, texels: &Texels) -> Vec<f64> {
    let mut light = vec![0.0; grid.cells()];
    for (point, normal, power) in texels {
        if let Some(cell) = grid.index((grid.in_cells(*point) + 0.5 * *normal).floor().as_ivec3()) {
            light[cell] += f64::from(*power);
        }
    }
    light
}

/// What of light is in other cells, or is too much or too little, over all of it.
fn off(light: &[f64], exact: &[f64]) -> f64 {
    let apart: f64 = light.iter().zip(exact).map(|(a, b)| (a - b).abs()).sum();
    apart / exact.iter().sum::<f64>()
}

impl Injections {
    /// Of the frame's lamp.
    ///
    /// # Errors
    /// If the device fails.
    pub fn of(subject: &LpvFrame<'_>, runs: usize) -> Result<Self> {
        let parameters = LpvParameters { cells: CELLS, iterations: 1, ..LpvParameters::of(Quality::Medium) };
        let grid = subject.grid(parameters);
        let (exact, _) = subject.reflective(EXACT, 1)?;
        let exact = injected(&grid, &exact);
        let mut found = Vec::new();
        for size in SIZES {
            let (texels, milliseconds) = subject.reflective(size, runs)?;
            found.push((format!("map_{size}"), off(&injected(&grid, &texels), &exact), milliseconds));
        }
        let passes = subject.clear(parameters)?;
        let light = subject.sent_by_surfels(&passes, f64::from(grid.cell * grid.cell))?;
        let cost = Cost::of(subject.gpu, &passes, runs)?;
        let milliseconds = [Stage::Surfels, Stage::Light].map(|stage| cost.of_stage(stage)).iter().sum();
        found.push(("surfels".to_owned(), off(&light, &exact), milliseconds));
        Ok(Self(found))
    }

    /// Sets its figures.
    pub fn set(&self, figures: &mut Figures) {
        for (name, off, milliseconds) in &self.0 {
            figures.set(&format!("injection_error_{name}"), *off);
            figures.set(&format!("ms_injection_{name}"), *milliseconds);
        }
    }

    /// Rows of a table.
    pub fn rows(&self) -> Vec<Vec<String>> {
        let head = ["light injected from", "in other cells", "ms without injecting"].map(str::to_owned);
        let row = |(name, off, milliseconds): &(String, f64, f64)| {
            vec![name.replace('_', " "), format!("{off:.4}"), format!("{milliseconds:.2}")]
        };
        std::iter::once(head.to_vec()).chain(self.0.iter().map(row)).collect()
    }
}
