//! Statements of OBJ and MTL files: lines, a line that ends in `\` with the next one, and what in them is a
//! comment.

use std::borrow::Cow;

/// The statements of a text, each with the number of its first line, from 1.
pub(super) fn statements(text: &str) -> Statements<'_> {
    // Lines end as on Unix and Windows, or as on old Macintoshes.
    let ending = if text.contains('\n') { '\n' } else { '\r' };
    Statements { lines: text.split(ending), line: 0 }
}

/// A statement's keyword and what follows it, with its comment.
pub(super) fn parts(statement: &str) -> (&str, &str) {
    let (keyword, rest) = statement.split_once(char::is_whitespace).unwrap_or((statement, ""));
    (keyword, rest.trim_start())
}

/// Numbers without the comment behind them.
pub(super) fn operands(rest: &str) -> &str {
    rest.split('#').next().unwrap_or(rest).trim_end()
}

/// The most number signs of a name that are looked at.
const MOST_SIGNS: usize = 8;

/// What a name may be: the whole, as names may have a number sign (`Material #1`), or what stands before a
/// word that begins with one, the shortest last.
pub(super) fn readings(name: &str) -> impl Iterator<Item = &str> {
    let is_first = |at: &usize| name[..*at].chars().next_back().is_none_or(char::is_whitespace);
    let signs = name.rmatch_indices('#').map(|(at, _)| at).filter(is_first).take(MOST_SIGNS);
    std::iter::once(name.len()).chain(signs).map(|end| name[..end].trim_end())
}

/// Whether nothing stands behind a keyword, or a comment only.
pub(super) fn is_nameless(rest: &str) -> bool {
    let comment = rest.strip_prefix('#');
    rest.is_empty() || comment.is_some_and(|text| text.is_empty() || text.starts_with(char::is_whitespace))
}

/// Iterator over statements: number of the line, and text that neither begins nor ends in a space. Comments
/// behind a statement are in it.
pub(super) struct Statements<'a> {
    lines: std::str::Split<'a, char>,
    line: usize,
}

impl<'a> Statements<'a> {
    /// The next line, and whether it goes on in the one after it.
    fn next_line(&mut self) -> Option<(&'a str, bool)> {
        let line = self.lines.next()?;
        self.line += 1;
        // Files with a byte order mark may have been put one behind the other.
        let content = line.strip_prefix('\u{feff}').unwrap_or(line).trim();
        // A comment is not continued, whatever it ends in.
        let goes_on = content.strip_suffix('\\').filter(|_| !content.contains('#'));
        Some((goes_on.unwrap_or(content).trim_end(), goes_on.is_some()))
    }
}

impl<'a> Iterator for Statements<'a> {
    type Item = (usize, Cow<'a, str>);

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            let (content, mut goes_on) = self.next_line()?;
            let first = self.line;
            let mut statement = Cow::Borrowed(content);
            while goes_on {
                let Some((more, again)) = self.next_line() else { break };
                let joined = statement.to_mut();
                joined.push(' ');
                joined.push_str(more);
                goes_on = again;
            }
            if !statement.trim().is_empty() && !statement.starts_with('#') {
                return Some((first, statement));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Vec<(usize, String)> {
        statements(text).map(|(line, statement)| (line, statement.into_owned())).collect()
    }

    #[test]
    fn lines_end_in_three_ways_and_a_byte_order_mark_is_none_of_them() {
        for text in ["v 1\n\n f 2 \n", "v 1\r\n\r\n f 2 \r\n", "v 1\r\r f 2 \r", "\u{feff}v 1\n\n\u{feff}f 2"]
        {
            assert_eq!(of(text), [(1, "v 1".to_owned()), (3, "f 2".to_owned())], "{text:?}");
        }
    }

    #[test]
    fn comments_behind_numbers_begin_anywhere_and_those_behind_names_with_a_word() {
        assert_eq!(of("# a\nusemtl red # paint\n#\n\t# b"), [(2, "usemtl red # paint".to_owned())]);
        assert_eq!(["1 2 3#front", "1 2 3 # front", "1 2 3"].map(operands), ["1 2 3"; 3]);
        let of_name = |name| readings(name).collect::<Vec<_>>();
        assert_eq!(of_name("red#2 # paint"), ["red#2 # paint", "red#2"]);
        assert_eq!(of_name("a #1 # b"), ["a #1 # b", "a #1", "a"]);
        assert_eq!((of_name("#1"), of_name("a#1")), (vec!["#1", ""], vec!["a#1"]));
        assert_eq!(["", "#", "# paint", "#1", "red # a"].map(is_nameless), [true, true, true, false, false]);
    }

    #[test]
    fn lines_are_continued_and_comments_are_not() {
        assert_eq!(of("f 1 2 \\\n3\\ \n 4\nv 1"), [(1, "f 1 2 3 4".to_owned()), (4, "v 1".to_owned())]);
        let (first, second) = ((2, "v 1 # b \\".to_owned()), (3, "f 2".to_owned()));
        assert_eq!(of("# a \\\nv 1 # b \\\nf 2\\"), [first, second]);
    }

    #[test]
    fn keywords_end_at_any_space() {
        assert_eq!(parts("usemtl\t two words"), ("usemtl", "two words"));
        assert_eq!(parts("usemtl"), ("usemtl", ""));
    }
}
