//! What the book promises of studies: its commands are theirs, and none is left out.

#[path = "../../tests/book/shown.rs"]
mod shown;

use shown::{Program, chapters, commands, row, text};
use std::collections::BTreeSet;

const PROGRAM: Program = Program { name: "deepshade-studies", path: env!("CARGO_BIN_EXE_deepshade-studies") };

#[test]
fn every_command_and_option_in_the_book_and_beside_it_is_the_studies() {
    let beside = ["README.md", "CONTRIBUTING.md"].map(|file| text(&format!("../../{file}")));
    let commands: BTreeSet<String> =
        chapters().values().chain(&beside).flat_map(|text| commands(text)).collect();
    assert!(commands.iter().filter(|line| line.starts_with("deepshade-studies ")).count() > 5);
    let faults: Vec<String> = commands.iter().flat_map(|line| PROGRAM.unknown(line)).collect();
    assert!(faults.is_empty(), "{faults:#?}");
}

#[test]
fn every_study_has_its_row_in_the_chapter_of_commands() {
    let chapter = text("commands.md");
    let verbs = PROGRAM.all_verbs();
    assert!(verbs.len() > 9, "{verbs:?}");
    let missing: Vec<&String> =
        verbs.iter().filter(|verb| row(&chapter, &format!("{} {verb}", PROGRAM.name)).is_none()).collect();
    assert!(missing.is_empty(), "{missing:?}");
}

#[test]
fn what_is_wrong_of_studies_in_a_book_is_found() {
    let chapter = "```sh\ndeepshade-studies paint\ndeepshade-studies lpv --colour red\n\
                   deepshade-studies lpv --full\n```\n";
    let faults: Vec<String> = commands(chapter).iter().flat_map(|line| PROGRAM.unknown(line)).collect();
    assert_eq!(faults.len(), 2, "{faults:?}");
    assert!(
        faults[0].contains("`deepshade-studies paint`") && faults[1].ends_with("no --colour"),
        "{faults:?}"
    );
}
