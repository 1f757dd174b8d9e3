//! Parameter lists: `"type name" value` or `"type name" [values]`, read by name and type, none left over unnoticed.

use super::lexer::{Lexer, Token};
use crate::error::Result;
use crate::import::place::{At, quote};
use crate::math::Rgb;
use std::collections::BTreeMap;
use std::ops::RangeInclusive;

/// The arguments of a directive: its kind (`"sphere"`) and its parameters.
pub struct Params {
    /// The directive with its kind, for messages: `Shape "sphere"`.
    pub owner: String,
    /// The first string after the directive.
    pub kind: String,
    /// Position of the directive.
    pub at: At,
    left: BTreeMap<String, Param>,
    /// The names that were asked for: what the directive understands.
    known: Vec<&'static str>,
}

struct Param {
    /// The declaration as written, quoted.
    label: String,
    type_name: String,
    at: At,
    values: Values,
}

enum Values {
    Numbers(Vec<f64>),
    Texts(Vec<String>),
    Flags(Vec<bool>),
}

const NUMERIC: [&str; 14] = [
    "float",
    "integer",
    "point",
    "point2",
    "point3",
    "vector",
    "vector2",
    "vector3",
    "normal",
    "normal3",
    "rgb",
    "color",
    "xyz",
    "blackbody",
];

impl Params {
    /// Reads the kind and the parameters that follow the directive at `at`.
    pub fn read(lexer: &mut Lexer, directive: &str, at: At) -> Result<Self> {
        let kind = lexer.text(directive, &at, "its kind")?;
        let owner = format!("{directive} {}", quote(&kind));
        let mut left = BTreeMap::new();
        while let Some(Token::Text(_)) = lexer.peek()? {
            let (name, param) = Param::read(lexer, &owner, &at)?;
            let (place, label) = (param.at.clone(), param.label.clone());
            if left.insert(name, param).is_some() {
                return Err(place.input(format!("{owner} already has the parameter {label}")));
            }
        }
        Ok(Self { owner, kind, at, left, known: Vec::new() })
    }

    /// The error for a kind that is not implemented; `supported` names those that are.
    pub fn unsupported_kind(&self, supported: &str) -> crate::error::Error {
        self.at.unsupported(format!("{} is not supported", self.owner)).with_hint(format!("supported: {supported}"))
    }

    /// Takes a parameter out of the list, if it is of one of the given types.
    fn take(&mut self, name: &'static str, types: &[&str]) -> Result<Option<Param>> {
        self.known.push(name);
        let Some(param) = self.left.remove(name) else { return Ok(None) };
        if types.contains(&param.type_name.as_str()) {
            return Ok(Some(param));
        }
        let message = format!("{}: {} is not of type {}", self.owner, param.label, types.join(" or "));
        Err(match param.type_name.as_str() {
            "texture" | "spectrum" | "blackbody" | "xyz" => param
                .at
                .unsupported(format!("{}: {} is not supported", self.owner, param.label))
                .with_hint(format!("give it as {}", types.join(" or "))),
            _ => param.at.input(message),
        })
    }

    /// Takes `N` numbers that `valid` accepts; `rule` says what it accepts.
    pub fn numbers<const N: usize>(
        &mut self,
        name: &'static str,
        types: &[&str],
        valid: impl Fn(f64) -> bool,
        rule: &str,
    ) -> Result<Option<[f64; N]>> {
        let Some(param) = self.take(name, types)? else { return Ok(None) };
        let wrong = |what: String| param.at.input(format!("{}: {} {what}", self.owner, param.label));
        let Values::Numbers(numbers) = &param.values else { return Err(wrong("needs numbers".into())) };
        let Ok(numbers) = <[f64; N]>::try_from(numbers.as_slice()) else {
            return Err(wrong(format!("needs {}, not {}", count(N, "number"), numbers.len())));
        };
        match numbers.iter().find(|&&number| !valid(number)) {
            Some(bad) => Err(wrong(format!("must be {rule}, not {bad}"))),
            None => Ok(Some(numbers)),
        }
    }

    /// A list of numbers, in groups of `N`.
    pub fn groups<const N: usize>(&mut self, name: &'static str, types: &[&str]) -> Result<Option<Vec<[f64; N]>>> {
        let Some(param) = self.take(name, types)? else { return Ok(None) };
        let wrong = |what: String| param.at.input(format!("{}: {} {what}", self.owner, param.label));
        let Values::Numbers(numbers) = &param.values else { return Err(wrong("needs numbers".into())) };
        match numbers.as_chunks() {
            (groups, []) => Ok(Some(groups.to_vec())),
            _ => Err(wrong(format!("needs groups of {}, not {} in all", count(N, "number"), numbers.len()))),
        }
    }

    /// A number that `valid` accepts.
    pub fn float(&mut self, name: &'static str, valid: impl Fn(f64) -> bool, rule: &str) -> Result<Option<f64>> {
        Ok(self.numbers::<1>(name, &["float"], valid, rule)?.map(|[value]| value))
    }

    /// A whole number in a range.
    pub fn integer(&mut self, name: &'static str, range: RangeInclusive<u32>) -> Result<Option<u32>> {
        let rule = format!("a whole number from {} to {}", range.start(), range.end());
        let valid = |x: f64| x.fract() == 0.0 && (f64::from(*range.start())..=f64::from(*range.end())).contains(&x);
        Ok(self.numbers::<1>(name, &["integer"], valid, &rule)?.map(|[value]| value as u32))
    }

    /// A colour whose channels `valid` accepts.
    pub fn rgb(&mut self, name: &'static str, valid: impl Fn(f64) -> bool, rule: &str) -> Result<Option<Rgb>> {
        let values = self.numbers::<3>(name, &["rgb", "color"], valid, rule)?;
        Ok(values.map(|rgb| Rgb::from_array(rgb.map(|channel| channel as f32))))
    }

    /// A string.
    pub fn text(&mut self, name: &'static str) -> Result<Option<String>> {
        let Some(param) = self.take(name, &["string"])? else { return Ok(None) };
        match param.values {
            Values::Texts(mut texts) if texts.len() == 1 => Ok(texts.pop()),
            _ => Err(param.at.input(format!("{}: {} needs one string", self.owner, param.label))),
        }
    }

    /// The name of a spectrum, if the parameter is given as one.
    pub fn spectrum(&mut self, name: &'static str) -> Result<Option<String>> {
        if !self.has_type(name, "spectrum") {
            return Ok(None);
        }
        match self.take(name, &["spectrum"])? {
            Some(Param { values: Values::Texts(mut texts), .. }) if texts.len() == 1 => Ok(texts.pop()),
            Some(param) => Err(param
                .at
                .unsupported(format!("{}: {} is not supported by its samples", self.owner, param.label))
                .with_hint("give it as rgb")),
            None => Ok(None),
        }
    }

    /// Position of a parameter that has not been taken; otherwise of the directive.
    pub fn place(&self, name: &str) -> At {
        self.left.get(name).map_or(&self.at, |param| &param.at).clone()
    }

    /// Whether the file gives this parameter with this type.
    pub fn has_type(&self, name: &str, type_name: &str) -> bool {
        self.left.get(name).is_some_and(|param| param.type_name == type_name)
    }

    /// A number that may only be what it would be anyway.
    pub fn only_float(&mut self, name: &'static str, neutral: impl Fn(f64) -> bool, allowed: &str) -> Result<()> {
        let at = self.place(name);
        match self.float(name, |_| true, "a number")? {
            Some(value) if !neutral(value) => {
                Err(at.unsupported(format!("{}: {name} {value} is not supported, only {allowed}", self.owner)))
            }
            _ => Ok(()),
        }
    }

    /// A flag. It may be written with or without quotes.
    pub fn flag(&mut self, name: &'static str) -> Result<Option<bool>> {
        let Some(param) = self.take(name, &["bool"])? else { return Ok(None) };
        match &param.values {
            Values::Flags(flags) if flags.len() == 1 => Ok(Some(flags[0])),
            Values::Texts(texts) if texts.len() == 1 && texts[0] == "true" => Ok(Some(true)),
            Values::Texts(texts) if texts.len() == 1 && texts[0] == "false" => Ok(Some(false)),
            _ => Err(param.at.input(format!("{}: {} needs true or false", self.owner, param.label))),
        }
    }

    /// A flag that may only be `false`, which it is anyway.
    pub fn only_false(&mut self, name: &'static str) -> Result<()> {
        let at = self.place(name);
        match self.flag(name)? {
            Some(true) => Err(at.unsupported(format!("{}: {name} is not supported", self.owner))),
            _ => Ok(()),
        }
    }

    /// Closes the list: what is left may be one of `harmless`, which gives a warning; anything else is an error.
    pub fn finish(mut self, harmless: &[&str], warnings: &mut Vec<String>) -> Result<()> {
        for name in harmless {
            if let Some(param) = self.left.remove(*name) {
                warnings.push(param.at.warning(&format!("{}: {} has no effect here", self.owner, param.label)));
            }
        }
        let Some((_, param)) = self.left.pop_first() else { return Ok(()) };
        Err(param
            .at
            .unsupported(format!("{}: the parameter {} is not supported", self.owner, param.label))
            .with_hint(format!("supported: {}", self.known.join(", "))))
    }
}

impl Param {
    fn read(lexer: &mut Lexer, owner: &str, at: &At) -> Result<(String, Self)> {
        let (token, at) = lexer.require(owner, at, "a parameter")?;
        let Token::Text(declaration) = token else {
            return Err(at.input(format!("{owner} needs a parameter, not {}", token.describe())));
        };
        let label = quote(&declaration);
        let mut words = declaration.split_ascii_whitespace();
        let (Some(type_name), Some(name), None) = (words.next(), words.next(), words.next()) else {
            return Err(at
                .input(format!("{owner}: {label} is not a type and a name"))
                .with_hint("parameters look like \"float radius\" [1]"));
        };
        if !NUMERIC.contains(&type_name) && !["string", "texture", "bool", "spectrum"].contains(&type_name) {
            return Err(at.input(format!("{owner}: {label} starts with an unknown type")));
        }
        let values = Values::read(lexer, &format!("{owner}: {label}"), &at)?;
        let (name, type_name) = (name.to_owned(), type_name.to_owned());
        let fits = match &values {
            Values::Numbers(_) => type_name == "spectrum" || NUMERIC.contains(&type_name.as_str()),
            Values::Texts(_) => !NUMERIC.contains(&type_name.as_str()),
            Values::Flags(_) => type_name == "bool",
        };
        if !fits {
            return Err(at.input(format!("{owner}: {label} has values of another type")));
        }
        Ok((name, Self { label, type_name, at, values }))
    }
}

impl Values {
    /// A value, or a bracket with values of one type.
    fn read(lexer: &mut Lexer, owner: &str, at: &At) -> Result<Self> {
        let (first, first_at) = lexer.require(owner, at, "a value")?;
        if first != Token::Open {
            return Self::one(first, owner, &first_at);
        }
        let mut values: Option<Self> = None;
        loop {
            let Some((token, at)) = lexer.next()? else {
                return Err(first_at.input(format!("{owner}: this bracket is never closed")));
            };
            if token == Token::Close {
                return values.ok_or_else(|| at.input(format!("{owner} has no value")));
            }
            let next = Self::one(token, owner, &at)?;
            match (&mut values, next) {
                (None, next) => values = Some(next),
                (Some(Values::Numbers(all)), Values::Numbers(next)) => all.extend(next),
                (Some(Values::Texts(all)), Values::Texts(next)) => all.extend(next),
                (Some(Values::Flags(all)), Values::Flags(next)) => all.extend(next),
                _ => return Err(at.input(format!("{owner} mixes values of different types"))),
            }
        }
    }

    fn one(token: Token, owner: &str, at: &At) -> Result<Self> {
        Ok(match token {
            Token::Number(number) => Values::Numbers(vec![number]),
            Token::Text(text) => Values::Texts(vec![text]),
            Token::Word("true") => Values::Flags(vec![true]),
            Token::Word("false") => Values::Flags(vec![false]),
            other => return Err(at.input(format!("{owner} needs a value, not {}", other.describe()))),
        })
    }
}

fn count(n: usize, what: &str) -> String {
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;
    use std::rc::Rc;

    fn read(text: &str) -> Result<Params> {
        let path: Rc<Path> = Rc::from(Path::new("a"));
        let at = At::new(path.clone(), 1, 1);
        Params::read(&mut Lexer::new(text.as_bytes(), path), "Shape", at)
    }

    fn fails<T>(result: Result<T>, message: &str) {
        match result {
            Ok(_) => panic!("no error, but: {message}"),
            Err(e) => assert!(e.to_string().contains(message), "{e}\nis not\n{message}"),
        }
    }

    #[test]
    fn values_by_name_and_type() {
        let mut p = read(
            r#""s" "float r" 2 "integer n" [3] "color K" [1 .5 0] "string f" ["x.exr"] "bool a" false
               "bool b" ["false"] "float w" [0 1 2 3] "float iso" 1"#,
        )
        .unwrap();
        assert_eq!(p.kind, "s");
        assert_eq!(p.float("r", |x| x > 0.0, "").unwrap(), Some(2.0));
        assert_eq!(p.integer("n", 1..=4).unwrap(), Some(3));
        assert_eq!(p.rgb("K", |_| true, "").unwrap(), Some(Rgb::new(1.0, 0.5, 0.0)));
        assert_eq!(p.text("f").unwrap().as_deref(), Some("x.exr"));
        assert_eq!(p.numbers::<4>("w", &["float"], |_| true, "").unwrap(), Some([0.0, 1.0, 2.0, 3.0]));
        assert_eq!(p.float("missing", |_| true, "").unwrap(), None);
        p.only_false("a").unwrap();
        p.only_false("b").unwrap();
        let mut warnings = Vec::new();
        p.finish(&["iso"], &mut warnings).unwrap();
        assert_eq!(warnings, [r#"a:2:55: Shape "s": "float iso" has no effect here"#]);
    }

    #[test]
    fn wrong_values_are_named() {
        let float = |text: &str| read(text)?.float("r", |x| x > 0.0, "positive");
        fails(float(r#""s" "float r" -1"#), r#"a:1:5: Shape "s": "float r" must be positive, not -1"#);
        fails(float(r#""s" "float r" [1 2]"#), "needs 1 number, not 2");
        fails(float(r#""s" "float r" "1""#), "has values of another type");
        fails(float(r#""s" "integer r" 1"#), "is not of type float");
        fails(float(r#""s" "texture r" "t""#), "\"texture r\" is not supported");
        let integer = |text: &str| read(text)?.integer("n", 1..=9);
        assert_eq!(integer(r#""s" "integer n" 4.0"#).unwrap(), Some(4));
        for bad in ["0", "10", "2.5", "-1", "1e300"] {
            fails(integer(&format!(r#""s" "integer n" {bad}"#)), "must be a whole number from 1 to 9");
        }
        fails(read(r#""s" "spectrum K" [400 1]"#).unwrap().rgb("K", |_| true, ""), "is not supported");
        fails(read(r#""s" "string f" ["a" "b"]"#).unwrap().text("f"), "needs one string");
        fails(read(r#""s" "bool b" "yes""#).unwrap().only_false("b"), "needs true or false");
        fails(read(r#""s" "bool b" true"#).unwrap().only_false("b"), "b is not supported");
        fails(
            read(r#""s" "float z" .5"#).unwrap().only_float("z", |z| z == 0.0, "0"),
            "z 0.5 is not supported, only 0",
        );
        fails(read(r#""s" "float z" .5"#).unwrap().finish(&[], &mut Vec::new()), "\"float z\" is not supported");
    }

    #[test]
    fn broken_lists_are_errors_with_a_place() {
        for (text, message) in [
            ("", "a:1:1: the file ends where Shape needs its kind"),
            ("sphere", "a:1:1: Shape needs its kind in double quotes, not \"sphere\""),
            (r#""s" "float r""#, "a:1:5: the file ends where Shape \"s\": \"float r\" needs a value"),
            (r#""s" "float r" ["#, "a:1:15: Shape \"s\": \"float r\": this bracket is never closed"),
            (r#""s" "float r" [1 [2]]"#, "a:1:18: "),
            (r#""s" "float r" [1 "a"]"#, "a:1:18: "),
            (r#""s" "float r" []"#, "a:1:16: "),
            (r#""s" "float r" ]"#, "a:1:15: "),
            (r#""s" "float r" Shape"#, "a:1:15: "),
            (r#""s" "float" 1"#, "is not a type and a name"),
            (r#""s" "float r r" 1"#, "is not a type and a name"),
            (r#""s" "double r" 1"#, "unknown type"),
            (r#""s" "float r" 1 "integer r" 1"#, "a:1:17: Shape \"s\" already has the parameter \"integer r\""),
        ] {
            fails(read(text), message);
        }
    }
}
