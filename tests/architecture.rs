//! What ARCHITECTURE.md promises: who imports whom, where burn may be, how long a file may be; and that what
//! people read about g-buffers has every channel.

use deepshade_shaders::Attribute;
use serde::Deserialize;
use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
    process::Command,
};

/// Who imports whom among the project's own packages; no other edges, not in tests either.
const EDGES: [(&str, &[&str]); 10] = [
    ("deepshade-shaders", &[]),
    ("deepshade-glow", &["deepshade-shaders"]),
    ("deepshade-render", &["deepshade-glow", "deepshade-shaders"]),
    ("deepshade-phosphor", &["deepshade-glow", "deepshade-shaders"]),
    ("deepshade-infer", &["deepshade-shaders"]),
    ("deepshade-dataset", &["deepshade-render", "deepshade-shaders"]),
    ("deepshade-train", &["deepshade-dataset", "deepshade-infer", "deepshade-shaders"]),
    (
        "deepshade",
        &[
            "deepshade-dataset",
            "deepshade-glow",
            "deepshade-infer",
            "deepshade-phosphor",
            "deepshade-render",
            "deepshade-shaders",
            "deepshade-train",
        ],
    ),
    (
        "deepshade-studies",
        &[
            "deepshade",
            "deepshade-dataset",
            "deepshade-glow",
            "deepshade-infer",
            "deepshade-phosphor",
            "deepshade-render",
            "deepshade-shaders",
            "deepshade-train",
        ],
    ),
    ("xtask", &[]),
];

/// The modules of `render`, the lowest layer first. A module imports its own layer and those below; its tests
/// may import all.
const LAYERS: [&[&str]; 6] = [
    &["exr_file", "metrics", "nearest", "processor", "sampler"],
    &["scene"],
    &["bvh", "gbuffer", "intersection", "past", "path", "scotopic"],
    &["method", "raster", "screen"],
    &["lpv", "surfels"],
    &["methods"],
];

const MOST_LINES: usize = 500;

/// What `cargo metadata` says of this workspace, as far as these tests ask. The crate `cargo_metadata` would
/// switch on features of serde that the program is built without, and everything above serde would be built
/// twice.
#[derive(Deserialize)]
struct Metadata {
    packages: Vec<Package>,
}

#[derive(Deserialize)]
struct Package {
    name: String,
    manifest_path: PathBuf,
    dependencies: Vec<Dependency>,
}

#[derive(Deserialize)]
struct Dependency {
    name: String,
    /// `dev`, `build` or none.
    kind: Option<String>,
}

fn workspace() -> Metadata {
    let cargo = Command::new(env!("CARGO"))
        .args(["metadata", "--no-deps", "--format-version", "1", "--offline"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("cargo starts");
    serde_json::from_slice(&cargo.stdout).expect("cargo metadata of this workspace")
}

fn imports(package: &Package, wanted: impl Fn(&str) -> bool) -> BTreeSet<&str> {
    package
        .dependencies
        .iter()
        .map(|dependency| dependency.name.as_str())
        .filter(|name| wanted(name))
        .collect()
}

#[test]
fn packages_import_only_what_lies_below_them() {
    let workspace = workspace();
    let names: BTreeSet<&str> = workspace.packages.iter().map(|package| package.name.as_str()).collect();
    assert_eq!(names, EDGES.iter().map(|(name, _)| *name).collect(), "packages of the workspace");
    for (name, allowed) in EDGES {
        let package = workspace.packages.iter().find(|package| package.name == name).expect("just compared");
        let ours = imports(package, |dependency| names.contains(dependency));
        assert_eq!(ours, allowed.iter().copied().collect(), "what {name} imports");
    }
}

#[test]
fn modules_of_render_import_only_their_layer_and_those_below() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("render/src");
    let layer = |name: &str| LAYERS.iter().position(|modules| modules.contains(&name));
    let mut imported = 0;
    for file in source_files(&root) {
        let path = file.strip_prefix(&root).expect("below it").with_extension("");
        let names: Vec<_> = path.iter().map(|name| name.to_string_lossy()).collect();
        if names.iter().any(|name| name == "tests") || names[0] == "lib" {
            continue;
        }
        let own = layer(&names[0]);
        assert!(own.is_some(), "{} is in no layer", file.display());
        let text = std::fs::read_to_string(&file).expect("a text");
        let code = text.lines().take_while(|line| !line.ends_with("mod tests {"));
        for line in code.filter(|line| !line.trim_start().starts_with("//")) {
            for (_, after) in line.match_indices("crate::").map(|(at, found)| line.split_at(at + found.len()))
            {
                let name: String = after.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
                let below = layer(&name).is_some_and(|theirs| Some(theirs) <= own);
                assert!(below, "{} imports `{name}` from above: {line}", file.display());
                imported += 1;
            }
        }
    }
    assert!(imported > 500, "only {imported} imports were found");
}

#[test]
fn burn_is_only_in_train() {
    let is_burn = |name: &str| name == "burn" || name.starts_with("burn-") || name.starts_with("cubecl");
    let users: BTreeSet<String> = workspace()
        .packages
        .iter()
        .filter(|package| !imports(package, is_burn).is_empty())
        .map(|package| package.name.clone())
        .collect();
    assert_eq!(users, BTreeSet::from(["deepshade-train".to_owned()]));
}

#[test]
fn nothing_that_the_program_is_built_from_needs_a_cpp_compiler() {
    for package in workspace().packages {
        let flip = package.dependencies.iter().find(|dependency| dependency.name == "nv-flip");
        assert!(flip.is_none_or(|flip| flip.kind.as_deref() == Some("dev")), "nv-flip in {}", package.name);
    }
}

#[test]
fn every_package_follows_the_one_table_of_lints() {
    let workspace = workspace();
    for package in &workspace.packages {
        let manifest = std::fs::read_to_string(&package.manifest_path).expect("a manifest");
        assert!(manifest.contains("[lints]\nworkspace = true"), "{} has lints of its own", package.name);
    }
}

/// As `cargo publish` would make them, but for compiling what was packaged.
#[test]
fn library_crates_can_be_packaged() {
    let libraries = ["shaders", "glow", "render", "infer", "dataset"].map(|name| format!("deepshade-{name}"));
    let made = Command::new(env!("CARGO"))
        .args(["package", "--locked", "--no-verify", "--allow-dirty"])
        .args(libraries.iter().flat_map(|name| ["--package", name]))
        .args(["--target-dir", concat!(env!("CARGO_TARGET_TMPDIR"), "/packages")])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("cargo starts");
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
}

#[test]
fn no_file_is_longer_than_one_can_read() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let files = source_files(root);
    assert!(files.iter().any(|file| file.ends_with("shaders/src/channel.rs")), "the search finds sources");
    assert!(files.iter().any(|file| file.extension().is_some_and(|kind| kind == "wgsl")), "and shaders");
    for file in files {
        let lines = std::fs::read_to_string(&file).expect("a text").lines().count();
        assert!(lines <= MOST_LINES, "{} has {lines} lines, more than {MOST_LINES}", file.display());
    }
}

/// Everything written by hand that is a program, in any language.
fn source_files(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()) {
        let name = entry.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if entry.is_dir() && name != "target" && !name.starts_with('.') {
            files.extend(source_files(&entry));
        } else if entry.extension().is_some_and(|kind| {
            ["rs", "wgsl", "html", "css", "js", "toml"].iter().any(|known| kind.eq_ignore_ascii_case(known))
        }) {
            files.push(entry);
        }
    }
    files
}

/// CONTRIBUTING.md says why each is sound.
#[test]
fn unsafe_code_is_where_it_is_accounted_for() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let contributing = std::fs::read_to_string(root.join("CONTRIBUTING.md")).expect("CONTRIBUTING.md");
    let ours = Path::new("tests/architecture.rs");
    let places = |text: &str| {
        ["unsafe {", "unsafe impl", "unsafe fn"].map(|what| text.matches(what).count()).iter().sum::<usize>()
    };
    let mut found: Vec<(String, usize)> = source_files(root)
        .into_iter()
        .filter_map(|file| {
            let name = file.strip_prefix(root).expect("below the root").to_owned();
            let count = places(&std::fs::read_to_string(&file).expect("a text"));
            (count > 0 && name != ours).then(|| (name.display().to_string(), count))
        })
        .collect();
    found.sort();
    let expected = [("shaders/src/gpu/pipeline_cache.rs", 1), ("studies/src/embree/library.rs", 10)];
    assert_eq!(found, expected.map(|(name, count)| (name.to_owned(), count)));
    assert!(found.iter().all(|(name, _)| contributing.contains(name)));
}

#[test]
fn every_channel_of_a_gbuffer_is_explained_to_users_and_to_hosts_alike() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let explained = |file: &str| {
        let text = std::fs::read_to_string(root.join(file)).expect(file);
        let (_, table) = text.split_once("| layer | channels | what, in which unit |").expect("a table");
        let rows = table.lines().skip(2).take_while(|line| line.starts_with('|'));
        rows.map(str::to_owned).collect::<Vec<_>>()
    };
    let rows = explained("book/src/own-gbuffer.md");
    assert_eq!(rows, explained("infer/src/forward/host.md"));
    let named: Vec<String> = rows.iter().map(|row| row.split('|').take(3).collect()).collect();
    let expected = Attribute::ALL.map(|attribute| match attribute.components() {
        [""] => format!(" `{}`  ", attribute.name()),
        components => format!(" `{}`  `{}` ", attribute.name(), components.join(" ")),
    });
    assert_eq!(
        named.iter().map(|row| row.trim_end()).collect::<Vec<_>>(),
        expected.each_ref().map(|row| row.trim_end())
    );
}
