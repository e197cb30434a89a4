//! MTL material libraries.
//!
//! Read are `Kd`, `d`, `Tr`, `Ke`, `Ks` and `Ns` as the width of the highlight, `map_Kd`, `map_d`, and of the
//! extension for physically based rendering `Pr`, `Pm`, `map_Ke` and `norm`. Left out are what the g-buffer has
//! no channel for, a highlight that varies over a surface (`map_Ks`, `map_Ns`, `map_Pr`, `map_Pm`), and relief
//! (`bump`, `disp`): those images hold heights in units that the file does not state, where `norm` holds normals.

use super::map::Map;
use super::parse::short;
use super::statement::{parts, statements};
use super::warnings::Warnings;
use glam::Vec3;

/// A material as a library states it; what it does not state is nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Stated {
    pub name: String,
    pub diffuse: Option<Vec3>,
    pub specular: Option<Vec3>,
    pub emission: Option<Vec3>,
    /// Phong exponent.
    pub exponent: Option<f32>,
    /// Opacity.
    pub dissolve: Option<f32>,
    pub roughness: Option<f32>,
    pub metallic: Option<f32>,
    pub diffuse_map: Option<Map>,
    pub dissolve_map: Option<Map>,
    pub emission_map: Option<Map>,
    pub normal_map: Option<Map>,
}

/// The materials of a library, in its order; of those with the same name the last one.
pub(super) fn parse(text: &str, warnings: &mut Warnings) -> Vec<Stated> {
    let mut materials: Vec<Stated> = Vec::new();
    let mut current = None;
    for (line, statement) in statements(text) {
        let (keyword, rest) = parts(&statement);
        if keyword == "newmtl" {
            let known = materials.iter().position(|material| material.name == rest);
            let stated = Stated { name: rest.to_owned(), ..Stated::default() };
            current = Some(known.unwrap_or(materials.len()));
            match known {
                Some(index) => materials[index] = stated,
                None => materials.push(stated),
            }
        } else if let Some(index) = current {
            Line { line, keyword, rest, warnings }.read(&mut materials[index]);
        } else {
            warnings.add(line, format!("`{}` before the first `newmtl` is passed over", short(keyword)));
        }
    }
    materials
}

/// A statement about a material.
struct Line<'a> {
    line: usize,
    keyword: &'a str,
    rest: &'a str,
    warnings: &'a mut Warnings,
}

impl Line<'_> {
    fn read(&mut self, material: &mut Stated) {
        // Exporters do not agree on capital letters.
        match self.keyword.to_ascii_lowercase().as_str() {
            "kd" => material.diffuse = self.colour().or(material.diffuse),
            "ks" => material.specular = self.colour().or(material.specular),
            "ke" => material.emission = self.colour().or(material.emission),
            "ns" => material.exponent = self.number().or(material.exponent),
            "d" if self.rest.starts_with("-halo") => {
                self.warnings.add(self.line, "`d -halo`, which varies with the angle, is passed over");
            }
            "d" => material.dissolve = self.number().or(material.dissolve),
            "tr" => {
                let opacity = self.number().map(|transparency| 1.0 - transparency);
                material.dissolve = material.dissolve.or(opacity);
            }
            "pr" => material.roughness = self.number().or(material.roughness),
            "pm" => material.metallic = self.number().or(material.metallic),
            "map_kd" => material.diffuse_map = self.map().or(material.diffuse_map.take()),
            "map_d" => material.dissolve_map = self.map().or(material.dissolve_map.take()),
            "map_ke" => material.emission_map = self.map().or(material.emission_map.take()),
            "norm" => material.normal_map = self.map().or(material.normal_map.take()),
            "ka" | "ni" | "tf" | "illum" | "sharpness" | "ps" | "pc" | "pcr" | "aniso" | "anisor"
            | "map_ka" | "map_ks" | "map_ns" | "map_pr" | "map_pm" | "map_ps" | "map_tr" | "map_bump"
            | "bump" | "disp" | "decal" | "refl" | "map_refl" | "map_aat" | "map_opacity" | "map_disp" => {}
            _ => self.warnings.add(self.line, format!("`{}` is passed over", short(self.keyword))),
        }
    }

    /// A colour of three numbers, or of one that counts for all.
    fn colour(&mut self) -> Option<Vec3> {
        let numbers: Option<Vec<f32>> = self.rest.split_ascii_whitespace().map(finite).collect();
        match numbers.as_deref() {
            Some([grey]) => Some(Vec3::splat(*grey)),
            Some([r, g, b, ..]) => Some(Vec3::new(*r, *g, *b)),
            _ => {
                self.pass_over("is no colour of one or three numbers");
                None
            }
        }
    }

    fn number(&mut self) -> Option<f32> {
        let number = self.rest.split_ascii_whitespace().next().and_then(finite);
        if number.is_none() {
            self.pass_over("is no number");
        }
        number
    }

    fn map(&mut self) -> Option<Map> {
        let (map, odd) = Map::parse(self.rest);
        if let Some(odd) = odd {
            self.warnings.add(self.line, format!("`{}`: {odd}", self.keyword));
        }
        map
    }

    fn pass_over(&mut self, why: &str) {
        let what = format!("`{} {}` {why} and is passed over", self.keyword, short(self.rest));
        self.warnings.add(self.line, what);
    }
}

fn finite(word: &str) -> Option<f32> {
    word.parse().ok().filter(|number: &f32| number.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn read(text: &str) -> (Vec<Stated>, Vec<String>) {
        let mut warnings = Warnings::default();
        let materials = parse(text, &mut warnings);
        (materials, warnings.about(Path::new("a")))
    }

    #[test]
    fn one_number_is_grey_and_what_is_no_colour_is_said_and_passed_over() {
        let (read_of, warnings) = read("\u{feff}newmtl a\nKd .8\nKe 0\n ks 1 0.5 0 # shine\n");
        assert_eq!(read_of[0].diffuse, Some(Vec3::splat(0.8)));
        assert_eq!(
            (read_of[0].emission, read_of[0].specular),
            (Some(Vec3::ZERO), Some(Vec3::new(1.0, 0.5, 0.0)))
        );
        assert!(warnings.is_empty());
        for odd in ["Kd 1 0", "Kd", "Ks nan 1 1", "Kd spectral a.rfl", "Ke xyz 1 1 1", "d inf", "Pr very"] {
            let (read_of, warnings) = read(&format!("newmtl a\nKa spectral a.rfl\n{odd}\nNs 3\n"));
            assert_eq!(read_of[0], Stated { name: "a".into(), exponent: Some(3.0), ..Stated::default() });
            assert!(warnings.len() == 1 && warnings[0].starts_with("a: line 3: "), "{odd}: {warnings:?}");
        }
    }

    #[test]
    fn opacity_is_stated_in_three_ways() {
        let opacity = |text: &str| read(&format!("newmtl a\n{text}\n")).0[0].dissolve;
        assert_eq!(
            ["d 0.25", "Tr 0.25", "Tr 0.1\nd 0.5", "d -halo 0"].map(opacity),
            [Some(0.25), Some(0.75), Some(0.5), None]
        );
    }

    #[test]
    fn names_have_spaces_and_the_last_of_the_same_name_counts() {
        let (materials, warnings) =
            read("Kd 1 1 1\nnewmtl red paint\nKd 1 0 0\nnewmtl b\nnewmtl red paint\nNs 1\n");
        let names: Vec<&str> = materials.iter().map(|material| material.name.as_str()).collect();
        assert_eq!((names.as_slice(), materials[0].diffuse), (&["red paint", "b"][..], None));
        assert_eq!(warnings, ["a: line 1: `Kd` before the first `newmtl` is passed over"]);
    }

    #[test]
    fn empty_maps_and_unknown_keywords_are_said() {
        let (materials, warnings) = read("newmtl a\nmap_Kd\nmap_d \nmap_Bump x.png\nhello 1\n");
        assert!(materials[0].diffuse_map.is_none() && materials[0].dissolve_map.is_none());
        assert_eq!(warnings.len(), 3, "{warnings:?}");
    }
}
