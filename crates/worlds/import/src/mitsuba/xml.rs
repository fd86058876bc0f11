//! Conversion of XML to objects: substitutes parameters, includes files and upgrades names.

use super::object::{MitsubaObject, ObjectProperty, Value, kind_of};
use super::parameters::Parameters;
use super::transform::{Attributes, allow, find, required};
use super::upgrade;
use crate::files::Files;
use crate::main_file::MainFile;
use crate::report::{Report, SourcePlace, quoted};
use roxmltree::{Document, Node, ParsingOptions};
use std::collections::HashMap;
use std::path::PathBuf;
use std::rc::Rc;

/// Maximum nesting depth of elements.
const MAX_DEPTH: usize = 64;

/// Maximum number of attributes of an element.
const MAX_ATTRIBUTES: usize = 64;

/// Maximum number of elements in all files.
const MOST_ELEMENTS: usize = 1 << 23;

/// Maximum number of elements, texts and comments in one file. An element usually stands between
/// two texts, which are line ends.
const MOST_NODES: u32 = 1 << 25;

/// The content of the files of a scene.
pub(super) struct Tree<'a> {
    /// The objects of all files; the scene is the first object.
    pub(super) objects: Vec<MitsubaObject<'a>>,
    /// Objects by their id.
    pub(super) ids: HashMap<String, usize>,
    parameters: Parameters,
    pub(super) files: &'a Files,
    pub(super) report: &'a Report,
    /// Files that are being read, with the innermost included file last.
    pub(super) open: Vec<PathBuf>,
    pub(super) elements: usize,
    pub(super) includes: usize,
}

/// An element whose parameters were replaced by their values.
pub(super) struct XmlElement<'n, 't> {
    pub(super) node: Node<'n, 't>,
    pub(super) attributes: Attributes,
    place: SourcePlace,
    /// The index of the object that contains the element.
    pub(super) parent: usize,
    pub(super) depth: usize,
}

impl<'a> Tree<'a> {
    pub(super) fn new(file: &'a MainFile<'_>) -> Self {
        Self {
            objects: Vec::new(),
            ids: HashMap::new(),
            parameters: Parameters::new(&file.options.set),
            files: &file.files,
            report: &file.report,
            open: Vec::new(),
            elements: 0,
            includes: 0,
        }
    }

    /// Reads the file of the scene.
    pub(super) fn read(&mut self, text: &str, file: &MainFile<'_>) {
        self.open.push(file.path.clone());
        self.file(text, &file.name, Rc::from([file.folder()]), None);
        for name in &self.parameters.unused {
            let message = format!("`${name}` is set, but the scene does not use it");
            self.report
                .cause(&SourcePlace::whole("parameters"), message);
        }
    }

    /// Reads the file of the scene, or a file that an object at the given nesting depth includes.
    pub(super) fn file(
        &mut self,
        text: &str,
        name: &str,
        folders: Rc<[PathBuf]>,
        parent: Option<(usize, usize)>,
    ) {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let name: Rc<str> = name.into();
        // The number of attributes is checked first, because the time of the XML parser grows with
        // the square of this number.
        if let Some(offset) = crowded(text) {
            let mut cursor = LineCursor::new(text);
            let place = cursor.place(offset, &name);
            let message = format!("an element has more than {MAX_ATTRIBUTES} attributes");
            return self.report.cause(&place, message);
        }
        let document = match parsed(text, &name) {
            Ok(document) => document,
            Err((place, message)) => return self.report.cause(&place, message),
        };
        let root = document.root_element();
        let mut source = SourceFile {
            name,
            folders,
            is_old: false,
            cursor: LineCursor::new(text),
        };
        let place = source.cursor.place(root.range().start, &source.name);
        match root.attribute("version").map(version) {
            Some(Some(major)) => source.is_old = major < 2,
            Some(None) => self.report.cause(&place, "the version is not a number"),
            None => self.report.cause(&place, "no attribute version"),
        }
        match parent {
            // The content of an included scene becomes part of the including object.
            Some((parent, depth)) if root.tag_name().name() == "scene" => {
                self.children(root, parent, &mut source, depth);
            }
            Some((parent, depth)) => self.element(root, parent, &mut source, depth),
            None if root.tag_name().name() == "scene" => {
                let scene = XmlElement {
                    node: root,
                    attributes: Vec::new(),
                    place,
                    parent: 0,
                    depth: 0,
                };
                self.object("scene", &scene, &mut source);
            }
            None => self.report.cause(&place, "the root is not <scene>"),
        }
    }

    fn children(
        &mut self,
        node: Node<'_, '_>,
        at: usize,
        source: &mut SourceFile<'_>,
        depth: usize,
    ) {
        for child in node.children().filter(Node::is_element) {
            self.element(child, at, source, depth);
        }
    }

    /// Reads one element within the object `parent`.
    fn element(
        &mut self,
        node: Node<'_, '_>,
        parent: usize,
        source: &mut SourceFile<'_>,
        depth: usize,
    ) {
        let place = source.cursor.place(node.range().start, &source.name);
        self.elements += 1;
        if self.elements > MOST_ELEMENTS || depth > MAX_DEPTH {
            // Only the first element beyond the limit adds a cause.
            if self.elements <= MOST_ELEMENTS || self.elements == MOST_ELEMENTS + 1 {
                let most =
                    format!("at most {MOST_ELEMENTS} elements, nested at most {MAX_DEPTH} deep");
                self.report.cause(
                    &place,
                    format!("the scene has too many elements, or elements are nested too deeply; allowed: {most}"),
                );
            }
            return;
        }
        let name = node.tag_name().name();
        let done = self.attributes(node).and_then(|attributes| {
            let element = XmlElement {
                node,
                attributes,
                place: place.clone(),
                parent,
                depth,
            };
            let attributes = &element.attributes;
            let Some(kind) = kind_of(name, find(attributes, "type").is_some()) else {
                return self.other(&element, source);
            };
            // An element without a parent is the root of an included file.
            let is_root = node.parent_element().is_none();
            let version: &[&str] = if is_root { &["version"] } else { &[] };
            allow(attributes, &[&["type", "id", "name"], version].concat())?;
            required(attributes, "type")?;
            self.object(kind, &element, source);
            Ok(())
        });
        if let Err(message) = done {
            self.report.cause(&place, format!("<{name}>: {message}"));
        }
    }

    /// The attributes with parameters substituted.
    pub(super) fn attributes(&mut self, node: Node<'_, '_>) -> Result<Attributes, String> {
        let mut made = Vec::new();
        for attribute in node.attributes() {
            let value = self.parameters.substitute(attribute.value())?;
            made.push((attribute.name().to_owned(), value));
        }
        Ok(made)
    }

    fn object(
        &mut self,
        kind: &'static str,
        element: &XmlElement<'_, '_>,
        source: &mut SourceFile<'_>,
    ) {
        let (attributes, place, parent) = (&element.attributes, &element.place, element.parent);
        let at = self.objects.len();
        let id = find(attributes, "id").map(str::to_owned);
        let name = find(attributes, "name").unwrap_or_default().to_owned();
        self.objects.push(MitsubaObject {
            report: self.report,
            kind,
            number: at,
            plugin: find(attributes, "type").unwrap_or("scene").to_owned(),
            id: id.clone(),
            place: place.clone(),
            folders: Rc::clone(&source.folders),
            properties: Vec::new(),
            parent,
            is_used: false.into(),
        });
        if let Some(id) = id {
            self.name(id, at, place);
        }
        if at != parent {
            self.add(parent, name, Value::Object(at), place, source);
        }
        self.children(element.node, at, source, element.depth + 1);
        self.objects[at].folders = Rc::clone(&source.folders);
        // Scenes may have millions of objects, so unused memory is freed.
        self.objects[at].properties.shrink_to_fit();
        if source.is_old {
            upgrade::upgrade(&mut self.objects[at]);
        }
    }

    fn name(&mut self, id: String, at: usize, place: &SourcePlace) {
        match self.ids.get(&id) {
            None => {
                self.ids.insert(id, at);
            }
            Some(first) => {
                let line = self.objects[*first].place.line;
                let message = format!("id {} is already used in line {line}", quoted(&id));
                self.report.cause(place, message);
            }
        }
    }

    fn add(
        &mut self,
        at: usize,
        name: String,
        value: Value,
        place: &SourcePlace,
        source: &SourceFile<'_>,
    ) {
        let name = match source.is_old {
            true => upgrade::underscored(&name),
            false => name,
        };
        let properties = &mut self.objects[at].properties;
        let is_value = !matches!(value, Value::Object(_) | Value::Reference(_));
        if is_value && properties.iter().rev().take(1000).any(|p| p.name == name) {
            self.report
                .cause(place, format!("property {} is given twice", quoted(&name)));
        }
        properties.push(ObjectProperty {
            name,
            value,
            place: place.clone(),
            is_read: false.into(),
        });
    }

    /// Reads an element that is not an object.
    fn other(
        &mut self,
        element: &XmlElement<'_, '_>,
        source: &mut SourceFile<'_>,
    ) -> Result<(), String> {
        let (attributes, place, parent) = (&element.attributes, &element.place, element.parent);
        match element.node.tag_name().name() {
            "default" => {
                allow(attributes, &["name", "value"])?;
                let name = required(attributes, "name")?;
                if name.is_empty() {
                    return Err("an empty name".to_owned());
                }
                self.parameters
                    .default(name, required(attributes, "value")?);
                Ok(())
            }
            "include" => self.include(element, source),
            "path" => self.search(element, source),
            "alias" => {
                allow(attributes, &["id", "as"])?;
                let id = required(attributes, "id")?;
                let at = *self.ids.get(id).ok_or_else(|| unknown(id))?;
                self.name(required(attributes, "as")?.to_owned(), at, place);
                Ok(())
            }
            "ref" => {
                allow(attributes, &["name", "id"])?;
                let id = required(attributes, "id")?.to_owned();
                let name = find(attributes, "name").unwrap_or_default().to_owned();
                self.add(parent, name, Value::Reference(id), place, source);
                Ok(())
            }
            name @ ("boolean" | "float" | "integer" | "point" | "rgb" | "spectrum" | "string"
            | "transform" | "vector") => {
                required(attributes, "name")?;
                let value = self.value(name, element, source);
                let name = find(attributes, "name").unwrap_or_default().to_owned();
                // An invalid value still defines the property, so only one cause of refusal is
                // added for the property.
                let (value, fault) = match value {
                    Ok(value) => (value, None),
                    Err(fault) => (Value::Broken, Some(fault)),
                };
                self.add(parent, name, value, place, source);
                fault.map_or(Ok(()), Err)
            }
            _ => Err("not an element of a scene".to_owned()),
        }
    }
}

/// A file that is being read.
pub(super) struct SourceFile<'t> {
    pub(super) name: Rc<str>,
    /// The search folders: first the folders that this file adds, then the folders of the
    /// including file.
    pub(super) folders: Rc<[PathBuf]>,
    /// Whether the format is older than version 2.
    pub(super) is_old: bool,
    pub(super) cursor: LineCursor<'t>,
}

/// Counts lines and columns for increasing offsets.
pub(super) struct LineCursor<'t> {
    text: &'t str,
    offset: usize,
    line: usize,
    column: usize,
}

impl<'t> LineCursor<'t> {
    pub(super) fn new(text: &'t str) -> Self {
        Self {
            text,
            offset: 0,
            line: 1,
            column: 1,
        }
    }

    pub(super) fn place(&mut self, offset: usize, file: &Rc<str>) -> SourcePlace {
        // Elements are visited in the order of the text, so each line is counted once.
        if let Some(passed) = self.text.get(self.offset..offset) {
            for c in passed.chars() {
                if c == '\n' {
                    (self.line, self.column) = (self.line + 1, 1);
                } else {
                    self.column += 1;
                }
            }
            self.offset = offset;
        }
        SourcePlace::at(file, self.line, self.column)
    }
}

/// Parses a file; `Err` holds the place and the description of a fault.
fn parsed<'t>(text: &'t str, name: &Rc<str>) -> Result<Document<'t>, (SourcePlace, String)> {
    let options = ParsingOptions {
        nodes_limit: MOST_NODES,
        ..ParsingOptions::default()
    };
    Document::parse_with_options(text, options).map_err(|error| {
        if matches!(error, roxmltree::Error::NodesLimitReached) {
            let message = format!(
                "more than {MOST_NODES} elements, texts and comments; allowed: at most {MOST_ELEMENTS} elements"
            );
            return (SourcePlace::whole(name), message);
        }
        let at = error.pos();
        let place = SourcePlace::at(name, at.row as usize, at.col as usize);
        (place, format!("no XML: {error}"))
    })
}

/// The offset of an element with too many attributes, if any.
fn crowded(text: &str) -> Option<usize> {
    let mut at = 0;
    while let Some(start) = text[at..].find('<').map(|i| at + i) {
        let rest = &text[start..];
        let skipped = [("<!--", "-->"), ("<![CDATA[", "]]>"), ("<?", "?>")];
        if let Some((_, end)) = skipped.iter().find(|(begin, _)| rest.starts_with(begin)) {
            at = start + rest.find(end)? + end.len();
            continue;
        }
        let (mut quote, mut attributes, mut end) = (None, 0, rest.len());
        for (i, byte) in rest.bytes().enumerate() {
            match (quote, byte) {
                (None, b'>') => {
                    end = i + 1;
                    break;
                }
                (None, b'=') => attributes += 1,
                (None, b'"' | b'\'') => quote = Some(byte),
                (Some(open), _) if open == byte => quote = None,
                _ => {}
            }
        }
        if attributes > MAX_ATTRIBUTES {
            return Some(start);
        }
        at = start + end;
    }
    None
}

pub(super) fn unknown(id: &str) -> String {
    format!("no object has id {}", quoted(id))
}

/// The first number of a version such as 3.0.0.
fn version(text: &str) -> Option<u32> {
    text.trim().split('.').next()?.parse().ok()
}
