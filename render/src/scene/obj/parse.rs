//! The statements of an OBJ file: vertices, and faces in runs of one object and one material.

use super::colours::Colours;
use super::statement::{is_nameless, operands, parts, statements};
use super::warnings::Warnings;
use glam::{Vec2, Vec3, Vec4};
use std::collections::HashMap;

/// Stands for a texture coordinate or a normal that a corner does not have.
pub(super) const NONE: u32 = u32::MAX;

/// A corner of a face: places in the lists of the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Corner {
    pub position: u32,
    /// Or [`NONE`].
    pub uv: u32,
    /// Or [`NONE`].
    pub normal: u32,
}

/// Faces of one object and one material.
#[derive(Debug, Default, PartialEq, Eq)]
pub(super) struct FaceRun {
    /// What the file calls the object or the group.
    pub name: String,
    /// Place in [`Obj::materials`].
    pub material: Option<usize>,
    /// Corners of all faces, one face after the other.
    pub corners: Vec<Corner>,
    /// How many of them each face has, three at least.
    pub sides: Vec<u32>,
}

/// A name in a file, and the line that it is in.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Named {
    pub name: String,
    pub line: usize,
}

/// An OBJ file.
#[derive(Debug, Default)]
pub(super) struct Obj {
    /// As the file has them, maybe not finite.
    pub positions: Vec<Vec3>,
    /// Of each vertex, 0 to 1, not a number where it has none; empty where no vertex has one.
    pub colours: Vec<Vec4>,
    /// `v` up.
    pub uvs: Vec<Vec2>,
    pub normals: Vec<Vec3>,
    pub runs: Vec<FaceRun>,
    /// Names that `usemtl` uses, each once, with what may be a comment; an empty one where it has none.
    pub materials: Vec<Named>,
    /// What follows `mtllib`: a name, or several, and maybe a comment.
    pub libraries: Vec<Named>,
}

/// How many elements a file has.
#[derive(Clone, Copy, Debug, Default)]
struct Counts {
    positions: usize,
    uvs: usize,
    normals: usize,
}

/// Reads a file of at most so many triangles.
///
/// # Errors
/// If a face has a corner that there is not, a vertex has no position, or there are more triangles; the line
/// is named.
pub(super) fn parse(text: &str, most: usize, warnings: &mut Warnings) -> Result<Obj, String> {
    let counts = counts(text, most)?;
    let mut reader = Reader {
        counts,
        warnings,
        obj: Obj::default(),
        run: FaceRun::default(),
        colours: Colours::default(),
        known: HashMap::new(),
    };
    for (line, statement) in statements(text) {
        let (keyword, rest) = parts(&statement);
        reader.read(line, keyword, rest)?;
    }
    reader.end_run();
    let mut obj = reader.obj;
    obj.colours = reader.colours.of_all(obj.positions.len(), reader.warnings);
    Ok(obj)
}

/// How many elements there are: faces may name those below them.
fn counts(text: &str, most: usize) -> Result<Counts, String> {
    let (mut counts, mut triangles) = (Counts::default(), 0);
    for (line, statement) in statements(text) {
        let (keyword, rest) = parts(&statement);
        match keyword {
            "v" => counts.positions += 1,
            "vt" => counts.uvs += 1,
            "vn" => counts.normals += 1,
            "f" | "fo" => triangles += operands(rest).split_ascii_whitespace().count().saturating_sub(2),
            _ => {}
        }
        if triangles > most {
            return Err(format!("line {line}: there are more triangles than the {most} that memory holds"));
        }
    }
    Ok(counts)
}

struct Reader<'a> {
    counts: Counts,
    warnings: &'a mut Warnings,
    obj: Obj,
    /// Faces since the last object, group or material.
    run: FaceRun,
    colours: Colours,
    /// Places of the names in [`Obj::materials`].
    known: HashMap<String, usize>,
}

impl Reader<'_> {
    fn read(&mut self, line: usize, keyword: &str, rest: &str) -> Result<(), String> {
        match keyword {
            "v" => self.vertex(line, operands(rest))?,
            "vt" => {
                let [u, v] = self.numbers(line, keyword, operands(rest));
                self.obj.uvs.push(Vec2::new(u, v));
            }
            "vn" => {
                let normal = self.numbers(line, keyword, operands(rest));
                self.obj.normals.push(Vec3::from(normal));
            }
            "f" | "fo" => self.face(line, operands(rest))?,
            "o" | "g" => {
                self.end_run();
                self.run.name = if is_nameless(rest) { String::new() } else { rest.to_owned() };
            }
            "usemtl" if !is_nameless(rest) => self.material(line, rest),
            // What that stands for is known once the libraries are.
            "usemtl" if self.run.material.is_none() => self.material(line, ""),
            "usemtl" => self.warnings.add(line, "`usemtl` without a name is passed over"),
            "mtllib" if is_nameless(rest) => {
                self.warnings.add(line, "`mtllib` without a name is passed over")
            }
            "mtllib" => self.obj.libraries.push(Named { name: rest.to_owned(), line }),
            "l" | "p" => self.warnings.add(line, "lines and points have no surface and are left out"),
            "curv" | "curv2" | "surf" => self.warnings.add(line, "free-form geometry is left out"),
            // Smoothing, levels of detail, grouping, and what belongs to free-form geometry.
            "s" | "mg" | "lod" | "bevel" | "c_interp" | "d_interp" | "vp" | "cstype" | "deg" | "bmat"
            | "step" | "parm" | "trim" | "hole" | "scrv" | "sp" | "end" | "con" | "shadow_obj"
            | "trace_obj" | "ctech" | "stech" | "maplib" | "usemap" => {}
            _ => self.warnings.add(line, format!("`{}` is passed over", short(keyword))),
        }
        Ok(())
    }

    /// A vertex: position; a weight, which polygons do not have, where one number follows; a colour where
    /// three or more do.
    fn vertex(&mut self, line: usize, rest: &str) -> Result<(), String> {
        let mut numbers = [f32::NAN; 7];
        let mut count = 0;
        for (number, word) in numbers.iter_mut().zip(rest.split_ascii_whitespace()) {
            let Ok(read) = word.parse() else { break };
            *number = read;
            count += 1;
        }
        let [x, y, z, r, g, b, a] = numbers;
        if count < 3 {
            return Err(format!("line {line}: `v {}` is no position of three numbers", short(rest)));
        }
        if count == 5 || rest.split_ascii_whitespace().nth(count).is_some() {
            self.warnings.add(line, "what follows a vertex's position is passed over where it is no colour");
        }
        if count >= 6 {
            self.colours.add(line, self.obj.positions.len(), Vec4::new(r, g, b, a));
        }
        self.obj.positions.push(Vec3::new(x, y, z));
        Ok(())
    }

    /// The first numbers of a line, 0 for those that are missing or are none.
    fn numbers<const N: usize>(&mut self, line: usize, keyword: &str, rest: &str) -> [f32; N] {
        let words = rest.split_ascii_whitespace();
        let read = |word: &str| word.parse().ok().filter(|number: &f32| number.is_finite());
        let (mut numbers, mut count, mut is_whole) = ([0.0; N], 0, true);
        for (number, word) in numbers.iter_mut().zip(words) {
            is_whole &= read(word).is_some();
            *number = read(word).unwrap_or(0.0);
            count += 1;
        }
        // A texture coordinate may be of one number.
        is_whole &= count == N || (keyword == "vt" && count == 1);
        if !is_whole {
            self.warnings.add(line, format!("`{keyword}` is read as 0 where it has no number"));
        }
        numbers
    }

    fn face(&mut self, line: usize, rest: &str) -> Result<(), String> {
        let (begin, mut is_whole) = (self.run.corners.len(), true);
        for word in rest.split_ascii_whitespace() {
            let unknown = || format!("line {line}: there is no vertex `{}`", short(word));
            let (corner, is_whole_corner) = self.corner(word).ok_or_else(unknown)?;
            is_whole &= is_whole_corner;
            self.run.corners.push(corner);
        }
        let sides = self.run.corners.len() - begin;
        if sides < 3 {
            self.run.corners.truncate(begin);
            self.warnings.add(line, "faces of fewer than three corners are left out");
            return Ok(());
        }
        self.run.sides.push(sides as u32);
        if !is_whole {
            let what = "a texture coordinate or a normal that is not there is left out of a face";
            self.warnings.add(line, what);
        }
        Ok(())
    }

    /// A corner `v`, `v/vt`, `v//vn` or `v/vt/vn`, nothing where its position is not there; and whether its
    /// other elements are.
    fn corner(&self, word: &str) -> Option<(Corner, bool)> {
        let mut indices = word.split('/');
        let position = place(number(indices.next()?)?, self.counts.positions, self.obj.positions.len())?;
        let optional = |text: Option<&str>, total: usize, above: usize| match text {
            None | Some("") => Some((NONE, true)),
            // Exporters write 0 for none.
            Some(text) => number(text)
                .map(|index| place(index, total, above).map_or((NONE, false), |place| (place, true))),
        };
        let (uv, has_uv) = optional(indices.next(), self.counts.uvs, self.obj.uvs.len())?;
        let (normal, has_normal) = optional(indices.next(), self.counts.normals, self.obj.normals.len())?;
        indices.next().is_none().then_some((Corner { position, uv, normal }, has_uv && has_normal))
    }

    fn material(&mut self, line: usize, name: &str) {
        let next = self.obj.materials.len();
        let known = self.known.get(name).copied();
        let material = known.unwrap_or(next);
        if known.is_none() {
            self.known.insert(name.to_owned(), next);
            self.obj.materials.push(Named { name: name.to_owned(), line });
        }
        if self.run.material != Some(material) {
            self.end_run();
            self.run.material = Some(material);
        }
    }

    /// Puts the run with the others, if it has a face, and begins one of the same object and material.
    fn end_run(&mut self) {
        let (name, material) = (self.run.name.clone(), self.run.material);
        if !self.run.sides.is_empty() {
            self.obj.runs.push(std::mem::take(&mut self.run));
        }
        self.run = FaceRun { name, material, ..FaceRun::default() };
    }
}

fn number(text: &str) -> Option<i64> {
    text.parse().ok()
}

/// The place of an element that counts from 1, or, where negative, back from the last one above the line.
fn place(index: i64, total: usize, above: usize) -> Option<u32> {
    let place = if index < 0 { (above as i64).checked_add(index)? } else { index - 1 };
    let last = if index < 0 { above } else { total };
    (0..last as i64).contains(&place).then_some(place).and_then(|place| u32::try_from(place).ok())
}

/// The beginning of a text, for messages.
pub(super) fn short(text: &str) -> &str {
    text.char_indices().nth(40).map_or(text, |(at, _)| &text[..at])
}

#[cfg(test)]
mod tests;
