//! What files call the materials of a scene, whose names need not differ.

use super::{Material, Scene};
use std::collections::HashMap;

impl Scene {
    /// What files call each material: its name, or where several have that name `name#1`, `name#2` and so on, in the scene's order.
    pub fn material_names(&self) -> Vec<String> {
        let mut counts = HashMap::<&str, usize>::new();
        self.materials.iter().for_each(|material| *counts.entry(&material.name).or_default() += 1);
        let mut numbers = HashMap::<&str, usize>::new();
        let names = self.materials.iter().map(|Material { name, .. }| {
            let number = numbers.entry(name).or_default();
            *number += 1;
            if counts[name.as_str()] == 1 { name.clone() } else { format!("{name}#{number}") }
        });
        names.collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn materials_of_one_name_have_numbers() {
        let materials =
            ["paint", "wall", "paint", "floor", "paint"].map(|name| Material::matte(name, Vec3::ONE));
        let scene = Scene { materials: materials.to_vec(), ..Scene::default() };
        assert_eq!(scene.material_names(), ["paint#1", "wall", "paint#2", "floor", "paint#3"]);
    }
}
