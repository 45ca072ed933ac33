//! Keys that take values of more than one kind. By hand, because what serde derives for "one of two"
//! loses the lines of what is inside.

use std::fmt;

use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer};
use serde::de::{self, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};

use super::{BandTable, LabelTable};

/// A number with or without decimals.
#[derive(Debug, Clone, Copy)]
pub enum Number {
    /// Without.
    Integer(i64),
    /// With; its shortest form is what was written.
    Float(f64),
}

/// What raw numbers are multiplied with.
#[derive(Debug)]
pub enum ScaleKey {
    /// A number.
    Number(Number),
    /// The name of a factor.
    Factor(String),
    /// One number or another, by where the raw number lies.
    Bands(Vec<BandTable>),
}

/// A number, or the name of a factor or a point, with `-` before it for its negative.
#[derive(Debug)]
pub enum OperandKey {
    /// A number.
    Number(Number),
    /// A name.
    Name(String),
}

/// The name of a shared table, or the table itself.
#[derive(Debug)]
pub enum LabelsKey {
    /// A table of `[labels]`.
    Shared(String),
    /// A table in place.
    Own(LabelTable),
}

impl<'de> Deserialize<'de> for Number {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Either;

        impl Visitor<'_> for Either {
            type Value = Number;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number")
            }

            fn visit_i64<E: de::Error>(self, number: i64) -> Result<Number, E> {
                Ok(Number::Integer(number))
            }

            fn visit_f64<E: de::Error>(self, number: f64) -> Result<Number, E> {
                Ok(Number::Float(number))
            }
        }

        deserializer.deserialize_any(Either)
    }
}

impl<'de> Deserialize<'de> for ScaleKey {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Either;

        impl<'de> Visitor<'de> for Either {
            type Value = ScaleKey;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number, the name of a factor, or a list of { raw, factor }")
            }

            fn visit_i64<E: de::Error>(self, number: i64) -> Result<ScaleKey, E> {
                Ok(ScaleKey::Number(Number::Integer(number)))
            }

            fn visit_f64<E: de::Error>(self, number: f64) -> Result<ScaleKey, E> {
                Ok(ScaleKey::Number(Number::Float(number)))
            }

            fn visit_str<E: de::Error>(self, name: &str) -> Result<ScaleKey, E> {
                Ok(ScaleKey::Factor(name.to_owned()))
            }

            fn visit_seq<A: SeqAccess<'de>>(self, bands: A) -> Result<ScaleKey, A::Error> {
                Vec::deserialize(SeqAccessDeserializer::new(bands)).map(ScaleKey::Bands)
            }
        }

        deserializer.deserialize_any(Either)
    }
}

impl<'de> Deserialize<'de> for OperandKey {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Either;

        impl Visitor<'_> for Either {
            type Value = OperandKey;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number, or the name of a factor or a point")
            }

            fn visit_i64<E: de::Error>(self, number: i64) -> Result<OperandKey, E> {
                Ok(OperandKey::Number(Number::Integer(number)))
            }

            fn visit_f64<E: de::Error>(self, number: f64) -> Result<OperandKey, E> {
                Ok(OperandKey::Number(Number::Float(number)))
            }

            fn visit_str<E: de::Error>(self, name: &str) -> Result<OperandKey, E> {
                Ok(OperandKey::Name(name.to_owned()))
            }
        }

        deserializer.deserialize_any(Either)
    }
}

impl<'de> Deserialize<'de> for LabelsKey {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Either;

        impl<'de> Visitor<'de> for Either {
            type Value = LabelsKey;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a table of names, or the name of one in [labels]")
            }

            fn visit_str<E: de::Error>(self, name: &str) -> Result<LabelsKey, E> {
                Ok(LabelsKey::Shared(name.to_owned()))
            }

            fn visit_map<A: MapAccess<'de>>(self, table: A) -> Result<LabelsKey, A::Error> {
                LabelTable::deserialize(MapAccessDeserializer::new(table)).map(LabelsKey::Own)
            }
        }

        deserializer.deserialize_any(Either)
    }
}
