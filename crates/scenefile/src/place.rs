//! Where a field stands in the text of a scene file.
//!
//! The text is walked once, token by token, and need not be sound: what makes no sense is a word
//! like any other.

/// A value in the text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ScenePlace<'a> {
    /// Line, from 1.
    pub(crate) line: usize,
    /// Column in characters, from 1.
    pub(crate) column: usize,
    /// As it is written.
    pub(crate) value: &'a str,
}

/// The names and numbers of a path such as `blockers[0].fill` or `blockers.0.fill`, as far as it is
/// one, without names of variants.
pub(crate) fn steps(path: &str) -> Vec<&str> {
    let in_path = |c: char| c.is_alphanumeric() || "_.[]".contains(c);
    let end = path.find(|c| !in_path(c)).unwrap_or(path.len());
    let steps = path[..end].split(['.', '[', ']']);
    let is_step = |step: &&str| !step.is_empty() && !step.starts_with(char::is_uppercase);
    steps.filter(is_step).collect()
}

/// The value at a path, or the innermost around it that is written.
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
                // A bracket too many closes nothing.
                levels.truncate((depth - 1).max(1));
            }
            ValueKind::Colon => {}
            ValueKind::Word
                if tokens
                    .next_if(|next| next.kind == ValueKind::Colon)
                    .is_some() =>
            {
                // In JSON names stand in quotes.
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
    // All of the file is around what is not written at all: that is no place.
    let found = found.filter(|found| found.steps > 0 || steps.is_empty())?;
    let before = &text[..found.start];
    Some(ScenePlace {
        line: 1 + before.matches('\n').count(),
        column: 1 + before.chars().rev().take_while(|c| *c != '\n').count(),
        value: &text[found.start..found.end],
    })
}

/// The innermost value found so far.
struct InnermostValue {
    /// Steps of the path that lead to it.
    steps: usize,
    start: usize,
    end: usize,
    depth: usize,
}

/// What stands between two brackets.
struct OpenBracket<'a> {
    /// Steps of the path that lead to it; `None` where they lead elsewhere.
    at: Option<usize>,
    /// After a name: a value without a key is then not an element, as in `Hann(0.5)`.
    named: bool,
    index: usize,
    key: Option<&'a str>,
    /// The value begun after the last comma: steps that lead to it.
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

    /// Steps that lead to the next value.
    fn child(&self, steps: &[&str]) -> Option<usize> {
        let at = self.at?;
        let step = steps.get(at);
        match self.key {
            // In JSON a variant is a field.
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
    /// A name, a number or a string.
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

/// Bytes of white space and comments.
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

/// Bytes of a comment that may hold others, or of all the text where it has no end.
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

/// Bytes of a string, plain or raw.
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

/// Bytes up to the next bracket, comma, colon, quote, blank or comment; one character at least if
/// there is one.
pub(crate) fn word(text: &str) -> usize {
    let ends = |c: char| c.is_whitespace() || "()[]{},:\"/".contains(c);
    let first = text.chars().next().map_or(0, char::len_utf8);
    let rest = &text[first..];
    first + rest.find(ends).unwrap_or(rest.len())
}
