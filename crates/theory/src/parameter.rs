use crate::{Chain, Operator};
use etendue_field::Rectangle;

/// A number of a [`Chain`] that a measurement may be asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parameter {
    /// The side of the source along X; its other side keeps the proportion.
    SourceSide,
    /// The distance of the travel with this index among the operators.
    Travel(usize),
    /// The side along X of the first blocker of the visibility with this index among the operators; all
    /// sides of all its blockers keep the proportion, all centres stay.
    BlockerSide(usize),
}

impl Chain {
    /// All parameters, in the order light meets them.
    #[must_use]
    pub fn parameters(&self) -> Vec<Parameter> {
        let steps = self.operators.iter().enumerate();
        std::iter::once(Parameter::SourceSide)
            .chain(steps.filter_map(|(i, operator)| match operator {
                Operator::Travel { .. } => Some(Parameter::Travel(i)),
                Operator::Visibility { blockers, .. } => {
                    (!blockers.is_empty()).then_some(Parameter::BlockerSide(i))
                }
            }))
            .collect()
    }

    /// The parameter in words, e.g. "travel light to blockers".
    ///
    /// # Panics
    /// When the parameter is of another chain: no such operator.
    #[must_use]
    pub fn name(&self, parameter: Parameter) -> String {
        match (parameter, self.operator(parameter)) {
            (Parameter::SourceSide, _) => format!("side of {}", self.source.name),
            (Parameter::Travel(_), Some(Operator::Travel { from, to, .. })) => {
                format!("travel {from} to {to}")
            }
            (Parameter::BlockerSide(_), Some(Operator::Visibility { name, .. })) => {
                format!("side of {name}")
            }
            _ => foreign(parameter),
        }
    }

    /// Its value, in metres.
    ///
    /// # Panics
    /// When the parameter is of another chain: no such operator, or no blockers.
    #[must_use]
    pub fn value(&self, parameter: Parameter) -> f64 {
        match (parameter, self.operator(parameter)) {
            (Parameter::SourceSide, _) => self.source.rectangle.size[0],
            (Parameter::Travel(_), Some(Operator::Travel { distance, .. })) => *distance,
            (Parameter::BlockerSide(_), Some(Operator::Visibility { blockers, .. }))
                if !blockers.is_empty() =>
            {
                blockers[0].size[0]
            }
            _ => foreign(parameter),
        }
    }

    /// The same chain with another value of one parameter, in metres.
    ///
    /// # Panics
    /// When the parameter is of another chain.
    #[must_use]
    pub fn with(&self, parameter: Parameter, value: f64) -> Self {
        let factor = value / self.value(parameter);
        let mut chain = self.clone();
        match parameter {
            Parameter::SourceSide => scale(&mut chain.source.rectangle, factor),
            Parameter::Travel(i) | Parameter::BlockerSide(i) => match &mut chain.operators[i] {
                Operator::Travel { distance, .. } => *distance = value,
                Operator::Visibility { blockers, .. } => {
                    blockers.iter_mut().for_each(|b| scale(b, factor));
                }
            },
        }
        chain
    }

    fn operator(&self, parameter: Parameter) -> Option<&Operator> {
        match parameter {
            Parameter::SourceSide => None,
            Parameter::Travel(i) | Parameter::BlockerSide(i) => self.operators.get(i),
        }
    }
}

fn scale(rectangle: &mut Rectangle, factor: f64) {
    rectangle.size = rectangle.size.map(|side| side * factor);
}

fn foreign(parameter: Parameter) -> ! {
    panic!("this chain has no parameter {parameter:?}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{blockers, chain};

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
        chain.source.rectangle.size = [0.2, 0.5];
        let wider = chain.with(Parameter::SourceSide, 0.4);
        let expected = Rectangle {
            size: [0.4, 1.0],
            ..chain.source.rectangle
        };
        assert_eq!(wider.source.rectangle, expected);
        let wider = chain.with(Parameter::BlockerSide(1), 0.2);
        let expected = blockers(2, 0.3, 0.1).into_iter().map(|b| Rectangle {
            size: [0.2, 0.2],
            ..b
        });
        let name = "b".into();
        let blockers = expected.collect();
        assert_eq!(wider.operators[1], Operator::Visibility { name, blockers });
    }
}
