//! The list of all methods: those of `render`, and `learned`.

use crate::learned::Learned;
use anyhow::{Context, Result, bail};
use deepshade_infer::Model;
use deepshade_render::method::Method;
use deepshade_render::methods::hbao::{self, Hbao};
use deepshade_shaders::{Effect, gpu::Gpu};

/// The name of truth, which is no [`Method`]: it is rendered twice, and the others are measured against it.
pub const TRUTH: &str = "truth";

/// The name of the trained network's method.
pub const LEARNED: &str = "learned";

/// What methods are opened with.
#[derive(Clone, Copy)]
pub struct Setup<'a> {
    /// Where they run.
    pub gpu: &'a Gpu,
    /// The network of `learned`.
    pub model: Option<&'a Model>,
}

/// A method that can be asked for by name.
struct Entry {
    name: &'static str,
    effect: Effect,
    open: fn(Setup<'_>) -> Result<Box<dyn Method>>,
}

/// Every method; a new one is a line here.
const ALL: [Entry; 2] = [
    Entry { name: LEARNED, effect: Effect::Ao, open: open_learned },
    Entry {
        name: "hbao",
        effect: Effect::Ao,
        open: |setup| Ok(Box::new(Hbao::new(setup.gpu, hbao::Parameters::default())?)),
    },
];

/// Opens an effect's methods by name, in the order asked for; [`TRUTH`] is passed over.
///
/// # Errors
/// If there is no such method of this effect, or one cannot be opened; both are named.
pub fn open(effect: Effect, names: &[String], setup: Setup<'_>) -> Result<Vec<Box<dyn Method>>> {
    check(effect, names)?;
    let asked = |entry: &&Entry, name: &str| entry.effect == effect && entry.name == name;
    names
        .iter()
        .filter_map(|name| ALL.iter().find(|entry| asked(entry, name)))
        .map(|entry| (entry.open)(setup).with_context(|| format!("method `{}`", entry.name)))
        .collect()
}

/// Whether an effect has all of these methods, each named once.
///
/// # Errors
/// If one is unknown or named twice; what there is, is listed.
pub fn check(effect: Effect, names: &[String]) -> Result<()> {
    let known = names_of(effect);
    for (index, name) in names.iter().enumerate() {
        if !known.contains(&name.as_str()) {
            bail!("effect `{effect}` has no method `{name}`; there are {}", known.join(", "));
        }
        if names[..index].contains(name) {
            bail!("method `{name}` is asked for twice");
        }
    }
    Ok(())
}

/// Names of an effect's methods, and of truth.
pub fn names_of(effect: Effect) -> Vec<&'static str> {
    ALL.iter().filter(|entry| entry.effect == effect).map(|entry| entry.name).chain([TRUTH]).collect()
}

fn open_learned(setup: Setup<'_>) -> Result<Box<dyn Method>> {
    let model = setup.model.context("no model is given")?;
    Ok(Box::new(Learned::new(setup.gpu, model)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn checked(names: &[&str]) -> Result<(), String> {
        let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
        check(Effect::Ao, &names).map_err(|error| error.to_string())
    }

    #[test]
    fn methods_that_do_not_exist_are_named_with_those_that_do() {
        assert_eq!(checked(&["learned", "hbao", "truth"]), Ok(()));
        let error = checked(&["hbao", "gtao"]).expect_err("no such method");
        assert_eq!(error, "effect `ao` has no method `gtao`; there are learned, hbao, truth");
        assert!(checked(&["hbao", "hbao"]).expect_err("twice").contains("twice"));
    }

    #[test]
    fn figures_of_methods_cannot_collide() {
        let names = names_of(Effect::Ao);
        assert!(!names.contains(&"ceiling") && !names.contains(&"white"));
    }
}
