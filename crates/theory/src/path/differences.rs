//! Differences between the light fields of a path with a parameter increased and decreased.

use super::{AtMask, MaskCrossings, Observed, PreparedPath};
use crate::model::{Over, ShiftedModels};
use crate::nets::{self, DIMENSIONS, Integrand, RayNode};
use crate::predicted::{NetMean, Predicted};

/// A light field of a path. Its rays are functions of a point of the unit cube.
pub(super) trait DrawnField: Sync {
    /// The path that light follows.
    fn path(&self) -> &PreparedPath<'_>;

    /// The number of coordinates of a point on which a ray depends.
    fn dimensions(&self) -> usize {
        6
    }

    /// The ray for a point of the unit cube, or `None` if it does not arrive.
    fn draw(&self, at: &[f64; DIMENSIONS], at_mask: AtMask<'_>) -> Option<RayNode>;

    /// Checks whether the field has a first-order chain.
    fn has_chain(&self) -> bool {
        false
    }

    /// The ray of the chain and the exact ray for a point of the unit cube.
    fn beside_chain(&self, _at: &[f64; DIMENSIONS]) -> [Option<RayNode>; 2] {
        [None; 2]
    }
}

/// The difference between the chain of a field, if it has one, and the field, and the differences
/// with respect to several parameters.
pub(super) struct Differences<'a, F> {
    field: &'a F,
    /// For each parameter, the difference between its two values, and the fields with them.
    moved: Vec<(f64, ShiftedFields<'a, F>)>,
}

/// The fields with a parameter increased and decreased.
enum ShiftedFields<'a, F> {
    /// The parameter belongs to a mask. It moves no ray, and changes what passes of each.
    Masks([PreparedPath<'a>; 2]),
    /// All rays are drawn anew.
    Rays([F; 2]),
    /// The light of one side does not arrive.
    Dark,
}

impl<'a, F: DrawnField> Differences<'a, F> {
    /// Builds the differences of a field. `of` returns the field of a changed model.
    pub(super) fn new(
        field: &'a F,
        moved: &'a [ShiftedModels<Observed>],
        of: impl Fn(&'a Observed) -> Option<F>,
    ) -> Self {
        let sides = |moved: &'a ShiftedModels<Observed>| {
            let [above, below] = &moved.sides;
            if moved.moves_mask {
                return ShiftedFields::Masks(
                    [above, below].map(|view| PreparedPath::new(&view.system)),
                );
            }
            match (of(above), of(below)) {
                (Some(above), Some(below)) => ShiftedFields::Rays([above, below]),
                _ => ShiftedFields::Dark,
            }
        };
        Self {
            field,
            moved: moved.iter().map(|one| (one.apart, sides(one))).collect(),
        }
    }

    /// A prediction with the differences, which are accurate to about a per cent if the budget
    /// suffices, and have the length that they would have without noise.
    pub(super) fn complete(&self, found: Predicted, over: Over<'_>) -> Predicted {
        let mut means = nets::means(self, (over.0, over.1), &found).into_iter();
        Predicted {
            to_first_order: self.field.has_chain().then(|| means.next()).flatten(),
            derivatives: means.map(NetMean::without_noise).collect(),
            ..found
        }
    }
}

impl<F: DrawnField> Integrand for Differences<'_, F> {
    fn fields(&self) -> usize {
        usize::from(self.field.has_chain()) + self.moved.len()
    }

    fn dimensions(&self) -> usize {
        self.field.dimensions()
    }

    fn rays(&self) -> usize {
        2
    }

    fn nodes(&self, at: &[f64; DIMENSIONS], wanted: &[bool], nodes: &mut [RayNode]) {
        let mut fields = wanted.iter().zip(nodes.chunks_mut(2));
        if self.field.has_chain()
            && let Some((true, nodes)) = fields.next()
        {
            difference(self.field.beside_chain(at), 1.0, nodes);
        }
        let fields = self.moved.iter().zip(fields);
        let fields = fields.filter_map(|(one, (wanted, nodes))| wanted.then_some((one, nodes)));
        // The ray of the unchanged field, drawn once for all masks.
        let mut unmasked = None;
        for ((apart, sides), nodes) in fields {
            let sides = match sides {
                ShiftedFields::Masks(paths) => {
                    let (ray, crossings) = unmasked.get_or_insert_with(|| {
                        let mut crossings = MaskCrossings::default();
                        let ray = self.field.draw(at, &mut crossings.record());
                        (ray, crossings)
                    });
                    paths.each_ref().map(|path| {
                        let RayNode { z, weight } = (*ray)?;
                        let weight = weight * path.through(crossings);
                        Some(RayNode { z, weight })
                    })
                }
                ShiftedFields::Rays(sides) => sides
                    .each_ref()
                    .map(|side| side.draw(at, &mut side.path().at_mask())),
                ShiftedFields::Dark => [None; 2],
            };
            difference(sides, *apart, nodes);
        }
    }
}

/// Writes the difference between two rays of increased and decreased parameters, `apart` from each
/// other, to two nodes. A ray that does not arrive contributes nothing, and rays with the same
/// coordinates become one.
fn difference(sides: [Option<RayNode>; 2], apart: f64, nodes: &mut [RayNode]) {
    if let [Some(above), Some(below)] = sides
        && above.z.map(f64::to_bits) == below.z.map(f64::to_bits)
    {
        let weight = (above.weight - below.weight) / apart;
        nodes[0] = RayNode { weight, ..above };
        return;
    }
    for ((side, sign), node) in sides.into_iter().zip([1.0, -1.0]).zip(nodes) {
        if let Some(RayNode { z, weight }) = side {
            let weight = sign * weight / apart;
            *node = RayNode { z, weight };
        }
    }
}
