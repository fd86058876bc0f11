//! Finds the attributes of vertices and faces: further numbers, such as colours, which a PLY file
//! names as Mitsuba does.
//!
//! The properties r, g, b and a, or red, green, blue and alpha, form the attribute `color`. Other
//! properties are named by a prefix, `_` and one character. Adjacent properties with the same prefix
//! form an attribute with the name of the prefix, if their characters are the first ones of `xyzw`,
//! `rgba`, `0123` or `1234`. After `rgba`, the name ends in `_color`.

use super::body::PlyRow;
use super::header::PlyElement;
use crate::detailed::MeshAttribute;
use crate::fault::Fault;
use crate::mesh::check_coordinates;

/// Names of the properties of a colour without a prefix.
const COLORS: [[&str; 4]; 2] = [["r", "g", "b", "a"], ["red", "green", "blue", "alpha"]];
/// Names of properties that belong to no attribute.
const RESERVED: [&str; 12] = [
    "x", "y", "z", "nx", "ny", "nz", "u", "v", "r", "g", "b", "a",
];
/// Characters after the prefix, in the order of the channels.
const SERIES: [&str; 4] = ["xyzw", "rgba", "0123", "1234"];

/// The columns of an attribute.
struct AttributeColumns {
    name: String,
    columns: Vec<usize>,
}

/// Adjacent properties with a common prefix.
struct OpenGroup<'a> {
    prefix: &'a str,
    series: &'a str,
    columns: Vec<usize>,
    is_broken: bool,
}

/// The attributes of an element that are read from the file.
#[derive(Default)]
pub(super) struct AttributeReader {
    /// The names of all attributes of the element.
    pub(super) names: Vec<String>,
    columns: Vec<Vec<usize>>,
    pub(super) read: Vec<MeshAttribute>,
}

impl AttributeReader {
    /// Finds the attributes of an element. The names of attributes begin with `start`, and `wanted`
    /// lists the attributes to read.
    pub(super) fn new(element: &PlyElement, start: &str, wanted: &[String]) -> Self {
        let mut reader = Self::default();
        for AttributeColumns { name, columns } in all(element) {
            let name = format!("{start}{name}");
            if wanted.contains(&name) && !reader.names.contains(&name) {
                reader.read.push(MeshAttribute {
                    name: name.clone(),
                    channels: columns.len(),
                    values: Vec::new(),
                    is_of_vertices: start == "vertex_",
                });
                reader.columns.push(columns);
            }
            reader.names.push(name);
        }
        reader
    }

    /// Appends the values of a row, `times` times.
    pub(super) fn push(
        &mut self,
        row: PlyRow<'_>,
        values: &[Vec<f64>],
        times: usize,
    ) -> Result<(), Fault> {
        for (attribute, columns) in self.read.iter_mut().zip(&self.columns) {
            let first = attribute.values.len();
            for column in columns {
                let place = |_| row.place(&attribute.name);
                attribute
                    .values
                    .extend(check_coordinates([values[*column][0]], place)?);
            }
            let last = attribute.values.len();
            for _ in 1..times {
                attribute.values.extend_from_within(first..last);
            }
            if times == 0 {
                attribute.values.truncate(first);
            }
        }
        Ok(())
    }
}

/// All attributes of an element.
fn all(element: &PlyElement) -> Vec<AttributeColumns> {
    let mut found = Vec::new();
    let color = COLORS.iter().find_map(|[r, g, b, a]| {
        let mut color = element.columns([*r, *g, *b])?.to_vec();
        color.extend(element.column(a));
        Some((color, *r == "red"))
    });
    let is_long = color.as_ref().is_some_and(|(_, is_long)| *is_long);
    if let Some((columns, _)) = color {
        let name = "color".to_owned();
        found.push(AttributeColumns { name, columns });
    }
    let mut open: Option<OpenGroup<'_>> = None;
    for (column, property) in element.properties.iter().enumerate() {
        let name = property.name.as_str();
        let is_color = is_long && COLORS[1].contains(&name);
        if property.length.is_some() || RESERVED.contains(&name) || is_color {
            continue;
        }
        let Some((prefix, character)) = prefix_of(name) else {
            found.extend(open.take().and_then(OpenGroup::close));
            continue;
        };
        if open.as_ref().is_some_and(|group| group.prefix != prefix) {
            found.extend(open.take().and_then(OpenGroup::close));
        }
        match &mut open {
            Some(group) => group.add(column, character),
            None => open = OpenGroup::new(column, prefix, character),
        }
    }
    found.extend(open.and_then(OpenGroup::close));
    found
}

/// Splits a name into the part before the last `_` and the one character after it.
fn prefix_of(name: &str) -> Option<(&str, char)> {
    let (prefix, rest) = name.rsplit_once('_')?;
    let mut characters = rest.chars();
    let character = characters.next()?;
    characters.next().is_none().then_some((prefix, character))
}

impl<'a> OpenGroup<'a> {
    /// Begins a group; `None` if no series begins with the character.
    fn new(column: usize, prefix: &'a str, character: char) -> Option<Self> {
        let series = SERIES.iter().find(|s| s.starts_with(character))?;
        Some(Self {
            prefix,
            series,
            columns: vec![column],
            is_broken: false,
        })
    }

    fn add(&mut self, column: usize, character: char) {
        let next = self.series.chars().nth(self.columns.len());
        self.is_broken |= next != Some(character);
        self.columns.push(column);
    }

    fn close(self) -> Option<AttributeColumns> {
        let end = if self.series == SERIES[1] {
            "_color"
        } else {
            ""
        };
        (!self.is_broken).then(|| AttributeColumns {
            name: format!("{}{end}", self.prefix),
            columns: self.columns,
        })
    }
}
