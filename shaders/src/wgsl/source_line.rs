//! Where lines of a shader come from. A source that was put together says it itself, in comments: whoever
//! has its text, a compiler's message about a line of it can be told as one about a line of a file.

use std::fmt;

/// What such a comment begins with. No file has one.
const MARK: &str = "//# ";

/// A line of a file of `shaders/wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct SourceLine<'a> {
    /// The file, as others import it.
    pub file: &'a str,
    /// Counted from 1.
    pub line: usize,
}

impl fmt::Display for SourceLine<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "shaders/wgsl/{}.wgsl:{}", self.file, self.line)
    }
}

impl SourceLine<'_> {
    /// The line of a product that says that the next one, and those after it, are from here on.
    pub(super) fn mark(&self) -> String {
        format!("{MARK}{}.wgsl:{}\n", self.file, self.line)
    }
}

/// Where a line of a product, counted from 1, is from; `None` where it is of no file but was generated.
pub(super) fn place(product: &str, line: usize) -> Option<SourceLine<'_>> {
    let before = product.lines().take(line.checked_sub(1)?);
    let (at, mark) =
        before.enumerate().filter_map(|(at, text)| Some((at, text.strip_prefix(MARK)?))).last()?;
    let (file, first) = mark.rsplit_once(".wgsl:")?;
    // The mark is line `at + 1`.
    Some(SourceLine { file, line: first.parse::<usize>().ok()? + line - (at + 2) })
}

/// The files that are in a product.
#[cfg(test)]
pub(super) fn files(product: &str) -> impl Iterator<Item = &str> {
    let marks = product.lines().filter_map(|line| line.strip_prefix(MARK));
    marks.filter_map(|mark| mark.rsplit_once(".wgsl:")).map(|(file, _)| file)
}

/// A compiler's message about a product, with the places of the lines that it names.
pub(crate) fn located(message: &str, product: &str) -> String {
    let located = |said: &str| match line_of(said).and_then(|line| place(product, line)) {
        Some(place) => format!("{said}, {place}"),
        None => said.to_owned(),
    };
    message.lines().map(located).collect::<Vec<_>>().join("\n")
}

/// The line that naga points at, if this is where it does: `┌─ wgsl:12:5`.
fn line_of(said: &str) -> Option<usize> {
    let (_, position) = said.split_once("─ wgsl:")?;
    position.split(':').next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    const PRODUCT: &str = "\
const TILE = 8u;

//# a/b.wgsl:1
first
//# a/b.wgsl:7
seventh
eighth

//# c.wgsl:2
x
";

    #[test]
    fn lines_are_found_in_their_files() {
        let found: Vec<_> =
            (0..=10).map(|line| place(PRODUCT, line).map(|place| (place.file, place.line))).collect();
        let (b, c) = (|line| Some(("a/b", line)), Some(("c", 2)));
        // Marks themselves, and empty lines before them, count as what is before them.
        let expected = [None, None, None, None, b(1), b(2), b(7), b(8), b(9), b(10), c];
        assert_eq!(found, expected);
    }

    #[test]
    fn only_what_points_into_the_product_is_located() {
        let message = "error: no\n  ┌─ wgsl:7:3\n  │\n7 │ wgsl:7:3\n  ┌─ wgsl:1:1\n  ┌─ wgsl:x";
        let expected = message.replacen("wgsl:7:3", "wgsl:7:3, shaders/wgsl/a/b.wgsl:8", 1);
        assert_eq!(located(message, PRODUCT), expected);
    }
}
