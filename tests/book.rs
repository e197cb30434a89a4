//! What the book promises: its summary lists its chapters, what it links to is there, its commands are the
//! program's, and no command, effect or method is left out. What README.md and CONTRIBUTING.md show of
//! commands is the program's, too.

#[path = "book/shown.rs"]
mod shown;

use deepshade_shaders::Effect;
use deepshade_shaders::effect::{Definition, EffectSetting};
use shown::{Program, chapters, commands, files, lines, row, source, text};
use std::collections::BTreeSet;
use std::process::Command;

const PROGRAM: Program = Program { name: "deepshade", path: env!("CARGO_BIN_EXE_deepshade") };

/// A count below twenty in words.
fn in_words(count: usize) -> &'static str {
    let words = [
        "none",
        "one",
        "two",
        "three",
        "four",
        "five",
        "six",
        "seven",
        "eight",
        "nine",
        "ten",
        "eleven",
        "twelve",
        "thirteen",
        "fourteen",
        "fifteen",
        "sixteen",
        "seventeen",
        "eighteen",
        "nineteen",
        "twenty",
        "twenty-one",
        "twenty-two",
        "twenty-three",
        "twenty-four",
    ];
    words[count]
}

#[test]
fn readme_and_book_count_the_same_effects() {
    let unwrapped = |file: &str| text(file).split_whitespace().collect::<Vec<_>>().join(" ");
    let [readme, effects, concepts] = ["../../README.md", "effects.md", "concepts.md"].map(unwrapped);
    let count = in_words(Effect::ALL.len());
    assert!(readme.contains(&format!("There are {count} effects.")));
    assert!(
        effects.contains(&format!("There are {count}.")) && concepts.contains(&format!("lists all {count}"))
    );
    for effect in Effect::ALL {
        assert!(readme.contains(&format!("| `{effect}` | ")), "README.md has no row of {effect}");
        let Definition { meaning, lit_by, .. } = effect.definition();
        let radius = if effect.listens_to(EffectSetting::Radius) { "yes" } else { "no" };
        let row = format!("| `{effect}` | {meaning} | {radius} | {} |", lit_by.words());
        assert!(effects.contains(&row), "effects.md has no row {row}");
    }
}

/// What a chapter's prose refers to, and what it includes, but for other sites and places within the chapter.
fn references(chapter: &str) -> Vec<&str> {
    let between = |line, start, end| -> Vec<&str> {
        let parts = str::split(line, start).skip(1);
        parts.filter_map(|part| Some(part.split_once(end)?.0)).collect()
    };
    let prose = lines(chapter).into_iter().filter(|(block, _)| block.is_none());
    let links = prose.flat_map(|(_, line)| between(line, "](", ")"));
    let included = chapter.lines().flat_map(|line| between(line, "{{#include ", "}}"));
    let places = links.chain(included).map(|link| link.split(['#', ':']).next().unwrap_or(link));
    places.filter(|place| !place.is_empty() && !["http", "https"].contains(place)).collect()
}

/// References that lead nowhere.
fn broken(name: &str, chapter: &str) -> Vec<String> {
    let folder = source().join(name).parent().expect("a file's folder").to_owned();
    let missing = references(chapter).into_iter().filter(|place| !folder.join(place).is_file());
    missing.map(|place| format!("{name}: {place}")).collect()
}

/// The methods of an effect, as the program lists them for somebody who asks for one that it has not.
fn methods(effect: Effect) -> Vec<String> {
    let folder = tempfile::tempdir().expect("a folder");
    let args = ["compare", "--scene", "stairs:1", "--methods", "nobody's", "--out", "report", "--effect"];
    let mut command = Command::new(PROGRAM.path);
    let output = command.args(args).arg(effect.name()).current_dir(folder.path()).output().expect("starts");
    let message = String::from_utf8(output.stderr).expect("text");
    let (_, list) = message.trim_end().split_once("there are ").expect("a list");
    list.split(", ").map(str::to_owned).collect()
}

#[test]
fn the_summary_lists_every_chapter_once_and_nothing_else() {
    let summary = text("SUMMARY.md");
    let listed = references(&summary);
    let chapters: Vec<String> = chapters().into_keys().collect();
    assert!(chapters.len() > 10);
    assert_eq!(
        listed.iter().copied().collect::<BTreeSet<_>>(),
        chapters.iter().map(String::as_str).collect()
    );
    assert_eq!(listed.len(), chapters.len(), "twice");
}

#[test]
fn every_reference_leads_somewhere_and_every_picture_is_shown() {
    let chapters = chapters();
    let faults: Vec<String> = chapters.iter().flat_map(|(name, chapter)| broken(name, chapter)).collect();
    assert!(faults.is_empty(), "{faults:#?}");
    let shown: BTreeSet<&str> = chapters.values().flat_map(|chapter| references(chapter)).collect();
    let pictures = files(&source().join("pictures"));
    assert!(!pictures.is_empty());
    let unseen: Vec<&String> = pictures.iter().filter(|name| !shown.contains(name.as_str())).collect();
    assert!(unseen.is_empty(), "in no chapter: {unseen:?}");
}

#[test]
fn every_command_and_option_in_the_book_and_beside_it_is_the_programs() {
    let beside = ["README.md", "CONTRIBUTING.md"].map(|file| text(&format!("../../{file}")));
    let commands: BTreeSet<String> =
        chapters().values().chain(&beside).flat_map(|text| commands(text)).collect();
    assert!(commands.iter().filter(|line| line.starts_with("deepshade ")).count() > 30);
    let faults: Vec<String> = commands.iter().flat_map(|line| PROGRAM.unknown(line)).collect();
    assert!(faults.is_empty(), "{faults:#?}");
}

#[test]
fn every_command_has_its_row_in_the_chapter_of_commands() {
    let chapter = text("commands.md");
    let missing: Vec<String> =
        PROGRAM.all_verbs().into_iter().filter(|verb| row(&chapter, verb).is_none()).collect();
    assert!(missing.is_empty(), "{missing:?}");
}

/// The row of an effect in the README.
fn row_of(readme: &str, effect: Effect) -> &str {
    readme.lines().find(|line| line.starts_with(&format!("| `{effect}` | "))).expect("a row")
}

#[test]
fn every_effect_is_explained_and_every_method_named_beside_its_effect() {
    let (effects, table, readme) = (text("effects.md"), text("methods.md"), text("../../README.md"));
    for effect in Effect::ALL {
        assert!(row(&effects, effect.name()).is_some(), "{effect}");
        let row = row(&table, effect.name()).expect("a row of methods");
        let named: Vec<&str> = row.split('`').skip(3).step_by(2).collect();
        let there = methods(effect);
        let there: BTreeSet<&str> =
            there.iter().map(String::as_str).filter(|name| *name != "truth").collect();
        assert_eq!(named.iter().copied().collect::<BTreeSet<_>>(), there, "{effect}");
        let analytic: Vec<&str> = named.into_iter().filter(|name| *name != "learned").collect();
        let cell = row_of(&readme, effect).rsplit('|').nth(1).expect("a column of methods");
        let in_readme: Vec<&str> = cell.split('`').skip(1).step_by(2).collect();
        assert_eq!(in_readme, analytic, "{effect} in README.md");
        for method in there.iter().filter(|name| **name != "learned") {
            let explained =
                chapters().values().any(|chapter| chapter.contains(&format!("\n### `{method}`\n")));
            assert!(explained, "{method}");
        }
    }
}

#[test]
fn the_patch_of_the_effect_that_is_shown_still_applies() {
    let patch = source().join("thickness.patch");
    let root = source().join("../..").canonicalize().expect("the checkout");
    let mut command = Command::new("git");
    command.args(["apply", "--check"]).arg(&patch).current_dir(&root);
    // In another repository's folder git would leave out all files, and find nothing wrong.
    command.env("GIT_CEILING_DIRECTORIES", root.parent().expect("a folder above"));
    let output = command.output().expect("git starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn what_is_wrong_in_a_book_is_found() {
    let chapter = "[a](no-such-chapter.md) [b](https://example.org)\n```sh\ndeepshade paint\ndeepshade bench \\\n  net --colour red  \
                   # --layers\ndeepshade bench net --layers\n```\n";
    assert_eq!(broken("concepts.md", chapter), ["concepts.md: no-such-chapter.md"]);
    let faults: Vec<String> = commands(chapter).iter().flat_map(|line| PROGRAM.unknown(line)).collect();
    assert_eq!(faults.len(), 2, "{faults:?}");
    assert!(faults[0].contains("`deepshade paint`") && faults[1].ends_with("no --colour"), "{faults:?}");
}
