//! Causes for which a scene is refused, and notes.

use crate::files::Files;
use crate::note::{Imported, Note, Refused};
use etendue_world::World;
use std::cell::RefCell;
use std::rc::Rc;

/// Maximum number of causes that a report keeps, and maximum number of notes. The limit on
/// messages is needed because each element of a file could give a message.
const MAX_MESSAGES: usize = 100;

/// Maximum number of bytes of a value in a message.
const LONGEST: usize = 60;

/// A position in a file.
#[derive(Clone, Debug)]
pub(crate) struct SourcePlace {
    /// The file, as the scene names it.
    pub(crate) file: Rc<str>,
    /// Line number, counted from 1; 0 for the file as a whole.
    pub(crate) line: usize,
    /// Column in characters, counted from 1.
    pub(crate) column: usize,
}

impl SourcePlace {
    /// Returns the place of a file as a whole.
    pub(crate) fn whole(file: &str) -> Self {
        let (line, column) = (0, 0);
        Self {
            file: file.into(),
            line,
            column,
        }
    }

    fn note(&self, message: String) -> Note {
        Note {
            file: self.file.to_string(),
            line: self.line,
            column: self.column,
            message,
        }
    }
}

/// Collects causes for refusal and notes while a scene is read.
#[derive(Debug, Default)]
pub(crate) struct Report {
    causes: RefCell<Messages>,
    notes: RefCell<Messages>,
}

/// The messages of one kind: the first messages, and the number of further messages.
#[derive(Debug, Default)]
struct Messages {
    kept: Vec<Note>,
    more: usize,
}

impl Messages {
    fn add(&mut self, place: &SourcePlace, message: String) {
        match self.kept.len() < MAX_MESSAGES {
            true => self.kept.push(place.note(message)),
            false => self.more += 1,
        }
    }

    /// Returns the kept messages; the last message gives the number of further messages of the same
    /// kind.
    fn finish(mut self, kind: &str) -> Vec<Note> {
        if let (Some(last), more @ 1..) = (self.kept.last(), self.more) {
            let more = SourcePlace::whole(&last.file).note(format!("and {more} more {kind}"));
            self.kept.push(more);
        }
        self.kept
    }
}

impl Report {
    /// Adds a cause for refusal.
    pub(crate) fn cause(&self, place: &SourcePlace, message: impl Into<String>) {
        self.causes.borrow_mut().add(place, message.into());
    }

    /// Adds a cause for refusal, and returns `None` in place of the value that is refused.
    pub(crate) fn refuse<T>(&self, place: &SourcePlace, message: impl Into<String>) -> Option<T> {
        self.cause(place, message);
        None
    }

    /// Adds a note on an omission or approximation.
    pub(crate) fn note(&self, place: &SourcePlace, message: impl Into<String>) {
        self.notes.borrow_mut().add(place, message.into());
    }

    /// Checks whether the scene is refused.
    pub(crate) fn has_causes(&self) -> bool {
        !self.causes.borrow().kept.is_empty()
    }

    /// Returns the world, or all causes.
    pub(crate) fn finish(self, world: World, files: &Files) -> Result<Imported, Refused> {
        let causes = self.causes.into_inner().finish("causes");
        if causes.is_empty() {
            let notes = self.notes.into_inner().finish("notes");
            Ok(Imported { world, notes })
        } else {
            Err(Refused {
                causes,
                lacks_memory: files.lacks_memory(),
            })
        }
    }
}

/// Quotes a value of the file for a message.
pub(crate) fn quoted(value: &str) -> String {
    let mut end = value.len().min(LONGEST);
    while !value.is_char_boundary(end) {
        end -= 1;
    }
    let more = if end < value.len() { "..." } else { "" };
    format!("`{}{more}`", value[..end].escape_debug())
}
