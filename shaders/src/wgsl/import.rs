//! Puts a product together from WGSL files, which say in their first lines what they need:
//!
//! - `#import shared/surface`: another file, whose text comes before theirs, and once only.
//! - `#constant HEIGHT = 8`: a whole number, which Rust may set otherwise.
//! - `#template`: something that Rust writes, without which it is no shader.

use super::source_line::SourceLine;
use std::collections::BTreeSet;

include!(concat!(env!("OUT_DIR"), "/wgsl_files.rs"));

/// What there is to import: names and texts.
#[derive(Clone, Copy)]
struct Library(&'static [(&'static str, &'static str)]);

const LIBRARY: Library = Library(FILES);

/// Every file of `shaders/wgsl`, in order.
pub(super) fn files() -> impl Iterator<Item = &'static str> {
    FILES.iter().map(|(file, _)| *file)
}

/// Files that no other imports.
pub(super) fn roots() -> impl Iterator<Item = &'static str> {
    let imports = FILES.iter().flat_map(|(_, text)| text.lines().filter_map(Directive::parse));
    let imported: BTreeSet<_> = imports.filter_map(|directive| directive.imported()).collect();
    files().filter(move |file| !imported.contains(file))
}

/// Whether there is such a file.
pub(super) const fn is_file(file: &str) -> bool {
    let mut index = 0;
    while index < FILES.len() {
        if is_same(FILES[index].0.as_bytes(), file.as_bytes()) {
            return true;
        }
        index += 1;
    }
    false
}

/// Whether two texts are the same: constants cannot compare slices.
const fn is_same(one: &[u8], other: &[u8]) -> bool {
    let mut index = 0;
    while index < one.len() && index < other.len() && one[index] == other[index] {
        index += 1;
    }
    index == one.len() && index == other.len()
}

impl Library {
    fn text(self, file: &str) -> Result<&'static str, String> {
        let found = self.0.iter().find(|(name, _)| *name == file);
        found.map(|(_, text)| *text).ok_or_else(|| format!("no file `{file}`"))
    }

    /// Whether a file can be imported by the last of `open`, each of which imports the next one.
    fn check(self, file: &str, open: &[&str]) -> Result<(), String> {
        if open.contains(&file) {
            return Err(format!("`{file}` imports itself: {} > {file}", open.join(" > ")));
        }
        self.text(file).map(|_| ())
    }
}

/// A constant with its default.
#[derive(Clone, Copy, Debug)]
pub(super) struct Constant {
    /// Its name.
    pub name: &'static str,
    /// What it is where Rust says nothing else.
    pub default: u32,
    /// Where it is stated.
    place: SourceLine<'static>,
}

/// Files put together.
#[derive(Debug, Default)]
pub(super) struct Product {
    /// What they state as constants.
    pub constants: Vec<Constant>,
    /// Their texts.
    pub text: String,
    files: Vec<&'static str>,
    is_template: bool,
}

impl Product {
    /// These files and all that they import.
    ///
    /// # Panics
    /// If there is no such file, or one imports what there is not. A test puts together all that there are.
    pub(super) fn of(files: &[&'static str]) -> Self {
        Self::joined(LIBRARY, files).expect("what WGSL files import is there")
    }

    /// Whether it is a shader as it is.
    pub(super) fn is_whole(&self) -> bool {
        !self.is_template && ["@compute", "@vertex"].iter().any(|stage| self.text.contains(stage))
    }

    fn joined(library: Library, files: &[&'static str]) -> Result<Self, String> {
        let mut product = Self::default();
        for file in files {
            product.add(library, file, &mut Vec::new())?;
        }
        Ok(product)
    }

    /// Adds a file, unless it is there; `open` are those that import it, the first one first.
    fn add(
        &mut self,
        library: Library,
        file: &'static str,
        open: &mut Vec<&'static str>,
    ) -> Result<(), String> {
        if self.files.contains(&file) {
            return Ok(());
        }
        let (directives, own) = parts(file, library.text(file)?)?;
        open.push(file);
        for (place, directive) in directives {
            let placed = |what| format!("{place}: {what}");
            match directive {
                Directive::Import(other) => {
                    library.check(other, open).map_err(placed)?;
                    self.add(library, other, open)?;
                }
                Directive::Template => self.is_template = true,
                Directive::Constant(name, default) => {
                    self.state(Constant { name, default, place }).map_err(placed)?;
                }
            }
        }
        open.pop();
        self.files.push(file);
        self.text += "\n";
        self.text += &own;
        Ok(())
    }

    fn state(&mut self, constant: Constant) -> Result<(), String> {
        let Constant { name, default, .. } = constant;
        match self.constants.iter().find(|other| other.name == name) {
            None => self.constants.push(constant),
            Some(other) if other.default == default => {}
            Some(Constant { default: other, place, .. }) => {
                return Err(format!("`{name}` is {default} here, and {other} at {place}"));
            }
        }
        Ok(())
    }
}

/// What a file says that it needs.
enum Directive {
    Import(&'static str),
    Constant(&'static str, u32),
    Template,
}

impl Directive {
    const fn imported(&self) -> Option<&'static str> {
        if let Self::Import(file) = self { Some(*file) } else { None }
    }

    fn parse(line: &'static str) -> Option<Self> {
        let words: Vec<&str> = line.split_whitespace().collect();
        match words[..] {
            ["#import", file] => Some(Self::Import(file)),
            ["#template"] => Some(Self::Template),
            ["#constant", name, "=", default] => Some(Self::Constant(name, default.parse().ok()?)),
            _ => None,
        }
    }
}

/// What a file needs, and the rest of it, marked with where it is from. An empty line after a directive is
/// part of neither.
fn parts(
    file: &'static str,
    text: &'static str,
) -> Result<(Vec<(SourceLine<'static>, Directive)>, String), String> {
    let (mut directives, mut own) = (Vec::new(), String::new());
    let (mut next, mut follows, mut begun) = (0, false, false);
    for (line, said) in (1..).zip(text.lines()) {
        let place = SourceLine { file, line };
        if said.trim_start().starts_with('#') {
            let directive =
                Directive::parse(said).ok_or_else(|| format!("{place}: `{said}` is no directive"))?;
            if begun {
                return Err(format!("{place}: a directive behind the file's first lines"));
            }
            directives.push((place, directive));
            follows = true;
            continue;
        }
        if !(follows && said.is_empty()) {
            if line != next {
                own += &place.mark();
            }
            own += said;
            own += "\n";
            next = line + 1;
        }
        follows = false;
        begun |= !(said.is_empty() || said.starts_with("//"));
    }
    Ok((directives, own))
}

#[cfg(test)]
mod tests;
