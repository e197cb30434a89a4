//! What a scene holds, in numbers.

use super::{Bounds, Scene};
use std::fmt;

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
    pub materials: usize,
    /// Textures.
    pub textures: usize,
    /// Point, spot and directional lights.
    pub lights: usize,
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
            materials: scene.materials.len(),
            textures: scene.textures.len(),
            lights: scene.lights.len(),
            cameras: scene.cameras.iter().map(|(name, _)| name.clone()).collect(),
            bounds: scene.bounds(),
        }
    }
}

impl fmt::Display for SceneSummary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Bounds { min, max } = self.bounds;
        writeln!(f, "scene      {}", self.name)?;
        writeln!(f, "triangles  {}", self.triangles)?;
        writeln!(f, "meshes     {}", self.meshes)?;
        writeln!(f, "materials  {}", self.materials)?;
        writeln!(f, "textures   {}", self.textures)?;
        writeln!(f, "lights     {}", self.lights)?;
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
    use crate::scene::{Camera, Mesh};
    use glam::Vec3;

    #[test]
    fn a_summary_counts_and_names() {
        let positions = vec![Vec3::ZERO, Vec3::new(3.0, 0.0, 0.0), Vec3::new(0.0, 4.0, 0.0)];
        let mesh = Mesh { positions, triangles: vec![[0, 1, 2]], ..Mesh::default() };
        let cameras = ["front", "side"].map(|name| (name.to_owned(), Camera::look_at(Vec3::Z, Vec3::ZERO)));
        let scene = Scene {
            name: "corner".into(),
            meshes: vec![mesh].into(),
            cameras: cameras.to_vec(),
            ..Scene::default()
        };
        let text = SceneSummary::of(&scene).to_string();
        for line in ["scene      corner", "triangles  1", "cameras    2 (front, side)", "diagonal   5.000 m"]
        {
            assert!(text.lines().any(|found| found == line), "{line} in\n{text}");
        }
    }
}
