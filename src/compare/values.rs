//! Values of a comparison's TOML file that may be written in two ways, the short one for what is wanted most
//! often. Read by visitors of their own: of an untagged enum serde says no more than that nothing fits.

use crate::location::Location;
use crate::views::{Choice, Viewpoint};
use deepshade_render::methods::Quality;
use deepshade_render::methods::dials::Changes;
use glam::Vec3;
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{Error, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt::{Formatter, Result as Written};

/// A method that takes part: `"hbao"`, or `{ name = "hbao", qualities = ["low", "ultra"] }`, or
/// `{ name = "gtao", parameters = { slices.thickness = 0.5 } }`, or
/// `{ name = "learned", model = "runs/ao" }`.
#[derive(Clone, Debug, PartialEq)]
pub struct MethodChoice {
    /// Its name.
    pub name: String,
    /// In which qualities; without them in those of the run.
    pub qualities: Option<Vec<Quality>>,
    /// Folder or address of its network, if it is one; without it that of the run.
    pub model: Option<Location>,
    /// Those of its parameters that are not as its quality has them.
    pub parameters: Changes,
}

/// A method as a table.
#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct MethodTable {
    name: String,
    qualities: Option<Vec<Quality>>,
    model: Option<Location>,
    #[serde(default, skip_serializing_if = "Changes::is_empty")]
    parameters: Changes,
}

/// A number for each colour: `0.5`, or `[0.5, 0.4, 0.3]`; none is negative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Colour(pub Vec3);

impl MethodChoice {
    /// A method in the run's qualities.
    pub fn named(name: impl Into<String>) -> Self {
        Self { name: name.into(), qualities: None, model: None, parameters: Changes::default() }
    }
}

impl<'de> Deserialize<'de> for MethodChoice {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Either;
        impl<'de> Visitor<'de> for Either {
            type Value = MethodChoice;

            fn expecting(&self, f: &mut Formatter<'_>) -> Written {
                f.write_str("a method's name, or a table of `name`, `qualities`, `model` and `parameters`")
            }

            fn visit_str<E: Error>(self, name: &str) -> Result<MethodChoice, E> {
                Ok(MethodChoice::named(name))
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<MethodChoice, A::Error> {
                let MethodTable { name, qualities, model, parameters } =
                    MethodTable::deserialize(MapAccessDeserializer::new(map))?;
                Ok(MethodChoice { name, qualities, model, parameters })
            }
        }
        deserializer.deserialize_any(Either)
    }
}

impl Serialize for MethodChoice {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Self { name, qualities, model, parameters } = self.clone();
        if qualities.is_none() && model.is_none() && parameters.is_empty() {
            return name.serialize(serializer);
        }
        MethodTable { name, qualities, model, parameters }.serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Colour {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Either;
        impl<'de> Visitor<'de> for Either {
            type Value = Vec3;

            fn expecting(&self, f: &mut Formatter<'_>) -> Written {
                f.write_str("a number, or those of red, green and blue")
            }

            fn visit_f64<E: Error>(self, value: f64) -> Result<Vec3, E> {
                Ok(Vec3::splat(value as f32))
            }

            fn visit_i64<E: Error>(self, value: i64) -> Result<Vec3, E> {
                self.visit_f64(value as f64)
            }

            fn visit_seq<A: SeqAccess<'de>>(self, values: A) -> Result<Vec3, A::Error> {
                <[f32; 3]>::deserialize(SeqAccessDeserializer::new(values)).map(Vec3::from)
            }
        }
        let value = deserializer.deserialize_any(Either)?;
        if value.is_finite() && value.min_element() >= 0.0 {
            Ok(Self(value))
        } else {
            Err(D::Error::custom(format!("{value} is negative or not finite")))
        }
    }
}

impl Serialize for Colour {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Vec3 { x, y, z } = self.0;
        if x == y && y == z { x.serialize(serializer) } else { [x, y, z].serialize(serializer) }
    }
}

/// A number of sampled views, or a list of views.
impl<'de> Deserialize<'de> for Choice {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Either;
        impl<'de> Visitor<'de> for Either {
            type Value = Choice;

            fn expecting(&self, f: &mut Formatter<'_>) -> Written {
                f.write_str("a number of sampled views from 1 to 1000, or a list of views")
            }

            fn visit_i64<E: Error>(self, count: i64) -> Result<Choice, E> {
                let fits = usize::try_from(count).ok().filter(|count| (1..=1000).contains(count));
                fits.map(Choice::Sampled).ok_or_else(|| E::custom(format!("{count} is not within 1 to 1000")))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, views: A) -> Result<Choice, A::Error> {
                Vec::<Viewpoint>::deserialize(SeqAccessDeserializer::new(views)).map(Choice::Stated)
            }
        }
        deserializer.deserialize_any(Either)
    }
}

impl Serialize for Choice {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Sampled(count) => count.serialize(serializer),
            Self::Stated(views) => views.serialize(serializer),
        }
    }
}
