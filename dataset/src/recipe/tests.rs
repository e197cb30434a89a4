use super::*;
use crate::SceneOrCapture;
use deepshade_render::scene::SceneSource;
use deepshade_render::scene::procedural::Family;

/// A sound recipe.
fn text() -> String {
    let train = Family::ALL.into_iter().find(|family| family.split() == Split::Train).expect("a family");
    format!(
        "effect = \"ao\"\nsplit = \"train\"\nseed = 1\nresolution = {{ height = 64, width = 96 }}\nsamples = 16\n\
         radius = {{ diagonal = 0.05 }}\nviews_per_scene = 2\nvalidation_share = 0.25\n\
         [[families]]\nname = \"{}\"\nscenes = 3\n",
        train.name()
    )
}

/// Writes a recipe with some lines put before, changed or added, and loads it.
fn load(folder: &Path, name: &str, edit: impl Fn(String) -> String) -> Result<Recipe, DatasetError> {
    let path = folder.join(name);
    std::fs::write(&path, edit(text())).expect("written");
    Recipe::load(&path)
}

fn refusal(edit: impl Fn(String) -> String) -> String {
    let folder = tempfile::tempdir().expect("a folder");
    let error = load(folder.path(), "a.toml", edit).expect_err("refused").to_string();
    assert!(error.contains("a.toml"), "names the file: {error}");
    error
}

#[test]
fn a_recipe_is_read() {
    let folder = tempfile::tempdir().expect("a folder");
    let recipe = load(folder.path(), "a.toml", |text| text).expect("a sound recipe");
    assert_eq!(recipe.radius, Radius::Diagonal(0.05));
    assert_eq!((recipe.radius.metres(20.0), recipe.scene_count()), (Some(1.0), 3));
    let metres = load(folder.path(), "b.toml", |text| text.replace("diagonal = 0.05", "metres = 0.5"));
    assert_eq!(metres.expect("a sound recipe").radius.metres(20.0), Some(0.5));
}

#[test]
fn recipes_that_draw_nothing_are_described_as_before_and_those_that_do_are_read() {
    let folder = tempfile::tempdir().expect("a folder");
    let described = |recipe: &Recipe| serde_json::to_value(recipe).expect("JSON");
    let plain = load(folder.path(), "a.toml", |text| format!("field_of_view = 60.0\n{text}"));
    let plain = described(&plain.expect("a sound recipe"));
    // What their hashes are made of.
    assert!(plain.get("smallest").is_none() && plain.get("views").is_none());
    assert_eq!(plain["field_of_view"], 60.0);
    assert!(plain["radius"]["diagonal"].is_number(), "{plain}");
    let drawn = load(folder.path(), "b.toml", |text| {
        let text = text.replace("diagonal = 0.05", "pixels = [8.0, 160.0]");
        format!(
            "field_of_view = [35, 90]\nviews = \"near-and-far\"\nsmallest = {{ height = 16, width = 32 }}\n{text}"
        )
    });
    let drawn = drawn.expect("a sound recipe");
    assert_eq!((drawn.radius, drawn.views), (Radius::Pixels([8.0, 160.0]), Views::NearAndFar));
    assert_eq!(drawn.field_of_view, Some(FieldOfView::Drawn([35.0, 90.0])));
    let again: Recipe = serde_json::from_value(described(&drawn)).expect("the same recipe");
    assert_eq!((again.smallest, again.field_of_view), (drawn.smallest, drawn.field_of_view));
    let test = refusal(|text| {
        for_testing(&text).replace("seed = 1", "seed = 1\nsmallest = { height = 16, width = 32 }")
    });
    assert!(test.contains("`smallest` is for training"), "{test}");
}

#[test]
fn unknown_keys_are_named() {
    let mistyped = refusal(|text| format!("sample = 3\n{text}"));
    assert!(mistyped.contains("unknown field `sample` (did you mean `samples`?), expected"), "{mistyped}");
    assert!(refusal(|text| format!("{text}seed = 3\n")).contains("unknown field `seed`"));
    assert!(refusal(|text| text.replace("diagonal", "feet")).contains("unknown variant `feet`"));
    assert!(refusal(|text| text.replace("samples = 16\n", "")).contains("missing field `samples`"));
}

#[test]
fn absurd_values_are_refused_with_their_limits() {
    let cases = [
        ("height = 64", "height = 9000", "`resolution.height` must be 16 to 8192"),
        ("width = 96", "width = 3", "`resolution.width` must be 16 to 8192"),
        ("height = 64, width = 96", "height = 8192, width = 8192", "at most 33554432 pixels"),
        ("samples = 16", "samples = 0", "`samples` must be 1 to 65536"),
        ("samples = 16", "samples = 100000", "`samples` must be 1 to 65536"),
        ("samples = 16", "samples = 16\nerror = 0.0", "`error` must be above 0"),
        ("samples = 16", "samples = 16\nscramblings = 0", "`scramblings` must be 1 to 8"),
        ("samples = 16", "samples = 16\nscramblings = 16", "`scramblings` must be 1 to 8"),
        ("samples = 16", "samples = 16\nscramblings = 3", "and a divisor of `samples`"),
        (
            "samples = 16",
            "samples = 16\nscramblings = 2\nerror = 0.1",
            "without `scramblings`: truth of `error` always has 8",
        ),
        ("samples = 16", "samples = 16\nscramblings = 2\ntarget = \"hbao\"", "`scramblings` is for truth"),
        ("\"train\"", "\"test\"\nscramblings = 2", "without `scramblings`: truth of a test set always has 8"),
        ("0.05", "nan", "`radius.diagonal` must be above 0"),
        ("0.05", "-1.0", "`radius.diagonal` must be above 0"),
        ("views_per_scene = 2", "views_per_scene = 0", "1 to 1000000 views"),
        ("views_per_scene = 2", "views_per_scene = 400000", "1 to 1000000 views"),
        (
            "seed = 1",
            "seed = 1\nsequence = { frames = 3, turn = 1.0, step = 0.0 }",
            "`views_per_scene` a multiple of it",
        ),
        (
            "seed = 1",
            "seed = 1\nsequence = { frames = 2, turn = 30.0, step = 0.0 }",
            "`sequence.turn` must be 0 to 10",
        ),
        (
            "seed = 1",
            "seed = 1\nfield_of_view = 50.0\nsequence = { frames = 2, turn = 1.0, step = 0.0 }",
            "without `field_of_view`",
        ),
        (
            "seed = 1",
            "seed = 1\nvary = {}\nsequence = { frames = 2, turn = 1.0, step = 0.0 }",
            "without `vary`, but for one with a `timeline`",
        ),
        ("seed = 1", "seed = 1\nfield_of_view = 19.0", "`field_of_view` must be 20 to 90 degrees"),
        ("seed = 1", "seed = 1\nfield_of_view = nan", "`field_of_view` must be 20 to 90 degrees"),
        ("seed = 1", "seed = 1\nfield_of_view = [50.0, 40.0]", "`field_of_view` must be 20 to 90 degrees"),
        ("seed = 1", "seed = 1\nfield_of_view = [40.0, 91.0]", "`field_of_view` must be 20 to 90 degrees"),
        ("seed = 1", "seed = 1\nfield_of_view = \"wide\"", "a number of degrees, or the two"),
        ("seed = 1", "seed = 1\nviews = \"near\"", "unknown variant `near`"),
        (
            "seed = 1",
            "seed = 1\nsmallest = { height = 12, width = 96 }",
            "`smallest` must be 16 pixels or more",
        ),
        ("seed = 1", "seed = 1\nsmallest = { height = 72, width = 96 }", "no more than `resolution`"),
        ("seed = 1", "seed = 1\nsmallest = { height = 60, width = 96 }", "in multiples of 8"),
        ("diagonal = 0.05", "pixels = [0.0, 9.0]", "`radius.pixels` must be above 0"),
        ("diagonal = 0.05", "pixels = [9.0, 8.0]", "`radius.pixels` must be above 0"),
        ("diagonal = 0.05", "metres-between = [1.0, nan]", "`radius.metres-between` must be above 0"),
        (
            "diagonal = 0.05 }",
            "pixels = [8.0, 9.0] }\nsequence = { frames = 2, turn = 1.0, step = 0.0 }",
            "without `radius`",
        ),
        (
            "seed = 1",
            "seed = 1\nviews = \"near-and-far\"\ncamera = { position = [1.0, 1.0, 1.0], target = [0.0, 0.0, 0.0] }",
            "without `views`",
        ),
        ("share = 0.25", "share = 0.75", "`validation_share` must be 0 to 0.5"),
        ("scenes = 3", "scenes = 0", "so that there is a scene"),
    ];
    for (old, new, expected) in cases {
        let error = refusal(|text| text.replace(old, new));
        assert!(error.contains(expected), "{new}: {error}");
    }
}

#[test]
fn families_for_testing_do_not_train_and_the_reverse() {
    let test = Family::ALL.into_iter().find(|family| family.split() == Split::Test).expect("a family");
    let train = Family::ALL[0];
    let mixed = refusal(|text| text.replace(train.name(), test.name()));
    assert!(mixed.contains("mixes training and testing") && mixed.contains(test.name()), "{mixed}");
    let mixed = refusal(|text| for_testing(&text));
    assert!(mixed.contains("mixes training and testing") && mixed.contains(train.name()), "{mixed}");
    assert!(refusal(|text| text.replace(train.name(), "castles")).contains("no procedural family `castles`"));
}

#[test]
fn a_timeline_is_of_a_sequence_and_of_light_that_is_kept() {
    let timeline = |text: &str, seconds: &str, on: &str| {
        let vary =
            format!("vary = {{ motion = [1.0, 2.0], timeline = {{ seconds = {seconds}, on = {on} }} }}");
        text.replace("\"ao\"", "\"phosphor\"").replace("seed = 1", &format!("seed = 1\n{vary}"))
    };
    let sequence = |text: &str| {
        text.replace("seed = 1\n", "seed = 1\nsequence = { frames = 2, turn = 0.0, step = 0.0 }\n")
    };
    let folder = tempfile::tempdir().expect("a folder");
    let sound = |text: String| sequence(&timeline(&text, "0.5", "[[0.0, 1.0], [2.0, inf]]"));
    let recipe = load(folder.path(), "a.toml", sound).expect("a sound recipe");
    assert_eq!(recipe.attributes().last_chunk(), Some(&[Attribute::Motion, Attribute::Valid]));
    assert!(
        refusal(|text| timeline(&text, "0.5", "[[0.0, 1.0]]"))
            .contains("`vary.timeline` is of the frames of a `sequence`")
    );
    let of_ao = |text: String| sound(text).replace("\"phosphor\"", "\"ao\"");
    assert!(refusal(of_ao).contains("`vary.motion` means nothing for effect `ao`"));
    let unmoved = |text: String| of_ao(text).replace("motion = [1.0, 2.0], ", "");
    assert!(refusal(unmoved).contains("`vary.timeline` means nothing for effect `ao`"));
    let still = |text: String| {
        text.replace("\"ao\"", "\"phosphor\"").replace("seed = 1", "seed = 1\nvary = { motion = [1.0, 2.0] }")
    };
    assert!(
        refusal(still).contains("`vary.motion` means nothing for effect `phosphor` without `vary.timeline`")
    );
    for (seconds, on, expected) in [
        ("0.0", "[[0.0, 1.0]]", "`vary.timeline.seconds` must be 0.001 to 3600"),
        ("nan", "[[0.0, 1.0]]", "`vary.timeline.seconds` must be 0.001 to 3600"),
        ("0.5", "[]", "`vary.timeline.on` must be times"),
        ("0.5", "[[1.0, 1.0]]", "`vary.timeline.on` must be times"),
        ("0.5", "[[-1.0, 1.0]]", "`vary.timeline.on` must be times"),
        ("0.5", "[[0.0, 2.0], [1.0, 3.0]]", "`vary.timeline.on` must be times"),
        ("0.5", "[[0.0, nan]]", "`vary.timeline.on` must be times"),
    ] {
        let error = refusal(|text| sequence(&timeline(&text, seconds, on)));
        assert!(error.contains(expected), "{seconds} {on}: {error}");
    }
}

/// A folder with scene files: `seen.obj`, others of the same scene, and another one.
fn folder_of_scenes() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).expect("written");
    write("seen.obj", "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\nf 1 2 3\nf 1 2 4\n");
    write("copy.obj", "# a copy\nv 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\nf 1 2 3\nf 1 2 4\n");
    write("again.obj", "o again\nv 0 0 300\nv 100 0 0\nv 0 0 0\nv 0 200 0\nf 2 1 3\nf 4 3 2\n");
    write("other.obj", "v 0 0 0\nv 1 0 0\nv 0 2 1\nv 0 1 3\nf 1 2 3\nf 1 2 4\n");
    folder
}

/// A recipe with scene files in place of families.
fn with(text: &str, lines: &str) -> String {
    text.split("[[").next().expect("a head").to_owned() + lines
}

fn for_testing(text: &str) -> String {
    text.replace("\"train\"", "\"test\"").replace("validation_share = 0.25\n", "")
}

#[test]
fn a_scene_of_a_test_recipe_does_not_train_under_any_name_or_in_any_form() {
    let folder = folder_of_scenes();
    let test = |text: String| for_testing(&with(&text, "files = [\"seen.obj\"]\n"));
    load(folder.path(), "test.toml", test).expect("a test recipe");
    let train = |lines: &str| load(folder.path(), "train.toml", |text| with(&text, lines));
    let unnamed = train("files = [\"other.obj\"]\n").expect_err("no test recipe named");
    assert!(unnamed.to_string().contains("must name `test_recipes`"), "{unnamed}");
    for file in ["seen.obj", "copy.obj", "again.obj"] {
        let lines = format!("files = [\"other.obj\", \"{file}\"]\ntest_recipes = [\"test.toml\"]\n");
        let seen = train(&lines).expect_err("a scene for testing");
        assert!(matches!(seen, DatasetError::Mixed { .. }) && seen.to_string().contains(file), "{seen}");
    }
    train("files = [\"other.obj\"]\ntest_recipes = [\"test.toml\"]\n").expect("another scene");
}

#[test]
fn scene_files_of_test_recipes_are_looked_for_where_those_of_the_recipe_are() {
    let (recipes, scenes) = (tempfile::tempdir().expect("a folder"), folder_of_scenes());
    let test = for_testing(&with(&text(), "files = [\"seen.obj\"]\n"));
    std::fs::write(recipes.path().join("test.toml"), test).expect("written");
    let train = |file: &str| {
        let lines = format!("files = [\"{file}\"]\ntest_recipes = [\"test.toml\"]\n");
        let path = recipes.path().join("train.toml");
        std::fs::write(&path, with(&text(), &lines)).expect("written");
        (Recipe::load(&path), Recipe::load_with_scenes(&path, scenes.path()))
    };
    let (beside, elsewhere) = train("other.obj");
    assert!(beside.expect_err("not beside the recipe").to_string().contains("other.obj"));
    assert_eq!(elsewhere.expect("another scene").folder, scenes.path());
    let (_, seen) = train("copy.obj");
    assert!(matches!(seen, Err(DatasetError::Mixed { .. })), "{seen:?}");
}

#[test]
fn a_recipe_that_names_itself_or_another_for_training_is_refused() {
    let folder = folder_of_scenes();
    let lines = "files = [\"other.obj\"]\ntest_recipes = [\"train.toml\"]\n";
    let error = load(folder.path(), "train.toml", |text| with(&text, lines)).expect_err("itself").to_string();
    assert!(error.contains("`test_recipes`: train.toml is not for testing"), "{error}");
}

#[test]
fn a_scene_that_is_named_twice_is_refused() {
    let folder = folder_of_scenes();
    let files = |text: String| for_testing(&with(&text, "files = [\"seen.obj\", \"copy.obj\"]\n"));
    let recipe = load(folder.path(), "test.toml", files).expect("sound but for its files");
    let error = recipe.plan().expect_err("twice").to_string();
    assert!(error.contains("test.toml") && error.contains("seen.obj and copy.obj hold the same"), "{error}");
}

#[test]
fn keys_that_mean_nothing_are_refused() {
    let test = Family::ALL.into_iter().find(|family| family.split() == Split::Test).expect("a family");
    let shared =
        refusal(|text| text.replace("\"train\"", "\"test\"").replace(Family::ALL[0].name(), test.name()));
    assert!(shared.contains("`validation_share` is for training"), "{shared}");
    let estimated = refusal(|text| {
        let text = for_testing(&text).replace(Family::ALL[0].name(), test.name());
        text.replace("[[", "estimates = [\"surfel:low\"]\n[[")
    });
    assert!(estimated.contains("`estimates` is for training"), "{estimated}");
    let without_files = refusal(|text| text.replace("[[", "test_recipes = [\"t.toml\"]\n[["));
    assert!(without_files.contains("`test_recipes` is for training recipes with `files`"), "{without_files}");
}

#[test]
fn noise_is_known_of_truth_alone() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("recipes/real.toml");
    let photographed = Recipe { scramblings: 2, ..Recipe::load(&path).expect("a sound recipe") };
    let captures = vec![PathBuf::from("desk")];
    let captured =
        Recipe { captures, families: Vec::new(), vary: None, camera: None, ..photographed.clone() };
    let estimates = vec!["surfel:low".to_owned()];
    let estimated = Recipe { estimates, scramblings: 1, ..captured.clone() }.check(&path);
    let error = estimated.expect_err("refused").to_string();
    assert!(error.contains("`estimates` is for scenes, and `captures` are none"), "{error}");
    for (recipe, expected) in [
        (photographed, "`scramblings` is for truth, and with `vary.sensor`"),
        (captured, "`scramblings` is for scenes, and `captures` are none"),
    ] {
        let error = recipe.check(&path).expect_err("refused").to_string();
        assert!(error.contains(expected), "{error}");
        Recipe { scramblings: 1, ..recipe }.check(&path).expect("sound without it");
    }
}

#[test]
fn seeds_use_all_their_bits_and_no_scene_is_made_twice() {
    let folder = tempfile::tempdir().expect("a folder");
    let recipe = load(folder.path(), "a.toml", |text| text.replace("scenes = 3", "scenes = 2000"));
    let plan = recipe.expect("a sound recipe").plan().expect("a plan");
    let seeds: Vec<u64> = plan
        .iter()
        .map(|planned| match planned.scene.source {
            SceneOrCapture::Scene(SceneSource::Procedural(_, seed)) => seed,
            _ => unreachable!("no files"),
        })
        .collect();
    assert_eq!(seeds.iter().fold(0, |used, seed| used | seed), u64::MAX, "every bit is used");
    let distinct: std::collections::HashSet<u64> = seeds.iter().copied().collect();
    assert_eq!(distinct.len(), 2000);
}

#[test]
fn the_recipes_of_the_project_are_sound() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("recipes");
    let paths: Vec<PathBuf> =
        std::fs::read_dir(folder).expect("listed").map(|entry| entry.expect("an entry").path()).collect();
    // Scene files do not come with the project.
    let recipes: Vec<Recipe> =
        paths.iter().map(|path| Recipe::parse(path).expect("a sound recipe")).collect();
    for split in [Split::Train, Split::Test] {
        let of_split = || recipes.iter().filter(|recipe| recipe.split == split);
        let used = |family: &Family| {
            of_split().any(|recipe| recipe.families.iter().any(|share| share.name == family.name()))
        };
        assert!(
            Family::ALL.iter().filter(|family| family.split() == split).all(used),
            "every family is used"
        );
        assert!(of_split().all(|recipe| (split == Split::Train) == (recipe.validation_share > 0.0)));
        let without =
            Effect::ALL.into_iter().find(|effect| !of_split().any(|recipe| recipe.effect == *effect));
        assert_eq!(without, None, "every effect has a recipe of {split:?}");
    }
}
