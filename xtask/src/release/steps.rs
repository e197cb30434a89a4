//! How each file of a release is made.

use super::{Release, empty, file_name};
use crate::command::{self, cargo, command, root, target};
use anyhow::{Context, Result};
use std::fs;
use std::path::{Path, PathBuf};

/// What figures call a file, and what makes it in an empty folder.
pub type Step = (&'static str, fn(&Release, &Path) -> Result<()>);

/// Each makes one file.
pub const STEPS: [Step; 6] = [
    ("archive", Release::archive),
    ("debian_package", Release::debian_package),
    ("wheel", Release::wheel),
    ("npm_package", Release::npm_package),
    ("addon", Release::addon),
    ("components", Release::components),
];

/// What goes into the archive beside the program: from the repository, and where to. The program looks for
/// networks in `share` beside its own `bin`.
const ARCHIVED: [(&str, &str); 6] = [
    ("models", "share/deepshade"),
    ("dataset/recipes", "share/deepshade"),
    ("README.md", ""),
    ("CHANGELOG.md", ""),
    ("LICENSE-MIT", ""),
    ("LICENSE-APACHE", ""),
];

impl Release {
    /// `deepshade-VERSION-TRIPLE.tar.gz`: `bin`, `share` and documents in a folder of that name.
    fn archive(&self, out: &Path) -> Result<()> {
        let name = format!("deepshade-{}-{}", self.version, self.triple);
        let stage = target().join("release-stage");
        let folder = empty(&stage.join(&name))?;
        command::copy(&self.program(), &folder.join("bin/deepshade"))?;
        for (from, to) in ARCHIVED {
            command::copy(&root().join(from), &folder.join(to).join(file_name(Path::new(from))?))?;
        }
        let archive = out.join(format!("{name}.tar.gz")).display().to_string();
        let stage = stage.display().to_string();
        // Test sets are for those who have the repository.
        let plain = ["--owner=0", "--group=0", "--numeric-owner", "--sort=name", "--exclude=testset*"];
        let words = [&plain[..], &["-C", &stage, "-czf", &archive, &name]].concat();
        command::run(&mut command("tar", &words))?;
        fs::remove_dir_all(&folder).with_context(|| folder.display().to_string())
    }

    fn debian_package(&self, out: &Path) -> Result<()> {
        let out = out.display().to_string();
        let words = ["deb", "--no-build", "--locked", "--output", &out];
        let of_target = [&words[..], &["--target", &self.triple]].concat();
        command::run(&mut cargo(if self.is_native { &words[..] } else { &of_target }))
    }

    /// For pip: the program beside the Python package.
    fn wheel(&self, out: &Path) -> Result<()> {
        let out = out.display().to_string();
        let words = ["build", "--release", "--strip", "--features", "store", "--out", &out];
        let of_target = [&words[..], &["--target", &self.triple]].concat();
        let words = if self.is_native { &words[..] } else { &of_target };
        command::run(command("maturin", words).current_dir(root().join("python")))
    }

    fn npm_package(&self, out: &Path) -> Result<()> {
        let out = out.display().to_string();
        let words = ["pack", "--silent", "--pack-destination", &out];
        command::run(command("npm", &words).current_dir(root().join("js")))
    }

    /// Blender installs an add-on from its one file.
    fn addon(&self, out: &Path) -> Result<()> {
        let addon = root().join("blender/deepshade_addon.py");
        // Its name is that of a Python module.
        command::copy(&addon, &out.join("deepshade_addon.py"))
    }

    /// The list of components in CycloneDX's form, of the program's features.
    fn components(&self, out: &Path) -> Result<()> {
        let name = format!("deepshade-{}-{}.cdx", self.version, self.triple);
        let features = ["--features", "store", "--target", &self.triple];
        let words = [&["cyclonedx", "--format", "json", "--override-filename", &name][..], &features];
        let written = command::run(&mut cargo(&words.concat()));
        let file = format!("{name}.json");
        let copied = written.and_then(|()| command::copy(&root().join(&file), &out.join(&file)));
        // It writes one beside each manifest.
        for folder in members()? {
            let beside = folder.join(&file);
            if beside.is_file() {
                fs::remove_file(&beside).with_context(|| beside.display().to_string())?;
            }
        }
        copied
    }
}

/// The repository's root and the folders in it.
fn members() -> Result<Vec<PathBuf>> {
    let entries = fs::read_dir(root()).context("the repository's root")?;
    let inside = entries.map(|entry| Ok(entry?.path()));
    std::iter::once(Ok(root())).chain(inside).collect()
}
