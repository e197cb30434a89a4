//! MTL material libraries.
//!
//! Read are `Kd`, `d`, `Tr`, `Ke`, `Ks` and `Ns` as the width of the highlight, `map_Kd`, `map_d`
//! (`map_opacity`, and `map_Tr` as its inverse), and of the extension for physically based rendering `Pr`,
//! `Pm`, `map_Ke` and `norm`. Left out with a warning are what the g-buffer has no channel for, a highlight
//! that varies over a surface (`map_Ks`, `map_Ns`, `map_Pr`, `map_Pm`), and relief (`bump`, `disp`): those
//! images hold heights in units that the file does not state, where `norm` holds normals.

use super::files::Files;
use super::map::Map;
use super::parse::short;
use super::statement::{operands, parts, statements};
use super::warnings::Warnings;
use glam::Vec3;
use std::collections::HashMap;
use std::ops::RangeInclusive;

/// What shares of light and of a surface may be.
const SHARE: RangeInclusive<f32> = 0.0..=1.0;
/// What strengths may be.
const POSITIVE: RangeInclusive<f32> = 0.0..=f32::MAX;

/// A material as a library states it; what it does not state is nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct MtlMaterial {
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

/// The materials of a library, in its order; of those with the same name the last one. Names are with what
/// may be a comment.
pub(super) fn parse(text: &str, files: &Files, warnings: &mut Warnings) -> Vec<MtlMaterial> {
    let mut materials: Vec<MtlMaterial> = Vec::new();
    let mut known: HashMap<String, usize> = HashMap::new();
    let mut current = None;
    for (line, statement) in statements(text) {
        let (keyword, rest) = parts(&statement);
        if keyword == "newmtl" {
            let stated = MtlMaterial { name: rest.to_owned(), ..MtlMaterial::default() };
            let index = *known.entry(rest.to_owned()).or_insert(materials.len());
            match materials.get_mut(index) {
                Some(before) => *before = stated,
                None => materials.push(stated),
            }
            current = Some(index);
        } else if let Some(index) = current {
            Line { line, keyword, rest, files, warnings }.read(&mut materials[index]);
        } else {
            warnings.add(line, format!("`{}` before the first `newmtl` is passed over", short(keyword)));
        }
    }
    materials.iter().for_each(|material| compare_placements(material, warnings));
    materials
}

/// Says where an image of opacity would lie otherwise than that of colour: they are one texture.
fn compare_placements(material: &MtlMaterial, warnings: &mut Warnings) {
    if let (Some(colour), Some(dissolve)) = (&material.diffuse_map, &material.dissolve_map)
        && colour.placement != dissolve.placement
    {
        let what = "`map_d` is placed as `map_Kd` is; its own -s, -o and -clamp are left out";
        warnings.add(dissolve.line, what);
    }
}

/// A statement about a material.
struct Line<'a> {
    line: usize,
    keyword: &'a str,
    rest: &'a str,
    files: &'a Files<'a>,
    warnings: &'a mut Warnings,
}

impl Line<'_> {
    fn read(&mut self, material: &mut MtlMaterial) {
        // Exporters do not agree on capital letters.
        match self.keyword.to_ascii_lowercase().as_str() {
            "kd" => material.diffuse = self.colour(SHARE).or(material.diffuse),
            // What it is but black or not is not read.
            "ks" => material.specular = self.colour(f32::MIN..=f32::MAX).or(material.specular),
            "ke" => material.emission = self.colour(POSITIVE).or(material.emission),
            "ns" => material.exponent = self.number(POSITIVE).or(material.exponent),
            "d" if self.rest.starts_with("-halo") => {
                self.warnings.add(self.line, "`d -halo`, which varies with the angle, is passed over");
            }
            "d" => material.dissolve = self.number(SHARE).or(material.dissolve),
            "tr" => {
                let opacity = self.number(SHARE).map(|transparency| 1.0 - transparency);
                material.dissolve = material.dissolve.or(opacity);
            }
            "pr" => material.roughness = self.number(SHARE).or(material.roughness),
            "pm" => material.metallic = self.number(SHARE).or(material.metallic),
            "map_kd" => material.diffuse_map = self.map().or(material.diffuse_map.take()),
            "map_d" | "map_opacity" => material.dissolve_map = self.map().or(material.dissolve_map.take()),
            "map_tr" => {
                let opacity = self.map().map(|map| Map { is_inverse: true, ..map });
                material.dissolve_map = material.dissolve_map.take().or(opacity);
            }
            "map_ke" => material.emission_map = self.map().or(material.emission_map.take()),
            "norm" => material.normal_map = self.map().or(material.normal_map.take()),
            "map_ks" | "map_ns" | "map_pr" | "map_pm" | "map_ps" | "map_bump" | "bump" | "disp"
            | "map_disp" | "decal" | "refl" | "map_refl" => self.leave_out(""),
            "tf" => self.leave_out("1"),
            "ps" | "pc" | "pcr" | "aniso" | "anisor" => self.leave_out("0"),
            "ka" | "map_ka" | "ni" | "illum" | "sharpness" | "map_aat" => {}
            _ => self.warnings.add(self.line, format!("`{}` is passed over", short(self.keyword))),
        }
    }

    /// A colour of three numbers, or of one that counts for all, brought into a range.
    fn colour(&mut self, range: RangeInclusive<f32>) -> Option<Vec3> {
        let numbers: Option<Vec<f32>> = operands(self.rest).split_ascii_whitespace().map(finite).collect();
        match numbers.as_deref() {
            Some([grey]) => Some(Vec3::from(self.within([*grey; 3], range))),
            Some([r, g, b, ..]) => Some(Vec3::from(self.within([*r, *g, *b], range))),
            _ => {
                self.pass_over("is no colour of one or three numbers");
                None
            }
        }
    }

    /// A number, brought into a range.
    fn number(&mut self, range: RangeInclusive<f32>) -> Option<f32> {
        let number = operands(self.rest).split_ascii_whitespace().next().and_then(finite);
        if number.is_none() {
            self.pass_over("is no number");
        }
        number.map(|number| self.within([number], range)[0])
    }

    /// The nearest values of a range, which is said where they are others.
    fn within<const N: usize>(&mut self, values: [f32; N], range: RangeInclusive<f32>) -> [f32; N] {
        if !values.iter().all(|value| range.contains(value)) {
            let bounds = if range == SHARE { "0 to 1" } else { "0 and more" };
            self.warnings.add(self.line, format!("`{}` is brought to {bounds}", self.keyword));
        }
        values.map(|value| value.clamp(*range.start(), *range.end()))
    }

    fn map(&mut self) -> Option<Map> {
        let (map, odd) = Map::parse(self.line, self.rest, self.files);
        for odd in odd {
            self.warnings.add(self.line, format!("`{}`: {odd}", self.keyword));
        }
        map
    }

    /// Says that a statement is left out, unless it states nothing, or numbers that are what is so without
    /// it.
    fn leave_out(&mut self, unless: &str) {
        let unless: Option<f32> = finite(unless);
        let is_without = |word: &str| unless.is_some() && finite(word) == unless;
        if !operands(self.rest).split_ascii_whitespace().all(is_without) {
            let what = format!("`{}` is left out, though it changes the picture", self.keyword);
            self.warnings.add(self.line, what);
        }
    }

    fn pass_over(&mut self, why: &str) {
        let statement = format!("{} {}", self.keyword, short(operands(self.rest)));
        let what = format!("`{statement}` {why} and is passed over");
        self.warnings.add(self.line, what);
    }
}

fn finite(word: &str) -> Option<f32> {
    word.parse().ok().filter(|number: &f32| number.is_finite())
}

#[cfg(test)]
mod tests;
