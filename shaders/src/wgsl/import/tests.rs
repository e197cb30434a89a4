//! Made-up files.

use super::*;
use crate::wgsl::source_line::place;

fn joined(files: &'static [(&'static str, &'static str)], roots: &[&'static str]) -> Result<Product, String> {
    Product::joined(Library(files), roots)
}

fn error(files: &'static [(&'static str, &'static str)]) -> String {
    joined(files, &["a"]).expect_err("an error")
}

const FILES: &[(&str, &str)] = &[
    (
        "a",
        "// A pass.\n//\n// Of two lines.\n\n#import b\n#import c\n#constant SIZE = 3\n\n\
         fn a() {}\n\nfn aa() {}\n",
    ),
    ("b", "#import c\n#constant SIZE = 3\n#constant TURNS = 1\n\nfn b() {}"),
    ("c", "// Of a function.\n#constant SIZE = 3\nfn c() {}\n"),
    ("d", "// Nothing of its own.\n#import c\n"),
];

#[test]
fn each_file_comes_once_and_before_those_that_import_it() {
    let product = joined(FILES, &["a"]).expect("whole");
    let expected = "
//# c.wgsl:1
// Of a function.
//# c.wgsl:3
fn c() {}

//# b.wgsl:5
fn b() {}

//# a.wgsl:1
// A pass.
//
// Of two lines.

//# a.wgsl:9
fn a() {}

fn aa() {}
";
    assert_eq!(product.text, expected);
    let constants: Vec<_> = product.constants.iter().map(|c| (c.name, c.default, c.place.file)).collect();
    assert_eq!(constants, [("SIZE", 3, "c"), ("TURNS", 1, "b")]);
}

#[test]
fn files_that_are_given_together_share_what_they_import() {
    let product = joined(FILES, &["d", "b", "c"]).expect("whole");
    assert_eq!(product.files, ["c", "d", "b"]);
    assert_eq!(product.text.matches("fn c()").count(), 1);
}

#[test]
fn every_line_is_where_it_says_that_it_is() {
    let product = joined(FILES, &["a"]).expect("whole");
    let mut found = 0;
    for (line, said) in (1..).zip(product.text.lines()).filter(|(_, said)| said.starts_with("fn")) {
        let place = place(&product.text, line).expect("a file");
        let (_, text) = FILES.iter().find(|(name, _)| *name == place.file).expect("its text");
        assert_eq!(text.lines().nth(place.line - 1), Some(said));
        found += 1;
    }
    assert_eq!(found, 4);
}

#[test]
fn what_is_not_there_is_said_with_its_place() {
    assert_eq!(error(&[]), "no file `a`");
    assert_eq!(error(&[("a", "// A.\n#import shared/b\n")]), "shaders/wgsl/a.wgsl:2: no file `shared/b`");
    assert_eq!(error(&[("a", "#import b\n"), ("b", "\n#import c\n")]), "shaders/wgsl/b.wgsl:2: no file `c`");
}

#[test]
fn a_cycle_is_said_with_its_way() {
    let said = error(&[("a", "#import b\n"), ("b", "#import c\n"), ("c", "// C.\n#import b\n")]);
    assert_eq!(said, "shaders/wgsl/c.wgsl:2: `b` imports itself: a > b > c > b");
    assert_eq!(error(&[("a", "#import a\n")]), "shaders/wgsl/a.wgsl:1: `a` imports itself: a > a");
    assert!(joined(&[("a", "#import b\n#import c\n"), ("b", "#import c\n"), ("c", "")], &["a"]).is_ok());
}

#[test]
fn a_constant_is_the_same_wherever_it_is_stated() {
    let said = error(&[("a", "#import b\n\n#constant N = 2\n"), ("b", "// B.\n#constant N = 1\n")]);
    assert_eq!(said, "shaders/wgsl/a.wgsl:3: `N` is 2 here, and 1 at shaders/wgsl/b.wgsl:2");
    assert!(joined(&[("a", "#import b\n#constant N = 1\n"), ("b", "#constant N = 1\n")], &["a"]).is_ok());
}

#[test]
fn what_looks_like_a_directive_has_to_be_one() {
    for line in
        ["#improt b", "#import", "#import b c", "#template x", "#constant N", "#constant N = -1", " # x"]
    {
        let text: &'static str = format!("// A.\n\n{line}\n").leak();
        let said = error(Vec::from([("a", text), ("b", "")]).leak());
        assert_eq!(said, format!("shaders/wgsl/a.wgsl:3: `{line}` is no directive"));
    }
    let late = error(&[("a", "fn a() {}\n#import b\n"), ("b", "")]);
    assert_eq!(late, "shaders/wgsl/a.wgsl:2: a directive behind the file's first lines");
    assert!(joined(&[("a", "// A.\n\n// More.\n #import  b\nfn a() {}\n"), ("b", "")], &["a"]).is_ok());
}
