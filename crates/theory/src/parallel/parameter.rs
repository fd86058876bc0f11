use crate::{Chain, Operator};
use etendue_field::{Light, Mask, Shape};

/// A number of a [`Chain`] that a measurement may be asked for. Indices are those of operators.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parameter {
    /// The side of a rectangular light along X, its other side keeping the proportion, or the
    /// radius of a disc.
    SourceSize,
    /// The exponent n of a spot's cosⁿθ.
    SpotExponent,
    /// The distance of a travel.
    Travel(usize),
    /// The side along X, or the radius, of the first shape of an opaque mask; all its shapes keep
    /// the proportion, all centres stay.
    BlockerSide(usize),
    /// The edge of the first half-plane of an opaque mask; nothing else moves.
    HalfPlaneEdge(usize),
    /// The frequency of a grating.
    GratingFrequency(usize),
    /// The phase of a grating.
    GratingPhase(usize),
}

impl Chain {
    /// All parameters, in the order light meets them.
    #[must_use]
    pub fn parameters(&self) -> Vec<Parameter> {
        let mut all = Vec::new();
        if let Light::Area { exponent, .. } = self.source.light {
            all.push(Parameter::SourceSize);
            all.extend((exponent > 0.0).then_some(Parameter::SpotExponent));
        }
        for (i, operator) in self.operators.iter().enumerate() {
            match operator {
                Operator::Travel { .. } => all.push(Parameter::Travel(i)),
                Operator::Visibility { mask, .. } => all.extend(of_mask(mask, i)),
                Operator::Cosine { .. } | Operator::Diffuse { .. } => {}
            }
        }
        all
    }

    /// The parameter in words, e.g. "travel light to blockers".
    ///
    /// # Panics
    /// When the parameter is of another chain.
    #[must_use]
    pub fn name(&self, parameter: Parameter) -> String {
        let source = &self.source.name;
        match (parameter, self.operator(parameter)) {
            (Parameter::SourceSize, _) => match &self.source.light {
                Light::Area { shape, .. } => format!("{} of {source}", size_word(shape)),
                _ => foreign(parameter),
            },
            (Parameter::SpotExponent, _) => format!("exponent of {source}"),
            (_, Some(Operator::Travel { from, to, .. })) => format!("travel {from} to {to}"),
            (_, Some(Operator::Visibility { name, mask })) => match (parameter, mask) {
                (Parameter::BlockerSide(_), Mask::Opaque { shapes, .. }) if !shapes.is_empty() => {
                    format!("{} of {name}", size_word(&shapes[0]))
                }
                (Parameter::HalfPlaneEdge(_), _) => format!("edge of {name}"),
                (Parameter::GratingFrequency(_), _) => format!("frequency of {name}"),
                (Parameter::GratingPhase(_), _) => format!("phase of {name}"),
                _ => foreign(parameter),
            },
            _ => foreign(parameter),
        }
    }

    /// The unit of a parameter; empty if it is a number.
    #[must_use]
    pub fn unit(&self, parameter: Parameter) -> &'static str {
        match parameter {
            Parameter::SourceSize
            | Parameter::Travel(_)
            | Parameter::BlockerSide(_)
            | Parameter::HalfPlaneEdge(_) => "m",
            Parameter::GratingFrequency(_) => "1/m",
            Parameter::GratingPhase(_) => "rad",
            Parameter::SpotExponent => "",
        }
    }

    /// Its value, in its unit.
    ///
    /// # Panics
    /// When the parameter is of another chain.
    #[must_use]
    pub fn value(&self, parameter: Parameter) -> f64 {
        let mut value = None;
        self.clone().change(parameter, |current| {
            value = Some(current);
            current
        });
        value.unwrap_or_else(|| foreign(parameter))
    }

    /// The same chain with another value of one parameter, in its unit.
    ///
    /// # Panics
    /// When the parameter is of another chain.
    #[must_use]
    pub fn with(&self, parameter: Parameter, value: f64) -> Self {
        let mut chain = self.clone();
        chain.change(parameter, |_| value);
        chain
    }

    /// Puts `new(value)` in the place of the value of a parameter.
    fn change(&mut self, parameter: Parameter, new: impl FnOnce(f64) -> f64) {
        match (parameter, &mut self.source.light) {
            (Parameter::SourceSize, Light::Area { shape, .. }) => {
                resize(std::slice::from_mut(shape), new);
            }
            (Parameter::SpotExponent, Light::Area { exponent, .. }) => *exponent = new(*exponent),
            _ => match self.operator_mut(parameter) {
                Some(operator) => operator.change(parameter, new),
                None => foreign(parameter),
            },
        }
    }

    fn operator(&self, parameter: Parameter) -> Option<&Operator> {
        self.operators.get(parameter.index()?)
    }

    fn operator_mut(&mut self, parameter: Parameter) -> Option<&mut Operator> {
        self.operators.get_mut(parameter.index()?)
    }
}

impl Operator {
    fn change(&mut self, parameter: Parameter, new: impl FnOnce(f64) -> f64) {
        match (parameter, self) {
            (Parameter::Travel(_), Self::Travel { distance, .. }) => *distance = new(*distance),
            (_, Self::Visibility { mask, .. }) => match (parameter, mask) {
                (Parameter::BlockerSide(_), Mask::Opaque { shapes, .. }) if !shapes.is_empty() => {
                    resize(shapes, new);
                }
                (Parameter::HalfPlaneEdge(_), Mask::Opaque { half_planes, .. })
                    if !half_planes.is_empty() =>
                {
                    half_planes[0].edge = new(half_planes[0].edge);
                }
                (Parameter::GratingFrequency(_), Mask::Grating(grating)) => {
                    grating.frequency = new(grating.frequency);
                }
                (Parameter::GratingPhase(_), Mask::Grating(grating)) => {
                    grating.phase = new(grating.phase);
                }
                _ => foreign(parameter),
            },
            _ => foreign(parameter),
        }
    }
}

impl Parameter {
    /// Index of its operator; `None` for those of the source.
    fn index(self) -> Option<usize> {
        match self {
            Self::SourceSize | Self::SpotExponent => None,
            Self::Travel(i)
            | Self::BlockerSide(i)
            | Self::HalfPlaneEdge(i)
            | Self::GratingFrequency(i)
            | Self::GratingPhase(i) => Some(i),
        }
    }
}

fn of_mask(mask: &Mask, index: usize) -> Vec<Parameter> {
    match mask {
        Mask::Opaque {
            shapes,
            half_planes,
        } => {
            let side = (!shapes.is_empty()).then_some(Parameter::BlockerSide(index));
            let edge = (!half_planes.is_empty()).then_some(Parameter::HalfPlaneEdge(index));
            side.into_iter().chain(edge).collect()
        }
        Mask::Grating(_) => vec![
            Parameter::GratingFrequency(index),
            Parameter::GratingPhase(index),
        ],
    }
}

/// What the size of a shape is called.
fn size_word(shape: &Shape) -> &'static str {
    match shape {
        Shape::Rectangle(_) => "side",
        Shape::Disc(_) => "radius",
    }
}

/// Gives the first shape a new side along X or radius, and all of them the same factor.
fn resize(shapes: &mut [Shape], new: impl FnOnce(f64) -> f64) {
    let size = match &shapes[0] {
        Shape::Rectangle(rectangle) => rectangle.size[0],
        Shape::Disc(disc) => disc.radius,
    };
    let factor = new(size) / size;
    for shape in shapes {
        match shape {
            Shape::Rectangle(rectangle) => rectangle.size = rectangle.size.map(|s| s * factor),
            Shape::Disc(disc) => disc.radius *= factor,
        }
    }
}

fn foreign(parameter: Parameter) -> ! {
    panic!("this chain has no parameter {parameter:?}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::*;
    use etendue_field::{HalfPlane, Rectangle};

    #[test]
    fn parameters_follow_the_light() {
        let chain = chain(0.2, &[(1.0, blockers(2, 0.3, 0.1)), (0.5, vec![])]);
        let names: Vec<_> = chain.parameters().iter().map(|&p| chain.name(p)).collect();
        assert_eq!(
            names,
            [
                "side of light",
                "travel a to b",
                "side of b",
                "travel b to c"
            ]
        );
    }

    #[test]
    #[expect(clippy::float_cmp, reason = "the value put in is the value read back")]
    fn with_sets_one_value() {
        let chain = chain(0.2, &[(1.0, blockers(2, 0.3, 0.1)), (0.5, vec![])]);
        for p in chain.parameters() {
            let other = chain.with(p, 0.5);
            assert_eq!(other.value(p), 0.5);
            for q in chain.parameters().into_iter().filter(|&q| q != p) {
                assert_eq!(other.value(q), chain.value(q));
            }
        }
    }
    #[test]
    fn sides_keep_their_proportion_and_centers_stay() {
        let mut chain = chain(0.2, &[(1.0, blockers(2, 0.3, 0.1))]);
        let sized = |size| {
            lambertian(Rectangle {
                center: [0.0, 0.1],
                size,
            })
        };
        chain.source.light = sized([0.2, 0.5]);
        let wider = chain.with(Parameter::SourceSize, 0.4);
        assert_eq!(wider.source.light, sized([0.4, 1.0]));
        let wider = chain.with(Parameter::BlockerSide(1), 0.2);
        let expected: Vec<_> = blockers(2, 0.3, 0.1)
            .into_iter()
            .map(|b| Rectangle {
                size: [0.2, 0.2],
                ..b
            })
            .collect();
        let name = "b".into();
        let mask = rectangles(&expected);
        assert_eq!(wider.operators[1], Operator::Visibility { name, mask });
    }

    /// Every kind of parameter.
    fn rich() -> Chain {
        let mixed = Mask::Opaque {
            shapes: vec![disc([0.0, 0.1], 0.2)],
            half_planes: vec![HalfPlane {
                axis: 1,
                edge: 0.4,
                above: true,
            }],
        };
        let mut chain = chain_of(
            spot(disc([0.0, 0.0], 0.1), 20.0),
            [(1.0, Some(mixed)), (0.5, Some(grating(0, 5.0, 0.3)))],
        );
        chain.operators.push(cosine());
        chain
    }

    #[test]
    fn parameters_of_every_kind() {
        let chain = rich();
        let said = |p| format!("{} [{}]", chain.name(p), chain.unit(p));
        let all: Vec<_> = chain.parameters().into_iter().map(said).collect();
        assert_eq!(
            all,
            [
                "radius of light [m]",
                "exponent of light []",
                "travel a to b [m]",
                "radius of b [m]",
                "edge of b [m]",
                "travel b to c [m]",
                "frequency of c [1/m]",
                "phase of c [rad]",
            ]
        );
        for p in chain.parameters() {
            let moved = chain.with(p, chain.value(p) * 2.0);
            let changed = |q: &Parameter| (moved.value(*q) - chain.value(*q)).abs() > 1e-3;
            let others: Vec<_> = chain.parameters().into_iter().filter(changed).collect();
            assert_eq!(others, [p]);
        }
        let point = chain_of(Light::Point { intensity: 1.0 }, [(1.0, None)]);
        assert_eq!(point.parameters(), [Parameter::Travel(0)]);
    }

    #[test]
    #[should_panic(expected = "no parameter GratingPhase(0)")]
    fn foreign_parameters_are_refused() {
        let _ = rich().value(Parameter::GratingPhase(0));
    }
}
