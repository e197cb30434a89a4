//! Where proofs are written down: one line of JSON for each comparison, in the file that the environment
//! variable `DEEPSHADE_PROOFS` names. `cargo xtask prove` reads it.

use std::fmt::Write as _;
use std::fs::OpenOptions;
use std::io::Write as _;

/// The variable that names the file.
const FILE: &str = "DEEPSHADE_PROOFS";

/// A measured value beside what it should be, or, for a control, beside what it must not be.
#[derive(Clone, Copy, Debug)]
pub struct Comparison<'a> {
    /// Of the proof; controls have the name of theirs. Without quotation marks.
    pub name: &'a str,
    pub value: f64,
    pub expected: f64,
    /// With a third of what rounding may add; `None` where the value is a probability or a ratio.
    pub standard_error: Option<f64>,
    /// Whether the value is what it is compared with.
    pub within: bool,
    /// Whether it must not be.
    pub control: bool,
}

impl Comparison<'_> {
    /// Writes it down where that is wanted, and asserts it.
    pub fn record_and_assert(&self) {
        if let Some(path) = std::env::var_os(FILE) {
            let file = OpenOptions::new().create(true).append(true).open(path);
            // One write a line, so that lines of tests that run at once do not mix.
            file.and_then(|mut file| file.write_all(self.line().as_bytes())).expect("a file for proofs");
        }
        assert!(self.within != self.control, "{self:?}");
    }

    fn line(&self) -> String {
        let Self { name, value, expected, standard_error, within, control } = self;
        let mut line = format!("{{\"name\": \"{name}\", \"value\": {value}, \"expected\": {expected}");
        if let Some(error) = standard_error {
            write!(line, ", \"standard_error\": {error}").expect("a string");
        }
        writeln!(line, ", \"within\": {within}, \"control\": {control}}}").expect("a string");
        line
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_comparison_is_a_line_of_json() {
        let proof = Comparison {
            name: "ao/disk",
            value: 0.25,
            expected: 0.5,
            standard_error: Some(0.125),
            within: true,
            control: false,
        };
        assert_eq!(
            proof.line(),
            "{\"name\": \"ao/disk\", \"value\": 0.25, \"expected\": 0.5, \"standard_error\": 0.125, \
             \"within\": true, \"control\": false}\n"
        );
        assert!(!Comparison { standard_error: None, ..proof }.line().contains("error"));
    }
}
