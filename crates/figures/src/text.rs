//! Markup: `*italic*`, `_{subscript}`, `^{superscript}`.

use crate::sizes::LEAST_TEXT;

/// A run of text in one style.
#[derive(Clone, Debug, PartialEq)]
struct TextRun {
    text: String,
    italic: bool,
    level: TextLevel,
}

/// Vertical position of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum TextLevel {
    Below,
    Line,
    Above,
}

impl TextLevel {
    /// The offset below the baseline, relative to the text size.
    fn depth(self) -> f64 {
        match self {
            Self::Below => 0.2,
            Self::Line => 0.0,
            Self::Above => -0.36,
        }
    }
}

/// Font size of subscripts and superscripts, relative to the font size of the text.
const SCRIPT_SIZE: f64 = 0.72;

/// The SVG content for markup at the font size `size`, in SVG units.
///
/// Subscripts and superscripts are shifted by `dy`, because some browsers do not support
/// `baseline-shift`.
pub(crate) fn spans(markup: &str, size: f64) -> String {
    let mut content = String::new();
    let mut level = TextLevel::Line;
    for run in runs(markup) {
        let mut attributes = String::new();
        if run.italic {
            attributes += " font-style=\"italic\"";
        }
        if run.level != TextLevel::Line {
            let size = (size * SCRIPT_SIZE).max(LEAST_TEXT);
            attributes += &format!(" font-size=\"{size:.2}\"");
        }
        if run.level != level {
            let down = size * (run.level.depth() - level.depth());
            attributes += &format!(" dy=\"{down:.2}\"");
        }
        level = run.level;
        let text = escape(&run.text);
        if attributes.is_empty() {
            content += &text;
        } else {
            content += &format!("<tspan{attributes}>{text}</tspan>");
        }
    }
    content
}

/// The text of markup without its marks.
pub(crate) fn plain(markup: &str) -> String {
    runs(markup).into_iter().map(|run| run.text).collect()
}

/// Estimates the width of `text` at the font size `size`, in SVG units. The error of the estimate
/// is about 7 %, which is small enough for layout.
pub(crate) fn width(text: &str, size: f64) -> f64 {
    let ems: f64 = text.chars().map(advance).sum();
    ems * size
}

/// Returns `text`, possibly shortened, and a font size at which its width is at most `room`. The
/// size is reduced first; then the text is shortened.
pub(crate) fn fit(text: &str, size: f64, room: f64) -> (String, f64) {
    let smallest = size.min(LEAST_TEXT);
    let fitting = (size * room / width(text, size).max(1e-9)).clamp(smallest, size);
    if width(text, fitting) <= room * (1.0 + 1e-9) {
        return (text.to_owned(), fitting);
    }
    let mut kept: Vec<char> = text.chars().collect();
    while !kept.is_empty() && width(&kept.iter().collect::<String>(), smallest) + smallest > room {
        kept.pop();
    }
    let kept: String = kept.into_iter().collect();
    (format!("{}…", kept.trim_end()), smallest)
}

/// Breaks markup at spaces into lines that are at most `room` wide. A line is wider only if a
/// single word is wider.
pub(crate) fn lines(markup: &str, size: f64, room: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in markup.split(' ').filter(|word| !word.is_empty()) {
        match lines.last_mut() {
            Some(line)
                if is_open(line) || width(&plain(&format!("{line} {word}")), size) <= room =>
            {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// Checks whether markup ends inside italics, a subscript or a superscript.
fn is_open(markup: &str) -> bool {
    let count = |c| markup.matches(c).count();
    count('*') % 2 == 1 || count('{') != count('}')
}

/// Replaces the characters that are special in XML, and the characters that XML forbids.
pub(crate) fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out += "&amp;",
            '<' => out += "&lt;",
            '>' => out += "&gt;",
            '"' => out += "&quot;",
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

/// The advance width of a letter of DejaVu Sans, in em, or the mean of similar letters.
fn advance(c: char) -> f64 {
    match c {
        'i' | 'j' | 'l' | '\'' | 'I' => 0.28,
        '.' | ',' | ':' | ';' | ' ' | '|' | '/' => 0.33,
        'f' | 't' | 'r' | '-' | '(' | ')' => 0.39,
        'c' | 's' | 'z' => 0.53,
        '²' | '³' | '¹' | '⁰'..='⁹' | '⁻' => 0.43,
        'm' | 'M' | 'W' | '@' | '%' => 0.95,
        'w' | '+' | '−' | '=' | '<' | '>' | '±' => 0.83,
        c if c.is_uppercase() => 0.70,
        _ => 0.61,
    }
}

/// The runs of markup; unpaired marks are plain text.
fn runs(markup: &str) -> Vec<TextRun> {
    let mut runs = Vec::new();
    let mut rest = markup;
    while let Some((before, run, after)) = next_mark(rest) {
        push(&mut runs, before);
        runs.push(run);
        rest = after;
    }
    push(&mut runs, rest);
    runs
}

fn push(runs: &mut Vec<TextRun>, text: &str) {
    if !text.is_empty() {
        runs.push(TextRun {
            text: text.to_owned(),
            italic: false,
            level: TextLevel::Line,
        });
    }
}

/// The first complete mark: the text before the mark, the marked run, and the text after
/// the mark.
fn next_mark(text: &str) -> Option<(&str, TextRun, &str)> {
    let kinds = [
        ("*", "*", true, TextLevel::Line),
        ("_{", "}", false, TextLevel::Below),
        ("^{", "}", false, TextLevel::Above),
    ];
    kinds
        .into_iter()
        .filter_map(|(open, close, italic, level)| {
            let (before, tail) = text.split_once(open)?;
            let (inner, after) = tail.split_once(close)?;
            let run = TextRun {
                text: inner.to_owned(),
                italic,
                level,
            };
            Some((before, run, after))
        })
        .min_by_key(|(before, ..)| before.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn markup_becomes_spans_and_back_to_plain_text() {
        assert_eq!(plain("|*S*|^{2} of Ω_{x}"), "|S|2 of Ωx");
        assert_eq!(
            spans("*a*<b^{2}c", 10.0),
            "<tspan font-style=\"italic\">a</tspan>&lt;b\
             <tspan font-size=\"8.00\" dy=\"-3.60\">2</tspan><tspan dy=\"3.60\">c</tspan>"
        );
    }

    #[test]
    fn unpaired_marks_are_text() {
        assert_eq!(plain("before_blockers 2 * 3"), "before_blockers 2 * 3");
        assert_eq!(plain("a^{b"), "a^{b");
    }

    #[test]
    fn lines_break_between_words_and_never_within_marks() {
        let broken = lines("one *two three* four^{2} five", 10.0, 80.0);
        assert_eq!(broken, ["one *two three*", "four^{2} five"]);
        assert!(lines("", 10.0, 80.0).is_empty());
    }

    #[test]
    fn texts_are_fitted_to_their_room() {
        assert_eq!(fit("light", 12.0, 100.0), ("light".to_owned(), 12.0));
        let (text, size) = fit("a very long name of a virtual plane", 12.0, 100.0);
        assert!(text.ends_with('…') && width(&text, size) <= 110.0, "{text}");
        assert_eq!(fit("name", 12.0, 0.0).0, "…");
    }

    /// Compares the estimated width of typical texts with their width in the font DejaVu Sans.
    #[test]
    fn estimated_widths_are_near_the_true_ones() {
        for text in [
            "before_blockers",
            "receiver",
            "after blockers",
            "−0.25",
            "light field",
            "ν (cycles/slope)",
            "relative to its peak",
            "p = 0.43, pass",
            "W² m⁻⁴ sr⁻²",
        ] {
            let svg = format!(
                "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"900\" height=\"50\">\
                 <text x=\"5\" y=\"20\" font-size=\"12\" font-family=\"DejaVu Sans\">{text}</text></svg>"
            );
            let options = crate::figure::options();
            let tree = resvg::usvg::Tree::from_str(&svg, &options).unwrap();
            let truth = f64::from(tree.root().bounding_box().width());
            let ratio = width(text, 12.0) / truth;
            assert!((0.93..1.09).contains(&ratio), "{text}: {ratio}"); // the 7 % promised
        }
    }
}
