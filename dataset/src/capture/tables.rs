//! Text files of numbers, a line a record: lists of images, trajectories.

use super::CaptureError;
use std::path::Path;

/// A line's words.
pub struct Line<'a> {
    path: &'a Path,
    number: usize,
    words: Vec<&'a str>,
}

impl Line<'_> {
    /// The word of an index.
    ///
    /// # Errors
    /// If there are fewer.
    pub fn word(&self, index: usize) -> Result<&str, CaptureError> {
        let missing = || self.fault(&format!("has {} words, too few", self.words.len()));
        self.words.get(index).copied().ok_or_else(missing)
    }

    /// The word of an index as a finite number.
    ///
    /// # Errors
    /// If it is missing or no such number.
    pub fn number(&self, index: usize) -> Result<f64, CaptureError> {
        let word = self.word(index)?;
        let number = word.parse::<f64>().ok().filter(|number| number.is_finite());
        number.ok_or_else(|| self.fault(&format!("`{word}` is no finite number")))
    }

    /// So many numbers from an index on.
    ///
    /// # Errors
    /// As [`Line::number`].
    pub fn numbers<const N: usize>(&self, first: usize) -> Result<[f32; N], CaptureError> {
        let mut numbers = [0.0; N];
        for (index, number) in numbers.iter_mut().enumerate() {
            *number = self.number(first + index)? as f32;
        }
        Ok(numbers)
    }

    /// Says what is wrong with the line.
    pub fn fault(&self, what: &str) -> CaptureError {
        CaptureError::invalid(self.path, format!("line {}: {what}", self.number))
    }
}

/// The lines of a text that are neither empty nor comments (`#`).
pub fn lines<'a>(path: &'a Path, text: &'a str) -> Vec<Line<'a>> {
    let line = |(index, line): (usize, &'a str)| {
        let words: Vec<&str> = line.split_whitespace().collect();
        let says = words.first().is_some_and(|word| !word.starts_with('#'));
        says.then_some(Line { path, number: index + 1, words })
    };
    text.lines().enumerate().filter_map(line).collect()
}

/// The text of a file.
///
/// # Errors
/// If it cannot be read or is no text.
pub fn text(path: &Path) -> Result<String, CaptureError> {
    std::fs::read_to_string(path).map_err(|source| CaptureError::io(path, source))
}
