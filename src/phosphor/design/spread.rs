//! From materials that were designed to others of the scene that are like them (thesis, section 8.6: edits
//! propagate).

use super::Designed;
use anyhow::Result;
use deepshade_glow::material::Material;
use deepshade_phosphor::design::{Edit, Feature, Reach};
use deepshade_render::scene::{Bounds, Scene};
use glam::Vec3;

/// Materials less alike than this to all that were designed keep no light.
const ALIKE: f64 = 0.367_879_441; // 1/e

/// The paints of a scene's materials, by what files call them: those that were designed, and of materials
/// like them.
///
/// # Errors
/// If designs have no mean, which those of one task have.
pub fn paints(found: &[Designed], scene: &Scene, reach: Option<Reach>) -> Result<Vec<(String, Material)>> {
    let own = found.iter().map(|found| (found.name.clone(), found.design.material.clone()));
    let mut paints: Vec<(String, Material)> = own.collect();
    let Some(reach) = reach else { return Ok(paints) };
    let edits: Vec<Edit> = found.iter().flat_map(|found| edits(found, scene)).collect();
    for (index, (material, name)) in scene.materials.iter().zip(scene.material_names()).enumerate() {
        let Some(place) = middle(scene, index) else { continue };
        if found.iter().any(|found| found.material == index) {
            continue;
        }
        let spread = reach.propagate(&edits, feature(place, material.base_colour.truncate()))?;
        if spread.affinity >= ALIKE {
            let paint = Material { name: format!("{name}, like others"), ..spread.material };
            paints.push((name, paint));
        }
    }
    Ok(paints)
}

/// Where a material was designed, and with what colour.
fn edits(found: &Designed, scene: &Scene) -> Vec<Edit> {
    let colour = scene.materials[found.material].base_colour.truncate();
    let edit =
        |position| Edit { feature: feature(position, colour), material: found.design.material.clone() };
    found.spots.iter().map(|spot| edit(spot.position)).collect()
}

fn feature(position: Vec3, colour: Vec3) -> Feature {
    Feature { position: position.as_dvec3().to_array(), colour: colour.as_dvec3().to_array() }
}

/// The middle of all that is of a material; nothing where nothing is.
fn middle(scene: &Scene, material: usize) -> Option<Vec3> {
    let own = scene.meshes.iter().filter(|mesh| mesh.material.0 as usize == material);
    let bounds = own.map(|mesh| mesh.bounds()).reduce(Bounds::union)?;
    Some(bounds.centre())
}
