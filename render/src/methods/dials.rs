//! What of a method's parameters can be set, read off their own types: a number that has a range, a switch,
//! or one of several names, is a [`Dial`], with the field's documentation for a text. [`Tuning`] is a quality
//! with some of its dials changed.

use super::Quality;
use deepshade_shaders::names::did_you_mean;
use schemars::JsonSchema;
use schemars::generate::SchemaSettings;
use serde::de::{DeserializeOwned, Error as _, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fmt::{Display, Formatter};

/// Parameters of a method that can be set number by number.
///
/// Fields with a `range` are dials, and so are switches and enumerations; fields that are none of these,
/// `#[schemars(skip)]`, stay as the quality has them.
pub trait Tunable: Serialize + DeserializeOwned + JsonSchema {}

impl<T: Serialize + DeserializeOwned + JsonSchema> Tunable for T {}

/// What values a dial takes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Values {
    /// Any.
    Real,
    /// Multiples of a number.
    Whole(u32),
    /// 0 or 1.
    Switch,
    /// One of these names; as a number, which of them.
    Named(Vec<String>),
}

/// What a dial is set to.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum DialValue {
    /// A number, or a switch.
    Number(f64),
    /// One of the names that it takes.
    Name(String),
}

impl From<f64> for DialValue {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

/// A number where it is one, or what a switch is, else a name.
impl From<&str> for DialValue {
    fn from(text: &str) -> Self {
        let switch = |on: bool| Self::Number(f64::from(u8::from(on)));
        let number = |_| text.parse::<f64>().map(Self::Number);
        text.parse::<bool>().map(switch).or_else(number).unwrap_or_else(|_| Self::Name(text.to_owned()))
    }
}

impl Display for DialValue {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Number(number) => number.fmt(f),
            Self::Name(name) => name.fmt(f),
        }
    }
}

/// A value of a method that can be set.
#[derive(Clone, Debug, PartialEq)]
pub struct Dial {
    /// Its name; of a part's number with the part's before it, `blur.radius`.
    pub name: String,
    /// What it is.
    pub text: String,
    /// What it is measured in; empty for counts and shares.
    pub unit: String,
    /// The least and the greatest that make sense.
    pub range: [f64; 2],
    /// Which of these it takes.
    pub values: Values,
    /// What it is in the quality asked for; of names, which of them.
    pub usual: f64,
}

/// A change that cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DialError {
    /// There is none of that name.
    #[error("no parameter `{name}`{}; there are: {known}", did_you_mean(name, known.split(", ")))]
    Unknown {
        /// The name.
        name: String,
        /// Those that there are.
        known: String,
    },
    /// A value that is none of its own.
    #[error("parameter `{name}`: {value} is not {wanted}")]
    Value {
        /// The parameter.
        name: String,
        /// What it was to be.
        value: DialValue,
        /// What it can be.
        wanted: String,
    },
    /// Its values do not fit together.
    #[error("parameters: {0}")]
    Parameters(String),
}

/// What of a method is not as its quality has it, by the names of dials.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[serde(transparent)]
pub struct Changes(pub BTreeMap<String, DialValue>);

/// How much time a method may take, and which of its dials are set by hand.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tuning {
    /// What is not changed is as it has it.
    pub quality: Quality,
    /// Those that are.
    pub changes: Changes,
}

impl Dial {
    /// A setting as a number.
    ///
    /// # Errors
    /// If it is out of range, between two numbers that make sense, or no name that the dial takes.
    pub fn number(&self, setting: &DialValue) -> Result<f64, DialError> {
        let named = |names: &[String], name: &String| names.iter().position(|known| known == name);
        let found = match (&self.values, setting) {
            (Values::Named(names), DialValue::Name(name)) => named(names, name).map(|at| at as f64),
            (Values::Named(_), DialValue::Number(_)) | (_, DialValue::Name(_)) => None,
            (_, DialValue::Number(value)) => Some(*value).filter(|value| self.takes(*value)),
        };
        let (name, value) = (self.name.clone(), setting.clone());
        found.ok_or_else(|| DialError::Value { name, value, wanted: self.wanted() })
    }

    /// A number as it is set.
    pub fn setting(&self, number: f64) -> DialValue {
        match &self.values {
            Values::Named(names) => {
                names.get(number as usize).cloned().map_or(number.into(), DialValue::Name)
            }
            _ => number.into(),
        }
    }

    fn takes(&self, value: f64) -> bool {
        let [least, most] = self.range;
        let is_whole = match self.values {
            Values::Real => true,
            Values::Whole(of) => (value / f64::from(of)).fract() == 0.0,
            Values::Switch | Values::Named(_) => value.fract() == 0.0,
        };
        (least..=most).contains(&value) && is_whole
    }

    /// What it takes, in words.
    pub fn wanted(&self) -> String {
        let [least, most] = self.range;
        match &self.values {
            Values::Real => format!("within {least} to {most}"),
            Values::Whole(1) => format!("a whole number from {least} to {most}"),
            Values::Whole(of) => format!("a multiple of {of} from {least} to {most}"),
            Values::Switch => "0 or 1".to_owned(),
            Values::Named(names) => format!("one of {}", names.join(", ")),
        }
    }

    /// A number as the parameters' type has it.
    fn json(&self, number: f64) -> Value {
        match &self.values {
            Values::Real => number.into(),
            Values::Whole(_) => (number as u64).into(),
            Values::Switch => (number == 1.0).into(),
            Values::Named(names) => names[number as usize].clone().into(),
        }
    }
}

impl Changes {
    /// Whether all is as the quality has it.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

/// `blur.radius 2, slices.steps 12`.
impl Display for Changes {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let all: Vec<String> = self.0.iter().map(|(name, value)| format!("{name} {value}")).collect();
        f.write_str(&all.join(", "))
    }
}

/// Numbers, switches and names; parts are tables, `slices.steps = 12`.
impl<'de> Deserialize<'de> for Changes {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Tables;
        impl<'de> Visitor<'de> for Tables {
            type Value = Changes;

            fn expecting(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
                f.write_str("a table of a method's parameters and their values")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Changes, A::Error> {
                let mut changes = BTreeMap::new();
                while let Some((name, value)) = map.next_entry::<String, Value>()? {
                    flatten(&name, &value, &mut changes).map_err(A::Error::custom)?;
                }
                Ok(Changes(changes))
            }
        }
        deserializer.deserialize_map(Tables)
    }
}

/// Adds a setting under its name, or a table's under theirs.
fn flatten(name: &str, value: &Value, changes: &mut BTreeMap<String, DialValue>) -> Result<(), String> {
    match value {
        Value::Object(table) => {
            table.iter().try_for_each(|(part, value)| flatten(&format!("{name}.{part}"), value, changes))
        }
        _ => {
            let number = value.as_f64().or(value.as_bool().map(|on| f64::from(u8::from(on))));
            let setting =
                number.map(DialValue::Number).or(value.as_str().map(|it| DialValue::Name(it.to_owned())));
            let setting =
                setting.ok_or_else(|| format!("`{name}` is {value}, which is no number or name"))?;
            changes.insert(name.to_owned(), setting);
            Ok(())
        }
    }
}

impl From<Quality> for Tuning {
    fn from(quality: Quality) -> Self {
        Self { quality, changes: Changes::default() }
    }
}

impl Tuning {
    /// A method's parameters, of which `of` has those of a quality.
    ///
    /// # Errors
    /// If a change is of no dial, or out of its range.
    pub fn parameters<T: Tunable>(&self, of: impl Fn(Quality) -> T) -> Result<T, DialError> {
        let usual = of(self.quality);
        if self.changes.is_empty() {
            return Ok(usual);
        }
        let unfit = |error: serde_json::Error| DialError::Parameters(error.to_string());
        let dials = dials(&usual);
        let mut value = serde_json::to_value(usual).map_err(unfit)?;
        for (name, to) in &self.changes.0 {
            let dial = dials.iter().find(|dial| dial.name == *name);
            let known = || dials.iter().map(|dial| dial.name.as_str()).collect::<Vec<_>>().join(", ");
            let dial = dial.ok_or_else(|| DialError::Unknown { name: name.clone(), known: known() })?;
            let to = dial.number(to)?;
            if let Some(place) = value.pointer_mut(&format!("/{}", name.replace('.', "/"))) {
                *place = dial.json(to);
            }
        }
        serde_json::from_value(value).map_err(unfit)
    }
}

/// The dials of parameters, by name.
pub fn dials<T: Tunable>(usual: &T) -> Vec<Dial> {
    let settings = SchemaSettings::default().with(|settings| settings.inline_subschemas = true);
    let schema = settings.into_generator().into_root_schema_for::<T>().to_value();
    let usual = serde_json::to_value(usual).unwrap_or_default();
    let mut dials = Vec::new();
    collect("", &schema, &usual, &mut dials);
    dials
}

/// Adds the dials of a table's fields.
fn collect(prefix: &str, schema: &Value, usual: &Value, dials: &mut Vec<Dial>) {
    for (field, schema) in schema["properties"].as_object().into_iter().flatten() {
        let (name, usual) = (format!("{prefix}{field}"), &usual[field]);
        if schema["properties"].is_object() {
            collect(&format!("{name}."), schema, usual, dials);
        } else {
            dials.extend(dial(name, schema, usual));
        }
    }
}

/// A field's dial, if it is a switch, an enumeration or a number with a range.
fn dial(name: String, schema: &Value, usual: &Value) -> Option<Dial> {
    let text = |key: &str| schema[key].as_str().unwrap_or_default().replace('\n', " ");
    if let Some(variants) = schema["oneOf"].as_array() {
        let names: Vec<String> = variants
            .iter()
            .map(|variant| Some(variant["const"].as_str()?.to_owned()))
            .collect::<Option<_>>()?;
        let usual = names.iter().position(|known| usual.as_str() == Some(known))? as f64;
        let range = [0.0, (names.len() - 1) as f64];
        let (text, unit) = (text("description"), text("unit"));
        return Some(Dial { name, text, unit, range, values: Values::Named(names), usual });
    }
    let (range, values, usual) = match schema["type"].as_str()? {
        "boolean" => ([0.0, 1.0], Values::Switch, f64::from(u8::from(usual.as_bool()?))),
        kind @ ("integer" | "number") => {
            let range = [schema["minimum"].as_f64()?, schema["maximum"].as_f64()?];
            let multiple = schema["multipleOf"].as_u64().map_or(1, |of| of as u32);
            let values = if kind == "integer" { Values::Whole(multiple) } else { Values::Real };
            (range, values, shortest(usual.as_f64()?))
        }
        _ => return None,
    };
    Some(Dial { name, text: text("description"), unit: text("unit"), range, values, usual })
}

/// The number that a 32-bit float was written as: 0.3, where its value is 0.30000001192.
fn shortest(value: f64) -> f64 {
    (value as f32).to_string().parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lpv::Scheme;
    use crate::methods::{fxaa, gtao, lpv, ray_march, volume_shell};

    fn changed(changes: &str) -> Tuning {
        let changes = serde_json::from_str(changes).expect("numbers by name");
        Tuning { quality: Quality::Low, changes }
    }

    #[test]
    fn numbers_have_their_fields_documentation_range_and_value() {
        let dials = dials(&gtao::GtaoParameters::of(Quality::Low));
        let names: Vec<&str> = dials.iter().map(|dial| dial.name.as_str()).collect();
        assert_eq!(
            names,
            ["blur.radius", "blur.sharpness", "slices.slices", "slices.steps", "slices.thickness"]
        );
        let radius = &dials[0];
        assert_eq!((&radius.values, radius.usual, radius.unit.as_str()), (&Values::Whole(1), 4.0, "pixels"));
        assert!(radius.text.starts_with("Pixels on either side"), "{}", radius.text);
        assert_eq!((&dials[4].values, dials[4].usual), (&Values::Real, 0.3));
    }

    #[test]
    fn what_is_changed_is_changed_and_all_else_is_the_qualitys() {
        let tuning = changed(r#"{ "slices": { "steps": 5 }, "blur.sharpness": 0.5 }"#);
        let parameters = tuning.parameters(gtao::GtaoParameters::of).expect("parameters");
        let mut usual = gtao::GtaoParameters::of(Quality::Low);
        assert_ne!(parameters, usual);
        usual.slices.steps = 5;
        usual.blur.sharpness = 0.5;
        assert_eq!(parameters, usual);
        let still = changed(r#"{ "jitter": false }"#)
            .parameters(ray_march::RayMarchParameters::of)
            .expect("a switch");
        assert_eq!(
            still,
            ray_march::RayMarchParameters {
                jitter: false,
                ..ray_march::RayMarchParameters::of(Quality::Low)
            }
        );
    }

    #[test]
    fn text_is_a_number_a_switch_or_a_name() {
        for (text, number) in [("0.5", 0.5), ("-3", -3.0), ("true", 1.0), ("false", 0.0)] {
            assert_eq!(DialValue::from(text), DialValue::Number(number), "{text}");
        }
        assert_eq!(DialValue::from("two-bands"), DialValue::Name("two-bands".to_owned()));
        let changes = Changes([("jitter".to_owned(), "false".into())].into());
        let still = Tuning { quality: Quality::Low, changes }
            .parameters(ray_march::RayMarchParameters::of)
            .expect("a switch");
        assert!(!still.jitter && ray_march::RayMarchParameters::of(Quality::Low).jitter);
    }

    #[test]
    fn without_changes_all_qualities_are_as_they_are_bit_for_bit() {
        for quality in Quality::ALL {
            // A change to what it is anyway goes the long way, by text and back.
            let steps = f64::from(volume_shell::VolumeShellParameters::of(quality).steps);
            let changes = Changes([("steps".to_owned(), steps.into())].into());
            let parameters = Tuning { quality, changes }
                .parameters(volume_shell::VolumeShellParameters::of)
                .expect("parameters");
            assert_eq!(parameters, volume_shell::VolumeShellParameters::of(quality));
            let parameters = Tuning::from(quality).parameters(fxaa::FxaaParameters::of).expect("parameters");
            assert_eq!(parameters, fxaa::FxaaParameters::of(quality));
        }
    }

    #[test]
    fn what_cannot_be_set_is_refused_by_name() {
        let refused = |changes: &str| {
            changed(changes).parameters(gtao::GtaoParameters::of).expect_err(changes).to_string()
        };
        let mistyped = refused(r#"{ "slices.stepz": 5 }"#);
        let said = "no parameter `slices.stepz` (did you mean `slices.steps`?); there are: blur";
        assert!(mistyped.starts_with(said), "{mistyped}");
        assert!(refused(r#"{ "quux": 5 }"#).starts_with("no parameter `quux`; there are: blur"));
        assert!(refused(r#"{ "blur.radius": 1.5 }"#).contains("1.5 is not a whole number from 0 to"));
        assert!(refused(r#"{ "blur.radius": -1 }"#).contains("`blur.radius`: -1 is not"));
        assert!(refused(r#"{ "slices.thickness": 1e9 }"#).contains("is not within"));
        let error = serde_json::from_str::<Changes>(r#"{ "a": { "b": [1] } }"#).expect_err("no number");
        assert!(error.to_string().contains("`a.b` is [1], which is no number or name"), "{error}");
        assert!(refused(r#"{ "blur.radius": "much" }"#).contains("much is not a whole number"));
    }

    #[test]
    fn one_of_several_ways_is_chosen_by_its_name() {
        let dials = dials(&lpv::LpvParameters::of(Quality::Low));
        let factors = dials.iter().find(|dial| dial.name == "scheme.factors").expect("a choice");
        let names = ["placed", "linear"].map(str::to_owned);
        assert_eq!((&factors.values, factors.usual), (&Values::Named(names.to_vec()), 0.0));
        assert!(factors.text.starts_with("How collisions with the medium"), "{}", factors.text);
        let papers = r#"{ "scheme": { "factors": "linear", "lobes": "two-bands", "lookup": "within" } }"#;
        let parameters = changed(papers).parameters(lpv::LpvParameters::of).expect("the paper's scheme");
        assert_eq!(
            parameters,
            lpv::LpvParameters { scheme: Scheme::PAPER, ..lpv::LpvParameters::of(Quality::Low) }
        );
        let refused = |changes: &str| {
            changed(changes).parameters(lpv::LpvParameters::of).expect_err(changes).to_string()
        };
        assert!(refused(r#"{ "scheme.factors": "cubic" }"#).ends_with("one of placed, linear"));
        assert!(refused(r#"{ "scheme.factors": 1 }"#).contains("1 is not one of"));
    }
}
