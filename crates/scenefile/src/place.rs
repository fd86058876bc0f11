//! Locates a field in the text of a scene file.
//!
//! The text is scanned once, token by token, and may be malformed: any unrecognised text counts
//! as a word.

/// A value in the text of a scene file, with its position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ScenePlace<'a> {
    /// Line, from 1.
    pub(crate) line: usize,
    /// Column of the value in characters, counted from 1.
    pub(crate) column: usize,
    /// The value as it is written in the text.
    pub(crate) value: &'a str,
}

/// A path such as `blockers[0].fill` in the notation of `--set`: `blockers.0.fill`.
#[must_use]
pub fn dotted(path: &str) -> String {
    path.replace('[', ".").replace(']', "")
}

/// Splits a path such as `blockers[0].fill` or `blockers.0.fill` into names and indices. Names of
/// variants are left out, and the result ends before the first invalid name.
pub(crate) fn steps(path: &str) -> Vec<&str> {
    let in_path = |c: char| c.is_alphanumeric() || "_.[]".contains(c);
    let end = path.find(|c| !in_path(c)).unwrap_or(path.len());
    let steps = path[..end].split(['.', '[', ']']);
    let is_step = |step: &&str| !step.is_empty() && !step.starts_with(char::is_uppercase);
    steps.filter(is_step).collect()
}

/// The value at a path or, if it is not written, the innermost enclosing value that is
/// written.
pub(crate) fn find<'a>(text: &'a str, path: &str) -> Option<ScenePlace<'a>> {
    let steps = steps(path);
    let mut found: Option<InnermostValue> = None;
    let mut levels = vec![OpenBracket::new(Some(0), true)];
    let mut tokens = RonTokens { text, at: 0 }.peekable();
    while let Some(token) = tokens.next() {
        let depth = levels.len();
        let level = levels.last_mut()?;
        match token.kind {
            ValueKind::Comma => {
                *level = OpenBracket {
                    index: level.index + 1,
                    ..OpenBracket::new(level.at, level.named)
                }
            }
            ValueKind::Close => {
                // A closing bracket without an opening bracket has no effect.
                levels.truncate((depth - 1).max(1));
            }
            ValueKind::Colon => {}
            ValueKind::Word
                if tokens
                    .next_if(|next| next.kind == ValueKind::Colon)
                    .is_some() =>
            {
                // In JSON, names are quoted.
                level.key = Some(text[token.start..token.end].trim_matches('"'));
                continue;
            }
            ValueKind::Word | ValueKind::Open => {
                let is_named = level.value.is_some();
                let at = level.value.unwrap_or_else(|| level.child(&steps));
                level.value = Some(at);
                let best = found.as_ref().map(|found| found.steps);
                if let Some(steps) = at.filter(|at| best.is_none_or(|best| *at > best)) {
                    let RonToken { start, end, .. } = token;
                    found = Some(InnermostValue {
                        steps,
                        start,
                        end,
                        depth,
                    });
                }
                if token.kind == ValueKind::Open {
                    levels.push(OpenBracket::new(at, is_named));
                }
            }
        }
        if let Some(found) = &mut found {
            let depth = levels.len();
            if depth < found.depth || (depth == found.depth && token.kind == ValueKind::Comma) {
                break;
            }
            found.end = token.end;
        }
    }
    // If a field is not written and only the entire file encloses it, no position is returned,
    // because it would not help the user.
    let found = found.filter(|found| found.steps > 0 || steps.is_empty())?;
    let before = &text[..found.start];
    Some(ScenePlace {
        line: 1 + before.matches('\n').count(),
        column: 1 + before.chars().rev().take_while(|c| *c != '\n').count(),
        value: &text[found.start..found.end],
    })
}

/// The innermost enclosing value found so far.
struct InnermostValue {
    /// The number of steps of the path that lead to this value.
    steps: usize,
    start: usize,
    end: usize,
    depth: usize,
}

/// The text between an opening and a closing bracket.
struct OpenBracket<'a> {
    /// The number of steps of the path that lead to the bracket; `None` if the bracket is not on
    /// the path.
    at: Option<usize>,
    /// Whether a name precedes the bracket, as in `Hann(0.5)`. If a name precedes the bracket, a
    /// value without a key is not an element of a list.
    named: bool,
    index: usize,
    key: Option<&'a str>,
    /// The number of steps of the path to the value that began after the last comma.
    value: Option<Option<usize>>,
}

impl OpenBracket<'_> {
    fn new(at: Option<usize>, named: bool) -> Self {
        Self {
            at,
            named,
            index: 0,
            key: None,
            value: None,
        }
    }

    /// The number of steps of the path that lead to the next value.
    fn child(&self, steps: &[&str]) -> Option<usize> {
        let at = self.at?;
        let step = steps.get(at);
        match self.key {
            // In JSON, a variant is written as a field.
            Some(key) if key.starts_with(char::is_uppercase) => Some(at),
            Some(key) => (step == Some(&key)).then_some(at + 1),
            None if self.named => (self.index == 0).then_some(at),
            None => (step?.parse() == Ok(self.index)).then_some(at + 1),
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ValueKind {
    Open,
    Close,
    Comma,
    Colon,
    /// A name, a number or a quoted string.
    Word,
}

#[derive(Clone, Copy)]
struct RonToken {
    kind: ValueKind,
    start: usize,
    end: usize,
}

struct RonTokens<'a> {
    text: &'a str,
    at: usize,
}

impl Iterator for RonTokens<'_> {
    type Item = RonToken;

    fn next(&mut self) -> Option<RonToken> {
        self.at += blank(&self.text[self.at..]);
        let start = self.at;
        let rest = &self.text[start..];
        let first = rest.chars().next()?;
        let (kind, length) = match first {
            '(' | '[' | '{' => (ValueKind::Open, 1),
            ')' | ']' | '}' => (ValueKind::Close, 1),
            ',' => (ValueKind::Comma, 1),
            ':' => (ValueKind::Colon, 1),
            _ => (ValueKind::Word, string(rest).unwrap_or_else(|| word(rest))),
        };
        self.at += length;
        Some(RonToken {
            kind,
            start,
            end: self.at,
        })
    }
}

/// The length in bytes of white space and comments.
fn blank(text: &str) -> usize {
    let mut rest = text.trim_start();
    loop {
        let comment = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if rest.starts_with("/*") {
            block(rest)
        } else {
            return text.len() - rest.len();
        };
        rest = rest[comment..].trim_start();
    }
}

/// Returns the length in bytes of a comment, which may contain comments; if the comment is not
/// closed, returns the length of the remaining text.
fn block(text: &str) -> usize {
    let mut depth = 0;
    let bytes = text.as_bytes();
    let mut at = 0;
    while at + 1 < bytes.len() {
        match &bytes[at..at + 2] {
            b"/*" => depth += 1,
            b"*/" => depth -= 1,
            _ => {
                at += 1;
                continue;
            }
        }
        at += 2;
        if depth == 0 {
            return at;
        }
    }
    text.len()
}

/// The length in bytes of a string, plain or raw.
fn string(text: &str) -> Option<usize> {
    let plain = text.strip_prefix('"');
    if let Some(inside) = plain {
        let mut escaped = false;
        let end = inside.find(|c| {
            let ends = c == '"' && !escaped;
            escaped = c == '\\' && !escaped;
            ends
        });
        return Some(end.map_or(text.len(), |end| end + 2));
    }
    let hashes = text.strip_prefix('r')?;
    let inside = hashes.trim_start_matches('#');
    let fence = &hashes[..hashes.len() - inside.len()];
    let end = inside.strip_prefix('"')?.find(&format!("\"{fence}"));
    let open = 2 + fence.len();
    Some(end.map_or(text.len(), |end| open + end + 1 + fence.len()))
}

/// The number of bytes before the next bracket, comma, colon, quote, blank or comment. If
/// the text is not empty, at least its first character is counted.
pub(crate) fn word(text: &str) -> usize {
    let ends = |c: char| c.is_whitespace() || "()[]{},:\"/".contains(c);
    let first = text.chars().next().map_or(0, char::len_utf8);
    let rest = &text[first..];
    first + rest.find(ends).unwrap_or(rest.len())
}
