//! Elements that hold values of properties, and elements that name files and folders.

use super::object::Value;
use super::transform::{allow, find, is_rigid, required, step};
use super::value;
use super::xml::{SourceFile, Tree, XmlElement};
use crate::files;
use crate::range::{MAX_NUMBER, holds};
use crate::report::quoted;
use glam::DAffine3;
use roxmltree::Node;
use std::path::Path;

/// Maximum nesting depth of included files.
const MOST_INCLUDED: usize = 15;

/// Maximum number of includes, counting repeats.
const MAX_INCLUDES: usize = 1000;

/// Maximum number of search folders.
const MOST_FOLDERS: usize = 64;

impl Tree<'_> {
    /// The value of a property.
    pub(super) fn value(
        &mut self,
        name: &str,
        element: &XmlElement<'_, '_>,
        source: &mut SourceFile<'_>,
    ) -> Result<Value, String> {
        let (node, attributes) = (element.node, &element.attributes);
        if name == "transform" {
            allow(attributes, &["name"])?;
            let map = self.transform(node, source)?;
            return Ok(Value::Transform(Box::new(map)));
        }
        if let Some(child) = node.children().find(Node::is_element) {
            let name = child.tag_name().name();
            return Err(format!("<{name}> within a property"));
        }
        match name {
            "point" | "vector" => allow(attributes, &["name", "value", "x", "y", "z"])?,
            "spectrum" => allow(attributes, &["name", "value", "filename"])?,
            _ => allow(attributes, &["name", "value"])?,
        }
        let text = || required(attributes, "value");
        Ok(match name {
            "float" => Value::Number(value::number(text()?)?),
            "integer" => Value::Whole(value::whole(text()?)?),
            "boolean" => Value::Truth(value::truth(text()?)?),
            "string" => Value::Text(text()?.to_owned()),
            "rgb" => Value::Color(value::triple(text()?)?),
            "spectrum" => match (find(attributes, "value"), find(attributes, "filename")) {
                (Some(text), None) => value::spectrum(text)?,
                (None, Some(file)) => self.spectrum(file, source)?,
                _ => {
                    return Err("exactly one of value and filename must be given".to_owned());
                }
            },
            "point" | "vector" => match find(attributes, "value") {
                Some(text) => Value::Vector(value::triple(text)?.into()),
                None => {
                    let [x, y, z] = ["x", "y", "z"]
                        .map(|axis| required(attributes, axis).and_then(value::number));
                    Value::Vector([x?, y?, z?].into())
                }
            },
            _ => return Err("not an element of a scene".to_owned()),
        })
    }

    fn transform(
        &mut self,
        node: Node<'_, '_>,
        source: &mut SourceFile<'_>,
    ) -> Result<DAffine3, String> {
        let mut made = DAffine3::IDENTITY;
        for child in node.children().filter(Node::is_element) {
            self.elements += 1;
            let name = child.tag_name().name();
            let attributes = self.attributes(child)?;
            let step = match name {
                "lookAt" => step("lookat", &attributes),
                _ => step(name, &attributes),
            };
            let step = step.map_err(|error| format!("<{name}>: {error}"))?;
            if name == "rotate" && !is_rigid(step) {
                let place = source.cursor.place(child.range().start, &source.name);
                let message = "the length of the rotation axis is not 1: as in Mitsuba 3, this also distorts shapes";
                self.report.note(&place, message);
            }
            made = step * made;
        }
        match holds(made) {
            true => Ok(made),
            false => Err(format!(
                "the product with the preceding transforms has numbers out of range; allowed: up to {MAX_NUMBER:e}"
            )),
        }
    }

    fn spectrum(&self, file: &str, source: &SourceFile<'_>) -> Result<Value, String> {
        let read = || {
            let path = self.files.find(&source.folders, file)?;
            let bytes = self.files.read(&path)?;
            let text = String::from_utf8(bytes).map_err(|_| "is no text".to_owned())?;
            value::spectrum_file(&text)
        };
        read().map_err(|error| format!("file {}: {error}", quoted(file)))
    }

    /// Adds a search folder before all other search folders.
    pub(super) fn search(
        &mut self,
        element: &XmlElement<'_, '_>,
        source: &mut SourceFile<'_>,
    ) -> Result<(), String> {
        allow(&element.attributes, &["value"])?;
        if element.parent != 0 {
            return Err(
                "<path> is inside another element; allowed: directly in <scene>".to_owned(),
            );
        }
        let name = required(&element.attributes, "value")?;
        let found = self.files.find(&source.folders, name);
        let folder = found.map_err(|error| format!("folder {} {error}", quoted(name)))?;
        if source.folders.len() > MOST_FOLDERS {
            return Err(format!("more than {MOST_FOLDERS} folders"));
        }
        let folders = std::iter::once(folder).chain(source.folders.iter().cloned());
        source.folders = folders.collect();
        Ok(())
    }

    pub(super) fn include(
        &mut self,
        element: &XmlElement<'_, '_>,
        source: &SourceFile<'_>,
    ) -> Result<(), String> {
        allow(&element.attributes, &["filename", "name"])?;
        let name = required(&element.attributes, "filename")?;
        let told = |error: String| format!("file {} {error}", quoted(name));
        let path = self.files.find(&source.folders, name).map_err(told)?;
        if self.open.contains(&path) {
            return Err(told("includes itself".to_owned()));
        }
        if self.open.len() > MOST_INCLUDED {
            return Err(format!(
                "includes are nested more than {MOST_INCLUDED} deep"
            ));
        }
        self.includes += 1;
        if self.includes > MAX_INCLUDES {
            // Only the first file beyond the limit adds a cause of refusal.
            return match self.includes == MAX_INCLUDES + 1 {
                true => Err(format!("more than {MAX_INCLUDES} files are included")),
                false => Ok(()),
            };
        }
        let text = self.files.read(&path).and_then(files::text).map_err(told)?;
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        let folders = std::iter::once(folder).chain(source.folders.iter().cloned());
        self.open.push(path);
        self.file(
            &text,
            name,
            folders.collect(),
            Some((element.parent, element.depth + 1)),
        );
        self.open.pop();
        Ok(())
    }
}
