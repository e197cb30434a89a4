//! The steps of a container file, as far as they change a file system.

use anyhow::{Context, Result, bail};

/// A step.
#[derive(Debug, PartialEq, Eq)]
pub enum Instruction {
    /// A line for the shell.
    Run(String),
    /// From a path of the first stage to one of this.
    Copy(String, String),
}

/// The steps of the last stage.
///
/// # Errors
/// If there is an instruction that is not known here.
pub fn last_stage(text: &str) -> Result<Vec<Instruction>> {
    let mut steps = Vec::new();
    for line in joined(text) {
        let (word, rest) = line.split_once(' ').unwrap_or((&line, ""));
        let words: Vec<&str> = rest.split_whitespace().collect();
        match (word, words.as_slice()) {
            ("FROM", _) => steps.clear(),
            ("RUN", _) => steps.push(Instruction::Run(rest.to_owned())),
            ("COPY", ["--from=build", from, to]) => {
                steps.push(Instruction::Copy((*from).to_owned(), (*to).to_owned()));
            }
            ("COPY", [_, _]) | ("USER" | "ENV" | "WORKDIR" | "ENTRYPOINT" | "CMD", _) => {}
            _ => bail!("what `{line}` does is not known here"),
        }
    }
    Ok(steps)
}

/// The arguments of cargo by which the program is built there.
///
/// # Errors
/// If no step builds it by cargo alone.
pub fn build(text: &str) -> Result<Vec<String>> {
    let mut lines = joined(text).into_iter();
    let line = lines.find_map(|line| line.strip_prefix("RUN cargo ").map(str::to_owned));
    let words = line.context("no step of the container file runs cargo")?;
    Ok(words.split_whitespace().map(str::to_owned).collect())
}

/// Lines without comments, those that end with `\` joined with the next.
fn joined(text: &str) -> Vec<String> {
    let mut lines = Vec::new();
    let mut open = String::new();
    for line in text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#')) {
        match line.strip_suffix('\\') {
            Some(begun) => open.push_str(begun),
            None => lines.push(std::mem::take(&mut open) + line),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_those_of_the_last_stage() {
        let text = "FROM a AS build\nRUN make\n# a word\nFROM b\nRUN one \\\n    && two\nCOPY --from=build /src/x /y\nUSER z";
        let steps = last_stage(text).expect("steps");
        let expected = [
            Instruction::Run("one && two".to_owned()),
            Instruction::Copy("/src/x".to_owned(), "/y".to_owned()),
        ];
        assert_eq!(steps, expected);
        assert!(last_stage("FROM b\nVOLUME /x").is_err());
        assert!(build(text).is_err());
        let built =
            build("FROM a AS build\nRUN cargo build \\\n  --features x\nFROM b").expect("a step of cargo's");
        assert_eq!(built, ["build", "--features", "x"]);
    }
}
