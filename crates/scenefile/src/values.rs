//! Checks that each number of a scene file is within the range of its field.

use crate::display::number;
use crate::fault::{Fault, fault};
use crate::file::SceneFile;
use crate::schema::{element, referred, schema, variant};
use serde::ser::{
    Impossible, Serialize, SerializeSeq, SerializeStruct, SerializeStructVariant, SerializeTuple,
    SerializeTupleStruct, SerializeTupleVariant, Serializer,
};
use serde_json::Value;
use std::fmt;

impl SceneFile {
    /// A fault for each number that is outside its field's range in the schema.
    #[must_use]
    #[expect(
        clippy::missing_panics_doc,
        reason = "no field of a scene file is a map"
    )]
    pub fn numbers_out_of_range(&self) -> Vec<Fault> {
        let mut faults = Vec::new();
        let walk = ValueWalk {
            faults: &mut faults,
            path: &mut String::new(),
            node: schema(),
            place: 0,
        };
        let done = self.serialize(walk);
        done.expect("no field of a scene file is a map");
        faults
    }
}

/// A serialiser that visits the values of a scene file together with its schema.
struct ValueWalk<'a> {
    faults: &'a mut Vec<Fault>,
    path: &'a mut String,
    /// The schema node of the value that is being visited.
    node: &'static Value,
    /// The index of the next element of the list that is being visited.
    place: usize,
}

impl ValueWalk<'_> {
    fn check(&mut self, value: f64, shown: impl FnOnce() -> String) {
        let range = self.node["x-range"].as_str();
        let range = range.expect("each number of the schema has a range");
        let [least, most] = ["minimum", "maximum"].map(|end| self.node[end].as_f64());
        let is_within = |(least, most)| (least..=most).contains(&value);
        if !least.zip(most).is_none_or(is_within) {
            self.faults.push(fault(&*self.path, shown(), range));
        }
    }

    fn variant(self, name: &str) -> Self {
        let node = variant(self.node, name);
        Self { node, ..self }
    }

    fn go<T: Serialize + ?Sized>(&mut self, value: &T, step: &str, node: &'static Value) -> Walked {
        let length = self.path.len();
        self.path.push_str(step);
        value.serialize(ValueWalk {
            faults: self.faults,
            path: self.path,
            node,
            place: 0,
        })?;
        self.path.truncate(length);
        Ok(())
    }

    fn field<T: Serialize + ?Sized>(&mut self, name: Name, value: &T) -> Walked {
        let dot = if self.path.is_empty() { "" } else { "." };
        let node = &referred(self.node)["properties"][name];
        self.go(value, &format!("{dot}{name}"), node)
    }

    fn next<T: Serialize + ?Sized>(&mut self, value: &T) -> Walked {
        let place = self.place;
        self.place += 1;
        self.go(value, &format!("[{place}]"), element(self.node, place))
    }
}

type Name = &'static str;
type Walked = Result<(), fmt::Error>;

/// Implements visits of types that contain no number.
macro_rules! pass {
    ($($name:ident($($of:ty),*);)*) => {
        $(fn $name(self, $(_: $of),*) -> Walked { Ok(()) })*
    };
}

/// Implements visits of types that contain other values.
macro_rules! enter {
    ($($name:ident($($of:ty),*);)*) => {
        $(fn $name(self, $(_: $of),*) -> Result<Self, fmt::Error> { Ok(self) })*
    };
}

impl Serializer for ValueWalk<'_> {
    type Ok = ();
    type Error = fmt::Error;
    type SerializeSeq = Self;
    type SerializeTuple = Self;
    type SerializeTupleStruct = Self;
    type SerializeTupleVariant = Self;
    type SerializeMap = Impossible<(), fmt::Error>;
    type SerializeStruct = Self;
    type SerializeStructVariant = Self;

    pass! {
        serialize_bool(bool); serialize_char(char); serialize_str(&str); serialize_bytes(&[u8]);
        serialize_i8(i8); serialize_i16(i16); serialize_i32(i32); serialize_i64(i64);
        serialize_u8(u8); serialize_u16(u16); serialize_f32(f32);
        serialize_none(); serialize_unit(); serialize_unit_struct(Name); serialize_unit_variant(Name, u32, Name);
    }

    enter! {
        serialize_seq(Option<usize>); serialize_tuple(usize);
        serialize_tuple_struct(Name, usize); serialize_struct(Name, usize);
    }

    fn serialize_f64(mut self, value: f64) -> Walked {
        self.check(value, || number(value));
        Ok(())
    }

    fn serialize_u32(self, value: u32) -> Walked {
        self.serialize_u64(value.into())
    }

    fn serialize_u64(mut self, value: u64) -> Walked {
        self.check(value as f64, || value.to_string());
        Ok(())
    }

    fn serialize_some<T: Serialize + ?Sized>(self, value: &T) -> Walked {
        value.serialize(self)
    }

    fn serialize_newtype_struct<T: Serialize + ?Sized>(self, _: Name, value: &T) -> Walked {
        value.serialize(self)
    }

    fn serialize_newtype_variant<T: Serialize + ?Sized>(
        self,
        _: Name,
        _: u32,
        name: Name,
        value: &T,
    ) -> Walked {
        value.serialize(self.variant(name))
    }

    fn serialize_tuple_variant(
        self,
        _: Name,
        _: u32,
        name: Name,
        _: usize,
    ) -> Result<Self, fmt::Error> {
        Ok(self.variant(name))
    }

    fn serialize_struct_variant(
        self,
        _: Name,
        _: u32,
        name: Name,
        _: usize,
    ) -> Result<Self, fmt::Error> {
        Ok(self.variant(name))
    }

    fn serialize_map(self, _: Option<usize>) -> Result<Self::SerializeMap, fmt::Error> {
        Err(fmt::Error)
    }
}

macro_rules! inside {
    ($($of:ident::$name:ident($($key:ident)?) $go:ident;)*) => {$(
        impl $of for ValueWalk<'_> {
            type Ok = ();
            type Error = fmt::Error;

            fn $name<T: Serialize + ?Sized>(&mut self, $($key: Name,)? value: &T) -> Walked {
                self.$go($($key,)? value)
            }

            fn end(self) -> Walked {
                Ok(())
            }
        }
    )*};
}

inside! {
    SerializeSeq::serialize_element() next;
    SerializeTuple::serialize_element() next;
    SerializeTupleStruct::serialize_field() next;
    SerializeTupleVariant::serialize_field() next;
    SerializeStruct::serialize_field(name) field;
    SerializeStructVariant::serialize_field(name) field;
}
