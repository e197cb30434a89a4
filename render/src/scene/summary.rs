//! What a scene holds, in numbers.

use super::{Bounds, Light, Scene};
use std::fmt;

/// Materials and lights that are listed one by one.
const LISTED: usize = 8;

/// What a scene holds, in numbers; prints as one line a number.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneSummary {
    /// What the scene is called.
    pub name: String,
    /// Triangles with an area, instances counted each.
    pub triangles: usize,
    /// Meshes, one for every placed part of an object.
    pub meshes: usize,
    /// Materials.
    pub materials: Vec<MaterialSummary>,
    /// Textures.
    pub textures: usize,
    /// Point, spot and directional lights.
    pub lights: Vec<Light>,
    /// Names of the cameras.
    pub cameras: Vec<String>,
    /// The box around all triangles, metres.
    pub bounds: Bounds,
}

impl SceneSummary {
    /// Counts what is in a scene.
    pub fn of(scene: &Scene) -> Self {
        Self {
            name: scene.name.clone(),
            triangles: scene.triangle_count(),
            meshes: scene.meshes.len(),
            materials: materials(scene),
            textures: scene.textures.len(),
            lights: scene.lights.clone(),
            cameras: scene.cameras.iter().map(|(name, _)| name.clone()).collect(),
            bounds: scene.bounds(),
        }
    }
}

/// A material of a scene, and what is of it.
#[derive(Clone, Debug, PartialEq)]
pub struct MaterialSummary {
    /// What files call it: [`Scene::material_names`].
    pub name: String,
    /// Triangles with an area.
    pub triangles: usize,
    /// The box around them, metres.
    pub bounds: Bounds,
}

fn materials(scene: &Scene) -> Vec<MaterialSummary> {
    let unused = |name| MaterialSummary { name, triangles: 0, bounds: Bounds::EMPTY };
    let mut materials: Vec<MaterialSummary> = scene.material_names().into_iter().map(unused).collect();
    for mesh in &scene.meshes {
        let its = &mut materials[mesh.material.0 as usize];
        its.triangles += mesh.triangles.len();
        its.bounds = its.bounds.union(mesh.bounds());
    }
    materials
}

impl fmt::Display for MaterialSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, triangles, bounds } = self;
        if *triangles == 0 {
            return write!(f, "{name}, not used");
        }
        let middle = bounds.centre();
        let plural = if *triangles == 1 { "" } else { "s" };
        write!(
            f,
            "{name}, {triangles} triangle{plural} around ({:.3}, {:.3}, {:.3}) m",
            middle.x, middle.y, middle.z
        )
    }
}

/// The first of many, a line each, and how many more there are.
fn list(f: &mut fmt::Formatter<'_>, all: &[impl fmt::Display]) -> fmt::Result {
    all.iter().take(LISTED).try_for_each(|one| writeln!(f, "           {one}"))?;
    match all.len().saturating_sub(LISTED) {
        0 => Ok(()),
        more => writeln!(f, "           and {more} more"),
    }
}

impl fmt::Display for SceneSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Bounds { min, max } = self.bounds;
        writeln!(f, "scene      {}", self.name)?;
        writeln!(f, "triangles  {}", self.triangles)?;
        writeln!(f, "meshes     {}", self.meshes)?;
        writeln!(f, "materials  {}", self.materials.len())?;
        list(f, &self.materials)?;
        writeln!(f, "textures   {}", self.textures)?;
        writeln!(f, "lights     {}", self.lights.len())?;
        list(f, &self.lights)?;
        match self.cameras.as_slice() {
            [] => writeln!(f, "cameras    0")?,
            names => writeln!(f, "cameras    {} ({})", names.len(), names.join(", "))?,
        }
        writeln!(
            f,
            "bounds     ({:.3}, {:.3}, {:.3}) to ({:.3}, {:.3}, {:.3}) m",
            min.x, min.y, min.z, max.x, max.y, max.z
        )?;
        write!(f, "diagonal   {:.3} m", self.bounds.diagonal())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Camera, Material, Mesh};
    use glam::Vec3;

    #[test]
    fn a_summary_counts_and_names() {
        let positions = vec![Vec3::ZERO, Vec3::new(3.0, 0.0, 0.0), Vec3::new(0.0, 4.0, 0.0)];
        let mesh = Mesh { positions, triangles: vec![[0, 1, 2]], ..Mesh::default() };
        let cameras = ["front", "side"].map(|name| (name.to_owned(), Camera::look_at(Vec3::Z, Vec3::ZERO)));
        let lamp = Light::Point { position: Vec3::Y, intensity: Vec3::ONE, range: f32::INFINITY };
        let scene = Scene {
            name: "corner".into(),
            meshes: vec![mesh].into(),
            cameras: cameras.to_vec(),
            lights: vec![lamp; LISTED + 2],
            materials: vec![Material::matte("paint", Vec3::ONE); LISTED + 3],
            ..Scene::default()
        };
        let text = SceneSummary::of(&scene).to_string();
        for line in [
            "scene      corner",
            "triangles  1",
            "materials  11",
            "           paint#1, 1 triangle around (1.500, 2.000, 0.000) m",
            "           paint#8, not used",
            "           and 3 more",
            "lights     10",
            "           point at [0.000, 1.000, 0.000] m, [1.000, 1.000, 1.000] W/sr",
            "           and 2 more",
            "cameras    2 (front, side)",
            "diagonal   5.000 m",
        ] {
            assert!(text.lines().any(|found| found == line), "{line} in\n{text}");
        }
        assert!(!text.contains("paint#9"), "{text}");
    }
}
