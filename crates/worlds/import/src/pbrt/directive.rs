//! Parsing of the directives of a file.

use super::build::{Builder, no_medium};
use super::entity::parameters;
use super::scene::MaterialOf;
use super::token::{Token, Tokens, is_directive, number};
use super::transform::{look_at, matrix, rotation};
use crate::range::{MAX_NUMBER, holds, in_range};
use crate::report::{SourcePlace, quoted};
use glam::{DAffine3, DVec3};

impl Builder<'_> {
    /// Executes all directives of a text.
    pub(super) fn follow(&mut self, tokens: &mut Tokens<'_>) {
        while let Some((token, at)) = tokens.next() {
            let place = tokens.place(at);
            let done = match token {
                Token::Word(word) if is_directive(word) => self.directive(word, &place, tokens),
                Token::Word(word) => Err(format!("directive {} is not known", quoted(word))),
                Token::Text(text) => {
                    Err(format!("{} stands outside of a directive", quoted(&text)))
                }
                Token::Open | Token::Close => {
                    Err("a bracket stands outside of a directive".to_owned())
                }
                Token::Broken(what) => Err(what.to_owned()),
            };
            if let Err(error) = done {
                self.report.cause(&place, error);
                // The tokens up to the next directive belong to the unknown directive, and are
                // skipped.
                while tokens.peek_value().is_some() {
                    tokens.next();
                }
            }
        }
    }

    fn directive(
        &mut self,
        word: &str,
        place: &SourcePlace,
        tokens: &mut Tokens<'_>,
    ) -> Result<(), String> {
        match word {
            "Identity" => self.state.to_world = DAffine3::IDENTITY,
            "Translate" => self.concat(DAffine3::from_translation(DVec3::from_array(numbers(
                tokens,
            )?)))?,
            "Scale" => self.concat(DAffine3::from_scale(DVec3::from_array(numbers(tokens)?)))?,
            "Rotate" => self.concat(rotation(numbers(tokens)?)?)?,
            "LookAt" => self.concat(look_at(numbers(tokens)?)?)?,
            "ConcatTransform" => self.concat(matrix(&in_brackets(tokens)?)?)?,
            "Transform" => self.state.to_world = matrix(&in_brackets(tokens)?)?,
            "CoordinateSystem" => self.coordinate_system(text(tokens)?),
            "CoordSysTransform" => self.go_to_system(&text(tokens)?, place)?,
            "ActiveTransform" => active_transform(tokens)?,
            "TransformTimes" => {
                numbers::<2>(tokens)?;
            }
            "WorldBegin" => self.begin_world()?,
            "AttributeBegin" | "TransformBegin" => self.push("Attribute", place)?,
            "AttributeEnd" | "TransformEnd" => self.pop("Attribute")?,
            "ReverseOrientation" => self.state.is_reversed = !self.state.is_reversed,
            "ObjectBegin" => self.begin_object(text(tokens)?, place)?,
            "ObjectEnd" => self.pop("Object")?,
            "ObjectInstance" => self.instance(text(tokens)?, place)?,
            "NamedMaterial" => {
                self.state.material = MaterialOf::Named(text(tokens)?.into(), place.clone());
            }
            "MediumInterface" => self.media(tokens, place)?,
            "ColorSpace" => color_space(&text(tokens)?)?,
            "Option" => self.option(tokens, place)?,
            "Include" | "Import" => self.include(word, &text(tokens)?, place)?,
            "Texture" => self.texture(tokens, place)?,
            _ => {
                let plugin = text(tokens)?;
                let own = parameters(tokens, self.report);
                self.make(word, plugin, own, place)?;
            }
        }
        Ok(())
    }

    fn concat(&mut self, map: DAffine3) -> Result<(), String> {
        let product = self.state.to_world * map;
        if !holds(product) {
            return Err(format!(
                "the product with the preceding transform has numbers out of range; allowed: up to {MAX_NUMBER:e}"
            ));
        }
        self.state.to_world = product;
        Ok(())
    }

    fn texture(&mut self, tokens: &mut Tokens<'_>, place: &SourcePlace) -> Result<(), String> {
        let [name, kind, plugin] = [text(tokens)?, text(tokens)?, text(tokens)?];
        let own = parameters(tokens, self.report);
        self.require_world("Texture", true)?;
        let is_spectrum = kind == "spectrum";
        if !is_spectrum && kind != "float" {
            let kind = quoted(&kind);
            return Err(format!("a texture of {kind}; allowed: float, spectrum"));
        }
        let entity = self.entity("texture", plugin, own, place, Some(4));
        let shown = quoted(&name);
        match self.scene.textures.insert((is_spectrum, name), entity) {
            None => Ok(()),
            Some(_) => Err(format!("a second {kind} texture {shown}")),
        }
    }

    fn media(&self, tokens: &mut Tokens<'_>, place: &SourcePlace) -> Result<(), String> {
        let mut names = vec![text(tokens)?];
        if let Some((Token::Text(second), _)) = tokens.peek().cloned() {
            tokens.next();
            names.push(second.into_owned());
        }
        if let Some(name) = names.iter().find(|name| !name.is_empty()) {
            self.report.cause(place, no_medium(name));
        }
        Ok(())
    }

    fn option(&self, tokens: &mut Tokens<'_>, place: &SourcePlace) -> Result<(), String> {
        let name = text(tokens)?;
        if tokens.peek_value().is_none() {
            return Err("an option has no value".to_owned());
        }
        tokens.next();
        self.report
            .note(place, format!("option {} is left out", quoted(&name)));
        Ok(())
    }
}

/// Allows only transforms without motion.
fn active_transform(tokens: &mut Tokens<'_>) -> Result<(), String> {
    match tokens.peek() {
        Some((Token::Word("All"), _)) => {
            tokens.next();
            Ok(())
        }
        _ => Err("animated transforms are not supported; allowed: All".to_owned()),
    }
}

fn color_space(name: &str) -> Result<(), String> {
    if name.eq_ignore_ascii_case("srgb") {
        return Ok(());
    }
    let name = quoted(name);
    Err(format!(
        "colour space {name} is not supported; allowed: srgb"
    ))
}

fn text(tokens: &mut Tokens<'_>) -> Result<String, String> {
    match tokens.peek().cloned() {
        Some((Token::Text(text), _)) => {
            tokens.next();
            Ok(text.into_owned())
        }
        Some((Token::Broken(what), _)) => Err(what.to_owned()),
        _ => Err("a name in quotation marks is missing".to_owned()),
    }
}

fn numbers<const N: usize>(tokens: &mut Tokens<'_>) -> Result<[f64; N], String> {
    let mut all = [0.0; N];
    for value in &mut all {
        let Some((Token::Word(word), _)) = tokens.peek_value() else {
            return Err(format!("allowed: {N} numbers"));
        };
        *value = in_range(number(word)?)?;
        tokens.next();
    }
    Ok(all)
}

fn in_brackets(tokens: &mut Tokens<'_>) -> Result<[f64; 16], String> {
    let bracket = |tokens: &mut Tokens<'_>, wanted: Token<'_>| {
        let is_there = tokens.peek().is_some_and(|(token, _)| *token == wanted);
        if is_there {
            tokens.next();
        }
        is_there
    };
    let begins = bracket(tokens, Token::Open);
    let all = numbers(tokens)?;
    match begins && bracket(tokens, Token::Close) {
        true => Ok(all),
        false => Err("allowed: 16 numbers in brackets".to_owned()),
    }
}
