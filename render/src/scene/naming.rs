//! What files call the materials of a scene, whose names need not differ.

use super::{Material, Scene};
use std::collections::HashMap;

impl Scene {
    /// What files call each material: its name, or where several have that name `name#1`, `name#2` and so on,
    /// in the scene's order; a number that makes the name of another material is left out.
    pub fn material_names(&self) -> Vec<String> {
        let mut counts = HashMap::<&str, usize>::new();
        self.materials.iter().for_each(|material| *counts.entry(&material.name).or_default() += 1);
        let mut numbers = HashMap::<&str, usize>::new();
        let names = self.materials.iter().map(|Material { name, .. }| {
            if counts[name.as_str()] == 1 {
                return name.clone();
            }
            let number = numbers.entry(name).or_default();
            loop {
                *number += 1;
                let numbered = format!("{name}#{number}");
                if !counts.contains_key(numbered.as_str()) {
                    return numbered;
                }
            }
        });
        names.collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn called(names: &[&str]) -> Vec<String> {
        let materials = names.iter().map(|name| Material::matte(name, Vec3::ONE)).collect();
        Scene { materials, ..Scene::default() }.material_names()
    }

    #[test]
    fn materials_of_one_name_have_numbers() {
        let names = called(&["paint", "wall", "paint", "floor", "paint"]);
        assert_eq!(names, ["paint#1", "wall", "paint#2", "floor", "paint#3"]);
    }

    #[test]
    fn no_number_makes_the_name_of_another() {
        assert_eq!(called(&["paint", "paint", "paint#2"]), ["paint#1", "paint#3", "paint#2"]);
        let twice = called(&["paint", "paint#1", "paint", "paint#1"]);
        assert_eq!(twice, ["paint#2", "paint#1#1", "paint#3", "paint#1#2"]);
    }
}
