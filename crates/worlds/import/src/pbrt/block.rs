//! Attribute blocks and object definitions.

use super::build::Builder;
use super::scene::{GraphicsState, Instance, PbrtObject};
use crate::report::{SourcePlace, quoted};

/// Maximum nesting depth of blocks.
const MAX_DEPTH: usize = 1 << 12;

impl Builder<'_> {
    /// Adds a cause for each unclosed block that is nested deeper than a level.
    pub(super) fn refuse_open(&mut self, level: usize) {
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
}
