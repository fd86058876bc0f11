//! Describes a file that is being read, with lines and columns.

use crate::report::SourcePlace;
use std::path::PathBuf;
use std::rc::Rc;

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
        SourcePlace {
            file: Rc::clone(file),
            line: self.line,
            column: self.column,
        }
    }
}
