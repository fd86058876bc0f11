//! Builds a scene from directives.

use super::entity::Entity;
use super::parameter::PbrtParameter;
use super::scene::{GraphicsState, MaterialOf, PbrtScene, PbrtShape};
use super::token::Tokens;
use crate::files::Files;
use crate::report::{Report, SourcePlace, quoted};
use glam::DAffine3;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// Maximum nesting depth of files.
pub(super) const DEEPEST_FILES: usize = 64;

/// Maximum number of included files, counting repeats.
pub(super) const MOST_FILES: usize = 1 << 14;

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

/// Builds a scene from directives.
pub(super) struct Builder<'a> {
    pub(super) files: &'a Files,
    pub(super) report: &'a Report,
    pub(super) scene: PbrtScene,
    pub(super) state: GraphicsState,
    /// Saved graphics states, each with a letter (`a` for an attribute block, `o` for an object)
    /// and the place where it was saved.
    pub(super) stack: Vec<(GraphicsState, char, SourcePlace)>,
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
    pub(super) fn new(files: &'a Files, report: &'a Report, path: &Path) -> Self {
        Self {
            files,
            report,
            scene: PbrtScene::default(),
            state: GraphicsState::default(),
            stack: Vec::new(),
            systems: BTreeMap::new(),
            is_world: false,
            object: None,
            folder: path.parent().unwrap_or(path).to_owned(),
            open: vec![path.to_owned()],
            included: 0,
        }
    }

    /// Builds the scene that a text describes.
    pub(super) fn build(mut self, text: &str, name: &str) -> PbrtScene {
        let mut tokens = Tokens::new(text, name);
        self.follow(&mut tokens);
        if !self.is_world {
            self.report.cause(&tokens.here(), "no WorldBegin");
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
        self.before_world("WorldBegin")?;
        self.is_world = true;
        self.state.to_world = DAffine3::IDENTITY;
        self.coordinate_system("world".to_owned());
        Ok(())
    }

    pub(super) fn before_world(&self, word: &str) -> Result<(), String> {
        match self.is_world {
            false => Ok(()),
            true => Err(format!(
                "{word} stands after WorldBegin; allowed: before WorldBegin"
            )),
        }
    }

    pub(super) fn within_world(&self, word: &str) -> Result<(), String> {
        match self.is_world {
            true => Ok(()),
            false => Err(format!(
                "{word} stands before WorldBegin; allowed: after WorldBegin"
            )),
        }
    }

    pub(super) fn named_material(&mut self, name: &str, place: &SourcePlace) {
        self.state.material = MaterialOf::Named(name.into(), place.clone());
    }

    /// Handles a directive with a plugin.
    pub(super) fn make(
        &mut self,
        word: &str,
        plugin: String,
        own: Vec<Rc<PbrtParameter>>,
        place: &SourcePlace,
    ) -> Result<(), String> {
        if let Some(kind) = SETTINGS.iter().find(|kind| **kind == word) {
            self.before_world(word)?;
            let entity = self.entity(kind, plugin, own, place, None);
            if self.scene.settings.insert(kind, entity).is_some() {
                return Err(format!("a second {word}"));
            }
            return Ok(());
        }
        match word {
            "Camera" => return self.camera(plugin, own, place),
            "Attribute" => return self.attribute(&plugin, own),
            "MakeNamedMedium" => {
                let name = quoted(&plugin);
                return Err(format!(
                    "medium {name}: participating media are not supported"
                ));
            }
            _ => self.within_world(word)?,
        }
        match word {
            "Material" => {
                let entity = self.entity("material", plugin, own, place, Some(2));
                self.state.material = MaterialOf::Number(self.scene.materials.len());
                self.scene.materials.push(entity);
            }
            "MakeNamedMaterial" => return self.make_named(plugin, own, place),
            "LightSource" => {
                let entity = self.entity("light", plugin, own, place, Some(1));
                self.scene.lights.push((entity, self.state.to_world));
            }
            "AreaLightSource" => {
                let entity = self.entity("area light", plugin, own, place, Some(1));
                self.state.area = Some(self.scene.areas.len());
                self.scene.areas.push(entity);
            }
            _ => self.shape(plugin, own, place),
        }
        Ok(())
    }

    fn make_named(
        &mut self,
        name: String,
        own: Vec<Rc<PbrtParameter>>,
        place: &SourcePlace,
    ) -> Result<(), String> {
        let entity = self.entity("material", String::new(), own, place, Some(2));
        let shown = quoted(&name);
        let before = self.scene.named.insert(name, self.scene.materials.len());
        self.scene.materials.push(entity);
        match before {
            None => Ok(()),
            Some(_) => Err(format!("material {shown} is defined twice")),
        }
    }

    fn camera(
        &mut self,
        plugin: String,
        own: Vec<Rc<PbrtParameter>>,
        place: &SourcePlace,
    ) -> Result<(), String> {
        self.before_world("Camera")?;
        let entity = self.entity("camera", plugin, own, place, None);
        let map = self.state.to_world;
        self.systems.insert("camera".to_owned(), map.inverse());
        match self.scene.camera.replace((entity, map)) {
            None => Ok(()),
            Some(_) => Err("a second Camera".to_owned()),
        }
    }

    fn shape(&mut self, plugin: String, own: Vec<Rc<PbrtParameter>>, place: &SourcePlace) {
        let shape = PbrtShape {
            entity: self.entity("shape", plugin, own, place, Some(0)),
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
            let allowed = TARGETS.join(", ");
            return Err(format!(
                "attributes of {}; allowed: {allowed}",
                quoted(target)
            ));
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

    pub(super) fn make_texture(
        &mut self,
        name: String,
        kind: &str,
        plugin: String,
        own: Vec<Rc<PbrtParameter>>,
        place: &SourcePlace,
    ) -> Result<(), String> {
        self.within_world("Texture")?;
        let is_spectrum = match kind {
            "spectrum" => true,
            "float" => false,
            _ => {
                let kind = quoted(kind);
                return Err(format!("a texture of {kind}; allowed: float, spectrum"));
            }
        };
        let entity = self.entity("texture", plugin, own, place, Some(4));
        let shown = quoted(&name);
        match self.scene.textures.insert((is_spectrum, name), entity) {
            None => Ok(()),
            Some(_) => Err(format!("a second {kind} texture {shown}")),
        }
    }

    fn entity(
        &self,
        kind: &'static str,
        plugin: String,
        own: Vec<Rc<PbrtParameter>>,
        place: &SourcePlace,
        target: Option<usize>,
    ) -> Entity {
        let defaults = target.map(|at| Rc::clone(&self.state.defaults[at]));
        Entity {
            kind,
            plugin,
            place: place.clone(),
            own,
            defaults: defaults.unwrap_or_default(),
            is_used: false.into(),
        }
    }
}
