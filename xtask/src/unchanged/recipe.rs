//! Recipes made small: few pixels, few samples, one scene of each family, two views of each scene, one behind
//! the other where they make a sequence.

/// Pixels, samples and numbers of a small recipe, by the keys that recipes have for them.
const SMALL: [(&str, &str); 10] = [
    ("resolution", "{ height = 48, width = 64 }"),
    ("smallest", "{ height = 48, width = 64 }"),
    ("samples", "8"),
    ("views_per_scene", "2"),
    ("sequence", "{ frames = 2, turn = 0.1, step = 0.1 }"),
    ("scenes", "1"),
    ("one_in", "4"),
    ("whole_frames", "1"),
    ("textures", "{ procedural = 4 }"),
    ("validation_share", "0.5"),
];

/// A recipe made small, line by line; `None` of one that names files.
pub fn small(text: &str) -> Option<String> {
    let key = |line: &str| line.split_once('=').map(|(key, _)| key.trim().to_owned());
    if text.lines().any(|line| key(line).is_some_and(|key| ["files", "captures"].contains(&key.as_str()))) {
        return None;
    }
    let replaced = |line: &str| {
        let value = key(line).and_then(|key| SMALL.iter().find(|(name, _)| *name == key));
        value.map_or_else(|| line.to_owned(), |(name, value)| format!("{name} = {value}"))
    };
    Some(text.lines().map(replaced).collect::<Vec<_>>().join("\n"))
}

/// Whether a recipe is for testing.
pub fn is_test(text: &str) -> bool {
    text.lines().any(|line| line.trim() == "split = \"test\"")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_become_small_and_nothing_else_changes() {
        let text =
            "split = \"test\"\nsamples = 256 # many\nseed = 7\n\n[[families]]\nname = \"cave\"\nscenes = 40";
        let expected = "split = \"test\"\nsamples = 8\nseed = 7\n\n[[families]]\nname = \"cave\"\nscenes = 1";
        assert_eq!(small(text).as_deref(), Some(expected));
        assert_eq!(small("files = [\"hall.gltf\"]"), None);
        assert!(is_test(text) && !is_test("split = \"train\""));
    }
}
