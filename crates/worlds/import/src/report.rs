//! Causes for which a scene is refused, notes, and the result of an import.

use crate::files::Files;
use etendue_world::World;
use std::cell::RefCell;
use std::collections::HashSet;
use std::fmt;
use std::path::Path;
use std::rc::Rc;

/// Maximum number of causes that a report keeps, and maximum number of notes. The limit on
/// messages is needed because each element of a file could give a message.
const MAX_MESSAGES: usize = 100;

/// Maximum number of bytes of a value in a message.
const LONGEST: usize = 60;

/// A position in a file.
#[derive(Clone, Debug, Default)]
pub(crate) struct SourcePlace {
    /// The file, as the scene names it.
    pub(crate) file: Rc<str>,
    /// Line number, counted from 1; 0 for the file as a whole.
    pub(crate) line: usize,
    /// Column in characters, counted from 1.
    pub(crate) column: usize,
}

impl SourcePlace {
    /// The place of a file as a whole.
    pub(crate) fn whole(file: &str) -> Self {
        Self {
            file: file.into(),
            ..Self::default()
        }
    }

    /// A place in a file.
    pub(crate) fn at(file: &Rc<str>, line: usize, column: usize) -> Self {
        let file = Rc::clone(file);
        Self { file, line, column }
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
    /// The messages that are given only once, with their places.
    told: RefCell<HashSet<String>>,
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

    /// The kept messages; the last message gives the number of further messages of the same
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

    /// Returns a value, or adds a cause for refusal that states its error.
    pub(crate) fn accept<T>(&self, place: &SourcePlace, value: Result<T, String>) -> Option<T> {
        value.map_err(|error| self.cause(place, error)).ok()
    }

    /// Adds a note on an omission or approximation.
    pub(crate) fn note(&self, place: &SourcePlace, message: impl Into<String>) {
        self.notes.borrow_mut().add(place, message.into());
    }

    /// Adds a note only once, even if the object that the note concerns is used several times.
    pub(crate) fn note_once(&self, place: &SourcePlace, message: &str) {
        if self.is_first(place, message) {
            self.note(place, message);
        }
    }

    /// Checks whether a message was not given before at a place.
    pub(crate) fn is_first(&self, place: &SourcePlace, message: &str) -> bool {
        self.told
            .borrow_mut()
            .insert(place.note(message.to_owned()).to_string())
    }

    /// Checks whether the scene is refused.
    pub(crate) fn has_causes(&self) -> bool {
        !self.causes.borrow().kept.is_empty()
    }

    /// The world, or all causes.
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

/// A message about a position in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// The file, as the scene names it.
    pub file: String,
    /// Line number, counted from 1; 0 if the message concerns the file as a whole.
    pub line: usize,
    /// Column in characters, counted from 1.
    pub column: usize,
    /// The message.
    pub message: String,
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            0 => write!(f, "{}: {}", self.file, self.message),
            line => write!(f, "{}:{line}:{}: {}", self.file, self.column, self.message),
        }
    }
}

/// An imported scene.
#[derive(Clone, Debug)]
pub struct Imported {
    /// The world.
    pub world: World,
    /// Notes on omissions and approximations, in the order of reading; if there are too many notes,
    /// the last note states the number of further notes.
    pub notes: Vec<Note>,
}

/// The reasons why a scene is refused: all causes at once.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refused {
    /// The causes, at least one, in the order of reading.
    pub causes: Vec<Note>,
    /// Whether the free memory of the machine did not suffice to read the scene.
    pub lacks_memory: bool,
}

impl Refused {
    /// Creates a refusal with one cause that concerns a file as a whole.
    pub(crate) fn because(file: &Path, message: impl Into<String>) -> Self {
        let place = SourcePlace::whole(&file.display().to_string());
        Self {
            causes: vec![place.note(message.into())],
            lacks_memory: false,
        }
    }
}

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let causes: Vec<String> = self.causes.iter().map(Note::to_string).collect();
        f.write_str(&causes.join("\n"))
    }
}

impl std::error::Error for Refused {}

/// The value of a keyword; `Err` lists the allowed keywords.
pub(crate) fn keyword<T: Copy>(name: &str, word: &str, allowed: &[(&str, T)]) -> Result<T, String> {
    let found = allowed.iter().find(|(known, _)| *known == word);
    found.map(|(_, value)| *value).ok_or_else(|| {
        let words: Vec<&str> = allowed.iter().map(|(known, _)| *known).collect();
        let word = quoted(word);
        format!("{name} is {word}; allowed: {}", words.join(", "))
    })
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
