//! Builds a scene from the directives of its files: entities, attribute blocks, object definitions,
//! and included files.

use super::entity::{Entity, PbrtParameter};
use super::scene::{GraphicsState, Instance, MaterialOf, PbrtObject, PbrtScene, PbrtShape};
use super::token::Tokens;
use crate::files::{Files, has_extension, text};
use crate::main_file::MainFile;
use crate::report::{Report, SourcePlace, quoted};
use flate2::read::MultiGzDecoder;
use glam::DAffine3;
use std::collections::BTreeMap;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// Maximum nesting depth of files.
const DEEPEST_FILES: usize = 64;

/// Maximum number of included files, counting repeats.
const MOST_FILES: usize = 1 << 14;

/// Maximum number of `Attribute` parameters in effect at one place. The limit is needed because
/// each `Attribute` parameter is checked for each shape.
const MOST_DEFAULTS: usize = 256;

/// The kinds of entity whose parameters `Attribute` may set.
const TARGETS: [&str; 5] = ["shape", "light", "material", "medium", "texture"];

/// Directives allowed only before `WorldBegin`.
const SETTINGS: [&str; 5] = [
    "Film",
    "Sampler",
    "Integrator",
    "PixelFilter",
    "Accelerator",
];

/// Maximum nesting depth of blocks.
const MAX_DEPTH: usize = 1 << 12;

/// Builds a scene from directives.
pub(super) struct Builder<'a> {
    pub(super) files: &'a Files,
    pub(super) report: &'a Report,
    pub(super) scene: PbrtScene<'a>,
    pub(super) state: GraphicsState,
    /// Saved graphics states, each with the kind of block, `Attribute` or `Object`, and the place
    /// where it was saved.
    pub(super) stack: Vec<(GraphicsState, &'static str, SourcePlace)>,
    systems: BTreeMap<String, DAffine3>,
    pub(super) is_world: bool,
    /// The name of the object to which shapes are added, inside its definition.
    pub(super) object: Option<String>,
    /// The folder of the scene.
    pub(super) folder: PathBuf,
    /// Files being read.
    pub(super) open: Vec<PathBuf>,
    pub(super) included: usize,
}

impl<'a> Builder<'a> {
    pub(super) fn new(file: &'a MainFile<'_>) -> Self {
        Self {
            files: &file.files,
            report: &file.report,
            scene: PbrtScene::default(),
            state: GraphicsState::default(),
            stack: Vec::new(),
            systems: BTreeMap::new(),
            is_world: false,
            object: None,
            folder: file.folder(),
            open: vec![file.path.clone()],
            included: 0,
        }
    }

    /// Builds the scene that a text describes.
    pub(super) fn build(mut self, text: &str, name: &str) -> PbrtScene<'a> {
        let mut tokens = Tokens::new(text, name);
        self.follow(&mut tokens);
        if !self.is_world {
            self.report.cause(&tokens.place(tokens.at), "no WorldBegin");
        }
        self.refuse_open(0);
        self.scene
    }

    pub(super) fn coordinate_system(&mut self, name: String) {
        self.systems.insert(name, self.state.to_world);
    }

    pub(super) fn go_to_system(&mut self, name: &str, place: &SourcePlace) -> Result<(), String> {
        match self.systems.get(name) {
            Some(map) => self.state.to_world = *map,
            // An unknown coordinate system is only a note, because pbrt also only warns.
            None => {
                let message = format!("coordinate system {} is not known", quoted(name));
                self.report.note(place, format!("{message}: left out"));
            }
        }
        Ok(())
    }

    pub(super) fn begin_world(&mut self) -> Result<(), String> {
        self.require_world("WorldBegin", false)?;
        self.is_world = true;
        self.state.to_world = DAffine3::IDENTITY;
        self.coordinate_system("world".to_owned());
        Ok(())
    }

    /// Checks that a directive stands after `WorldBegin` or, if `is_world` is false, before it.
    pub(super) fn require_world(&self, word: &str, is_world: bool) -> Result<(), String> {
        let [here, allowed] = match is_world {
            true => ["before", "after"],
            false => ["after", "before"],
        };
        match self.is_world == is_world {
            true => Ok(()),
            false => Err(format!(
                "{word} stands {here} WorldBegin; allowed: {allowed} WorldBegin"
            )),
        }
    }

    /// Handles a directive with a plugin.
    pub(super) fn make(
        &mut self,
        word: &str,
        plugin: String,
        own: Vec<Rc<PbrtParameter>>,
        place: &SourcePlace,
    ) -> Result<(), String> {
        let setting = SETTINGS.iter().find(|kind| **kind == word);
        match word {
            "Attribute" => return self.attribute(&plugin, own),
            "MakeNamedMedium" => return Err(no_medium(&plugin)),
            _ => self.require_world(word, setting.is_none() && word != "Camera")?,
        }
        let (kind, target) = match word {
            "Camera" => ("camera", None),
            "Material" | "MakeNamedMaterial" => ("material", Some(2)),
            "LightSource" => ("light", Some(1)),
            "AreaLightSource" => ("area light", Some(1)),
            _ => setting.map_or(("shape", Some(0)), |setting| (*setting, None)),
        };
        let mut entity = self.entity(kind, plugin, own, place, target);
        let scene = &mut self.scene;
        let map = self.state.to_world;
        match word {
            "Camera" => {
                self.systems.insert("camera".to_owned(), map.inverse());
                if scene.camera.replace((entity, map)).is_some() {
                    return Err("a second Camera".to_owned());
                }
            }
            "Material" => {
                self.state.material = MaterialOf::Number(scene.materials.len());
                scene.materials.push(entity);
            }
            "MakeNamedMaterial" => {
                let name = std::mem::take(&mut entity.plugin);
                let shown = quoted(&name);
                let before = scene.named.insert(name, scene.materials.len());
                scene.materials.push(entity);
                if before.is_some() {
                    return Err(format!("material {shown} is defined twice"));
                }
            }
            "LightSource" => scene.lights.push((entity, map)),
            "AreaLightSource" => {
                self.state.area = Some(scene.areas.len());
                scene.areas.push(entity);
            }
            _ if setting.is_none() => self.shape(entity),
            _ => {
                if scene.settings.insert(kind, entity).is_some() {
                    return Err(format!("a second {word}"));
                }
            }
        }
        Ok(())
    }

    fn shape(&mut self, entity: Entity<'a>) {
        let shape = PbrtShape {
            entity,
            to_world: self.state.to_world,
            is_reversed: self.state.is_reversed,
            material: self.state.material.clone(),
            area: self.state.area,
        };
        let object = self.object.as_ref();
        match object.and_then(|name| self.scene.objects.get_mut(name)) {
            Some(object) => object.shapes.push(shape),
            None => self.scene.shapes.push(shape),
        }
    }

    fn attribute(&mut self, target: &str, own: Vec<Rc<PbrtParameter>>) -> Result<(), String> {
        let Some(at) = TARGETS.iter().position(|known| *known == target) else {
            let (target, allowed) = (quoted(target), TARGETS.join(", "));
            return Err(format!("attributes of {target}; allowed: {allowed}"));
        };
        let defaults = Rc::make_mut(&mut self.state.defaults[at]);
        if defaults.len() + own.len() > MOST_DEFAULTS {
            return Err(format!(
                "more than {MOST_DEFAULTS} attributes of a {target}"
            ));
        }
        self.scene.defaults.extend(own.iter().cloned());
        defaults.extend(own);
        Ok(())
    }

    pub(super) fn entity(
        &self,
        kind: &'static str,
        plugin: String,
        own: Vec<Rc<PbrtParameter>>,
        place: &SourcePlace,
        target: Option<usize>,
    ) -> Entity<'a> {
        let defaults = target.map(|at| Rc::clone(&self.state.defaults[at]));
        Entity {
            report: self.report,
            kind,
            plugin,
            place: place.clone(),
            own,
            defaults: defaults.unwrap_or_default(),
            is_used: false.into(),
        }
    }

    /// Adds a cause for each unclosed block that is nested deeper than a level.
    fn refuse_open(&mut self, level: usize) {
        while self.stack.len() > level {
            if let Some((state, word, place)) = self.stack.pop() {
                self.report
                    .cause(&place, format!("{word}Begin without {word}End"));
                self.close(state, word);
            }
        }
    }

    /// Returns to the graphics state before a block.
    fn close(&mut self, state: GraphicsState, word: &str) {
        self.state = state;
        if word == "Object" {
            self.object = None;
        }
    }

    pub(super) fn push(&mut self, word: &'static str, place: &SourcePlace) -> Result<(), String> {
        self.require_world("a block", true)?;
        if self.stack.len() >= MAX_DEPTH {
            return Err(format!("blocks are nested more than {MAX_DEPTH} deep"));
        }
        self.stack.push((self.state.clone(), word, place.clone()));
        Ok(())
    }

    pub(super) fn pop(&mut self, word: &str) -> Result<(), String> {
        if let Some((state, ..)) = self.stack.pop_if(|(_, begun, _)| *begun == word) {
            self.close(state, word);
            return Ok(());
        }
        match self.stack.last() {
            Some((.., place)) => Err(format!(
                "{word}End stands inside the block that line {} opens; this block must end first",
                place.line
            )),
            None => Err(format!("{word}End without {word}Begin")),
        }
    }

    pub(super) fn begin_object(&mut self, name: String, place: &SourcePlace) -> Result<(), String> {
        if self.object.is_some() {
            return Err("an object is defined within an object".to_owned());
        }
        if self.scene.objects.contains_key(&name) {
            return Err(format!("object {} is defined twice", quoted(&name)));
        }
        self.push("Object", place)?;
        let object = PbrtObject {
            place: place.clone(),
            shapes: Vec::new(),
        };
        self.scene.objects.insert(name.clone(), object);
        self.object = Some(name);
        Ok(())
    }

    pub(super) fn instance(&mut self, name: String, place: &SourcePlace) -> Result<(), String> {
        self.require_world("ObjectInstance", true)?;
        if self.object.is_some() {
            return Err("an object contains an instance".to_owned());
        }
        self.scene.instances.push(Instance {
            name,
            place: place.clone(),
            to_world: self.state.to_world,
        });
        Ok(())
    }

    /// Reads a file. `Include` reads a file as if the text of the file replaced the directive.
    /// After `Import`, the graphics state is restored, and only the objects that the file defines
    /// are kept.
    pub(super) fn include(
        &mut self,
        word: &str,
        name: &str,
        place: &SourcePlace,
    ) -> Result<(), String> {
        let told = |error: String| format!("file {} {error}", quoted(name));
        let folders = std::slice::from_ref(&self.folder);
        let path = self.files.find(folders, name).map_err(told)?;
        if self.open.contains(&path) {
            return Err(told("includes itself".to_owned()));
        }
        if self.open.len() >= DEEPEST_FILES {
            return Err(format!(
                "includes are nested more than {DEEPEST_FILES} deep"
            ));
        }
        self.included += 1;
        if self.included > MOST_FILES {
            return match self.included == MOST_FILES + 1 {
                true => Err(format!("more than {MOST_FILES} files are included")),
                // The cause of refusal for this file was already added.
                false => Ok(()),
            };
        }
        let text = read(self.files, &path).map_err(told)?;
        let before = (word == "Import").then(|| (self.state.clone(), self.stack.len()));
        if before.is_some() {
            self.require_world(word, true)?;
        }
        self.open.push(path);
        self.follow(&mut Tokens::new(&text, name));
        self.open.pop();
        if let Some((state, level)) = before {
            self.refuse_open(level);
            if self.stack.len() < level {
                self.report
                    .cause(place, told("closes more blocks than it opens".to_owned()));
            }
            self.state = state;
        }
        Ok(())
    }
}

/// The message that a medium is refused.
pub(super) fn no_medium(name: &str) -> String {
    let name = quoted(name);
    format!("medium {name}: participating media are not supported")
}

/// The text of a file, unpacked if its name ends in .gz.
pub(super) fn read(files: &Files, path: &Path) -> Result<String, String> {
    text(bytes(files, path)?)
}

/// The bytes of a file, unpacked if its name ends in .gz.
pub(super) fn bytes(files: &Files, path: &Path) -> Result<Vec<u8>, String> {
    let packed = files.read(path)?;
    if !has_extension(path, "gz") {
        return Ok(packed);
    }
    let most = files.left();
    let mut unpacked = Vec::new();
    let mut stream = MultiGzDecoder::new(packed.as_slice()).take(most.saturating_add(1));
    let read = stream.read_to_end(&mut unpacked);
    files.spend(unpacked.len() as u64)?;
    read.map_err(|error| format!("cannot be unpacked: {error}"))?;
    Ok(unpacked)
}
