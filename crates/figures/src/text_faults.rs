//! Finds texts of a drawing that overlap, that leave the page, or that are too small to read.

use crate::figure::{Error, Figure, options};
use crate::sizes::LEAST_TEXT;
use resvg::usvg;

/// Texts may overlap, or leave the page, by this length in SVG units, a tenth of a point.
const TOLERANCE: f32 = 0.13;

impl Figure {
    /// Names the texts that overlap, that are not wholly on the page, or that are smaller than
    /// six points. Empty if all can be read.
    ///
    /// # Errors
    /// If the SVG cannot be read back.
    pub fn text_faults(&self) -> Result<Vec<String>, Error> {
        text_faults(&self.svg)
    }
}

/// Names the texts of an SVG that overlap, that are not wholly on the page, or that are smaller
/// than six points at 96 units to the inch.
///
/// # Errors
/// If the SVG cannot be read.
pub fn text_faults(svg: &str) -> Result<Vec<String>, Error> {
    let tree = usvg::Tree::from_str(svg, &options())?;
    let size = tree.size();
    let texts = texts(tree.root());
    let mut faults = Vec::new();
    for (i, (text, a, letters)) in texts.iter().enumerate() {
        let left = a.left().min(a.top()) < -TOLERANCE;
        if left || a.right() > size.width() + TOLERANCE || a.bottom() > size.height() + TOLERANCE {
            faults.push(format!("{text:?} leaves the page"));
        }
        if f64::from(*letters) < LEAST_TEXT - 1e-6 {
            faults.push(format!("{text:?} has letters of {letters} units"));
        }
        for (other, b, _) in &texts[i + 1..] {
            let across = a.right().min(b.right()) - a.left().max(b.left());
            let down = a.bottom().min(b.bottom()) - a.top().max(b.top());
            if across.min(down) > TOLERANCE {
                faults.push(format!("{text:?} overlaps {other:?}"));
            }
        }
    }
    Ok(faults)
}

/// The texts of a group with the boxes of their ink, and the size of their smallest letters.
fn texts(group: &usvg::Group) -> Vec<(String, usvg::Rect, f32)> {
    let mut found = Vec::new();
    for node in group.children() {
        match node {
            usvg::Node::Group(inner) => found.extend(texts(inner)),
            usvg::Node::Text(text) => {
                let chunks = text.chunks();
                let content = chunks.iter().map(|chunk| chunk.text()).collect();
                let spans = chunks.iter().flat_map(|chunk| chunk.spans());
                let sizes = spans.map(|span| span.font_size().get());
                let smallest = sizes.fold(f32::INFINITY, f32::min);
                found.push((content, text.abs_bounding_box(), smallest));
            }
            _ => {}
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planted_faults_are_found() {
        let faults = |texts: &str| {
            let svg = format!(
                "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"90\" height=\"50\">{texts}</svg>"
            );
            text_faults(&svg).unwrap()
        };
        let text = |x: f64, size: f64| {
            format!("<text x=\"{x}\" y=\"20\" font-size=\"{size}\">word</text>")
        };
        assert!(faults(&(text(2.0, 12.0) + &text(45.0, 12.0))).is_empty());
        assert_eq!(
            faults(&(text(2.0, 12.0) + &text(25.0, 12.0))),
            ["\"word\" overlaps \"word\""]
        );
        assert_eq!(faults(&text(70.0, 12.0)), ["\"word\" leaves the page"]);
        assert_eq!(
            faults(&text(2.0, 7.5)),
            ["\"word\" has letters of 7.5 units"]
        );
    }
}
