//! What the cards of shipped networks say of their data: that they were trained and tested on scenes that are
//! apart.

use deepshade_dataset::Recipe;
use deepshade_dataset::vary::Surroundings;
use deepshade_infer::{Model, TrainedUnder};
use deepshade_render::scene::procedural::{Family, Split};
use deepshade_shaders::Effect;
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Frames that a network is tested on at least.
const LEAST_FRAMES: usize = 200;

fn root(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// What a row of a card's tables says.
fn row<'a>(card: &'a str, name: &str) -> &'a str {
    let line = card.lines().find_map(|line| line.strip_prefix(&format!("| {name} | ")));
    line.expect("a row of that name").trim_end_matches([' ', '|'])
}

/// The scene families that a card names: the last words in brackets.
fn families(card: &str) -> BTreeSet<String> {
    let words = row(card, "Data").rsplit_once('(').expect("families in brackets").1;
    words.trim_end_matches(')').split(", ").map(str::to_owned).collect()
}

fn recipe(name: &str) -> Recipe {
    Recipe::load(&root("dataset/recipes").join(name)).expect("a sound recipe")
}

fn families_of(recipe: &Recipe) -> BTreeSet<String> {
    recipe.families.iter().map(|share| share.name.clone()).collect()
}

/// The networks' names, with their folders.
fn shipped() -> Vec<(String, PathBuf)> {
    let entries =
        std::fs::read_dir(root("models")).expect("models").map(|entry| entry.expect("an entry").path());
    let folders = entries.filter(|path| path.is_dir());
    let named = |folder: PathBuf| Some((folder.file_name()?.to_str()?.to_owned(), folder));
    let networks: Vec<_> = folders.filter_map(named).collect();
    assert!(!networks.is_empty());
    networks
}

/// The recipe that a card names, in backticks.
fn named(card: &str) -> String {
    let words = row(card, "Data").split('`').nth(1).expect("a recipe in backticks");
    words.to_owned()
}

/// All recipes for testing an effect.
fn tests_of(effect: Effect) -> Vec<Recipe> {
    let entries = std::fs::read_dir(root("dataset/recipes")).expect("recipes");
    let names = entries.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned());
    let recipes = names.filter(|name| name.ends_with(".toml")).map(|name| recipe(&name));
    recipes.filter(|recipe| recipe.split == Split::Test && recipe.effect == effect).collect()
}

#[test]
fn no_network_was_tested_on_scenes_that_it_was_trained_on() {
    for (name, folder) in shipped() {
        let card = std::fs::read_to_string(folder.join("card.md")).expect("a card");
        let spec = Model::load(&folder).expect("a model").spec;
        let trained = recipe(&named(&card));
        assert_eq!((trained.effect, trained.split), (spec.effect, Split::Train), "{name}");
        assert!(trained.files.is_empty(), "{name}: files are told apart elsewhere");
        assert_eq!(families(&card), families_of(&trained), "{name}: the card's families");
        let tests = tests_of(spec.effect);
        assert!(!tests.is_empty(), "{name}: nothing to test it on");
        for tested in tests {
            assert!(families(&card).is_disjoint(&families_of(&tested)), "{name}: {}", tested.path.display());
        }
        for family in families(&card) {
            assert_eq!(Family::by_name(&family).expect("a family").split(), Split::Train, "{name}: {family}");
        }
        let frames: usize = row(&card, "frames").parse().expect("a number");
        assert!(frames >= LEAST_FRAMES, "{name}: {frames} frames");
        assert_eq!(row(&card, "Weights"), spec.weight_count().to_string(), "{name}");
    }
}

#[test]
fn networks_that_know_one_environment_state_that_of_their_recipe() {
    let mut stated = 0;
    for (name, folder) in shipped() {
        let card = std::fs::read_to_string(folder.join("card.md")).expect("a card");
        let vary = recipe(&named(&card)).vary;
        let environment = vary.and_then(|vary| vary.environment);
        assert!(
            !matches!(environment, Some(Surroundings::File(_))),
            "{name}: a file that others do not have"
        );
        let sky = environment.and_then(|environment| match environment {
            Surroundings::Sky(number) => Some(TrainedUnder::Sky(number)),
            Surroundings::File(_) | Surroundings::Skies(_) => None,
        });
        let spec = Model::load(&folder).expect("a model").spec;
        assert_eq!(spec.environment, sky, "{name}");
        stated += usize::from(sky.is_some());
    }
    assert_eq!(stated, 2, "do and ibl");
}

/// What evaluations came to: of a network, under its name with underscores.
fn results() -> Value {
    let text = std::fs::read_to_string(root("models/results.json")).expect("results");
    serde_json::from_str::<Value>(&text).expect("JSON")["networks"].clone()
}

#[test]
fn what_cards_say_is_what_came_out() {
    let results = results();
    for (name, folder) in shipped() {
        let card = std::fs::read_to_string(folder.join("card.md")).expect("a card");
        let key = name.replace('-', "_");
        let figures = results[&key]["figures"].as_object().expect("figures");
        // `ssim_gi_surfel` is what the card of `gi` calls `ssim_surfel`, and `ssim_gi` its `ssim_learned`.
        for (figure, value) in figures.iter().filter(|(figure, _)| figure.starts_with("ssim_")) {
            let method = figure.trim_start_matches("ssim_").trim_start_matches(key.as_str());
            let method = if method.is_empty() { "_learned" } else { method };
            let value = value.as_f64().expect("a number");
            assert_eq!(row(&card, &format!("ssim{method}")), format!("{value:.4}"), "{name}: {figure}");
        }
    }
}

/// A method as figures name it: `ring_gather`, or `surfel_medium` where its quality is another than high.
fn method_in_words(figure: &str) -> String {
    let qualities = ["low", "medium", "ultra"];
    let tuned = figure.rsplit_once('_').filter(|(_, quality)| qualities.contains(quality));
    let hyphens = |name: &str| name.replace('_', "-");
    match tuned {
        Some((method, quality)) => format!("`{}` at {quality}", hyphens(method)),
        None => format!("`{}`", hyphens(figure)),
    }
}

/// A network's row of the README's table, of what its evaluation came to.
fn networks_row(name: &str, folder: &Path, network: &Value) -> String {
    let key = name.replace('-', "_");
    let figure = |name: &str| network["figures"][name].as_f64().expect("a figure");
    let with_interval = |name: &str| {
        let end = |end: usize| network["confidence_95"][name][end].as_f64().expect("an interval");
        format!("{:.3} [{:.3}, {:.3}]", figure(name), end(0), end(1))
    };
    let effect = Model::load(folder).expect("a model").spec.effect;
    let trivial = effect.definition().doing_nothing.name();
    let rivals = network["devices"].as_object().expect("devices").keys().filter(|rival| *rival != "learned");
    let ssim = |rival: &String| format!("ssim_{key}_{rival}");
    let best = rivals.max_by(|a, b| figure(&ssim(a)).total_cmp(&figure(&ssim(b))));
    let (rival, its_ssim) =
        best.map_or_else(Default::default, |best| (method_in_words(best), with_interval(&ssim(best))));
    format!(
        "| `{name}` | {} | {rival} | {its_ssim} | {:.3} | {:.3} |",
        with_interval(&format!("ssim_{key}")),
        figure(&format!("ssim_{key}_{trivial}")),
        figure(&format!("ceiling_{key}")),
    )
}

#[test]
fn the_readme_s_table_of_networks_is_made_of_what_came_out() {
    let results = results();
    let mut networks = shipped();
    networks.sort();
    let row =
        |(name, folder): &(String, PathBuf)| networks_row(name, folder, &results[name.replace('-', "_")]);
    let expected: Vec<String> = networks.iter().map(row).collect();
    let readme = std::fs::read_to_string(root("README.md")).expect("a README");
    let (_, table) = readme.split_once("<!-- networks -->").expect("where the table begins");
    let (table, _) = table.split_once("<!-- /networks -->").expect("where it ends");
    let rows: Vec<&str> = table.lines().filter(|line| line.starts_with("| `")).collect();
    assert_eq!(rows, expected, "the README's rows should be\n{}\n", expected.join("\n"));
}

#[test]
#[should_panic(expected = "the card's families")]
fn a_card_that_names_other_scenes_is_found() {
    let card = "| Data | `ao.toml`: 320 frames of 80 scenes (room, drapery) |";
    assert_eq!(families(card), families_of(&recipe("ao.toml")), "the card's families");
}
