//! What of a method's parameters can be set, read off their own types: a number that has a range, or a switch, is a [`Dial`],
//! with the field's documentation for a text. [`Tuning`] is a quality with some of its numbers changed.

use super::Quality;
use schemars::JsonSchema;
use schemars::generate::SchemaSettings;
use serde::de::{DeserializeOwned, Error as _, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fmt::{Display, Formatter};

/// Parameters of a method that can be set number by number.
///
/// Fields with a `range` are dials, and so are switches; fields that are neither, `#[schemars(skip)]`, stay as the
/// quality has them.
pub trait Tunable: Serialize + DeserializeOwned + JsonSchema {
    /// Those of a quality.
    fn of_quality(quality: Quality) -> Self;
}

/// Makes parameters that have qualities tunable.
macro_rules! tunable {
    ($($parameters:path),+ $(,)?) => {
        $(impl Tunable for $parameters {
            fn of_quality(quality: Quality) -> Self {
                Self::of(quality)
            }
        })+
    };
}

tunable!(
    super::aov::bounced::Parameters,
    super::bounced_z::Parameters,
    super::epipolar::Parameters,
    super::epipolar_sampling::Parameters,
    super::fog_march::Parameters,
    super::froxel::Parameters,
    super::fxaa::Parameters,
    super::gather::Parameters,
    super::gpu_epipolar::Parameters,
    super::gtao::Parameters,
    super::hbao::Parameters,
    super::lpv::Parameters,
    super::min_max::Parameters,
    super::phosphor::Parameters,
    super::phosphor::glassner::Parameters,
    super::prefiltered::Parameters,
    super::ray_march::Parameters,
    super::reconstruction::Parameters,
    super::ring_gather::Parameters,
    super::separable::Parameters,
    super::ssdo::Parameters,
    super::ssgi::Parameters,
    super::surfel::Parameters,
    super::volume_shell::Parameters,
);

impl Tunable for super::aov::Volumes {
    fn of_quality(_: Quality) -> Self {
        Self
    }
}

/// What values a dial takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Values {
    /// Any.
    Real,
    /// Multiples of a number.
    Whole(u32),
    /// 0 or 1.
    Switch,
}

/// A number of a method that can be set.
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
    /// What it is in the quality asked for.
    pub usual: f64,
}

/// A change that cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DialError {
    /// There is none of that name.
    #[error("no parameter `{name}`; there are: {known}")]
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
        value: f64,
        /// What it can be.
        wanted: String,
    },
    /// Its values do not fit together.
    #[error("parameters: {0}")]
    Parameters(String),
}

/// Numbers of a method that are not as its quality has them, by the names of their dials.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[serde(transparent)]
pub struct Changes(pub BTreeMap<String, f64>);

/// How much time a method may take, and which of its numbers are set by hand.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tuning {
    /// What the numbers are that are not changed.
    pub quality: Quality,
    /// Those that are.
    pub changes: Changes,
}

impl Dial {
    /// Refuses a value that is out of range or between two that make sense.
    ///
    /// # Errors
    /// If it is.
    pub fn check(&self, value: f64) -> Result<(), DialError> {
        let [least, most] = self.range;
        let is_whole = match self.values {
            Values::Real => true,
            Values::Whole(of) => (value / f64::from(of)).fract() == 0.0,
            Values::Switch => value == 0.0 || value == 1.0,
        };
        if (least..=most).contains(&value) && is_whole {
            return Ok(());
        }
        Err(DialError::Value { name: self.name.clone(), value, wanted: self.wanted() })
    }

    /// What it takes, in words.
    pub fn wanted(&self) -> String {
        let [least, most] = self.range;
        match self.values {
            Values::Real => format!("within {least} to {most}"),
            Values::Whole(1) => format!("a whole number from {least} to {most}"),
            Values::Whole(of) => format!("a multiple of {of} from {least} to {most}"),
            Values::Switch => "0 or 1".to_owned(),
        }
    }

    /// A value as the parameters' type has it.
    fn json(&self, value: f64) -> Value {
        match self.values {
            Values::Real => value.into(),
            Values::Whole(_) => (value as u64).into(),
            Values::Switch => (value == 1.0).into(),
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

/// Numbers and switches by name; parts are tables, `slices.steps = 12`.
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

/// Adds a number under its name, or a table's under theirs.
fn flatten(name: &str, value: &Value, changes: &mut BTreeMap<String, f64>) -> Result<(), String> {
    match value {
        Value::Object(table) => {
            table.iter().try_for_each(|(part, value)| flatten(&format!("{name}.{part}"), value, changes))
        }
        Value::Bool(on) => {
            changes.insert(name.to_owned(), f64::from(u8::from(*on)));
            Ok(())
        }
        _ => {
            let number = value.as_f64().ok_or_else(|| format!("`{name}` is {value}, which is no number"))?;
            changes.insert(name.to_owned(), number);
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
    /// A method's parameters.
    ///
    /// # Errors
    /// If a change is of no dial, or out of its range.
    pub fn parameters<T: Tunable>(&self) -> Result<T, DialError> {
        let usual = T::of_quality(self.quality);
        if self.changes.is_empty() {
            return Ok(usual);
        }
        let unfit = |error: serde_json::Error| DialError::Parameters(error.to_string());
        let dials = dials::<T>(self.quality);
        let mut value = serde_json::to_value(usual).map_err(unfit)?;
        for (name, to) in &self.changes.0 {
            let dial = dials.iter().find(|dial| dial.name == *name);
            let known = || dials.iter().map(|dial| dial.name.as_str()).collect::<Vec<_>>().join(", ");
            let dial = dial.ok_or_else(|| DialError::Unknown { name: name.clone(), known: known() })?;
            dial.check(*to)?;
            if let Some(place) = value.pointer_mut(&format!("/{}", name.replace('.', "/"))) {
                *place = dial.json(*to);
            }
        }
        serde_json::from_value(value).map_err(unfit)
    }
}

/// The dials of parameters in a quality, by name.
pub fn dials<T: Tunable>(quality: Quality) -> Vec<Dial> {
    let settings = SchemaSettings::default().with(|settings| settings.inline_subschemas = true);
    let schema = settings.into_generator().into_root_schema_for::<T>().to_value();
    let usual = serde_json::to_value(T::of_quality(quality)).unwrap_or_default();
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

/// A field's dial, if it is a switch or a number with a range.
fn dial(name: String, schema: &Value, usual: &Value) -> Option<Dial> {
    let text = |key: &str| schema[key].as_str().unwrap_or_default().replace('\n', " ");
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
    use crate::methods::{fxaa, gtao, ray_march, volume_shell};

    fn changed(changes: &str) -> Tuning {
        let changes = serde_json::from_str(changes).expect("numbers by name");
        Tuning { quality: Quality::Low, changes }
    }

    #[test]
    fn numbers_have_their_fields_documentation_range_and_value() {
        let dials = dials::<gtao::Parameters>(Quality::Low);
        let names: Vec<&str> = dials.iter().map(|dial| dial.name.as_str()).collect();
        assert_eq!(
            names,
            ["blur.radius", "blur.sharpness", "slices.slices", "slices.steps", "slices.thickness"]
        );
        let radius = &dials[0];
        assert_eq!((radius.values, radius.usual, radius.unit.as_str()), (Values::Whole(1), 4.0, "pixels"));
        assert!(radius.text.starts_with("Pixels on either side"), "{}", radius.text);
        assert_eq!((dials[4].values, dials[4].usual), (Values::Real, 0.3));
    }

    #[test]
    fn what_is_changed_is_changed_and_all_else_is_the_qualitys() {
        let tuning = changed(r#"{ "slices": { "steps": 5 }, "blur.sharpness": 0.5 }"#);
        let parameters: gtao::Parameters = tuning.parameters().expect("parameters");
        let mut usual = gtao::Parameters::of(Quality::Low);
        assert_ne!(parameters, usual);
        usual.slices.steps = 5;
        usual.blur.sharpness = 0.5;
        assert_eq!(parameters, usual);
        let still: ray_march::Parameters = changed(r#"{ "jitter": false }"#).parameters().expect("a switch");
        assert_eq!(still, ray_march::Parameters { jitter: false, ..ray_march::Parameters::of(Quality::Low) });
    }

    #[test]
    fn without_changes_all_qualities_are_as_they_are_bit_for_bit() {
        for quality in Quality::ALL {
            // A change to what it is anyway goes the long way, by text and back.
            let steps = f64::from(volume_shell::Parameters::of(quality).steps);
            let changes = Changes([("steps".to_owned(), steps)].into());
            let parameters: volume_shell::Parameters =
                Tuning { quality, changes }.parameters().expect("parameters");
            assert_eq!(parameters, volume_shell::Parameters::of(quality));
            let parameters: fxaa::Parameters = Tuning::from(quality).parameters().expect("parameters");
            assert_eq!(parameters, fxaa::Parameters::of(quality));
        }
    }

    #[test]
    fn what_cannot_be_set_is_refused_by_name() {
        let refused =
            |changes: &str| changed(changes).parameters::<gtao::Parameters>().expect_err(changes).to_string();
        assert!(
            refused(r#"{ "slices.stepz": 5 }"#).starts_with("no parameter `slices.stepz`; there are: blur")
        );
        assert!(refused(r#"{ "blur.radius": 1.5 }"#).contains("1.5 is not a whole number from 0 to"));
        assert!(refused(r#"{ "blur.radius": -1 }"#).contains("`blur.radius`: -1 is not"));
        assert!(refused(r#"{ "slices.thickness": 1e9 }"#).contains("is not within"));
        let error = serde_json::from_str::<Changes>(r#"{ "a": { "b": "much" } }"#).expect_err("no number");
        assert!(error.to_string().contains("`a.b` is \"much\", which is no number"), "{error}");
    }
}
