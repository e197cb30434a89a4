//! Where the files lie that an OBJ file and its libraries name: in the scene's folder and those in it.

use crate::scene::file;
use std::path::{Path, PathBuf};

/// The folder of a file that names others.
pub(super) struct Files<'a> {
    /// The scene's folder, out of which names do not lead.
    folder: &'a Path,
    /// The folder in it that names begin at.
    below: PathBuf,
}

impl<'a> Files<'a> {
    /// The folder of a file in a scene's folder.
    pub fn beside(folder: &'a Path, file: &Path) -> Self {
        let below = file.strip_prefix(folder).ok().and_then(Path::parent).unwrap_or(Path::new(""));
        Self { folder, below: below.to_owned() }
    }

    /// The plain file of a name. There is none where the name leads out of the scene's folder.
    pub fn named(&self, name: &str) -> Option<PathBuf> {
        let name = unquoted(name).replace('\\', "/");
        file::beside(self.folder, &self.below, name).ok().filter(|path| path.is_file())
    }

    /// The plain file of a name in other letters (`T.PNG` for `t.png`, which are one on other computers), or
    /// of its last part, here or in the folder `textures`: names of other computers (`C:\Users\x\t.png`) have
    /// been true where the files lay then.
    pub fn called(&self, name: &str) -> Option<PathBuf> {
        let last = unquoted(name).rsplit(['/', '\\']).next()?;
        let named = |name: &str| self.named(name).or_else(|| self.named_in_any_case(name));
        named(name).or_else(|| named(last)).or_else(|| named(&format!("textures/{last}")))
    }

    /// The plain file of a name of which any letter may be small or capital.
    fn named_in_any_case(&self, name: &str) -> Option<PathBuf> {
        let wanted = file::beside(self.folder, &self.below, unquoted(name).replace('\\', "/")).ok()?;
        let mut parts = wanted.strip_prefix(self.folder).ok()?.components();
        let path = parts.try_fold(self.folder.to_owned(), |folder, part| {
            let wanted = part.as_os_str().to_string_lossy().to_lowercase();
            let is_it = |path: &PathBuf| {
                path.file_name().is_some_and(|name| name.to_string_lossy().to_lowercase() == wanted)
            };
            let here = if folder.as_os_str().is_empty() { Path::new(".") } else { &folder };
            std::fs::read_dir(here)
                .ok()?
                .flatten()
                .map(|entry| folder.join(entry.file_name()))
                .filter(is_it)
                .min()
        });
        path.filter(|path| path.is_file())
    }
}

fn unquoted(name: &str) -> &str {
    name.trim().trim_matches('"')
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn names_are_looked_for_in_the_scenes_folder_only() {
        let all = tempfile::tempdir().expect("a temporary folder");
        let folder = all.path().join("scene");
        fs::create_dir_all(folder.join("mtl/textures")).expect("folders");
        for name in ["../outside.png", "beside.png", "mtl/t.png", "mtl/textures/u.png"] {
            fs::write(folder.join(name), "").expect("a file");
        }
        let files = Files::beside(&folder, &folder.join("mtl/a.mtl"));
        assert_eq!(files.named("\"t.png\""), Some(folder.join("mtl/t.png")));
        assert_eq!(files.named("..\\beside.png"), Some(folder.join("beside.png")));
        for name in ["../../outside.png", "u.png", "", "textures", "/etc/hostname", "C:\\x\\t.png"] {
            assert_eq!(files.named(name), None, "{name}");
        }
        for name in ["C:\\Users\\x\\t.png", "C:/Users/x/t.png", "/home/x/t.png"] {
            assert_eq!(files.called(name), Some(folder.join("mtl/t.png")), "{name}");
        }
        for name in ["T.png", "C:\\x\\T.PNG", "../MTL/T.png"] {
            assert_eq!(
                (files.named(name), files.called(name)),
                (None, Some(folder.join("mtl/t.png"))),
                "{name}"
            );
        }
        assert_eq!(files.called("../../u.png"), Some(folder.join("mtl/textures/u.png")));
        assert_eq!([files.called("../../outside.png"), files.called("x/..")], [None, None]);
    }
}
