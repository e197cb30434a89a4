//! Lists the files of `wgsl`, so that the program holds their text, and collects the structs that they share
//! with Rust.

use std::fmt::Write;
use std::path::{Path, PathBuf};

fn main() {
    println!("cargo::rerun-if-changed=wgsl");
    let root = Path::new(&std::env::var_os("CARGO_MANIFEST_DIR").expect("a folder")).join("wgsl");
    let mut files = files_below(&root);
    files.sort();
    let texts = files.iter().map(|file| std::fs::read_to_string(file).expect("a text"));
    let structs: String = texts.map(|text| documented_structs(&text)).collect();
    let mut table = "const FILES: &[(&str, &str)] = &[\n".to_owned();
    for file in files {
        let name = name_of(file.strip_prefix(&root).expect("below the root"));
        writeln!(table, "    ({name:?}, include_str!({file:?})),").expect("writing to a string");
    }
    table += "];\n";
    let out = PathBuf::from(std::env::var_os("OUT_DIR").expect("a folder"));
    std::fs::write(out.join("wgsl_files.rs"), table).expect("writing the table");
    let structs = format!("uniforms! {{\n{structs}}}\n");
    std::fs::write(out.join("uniforms.rs"), structs).expect("writing the structs");
}

/// The structs of a file that have documentation, by `///`, as the macro `uniforms!` takes them.
fn documented_structs(text: &str) -> String {
    let (mut structs, mut documentation, mut is_within) = (String::new(), String::new(), false);
    for line in text.lines().map(|line| format!("{line}\n")) {
        if is_within {
            structs += &line;
            is_within = line != "}\n";
        } else if line.starts_with("///") {
            documentation += &line;
        } else {
            if let Some(begun) = line.strip_prefix("struct ").filter(|_| !documentation.is_empty()) {
                structs += &documentation;
                structs += begun;
                is_within = true;
            }
            documentation.clear();
        }
    }
    structs
}

fn files_below(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path());
    let (folders, files): (Vec<_>, Vec<_>) = entries.partition(|path| path.is_dir());
    let is_wgsl = |file: &PathBuf| file.extension().is_some_and(|kind| kind == "wgsl");
    files.into_iter().filter(is_wgsl).chain(folders.iter().flat_map(|folder| files_below(folder))).collect()
}

/// A file as others import it: slashes on every system, and no ending.
fn name_of(file: &Path) -> String {
    let parts = file.with_extension("");
    let parts: Vec<_> = parts.iter().map(|part| part.to_str().expect("a name in Unicode")).collect();
    parts.join("/")
}
