//! The scene files of the repository that figures use.

use crate::subject::Text;

/// The text of a scene file.
macro_rules! scene {
    ($path:literal) => {
        include_str!(concat!("../../../scenes/", $path, ".ron"))
    };
}

/// A mirror whose axes lie out of the plane of incidence.
pub(crate) const TWIST: Text = ("twist", scene!("table1/twist"));

pub(crate) use scene;
