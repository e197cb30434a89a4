//! What of a file was passed over: one sentence for all lines of which the same is to be said.

use std::path::Path;

/// The most sentences about a file; a damaged one must not fill the memory with them.
const MOST: usize = 32;

/// Sentences about a file in the order in which they were said.
#[derive(Debug, Default)]
pub(super) struct Warnings {
    kinds: Vec<Kind>,
    /// Lines beyond the sentences that are kept.
    others: usize,
}

/// What is said of some lines.
#[derive(Debug)]
struct Kind {
    what: String,
    first: usize,
    /// Lines after the first.
    more: usize,
}

impl Warnings {
    /// Says something of a line.
    pub fn add(&mut self, line: usize, what: impl Into<String>) {
        let what = what.into();
        if let Some(kind) = self.kinds.iter_mut().find(|kind| kind.what == what) {
            kind.more += 1;
        } else if self.kinds.len() < MOST {
            self.kinds.push(Kind { what, first: line, more: 0 });
        } else {
            self.others += 1;
        }
    }

    /// Says something of a line that must not be lost among others.
    pub fn keep(&mut self, line: usize, what: String) {
        self.kinds.push(Kind { what, first: line, more: 0 });
    }

    /// The sentences, with the file that they are about.
    pub fn about(self, path: &Path) -> Vec<String> {
        let place = path.display();
        let sentence = |Kind { what, first, more }: Kind| match more {
            0 => format!("{place}: line {first}: {what}"),
            1 => format!("{place}: line {first} and another: {what}"),
            _ => format!("{place}: line {first} and {more} others: {what}"),
        };
        let others =
            (self.others > 0).then(|| format!("{place}: {} more lines are passed over", self.others));
        self.kinds.into_iter().map(sentence).chain(others).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_is_said_once_with_the_first_line() {
        let mut warnings = Warnings::default();
        for (line, what) in [(3, "odd"), (4, "strange"), (7, "odd"), (9, "odd")] {
            warnings.add(line, what);
        }
        let said = warnings.about(Path::new("a.obj"));
        assert_eq!(said, ["a.obj: line 3 and 2 others: odd", "a.obj: line 4: strange"]);
    }

    #[test]
    fn a_damaged_file_is_not_repeated_whole() {
        let mut warnings = Warnings::default();
        (1..100).for_each(|line| warnings.add(line, format!("odd {line}")));
        let said = warnings.about(Path::new("a.obj"));
        assert_eq!((said.len(), said[MOST].as_str()), (MOST + 1, "a.obj: 67 more lines are passed over"));
        let mut warnings = Warnings::default();
        (1..100).for_each(|line| warnings.add(line, format!("odd {line}")));
        warnings.keep(100, "missed".to_owned());
        assert_eq!(warnings.about(Path::new("a.obj"))[MOST], "a.obj: line 100: missed");
    }
}
