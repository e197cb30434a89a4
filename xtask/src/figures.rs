//! What a command found out, as a JSON file of the form that the program's own have: `{"command", "machine", "figures",
//! "details"}`. By hand, since nothing that this is built from writes JSON.

use anyhow::{Context, Result, bail};
use std::path::{Path, PathBuf};

/// The file of `--json F`, and the arguments that are left.
///
/// # Errors
/// If `--json` is the last argument.
pub fn json_argument(args: &[String]) -> Result<(Option<PathBuf>, Vec<String>)> {
    let mut rest = args.to_vec();
    let Some(place) = rest.iter().position(|arg| arg == "--json") else { return Ok((None, rest)) };
    if place + 1 == rest.len() {
        bail!("--json wants a file");
    }
    let path = rest.drain(place..place + 2).next_back();
    Ok((path.map(PathBuf::from), rest))
}

/// The file's text: figures, and lists of texts that explain them.
pub fn to_json(command: &str, figures: &[(String, f64)], details: &[(&str, Vec<String>)]) -> String {
    let figures: Vec<String> =
        figures.iter().map(|(name, value)| format!("    {}: {value}", quoted(name))).collect();
    let details: Vec<String> = details
        .iter()
        .map(|(name, texts)| {
            let texts: Vec<String> = texts.iter().map(|text| format!("      {}", quoted(text))).collect();
            format!("    {}: [\n{}\n    ]", quoted(name), texts.join(",\n"))
        })
        .collect();
    format!(
        "{{\n  \"command\": {},\n  \"machine\": {},\n  \"figures\": {{\n{}\n  }},\n  \"details\": {{\n{}\n  }}\n}}\n",
        quoted(command),
        machine(),
        figures.join(",\n"),
        details.join(",\n")
    )
}

/// A text as JSON has it.
fn quoted(text: &str) -> String {
    let escaped = text.chars().map(|character| match character {
        '"' | '\\' => format!("\\{character}"),
        control if control.is_control() => format!("\\u{:04x}", u32::from(control)),
        plain => plain.to_string(),
    });
    format!("\"{}\"", escaped.collect::<String>())
}

/// A figure of a JSON file of the program's.
///
/// # Errors
/// If it has none of that name.
pub fn figure(json: &str, name: &str) -> Result<f64> {
    let (_, rest) =
        json.split_once(&format!("\"{name}\": ")).with_context(|| format!("no figure `{name}`"))?;
    let number: String = rest.chars().take_while(|c| c.is_ascii_digit() || ".-e".contains(*c)).collect();
    number.parse().with_context(|| format!("figure `{name}`"))
}

/// The machine that figures are from, as the program says it.
pub fn machine() -> String {
    let cpuinfo = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = cpuinfo.lines().find(|line| line.starts_with("model name"));
    let processor = match name.and_then(|line| line.split_once(':')) {
        Some((_, name)) => quoted(name.trim()),
        None => "null".to_owned(),
    };
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let (os, architecture) = (std::env::consts::OS, std::env::consts::ARCH);
    let version = env!("CARGO_PKG_VERSION");
    format!(
        "{{ \"os\": \"{os}\", \"architecture\": \"{architecture}\", \"processor\": {processor}, \"threads\": {threads}, \
         \"version\": \"{version}\" }}"
    )
}

/// Writes a file, whole or not at all, and its folder where that is missing.
///
/// # Errors
/// If it cannot be written.
pub fn write(path: &Path, text: &str) -> Result<()> {
    let path = std::path::absolute(path)?;
    let folder = path.parent().context("a file's path")?;
    std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    let partial = folder.join(format!(".deepshade-{}", std::process::id()));
    let written = std::fs::write(&partial, text).and_then(|()| std::fs::rename(&partial, &path));
    written.with_context(|| path.display().to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_file_is_taken_from_among_the_arguments() {
        let args: Vec<String> = ["--kills", "3", "--json", "f", "x"].map(str::to_owned).to_vec();
        let (json, rest) = json_argument(&args).expect("arguments");
        assert_eq!((json, rest.join(" ")), (Some("f".into()), "--kills 3 x".to_owned()));
        assert!(json_argument(&args[..3]).is_err());
    }

    #[test]
    fn texts_are_escaped() {
        let json = to_json("x", &[("kills".to_owned(), 2.0)], &[("said", vec!["a \"b\"\n".to_owned()])]);
        assert!(json.contains("    \"kills\": 2\n") && json.contains("\"a \\\"b\\\"\\u000a\""), "{json}");
    }
}
