//! `deepshade methods`: which methods there are, and what of each can be set.

use crate::methods::{self, LEARNED, TRUTH};
use crate::table;
use anyhow::Result;
use deepshade_render::methods::Quality;
use deepshade_render::methods::dials::Dial;
use deepshade_shaders::Effect;

/// Lists methods, or the parameters of one.
#[derive(clap::Args)]
#[command(after_help = "Examples:\n  deepshade methods\n  deepshade methods --effect gi\n  \
    deepshade methods --effect ao --method gtao --quality low\n\n\
    What is listed for a method can be set in a comparison's file,\n  \
    methods = [{ name = \"gtao\", parameters = { slices.thickness = 0.5 } }]\n\
    and with sliders in `deepshade view`.")]
pub struct Args {
    /// Of which effect; by default of all.
    #[arg(long)]
    effect: Option<Effect>,
    /// The method whose parameters are listed.
    #[arg(long, requires = "effect")]
    method: Option<String>,
    /// The quality whose values are listed.
    #[arg(long, default_value = "high", requires = "method")]
    quality: Quality,
}

/// Prints the list.
pub fn run(args: &Args) -> Result<()> {
    let text = match (args.effect, &args.method) {
        (Some(effect), Some(method)) => parameters(method, &methods::dials(effect, method, args.quality)?),
        (effect, _) => list(effect)?,
    };
    say!("{text}")
}

/// A line for every method of an effect, or of all.
fn list(of: Option<Effect>) -> Result<String> {
    let mut rows = vec![["effect", "method", "parameters"].map(str::to_owned).to_vec()];
    for effect in Effect::ALL.into_iter().filter(|effect| of.is_none_or(|of| of == *effect)) {
        for method in methods::names_of(effect).into_iter().filter(|name| *name != TRUTH) {
            let dials = methods::dials(effect, method, Quality::default())?;
            let names: Vec<String> = dials.into_iter().map(|dial| dial.name).collect();
            let names = if method == LEARNED { "those of its network".to_owned() } else { names.join(", ") };
            rows.push(vec![effect.to_string(), method.to_owned(), names]);
        }
    }
    Ok(table::aligned(&rows))
}

/// A line for every parameter.
fn parameters(method: &str, dials: &[Dial]) -> String {
    if dials.is_empty() {
        return format!("`{method}` has nothing to set");
    }
    let mut rows = vec![["parameter", "value", "takes", "what it is"].map(str::to_owned).to_vec()];
    rows.extend(dials.iter().map(|dial| {
        let unit = if dial.unit.is_empty() { String::new() } else { format!(" {}", dial.unit) };
        vec![
            dial.name.clone(),
            format!("{}{unit}", dial.setting(dial.usual)),
            dial.wanted(),
            dial.text.clone(),
        ]
    }));
    table::aligned(&rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_method_has_its_line_and_every_parameter_what_it_takes() {
        let all = list(None).expect("a list");
        assert!(
            all.lines().any(|line| line.split_whitespace().take(2).eq(["fog-direct", "epipolar"])),
            "{all}"
        );
        let dials = methods::dials(Effect::Ao, "gtao", Quality::Low).expect("a method");
        let text = parameters("gtao", &dials);
        assert!(text.contains("4 pixels") && text.contains("a whole number from 0 to 32"), "{text}");
        assert_eq!(text.lines().count(), 1 + dials.len());
    }
}
