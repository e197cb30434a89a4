//! `cargo xtask unchanged`: what a rewrite must leave as it is. It makes small data of every recipe, and
//! truth, methods and networks of every effect on two scenes, and notes a hash of each file. The proof of a
//! change that only moves code is that all hashes stay, on the same machine and adapter.

mod recipe;

use crate::command::target;
use crate::program::{AS_TESTS, Program};
use anyhow::{Context, Result, ensure};
use std::collections::BTreeMap;
use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};

/// Every effect.
const EFFECTS: &str = "ao,do,gi,glossy,ibl,occluded-ibl,sss,subsurface,dof,motion-blur,aa,multi,fog-direct,\
                       fog-indirect,fog-multiple,phosphor,phosphor-gi,path,real";

/// What methods shade: a room with lamps, and things that stand under the sky.
const SCENES: [&str; 2] = ["room:7", "still-life:7"];

/// Hashes by the names of files.
type Hashes = BTreeMap<String, String>;

/// What hashes are for.
#[derive(clap::Args)]
pub struct Args {
    /// Notes the hashes, in place of holding them against those that were noted.
    #[arg(long)]
    write: bool,
    /// The file of hashes.
    file: PathBuf,
}

/// Notes hashes, or holds those of today's program against a file's.
///
/// # Errors
/// If something cannot be made, or a hash differs.
pub fn run(args: &Args) -> Result<()> {
    let (file, writes) = (args.file.as_path(), args.write);
    let expected = if writes { Hashes::new() } else { parse(&read(file)?)? };
    let program = Program::build_by(&AS_TESTS)?;
    let made = target().join("unchanged");
    if made.exists() {
        fs::remove_dir_all(&made).with_context(|| made.display().to_string())?;
    }
    make_data(&program, &made)?;
    make_images(&program, &made)?;
    let hashes = hashes(&made)?;
    if writes {
        let text: String = hashes.iter().map(|(name, hash)| format!("{hash} {name}\n")).collect();
        fs::write(file, text).with_context(|| file.display().to_string())?;
        println!("{} hashes in {}", hashes.len(), file.display());
        return Ok(());
    }
    let differing = differing(&expected, &hashes);
    ensure!(
        differing.is_empty(),
        "{} of {} files differ:\n{}",
        differing.len(),
        expected.len(),
        differing.join("\n")
    );
    println!("all {} files are as they were", hashes.len());
    Ok(())
}

fn read(file: &Path) -> Result<String> {
    fs::read_to_string(file).with_context(|| file.display().to_string())
}

fn parse(text: &str) -> Result<Hashes> {
    let line = |line: &str| {
        let (hash, name) = line.split_once(' ').with_context(|| format!("not a hash and a name: {line}"))?;
        Ok((name.to_owned(), hash.to_owned()))
    };
    text.lines().map(line).collect()
}

/// Small data of every recipe that names no files.
fn make_data(program: &Program, made: &Path) -> Result<()> {
    let recipes = made.join("recipes");
    fs::create_dir_all(&recipes).with_context(|| recipes.display().to_string())?;
    for path in files(Path::new("dataset/recipes"))? {
        let text = read(&path)?;
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let Some(small) = recipe::small(&text) else {
            println!("{name}: passed over, since its files do not come with the project");
            continue;
        };
        let small_path = recipes.join(format!("{name}.toml"));
        fs::write(&small_path, small).with_context(|| small_path.display().to_string())?;
        let verb = if recipe::is_test(&text) { "testset" } else { "generate" };
        let (recipe, out) = (small_path.display().to_string(), made.join("data").join(&name));
        println!("{name}");
        program.run(&["dataset", verb, &recipe, "--out", &out.display().to_string()])?;
    }
    Ok(())
}

/// Truth, methods and networks of every effect.
fn make_images(program: &Program, made: &Path) -> Result<()> {
    let out = made.join("compare").display().to_string();
    let mut args = vec!["compare", "--effect", EFFECTS, "--out", &out, "--quality", "low", "--spp", "16"];
    args.extend(["--width", "64", "--height", "48"]);
    args.extend(SCENES.iter().flat_map(|scene| ["--scene", *scene]));
    program.run(&args)
}

/// Hashes of all images below a folder, by their paths in it.
fn hashes(folder: &Path) -> Result<Hashes> {
    let images = files(folder)?.into_iter().filter(|path| path.extension().is_some_and(|kind| kind == "exr"));
    let hashed = |path: PathBuf| {
        let mut hasher = DefaultHasher::new();
        fs::read(&path).with_context(|| path.display().to_string())?.hash(&mut hasher);
        let name = path.strip_prefix(folder).unwrap_or(&path).display().to_string();
        Ok((name, format!("{:016x}", hasher.finish())))
    };
    images.map(hashed).collect()
}

/// All files below a folder, in the order of their paths.
fn files(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).with_context(|| folder.display().to_string())? {
        let path = entry?.path();
        if path.is_dir() { found.extend(files(&path)?) } else { found.push(path) }
    }
    found.sort();
    Ok(found)
}

/// What is another file now, is gone, or is new.
fn differing(expected: &Hashes, found: &Hashes) -> Vec<String> {
    let names: std::collections::BTreeSet<_> = expected.keys().chain(found.keys()).collect();
    names.into_iter().filter(|name| expected.get(*name) != found.get(*name)).cloned().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_of_the_table_of_effects_is_among_what_is_made() {
        let table = include_str!("../../shaders/src/effect/table.rs");
        let name = |line: &'static str| line.trim().strip_prefix("name: \"")?.strip_suffix("\",");
        let names: Vec<&str> = table.lines().filter_map(name).collect();
        assert_eq!(names.join(","), EFFECTS);
    }

    #[test]
    fn what_changed_came_or_went_is_named() {
        let before = parse("01 a.exr\n02 b c.exr\n03 d.exr\n").expect("hashes");
        assert_eq!(before["b c.exr"], "02");
        let after = parse("01 a.exr\n09 b c.exr\n04 e.exr\n").expect("hashes");
        assert_eq!(differing(&before, &after), ["b c.exr", "d.exr", "e.exr"]);
        assert!(differing(&before, &before).is_empty());
        assert!(parse("nothing").is_err());
    }
}
