//! What the book shows of commands, held against what a program says of itself. Studies have a program of
//! their own.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;

/// A program that the book shows.
pub struct Program {
    /// The first word of its command lines.
    pub name: &'static str,
    /// Where it was built.
    pub path: &'static str,
}

/// Where the chapters lie, whichever package asks.
pub fn source() -> PathBuf {
    let above = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors();
    above.map(|folder| folder.join("book/src")).find(|folder| folder.is_dir()).expect("the book")
}

/// A chapter, or another file by its path from there.
pub fn text(file: &str) -> String {
    std::fs::read_to_string(source().join(file)).expect(file)
}

/// Names of all files below a folder, relative to the chapters.
pub fn files(folder: &Path) -> BTreeSet<String> {
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

/// All chapters by their names.
pub fn chapters() -> BTreeMap<String, String> {
    let chapters = files(&source()).into_iter().filter(|name| name.ends_with(".md") && name != "SUMMARY.md");
    chapters.map(|name| (name.clone(), text(&name))).collect()
}

/// Lines of a chapter, each with the language of the code block that it is in; none in prose.
pub fn lines(chapter: &str) -> Vec<(Option<&str>, &str)> {
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

/// Commands of a chapter's shell blocks, their continued lines joined, without comments.
pub fn commands(chapter: &str) -> Vec<String> {
    let shell = lines(chapter).into_iter().filter(|(block, _)| *block == Some("sh"));
    let joined = shell.map(|(_, line)| format!("{line}\n")).collect::<String>().replace("\\\n", " ");
    let bare = joined.lines().map(|line| line.split('#').next().unwrap_or(line).split_whitespace());
    bare.map(|words| words.collect::<Vec<_>>().join(" ")).filter(|line| !line.is_empty()).collect()
}

/// The row of a table that begins with a name.
pub fn row<'a>(chapter: &'a str, name: &str) -> Option<&'a str> {
    chapter.lines().find(|line| line.starts_with(&format!("| `{name}` |")))
}

impl Program {
    /// The program's own words on a command, such as `bench net`.
    pub fn help(&self, words: &[&str]) -> String {
        let output = Command::new(self.path).args(words).arg("--help").output().expect("starts");
        assert!(output.status.success(), "{} --help", words.join(" "));
        String::from_utf8(output.stdout).expect("text")
    }

    /// What of a line the program does not know, if it is one of the program's.
    pub fn unknown(&self, line: &str) -> Vec<String> {
        let mut words = line.split_whitespace().peekable();
        if words.next() != Some(self.name) {
            return Vec::new();
        }
        let mut path = Vec::new();
        let mut page = self.help(&path);
        while !verbs(&page).is_empty() {
            let Some(verb) = words.next_if(|word| verbs(&page).contains(word)) else {
                return vec![format!("`{line}`: no such command")];
            };
            path.push(verb);
            page = self.help(&path);
        }
        let known = options(&page);
        let asked = words.filter(|word| word.starts_with("--"));
        asked
            .filter(|option| !known.contains(option))
            .map(|option| format!("`{line}`: no {option}"))
            .collect()
    }

    /// All commands, those below others too, such as `bench net`.
    pub fn all_verbs(&self) -> Vec<String> {
        let mut all = Vec::new();
        for verb in verbs(&self.help(&[])) {
            let page = self.help(&[verb]);
            match verbs(&page)[..] {
                [] => all.push(verb.to_owned()),
                ref below => all.extend(below.iter().map(|name| format!("{verb} {name}"))),
            }
        }
        all
    }
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
