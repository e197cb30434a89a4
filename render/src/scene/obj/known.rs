//! Materials by the names that faces use.

use super::parse::{Named, Obj};
use super::statement::{is_nameless, readings};
use super::warnings::Warnings;
use crate::scene::{Material, MaterialId};
use std::collections::HashMap;
use std::collections::hash_map::Entry;

/// The material of each name that faces use: that of the first library that has it.
pub(super) fn ids(obj: &Obj, materials: &[Material], warnings: &mut Warnings) -> Vec<Option<MaterialId>> {
    let known = Known::new(materials);
    let ids: Vec<_> = obj.materials.iter().map(|Named { name, .. }| known.id(name)).collect();
    let mut unknown = Vec::new();
    for (Named { name, line }, id) in obj.materials.iter().zip(&ids) {
        match id {
            Some(MaterialId(id)) if name.is_empty() => {
                let only = &materials[*id as usize].name;
                warnings
                    .add(*line, format!("`usemtl` without a name is taken for the only material `{only}`"));
            }
            None if name.is_empty() => {
                warnings.keep(*line, "`usemtl` without a name; the faces behind it are white".to_owned());
            }
            None => unknown.push((name.as_str(), *line)),
            Some(_) => {}
        }
    }
    if let Some((_, line)) = unknown.first() {
        warnings.keep(*line, no_material(&unknown));
    }
    ids
}

/// What is said of names that no library has, and their lines.
fn no_material(unknown: &[(&str, usize)]) -> String {
    if let [(name, _)] = unknown {
        return format!("no library has the material `{name}`; its faces are white");
    }
    let names: Vec<String> = unknown.iter().map(|(name, line)| format!("`{name}` (line {line})")).collect();
    format!("no library has the materials {}; their faces are white", names.join(", "))
}

struct Known<'a> {
    whole: HashMap<&'a str, MaterialId>,
    /// By what is left of names without what may be a comment; nothing where it is left of several.
    cut: HashMap<&'a str, Option<MaterialId>>,
}

impl<'a> Known<'a> {
    fn new(materials: &'a [Material]) -> Self {
        let (mut whole, mut cut) = (HashMap::new(), HashMap::new());
        for (index, Material { name, .. }) in materials.iter().enumerate() {
            let Entry::Vacant(new) = whole.entry(name.as_str()) else { continue };
            let id = MaterialId(index as u32);
            new.insert(id);
            for reading in readings(name).skip(1) {
                cut.entry(reading).and_modify(|known| *known = None).or_insert(Some(id));
            }
        }
        Self { whole, cut }
    }

    /// The material of a name: as it is, or without a comment behind it, here or in the library. Where there
    /// is no name it is the only material.
    fn id(&self, name: &str) -> Option<MaterialId> {
        if name.is_empty() {
            let only = self.whole.values().next().copied();
            return only.filter(|_| self.whole.len() == 1);
        }
        if let Some(id) = readings(name).find_map(|reading| self.whole.get(reading)) {
            return Some(*id);
        }
        // `#2` behind a space is a number, as 3ds Max writes it, where the library has a `#1`.
        let has_comment = |reading: &&str| is_nameless(name[reading.len()..].trim_start());
        readings(name).filter(has_comment).find_map(|reading| self.cut.get(reading).copied().flatten())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn found(materials: &[&str], used: &[&str]) -> (Vec<Option<u32>>, Vec<String>) {
        let named = |name: &&str| Material { name: (*name).to_owned(), ..Material::default() };
        let materials: Vec<Material> = materials.iter().map(named).collect();
        let used = used.iter().enumerate();
        let used = used.map(|(i, name)| Named { name: (*name).to_owned(), line: i + 1 }).collect();
        let mut warnings = Warnings::default();
        let obj = Obj { materials: used, ..Obj::default() };
        let ids = ids(&obj, &materials, &mut warnings);
        (ids.iter().map(|id| id.map(|id| id.0)).collect(), warnings.about(Path::new("a")))
    }

    #[test]
    fn a_number_sign_is_of_the_name_or_begins_a_comment() {
        let max = ["Material #1", "Material #2", "red # paint", "blue"];
        let used =
            ["Material #2", "Material #1", "red", "red # front", "blue # sky", "blue #sky", "red # paint"];
        let expected = [1, 0, 2, 2, 3, 3, 2].map(Some);
        assert_eq!(found(&max, &used), (expected.to_vec(), Vec::new()));
        let (ids, said) = found(&max[..2], &["Material #3", "Material", "Material # paint"]);
        assert_eq!((ids, said.len()), (vec![None; 3], 1), "one of two is not chosen");
        assert_eq!(found(&max[..1], &["Material #2"]).0, [None], "another number");
        let ids = found(&["m #1 # shiny", "m #2 # dull"], &["m #2", "m #1 # first", "m"]).0;
        assert_eq!(ids, [Some(1), Some(0), None]);
    }

    #[test]
    fn the_first_of_the_same_name_counts() {
        assert_eq!(found(&["a", "b", "a"], &["b", "a"]).0, [Some(1), Some(0)]);
    }

    #[test]
    fn no_name_is_the_only_material() {
        let (ids, said) = found(&["red", "red"], &[""]);
        assert_eq!((ids, said.len()), (vec![Some(0)], 1));
        for materials in [&["red", "blue"][..], &[]] {
            let (ids, said) = found(materials, &[""]);
            assert_eq!(ids, [None]);
            assert_eq!(said, ["a: line 1: `usemtl` without a name; the faces behind it are white"]);
        }
    }

    #[test]
    fn all_unknown_names_are_in_one_sentence() {
        let names: Vec<String> = (1..=50).map(|i| format!("m{i}")).collect();
        let mut used: Vec<&str> = names.iter().map(String::as_str).collect();
        used[9] = "red";
        let (ids, said) = found(&["red"], &used);
        assert_eq!((ids[9], ids.iter().flatten().count(), said.len()), (Some(0), 1, 1));
        let all =
            said[0].starts_with("a: line 1: no library has the materials `m1` (line 1), `m2` (line 2), ");
        assert!(all && said[0].contains("`m50` (line 50); ") && !said[0].contains("`m10`"), "{said:?}");
    }
}
