//! Statements of OBJ and MTL files: lines without comments, a line that ends in `\` with the next one.

use std::borrow::Cow;

/// The statements of a text, each with the number of its first line, from 1.
pub(super) fn statements(text: &str) -> Statements<'_> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    // Lines end as on Unix and Windows, or as on old Macintoshes.
    let ending = if text.contains('\n') { '\n' } else { '\r' };
    Statements { lines: text.split(ending), line: 0 }
}

/// A statement's keyword and what follows it.
pub(super) fn parts(statement: &str) -> (&str, &str) {
    let (keyword, rest) = statement.split_once(char::is_whitespace).unwrap_or((statement, ""));
    (keyword, rest.trim_start())
}

/// Iterator over statements: number of the line, and text that neither begins nor ends in a space.
pub(super) struct Statements<'a> {
    lines: std::str::Split<'a, char>,
    line: usize,
}

impl<'a> Statements<'a> {
    /// The next line without its comment, and whether it goes on in the one after it.
    fn next_line(&mut self) -> Option<(&'a str, bool)> {
        let line = self.lines.next()?;
        self.line += 1;
        let content = without_comment(line);
        // A comment is not continued, whatever it ends in.
        let goes_on = if content.len() == line.len() { content.trim_end().strip_suffix('\\') } else { None };
        Some((goes_on.unwrap_or(content).trim(), goes_on.is_some()))
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
            if !statement.trim().is_empty() {
                return Some((first, statement));
            }
        }
    }
}

/// A line up to the `#` with which a word begins: names may have one within.
fn without_comment(line: &str) -> &str {
    let begins = |at: &usize| line[..*at].chars().next_back().is_none_or(char::is_whitespace);
    line.match_indices('#').map(|(at, _)| at).find(begins).map_or(line, |at| &line[..at])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Vec<(usize, String)> {
        statements(text).map(|(line, statement)| (line, statement.into_owned())).collect()
    }

    #[test]
    fn lines_end_in_three_ways_and_a_byte_order_mark_is_none_of_them() {
        for text in ["v 1\n\n f 2 \n", "v 1\r\n\r\n f 2 \r\n", "v 1\r\r f 2 \r", "\u{feff}v 1\n\nf 2"] {
            assert_eq!(of(text), [(1, "v 1".to_owned()), (3, "f 2".to_owned())], "{text:?}");
        }
    }

    #[test]
    fn comments_stand_alone_or_behind_a_space() {
        assert_eq!(of("# a\nusemtl red#2 # paint\n#\n\t# b"), [(2, "usemtl red#2".to_owned())]);
    }

    #[test]
    fn lines_are_continued_and_comments_are_not() {
        assert_eq!(of("f 1 2 \\\n3\\ \n 4\nv 1"), [(1, "f 1 2 3 4".to_owned()), (4, "v 1".to_owned())]);
        assert_eq!(of("# a \\\nv 1 # b \\\nf 2\\"), [(2, "v 1".to_owned()), (3, "f 2".to_owned())]);
    }

    #[test]
    fn keywords_end_at_any_space() {
        assert_eq!(parts("usemtl\t two words"), ("usemtl", "two words"));
        assert_eq!(parts("usemtl"), ("usemtl", ""));
    }
}
