//! What the book promises: its summary lists its chapters, what it links to is there, its commands are the program's, and
//! no command, effect or method is left out. What README.md and CONTRIBUTING.md show of commands is the program's, too.

use deepshade_shaders::Effect;
use deepshade_shaders::effect::{Definition, Setting};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;

const PROGRAM: &str = env!("CARGO_BIN_EXE_deepshade");

/// Where the chapters lie.
fn source() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("book/src")
}

fn text(file: &str) -> String {
    std::fs::read_to_string(source().join(file)).expect(file)
}

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
        let radius = if effect.listens_to(Setting::Radius) { "yes" } else { "no" };
        let row = format!("| `{effect}` | {meaning} | {radius} | {} |", lit_by.words());
        assert!(effects.contains(&row), "effects.md has no row {row}");
    }
}

/// Names of all files below a folder, relative to the chapters.
fn files(folder: &Path) -> BTreeSet<String> {
    let mut names = BTreeSet::new();
    for path in std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()) {
        if path.is_dir() {
            names.extend(files(&path));
        } else {
            names.insert(path.strip_prefix(source()).expect("below it").to_string_lossy().into_owned());
        }
    }
    names
}

fn chapters() -> BTreeMap<String, String> {
    let chapters = files(&source()).into_iter().filter(|name| name.ends_with(".md") && name != "SUMMARY.md");
    chapters.map(|name| (name.clone(), text(&name))).collect()
}

/// Lines of a chapter, each with the language of the code block that it is in; none in prose.
fn lines(chapter: &str) -> Vec<(Option<&str>, &str)> {
    let mut block = None;
    let mut lines = Vec::new();
    for line in chapter.lines() {
        match line.trim_start().strip_prefix("```") {
            Some(language) => block = if block.is_some() { None } else { Some(language) },
            None => lines.push((block, line)),
        }
    }
    lines
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

/// Commands of a chapter's shell blocks, their continued lines joined, without comments.
fn commands(chapter: &str) -> Vec<String> {
    let shell = lines(chapter).into_iter().filter(|(block, _)| *block == Some("sh"));
    let joined = shell.map(|(_, line)| format!("{line}\n")).collect::<String>().replace("\\\n", " ");
    let bare = joined.lines().map(|line| line.split('#').next().unwrap_or(line).split_whitespace());
    bare.map(|words| words.collect::<Vec<_>>().join(" ")).filter(|line| !line.is_empty()).collect()
}

/// The program's own words on a command, such as `bench net`.
fn help(words: &[&str]) -> String {
    let output = Command::new(PROGRAM).args(words).arg("--help").output().expect("starts");
    assert!(output.status.success(), "{} --help", words.join(" "));
    String::from_utf8(output.stdout).expect("text")
}

/// The commands that a help lists, and not `help`.
fn verbs(help: &str) -> Vec<&str> {
    let rows = help.lines().skip_while(|line| *line != "Commands:").skip(1);
    let rows = rows.take_while(|line| !line.is_empty()).filter(|line| !line.starts_with("   "));
    rows.filter_map(|row| row.split_whitespace().next()).filter(|verb| *verb != "help").collect()
}

/// The options that a help lists.
fn options(help: &str) -> BTreeSet<&str> {
    let rows = help.lines().take_while(|line| !line.starts_with("Example")).map(str::trim_start);
    let rows = rows.filter(|row| row.starts_with('-'));
    rows.filter_map(|row| row.split_whitespace().find(|word| word.starts_with("--"))).collect()
}

/// What of a line the program does not know, if it is one of the program's.
fn unknown(line: &str) -> Vec<String> {
    let mut words = line.split_whitespace().peekable();
    if words.next() != Some("deepshade") {
        return Vec::new();
    }
    let mut path = Vec::new();
    let mut page = help(&path);
    while !verbs(&page).is_empty() {
        let Some(verb) = words.next_if(|word| verbs(&page).contains(word)) else {
            return vec![format!("`{line}`: no such command")];
        };
        path.push(verb);
        page = help(&path);
    }
    let known = options(&page);
    let asked = words.filter(|word| word.starts_with("--"));
    asked.filter(|option| !known.contains(option)).map(|option| format!("`{line}`: no {option}")).collect()
}

/// All commands, those below others too, such as `bench net`.
fn all_verbs() -> Vec<String> {
    let mut all = Vec::new();
    for verb in verbs(&help(&[])) {
        let page = help(&[verb]);
        match verbs(&page)[..] {
            [] => all.push(verb.to_owned()),
            ref below => all.extend(below.iter().map(|name| format!("{verb} {name}"))),
        }
    }
    all
}

/// The methods of an effect, as the program lists them for somebody who asks for one that it has not.
fn methods(effect: Effect) -> Vec<String> {
    let folder = tempfile::tempdir().expect("a folder");
    let args = ["compare", "--scene", "stairs:1", "--methods", "nobody's", "--out", "report", "--effect"];
    let mut command = Command::new(PROGRAM);
    let output = command.args(args).arg(effect.name()).current_dir(folder.path()).output().expect("starts");
    let message = String::from_utf8(output.stderr).expect("text");
    let (_, list) = message.trim_end().split_once("there are ").expect("a list");
    list.split(", ").map(str::to_owned).collect()
}

/// The row of a table that begins with a name.
fn row<'a>(chapter: &'a str, name: &str) -> Option<&'a str> {
    chapter.lines().find(|line| line.starts_with(&format!("| `{name}` |")))
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
    let faults: Vec<String> = commands.iter().flat_map(|line| unknown(line)).collect();
    assert!(faults.is_empty(), "{faults:#?}");
}

#[test]
fn every_command_has_its_row_in_the_chapter_of_commands() {
    let chapter = text("commands.md");
    let missing: Vec<String> = all_verbs().into_iter().filter(|verb| row(&chapter, verb).is_none()).collect();
    assert!(missing.is_empty(), "{missing:?}");
}

#[test]
fn every_effect_is_explained_and_every_method_named_beside_its_effect() {
    let (effects, table) = (text("effects.md"), text("methods.md"));
    for effect in Effect::ALL {
        assert!(row(&effects, effect.name()).is_some(), "{effect}");
        let row = row(&table, effect.name()).expect("a row of methods");
        let named: Vec<&str> = row.split('`').skip(3).step_by(2).collect();
        let there = methods(effect);
        let there: BTreeSet<&str> =
            there.iter().map(String::as_str).filter(|name| *name != "truth").collect();
        assert_eq!(named.iter().copied().collect::<BTreeSet<_>>(), there, "{effect}");
        for method in there.iter().filter(|name| **name != "learned") {
            let explained =
                chapters().values().any(|chapter| chapter.contains(&format!("\n### `{method}`\n")));
            assert!(explained, "{method}");
        }
    }
}

#[test]
fn what_is_wrong_in_a_book_is_found() {
    let chapter = "[a](no-such-chapter.md) [b](https://example.org)\n```sh\ndeepshade paint\ndeepshade bench \\\n  net --colour red  \
                   # --layers\ndeepshade bench net --layers\n```\n";
    assert_eq!(broken("concepts.md", chapter), ["concepts.md: no-such-chapter.md"]);
    let faults: Vec<String> = commands(chapter).iter().flat_map(|line| unknown(line)).collect();
    assert_eq!(faults.len(), 2, "{faults:?}");
    assert!(faults[0].contains("`deepshade paint`") && faults[1].ends_with("no --colour"), "{faults:?}");
}
