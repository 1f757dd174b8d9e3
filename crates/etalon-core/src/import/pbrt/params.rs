//! Parameter lists: `"type name" value` or `"type name" [values]`, read by name and type, none left over unnoticed.

use super::lexer::{Lexer, Token};
use crate::error::{Error, Result};
use crate::import::place::{ANY, At, Rule, quote};
use crate::math::Rgb;
use crate::memory;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::ops::RangeInclusive;

/// The arguments of a directive: its kind (`"sphere"`) and its parameters.
pub struct Params {
    /// The directive with its kind, for messages: `Shape "sphere"`.
    pub owner: String,
    /// The first string after the directive.
    pub kind: String,
    pub at: At,
    pub(super) given: BTreeMap<String, Param>,
    /// The names that were asked for: what the directive understands.
    known: RefCell<Vec<&'static str>>,
}

pub(super) struct Param {
    /// The declaration as written, quoted.
    pub(super) label: String,
    pub(super) type_name: String,
    pub(super) at: At,
    /// Values, if they are numbers.
    pub(super) numbers: Vec<f64>,
    /// Values, if they are strings or flags.
    pub(super) texts: Vec<String>,
}

/// Types of numbers, and of what else there is.
const NUMERIC: &str =
    "float integer point point2 point3 vector vector2 vector3 normal normal3 rgb color xyz blackbody spectrum";
const TEXTUAL: &str = "string texture bool spectrum";

impl Params {
    /// Reads the kind and the parameters that follow the directive at `at`.
    pub fn read(lexer: &mut Lexer, directive: &str, at: At) -> Result<Self> {
        let kind = lexer.text(directive, &at, "its kind")?;
        let owner = format!("{directive} {}", quote(&kind));
        let mut given = BTreeMap::new();
        while let Some(Token::Text(_)) = lexer.peek()? {
            let (name, param) = Param::read(lexer, &owner, &at)?;
            if given.contains_key(&name) {
                return Err(param.at.input(format!("{owner} already has the parameter {}", param.label)));
            }
            given.insert(name, param);
        }
        Ok(Self { owner, kind, at, given, known: RefCell::default() })
    }

    /// Reads the one parameter of a directive without a kind.
    pub fn single(lexer: &mut Lexer, directive: &str, at: At) -> Result<Self> {
        let given = BTreeMap::from([Param::read(lexer, directive, &at)?]);
        Ok(Self { owner: directive.into(), kind: String::new(), at, given, known: RefCell::default() })
    }

    /// Memory of the values, in bytes, and some for the directive itself.
    pub fn bytes(&self) -> u64 {
        let numbers: usize = self.given.values().map(|param| param.numbers.len()).sum();
        256 + (numbers * size_of::<f64>()) as u64
    }

    /// The error for a kind that is not implemented; `supported` names those that are.
    pub fn unsupported_kind(&self, supported: &str) -> Error {
        self.at.unsupported(format!("{} is not supported", self.owner)).with_hint(format!("supported: {supported}"))
    }

    /// Position of a parameter; of the directive, if it is not given.
    pub fn place(&self, name: &str) -> &At {
        self.given.get(name).map_or(&self.at, |param| &param.at)
    }

    /// Whether the file gives this parameter with this type.
    pub fn has_type(&self, name: &str, type_name: &str) -> bool {
        self.given.get(name).is_some_and(|param| param.type_name == type_name)
    }

    pub fn has(&self, name: &str) -> bool {
        self.given.contains_key(name)
    }

    /// The name of a texture, if the parameter is given as one.
    pub fn texture(&self, name: &'static str) -> Result<Option<&str>> {
        if !self.has_type(name, "texture") {
            return Ok(None);
        }
        let Some(param) = self.find(name, &["texture"])? else { return Ok(None) };
        match param.texts.as_slice() {
            [texture] => Ok(Some(texture)),
            _ => Err(self.wrong(param, "needs one name".into())),
        }
    }

    /// The parameter, if it is given; an error if it is of none of the types.
    fn find(&self, name: &'static str, types: &[&str]) -> Result<Option<&Param>> {
        if !self.known.borrow().contains(&name) {
            self.known.borrow_mut().push(name);
        }
        let Some(param) = self.given.get(name) else { return Ok(None) };
        match param.type_name.as_str() {
            known if types.contains(&known) => Ok(Some(param)),
            "texture" | "spectrum" | "blackbody" | "xyz" => Err(param
                .at
                .unsupported(format!("{}: {} is not supported", self.owner, param.label))
                .with_hint(format!("give it as {}", types.join(" or ")))),
            _ => Err(self.wrong(param, format!("is not of type {}", types.join(" or ")))),
        }
    }

    fn wrong(&self, param: &Param, what: String) -> Error {
        param.at.input(format!("{}: {} {what}", self.owner, param.label))
    }

    /// `N` numbers that keep a rule.
    pub fn numbers<const N: usize>(&self, name: &'static str, types: &[&str], rule: &Rule) -> Result<Option<[f64; N]>> {
        let Some(param) = self.find(name, types)? else { return Ok(None) };
        rule.check(&param.numbers).map(Some).map_err(|what| self.wrong(param, what))
    }

    /// A list of numbers, in groups of `N`.
    pub fn groups<const N: usize>(&self, name: &'static str, types: &[&str]) -> Result<Option<&[[f64; N]]>> {
        let Some(param) = self.find(name, types)? else { return Ok(None) };
        match param.numbers.as_chunks() {
            (groups, []) => Ok(Some(groups)),
            _ => {
                let group = if N == 1 { "1 number".into() } else { format!("{N} numbers") };
                Err(self.wrong(param, format!("needs groups of {group}, not {} in all", param.numbers.len())))
            }
        }
    }

    pub fn float(&self, name: &'static str, rule: &Rule) -> Result<Option<f64>> {
        Ok(self.numbers(name, &["float"], rule)?.map(|[value]| value))
    }

    pub fn integer(&self, name: &'static str, range: RangeInclusive<u32>) -> Result<Option<u32>> {
        let Some(param) = self.find(name, &["integer"])? else { return Ok(None) };
        let [value] = ANY.check(&param.numbers).map_err(|what| self.wrong(param, what))?;
        let (low, high) = range.into_inner();
        if value.fract() == 0.0 && (f64::from(low)..=f64::from(high)).contains(&value) {
            return Ok(Some(value as u32));
        }
        Err(self.wrong(param, format!("must be a whole number from {low} to {high}, not {value}")))
    }

    /// A colour whose channels keep a rule.
    pub fn rgb(&self, name: &'static str, rule: &Rule) -> Result<Option<Rgb>> {
        let values = self.numbers::<3>(name, &["rgb", "color"], rule)?;
        Ok(values.map(|rgb| Rgb::from_array(rgb.map(|channel| channel as f32))))
    }

    pub fn text(&self, name: &'static str) -> Result<Option<&str>> {
        let Some(param) = self.find(name, &["string"])? else { return Ok(None) };
        match param.texts.as_slice() {
            [text] => Ok(Some(text)),
            _ => Err(self.wrong(param, "needs one string".into())),
        }
    }

    pub fn texts(&self, name: &'static str) -> Result<Option<&[String]>> {
        Ok(self.find(name, &["string"])?.map(|param| param.texts.as_slice()))
    }

    /// A number that may only be what it would be anyway.
    pub fn only_float(&self, name: &'static str, neutral: impl Fn(f64) -> bool, allowed: &str) -> Result<()> {
        match self.float(name, &ANY)? {
            Some(value) if !neutral(value) => {
                let message = format!("{}: {name} {value} is not supported, only {allowed}", self.owner);
                Err(self.place(name).unsupported(message))
            }
            _ => Ok(()),
        }
    }

    /// A flag. It may be written with or without quotes.
    pub fn flag(&self, name: &'static str) -> Result<Option<bool>> {
        let Some(param) = self.find(name, &["bool"])? else { return Ok(None) };
        match param.texts.as_slice() {
            [text] if text == "true" => Ok(Some(true)),
            [text] if text == "false" => Ok(Some(false)),
            _ => Err(self.wrong(param, "needs true or false".into())),
        }
    }

    /// A flag that may only be `false`, which it is anyway.
    pub fn only_false(&self, name: &'static str) -> Result<()> {
        match self.flag(name)? {
            Some(true) => Err(self.place(name).unsupported(format!("{}: {name} is not supported", self.owner))),
            _ => Ok(()),
        }
    }

    /// Closes the list: what was not asked for may be one of `harmless`, which gives a warning; else it is an error.
    pub fn finish(&self, harmless: &[&str], warnings: &mut Vec<String>) -> Result<()> {
        let known = self.known.borrow();
        for param in harmless.iter().filter(|name| !known.contains(name)).filter_map(|name| self.given.get(*name)) {
            warnings.push(param.at.warning(&format!("{}: {} has no effect here", self.owner, param.label)));
        }
        let expected = |name: &str| known.contains(&name) || harmless.contains(&name);
        let Some((_, param)) = self.given.iter().find(|(name, _)| !expected(name)) else { return Ok(()) };
        Err(param
            .at
            .unsupported(format!("{}: the parameter {} is not supported", self.owner, param.label))
            .with_hint(format!("supported: {}", known.join(", "))))
    }
}

impl Param {
    fn read(lexer: &mut Lexer, owner: &str, at: &At) -> Result<(String, Self)> {
        let (token, at) = lexer.require(owner, at, "a parameter")?;
        let Token::Text(declaration) = token else {
            return Err(at.input(format!("{owner} needs a parameter, not {}", token.describe())));
        };
        let label = quote(&declaration);
        let owner = format!("{owner}: {label}");
        let mut words = declaration.split_ascii_whitespace();
        let (Some(type_name), Some(name), None) = (words.next(), words.next(), words.next()) else {
            return Err(at
                .input(format!("{owner} is not a type and a name"))
                .with_hint("parameters look like \"float radius\" [1]"));
        };
        let types = [NUMERIC, TEXTUAL].map(|types| types.split(' ').any(|known| known == type_name));
        if types == [false; 2] {
            return Err(at.input(format!("{owner} starts with an unknown type")));
        }
        let (numbers, texts) = (Vec::new(), Vec::new());
        let mut param = Self { label, type_name: type_name.into(), at, numbers, texts };
        // A value, or a bracket with values.
        let (first, first_at) = lexer.require(&owner, &param.at, "a value")?;
        if first != Token::Open {
            param.add(first, types, &owner, &first_at)?;
            return Ok((name.into(), param));
        }
        loop {
            match lexer.next()? {
                None => return Err(first_at.input(format!("{owner}: this bracket is never closed"))),
                Some((Token::Close, at)) if param.numbers.is_empty() && param.texts.is_empty() => {
                    return Err(at.input(format!("{owner} has no value")));
                }
                Some((Token::Close, _)) => return Ok((name.into(), param)),
                Some((token, at)) => param.add(token, types, &owner, &at)?,
            }
        }
    }

    /// Adds a value; `numeric` and `textual` say what the type allows.
    fn add(&mut self, value: Token, [numeric, textual]: [bool; 2], owner: &str, at: &At) -> Result<()> {
        match value {
            Token::Number(number) if numeric => memory::push(&mut self.numbers, number, || at.to_string())?,
            Token::Text(text) if textual => memory::push(&mut self.texts, text, || at.to_string())?,
            Token::Word(flag @ ("true" | "false")) if self.type_name == "bool" => self.texts.push(flag.into()),
            Token::Number(_) | Token::Text(_) | Token::Word("true" | "false") => {
                return Err(at.input(format!("{owner} has values of another type")));
            }
            other => return Err(at.input(format!("{owner} needs a value, not {}", other.describe()))),
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::place::POSITIVE;
    use super::*;
    use std::path::Path;
    use std::rc::Rc;

    fn read(text: &str) -> Result<Params> {
        let path: Rc<Path> = Rc::from(Path::new("a"));
        let at = At::new(path.clone(), 1, 1);
        Params::read(&mut Lexer::new(text.as_bytes(), path), "Shape", at)
    }

    #[test]
    fn values_by_name_and_type() {
        let p = read(
            r#""s" "float r" 2 "integer n" [3] "color K" [1 .5 0] "string f" ["x.exr"] "bool a" false
               "bool b" ["false"] "float w" [0 1 2 3] "float iso" 1"#,
        )
        .unwrap();
        assert_eq!(p.kind, "s");
        assert_eq!(p.float("r", &POSITIVE).unwrap(), Some(2.0));
        assert_eq!(p.integer("n", 1..=4).unwrap(), Some(3));
        assert_eq!(p.rgb("K", &ANY).unwrap(), Some(Rgb::new(1.0, 0.5, 0.0)));
        assert_eq!(p.text("f").unwrap(), Some("x.exr"));
        assert_eq!(p.numbers::<4>("w", &["float"], &ANY).unwrap(), Some([0.0, 1.0, 2.0, 3.0]));
        assert_eq!(p.float("missing", &ANY).unwrap(), None);
        p.only_false("a").unwrap();
        p.only_false("b").unwrap();
        let mut warnings = Vec::new();
        p.finish(&["iso"], &mut warnings).unwrap();
        assert_eq!(warnings, [r#"a:2:55: Shape "s": "float iso" has no effect here"#]);
    }
}
