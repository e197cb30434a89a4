//! What shines and what scatters, as the script reads it.

use super::super::files::write_pfm;
use anyhow::{Result, ensure};
use deepshade_render::scene::medium::write_vol;
use deepshade_render::scene::{Bounds, Density, Environment, Light, Medium};
use glam::Vec3;
use serde_json::{Value, json};
use std::path::Path;

/// A light without an extent.
///
/// # Errors
/// If Mitsuba has no such light.
pub fn light(light: &Light, brightness: f32) -> Result<Value> {
    Ok(match *light {
        Light::Point { position, intensity, range } => {
            ensure!(range.is_infinite(), "Mitsuba's point lights have no range");
            json!({
                "type": "point",
                "position": position.to_array(),
                "intensity": (intensity * brightness).to_array(),
            })
        }
        Light::Directional { direction, irradiance, .. } => json!({
            "type": "directional",
            "direction": direction.to_array(),
            "irradiance": (irradiance * brightness).to_array(),
        }),
        Light::Spot { position, direction, intensity, range, cos_inner, cos_outer, .. } => {
            ensure!(range.is_infinite(), "Mitsuba's spots have no range");
            json!({
                "type": "spot",
                "position": position.to_array(),
                "direction": direction.to_array(),
                "up": direction.any_orthonormal_vector().to_array(),
                "intensity": (intensity * brightness).to_array(),
                "cutoff_degrees": cos_outer.acos().to_degrees(),
                "beam_degrees": cos_inner.acos().to_degrees(),
            })
        }
    })
}

/// Writes an environment map as Mitsuba interpolates it: as many columns, and rows from pole to pole at twice
/// ours and between, so that both are the same function.
///
/// # Errors
/// If the file cannot be written.
pub fn environment(folder: &Path, map: &Environment, brightness: f32) -> Result<&'static str> {
    const FILE: &str = "environment.pfm";
    let [width, height] = map.size();
    let rows = 2 * height + 1;
    let radiance = |i: usize| {
        let u = ((i % width) as f32 + 0.5) / width as f32;
        let v = (i / width) as f32 / (rows - 1) as f32;
        let (sin, cos) = (std::f32::consts::TAU * u).sin_cos();
        let (side, up) = (std::f32::consts::PI * v).sin_cos();
        map.radiance(Vec3::new(sin * side, up, -cos * side)) * brightness
    };
    write_pfm(&folder.join(FILE), [width, rows], &(0..width * rows).map(radiance).collect::<Vec<_>>())?;
    Ok(FILE)
}

/// The box that a medium fills.
pub const fn bounds(medium: &Medium) -> Option<Bounds> {
    match &medium.density {
        Density::Everywhere => None,
        Density::Within(bounds) => Some(*bounds),
        Density::Grid(grid) => Some(grid.bounds()),
    }
}

/// Writes a medium's grid, if it has one.
///
/// # Errors
/// If the file cannot be written, or Mitsuba has no such medium.
pub fn medium(folder: &Path, medium: &Medium) -> Result<Value> {
    const FILE: &str = "extinction.vol";
    let bounds = bounds(medium);
    ensure!(bounds.is_some(), "Mitsuba's media are inside of something");
    let extinction = medium.extinction();
    ensure!(extinction.min_element() > 0.0, "a colour that the medium lets through has no albedo");
    if let Density::Grid(grid) = &medium.density {
        let values: Vec<f32> =
            grid.values().iter().flat_map(|density| (extinction * *density).to_array()).collect();
        let unit = Bounds { min: Vec3::ZERO, max: Vec3::ONE };
        write_vol(&folder.join(FILE), unit, grid.size(), 3, &values)?;
    }
    Ok(json!({
        "bounds": bounds.map(|bounds| [bounds.min.to_array(), bounds.max.to_array()]),
        "extinction": extinction.to_array(),
        "albedo": (medium.scattering / extinction).to_array(),
        "anisotropy": medium.anisotropy,
        "grid": matches!(medium.density, Density::Grid(_)).then_some(FILE),
    }))
}
