//! Defines how messages name arguments, because the command and the Python package name arguments
//! differently.

use std::fmt::Display;

/// The way in which messages name arguments. The command and the Python package call the same
/// functions, but their users write arguments differently.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ArgumentStyle {
    /// Options of the command, such as `--look-from`.
    #[default]
    Command,
    /// Keyword arguments of Python, such as `look_from=`.
    Python,
}

impl ArgumentStyle {
    /// The text for the argument with this name, without a value.
    #[must_use]
    pub fn name(self, name: &str) -> String {
        match self {
            Self::Command => format!("--{}", name.replace('_', "-")),
            Self::Python => format!("{name}="),
        }
    }

    /// The text for the argument with this name and a value.
    #[must_use]
    pub fn with(self, name: &str, value: impl Display) -> String {
        match self {
            Self::Command => format!("{} {value}", self.name(name)),
            Self::Python => format!("{name}={value}"),
        }
    }

    /// The text for one value of an argument that is repeated on the command line, and that is a
    /// collection with a name in the plural in Python.
    #[must_use]
    pub fn with_one(self, name: &str, value: impl Display) -> String {
        match self {
            Self::Command => self.with(name, value),
            Self::Python => self.with(&format!("{name}s"), value),
        }
    }

    /// The text for the argument that sets a field of a scene.
    #[must_use]
    pub fn set(self, path: &str, value: &str) -> String {
        match self {
            Self::Command => format!("--set {path}={value}"),
            Self::Python => format!("set={{'{path}': {value}}}"),
        }
    }

    /// The message for a fault in an argument that sets fields of a scene.
    #[must_use]
    pub fn in_set(self, fault: impl Display) -> String {
        match self {
            Self::Command => format!("--set {fault}"),
            Self::Python => format!("in set, {fault}"),
        }
    }

    /// The text for the argument that allows replacing files that Étendue did not write.
    #[must_use]
    pub fn force(self) -> &'static str {
        match self {
            Self::Command => "--force",
            Self::Python => "force=True",
        }
    }

    /// The advice to name another folder.
    #[must_use]
    pub fn another_folder(self) -> &'static str {
        match self {
            Self::Command => "choose another folder with --out",
            Self::Python => "choose another folder",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::ArgumentStyle::{Command, Python};

    #[test]
    fn each_caller_reads_its_own_arguments() {
        assert_eq!(Command.name("look_from"), "--look-from");
        assert_eq!(Python.name("look_from"), "look_from=");
        assert_eq!(Command.with("photons", 7), "--photons 7");
        assert_eq!(Python.with("photons", 7), "photons=7");
        assert_eq!(Command.set("light.radiance", "2"), "--set light.radiance=2");
        assert_eq!(
            Python.set("light.radiance", "2"),
            "set={'light.radiance': 2}"
        );
    }
}
