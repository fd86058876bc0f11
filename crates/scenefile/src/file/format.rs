//! The number of the format of a scene file.

use serde::de::{Error, Unexpected};
use serde::{Deserialize, Deserializer};

/// The format of scene files. Its number, 1, increases when a reader of the earlier format would
/// misread a new file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SceneFormat;

impl<'de> Deserialize<'de> for SceneFormat {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        match u64::deserialize(deserializer)? {
            1 => Ok(Self),
            other => Err(D::Error::invalid_value(Unexpected::Unsigned(other), &"1")),
        }
    }
}
