//! The XML of a COLLADA file: elements by name, by `id` and by link, their numbers, and the place of each.

use crate::error::{Error, Result};
use crate::import::number::finite;
use crate::import::place::{At, quote};
use crate::import::rule::Rule;
use crate::math::Rgb;
use roxmltree::{Document as Xml, Error as XmlError, Node, NodeType, ParsingOptions};
use std::cell::{Cell, RefCell};
use std::collections::HashMap;
use std::path::Path;
use std::rc::Rc;

/// Most elements and texts in a file: each takes about 70 bytes.
const MAX_NODES: u32 = 1 << 22;
/// Most attributes of an element, and most declarations of namespaces in a file: the parser's time grows with their
/// squares.
const MAX_ATTRIBUTES: usize = 64;
const MAX_NAMESPACES: usize = 64;
/// Most bytes of elements that links lead to, each counted as often as it is reached: what an instance costs in time.
const MAX_LINKED_BYTES: usize = 1 << 30;
const MAX_WARNINGS: usize = 100;

pub type Element<'a> = Node<'a, 'a>;

pub struct Document<'a> {
    xml: &'a Xml<'a>,
    path: Rc<Path>,
    ids: HashMap<&'a str, Element<'a>>,
    /// Where each line starts.
    lines: Vec<usize>,
    /// How many more bytes of elements links may lead to.
    linked_bytes: Cell<usize>,
    warnings: RefCell<Vec<String>>,
}

/// Parses the text of the file at `path`.
pub fn parse<'a>(text: &'a str, path: &Path) -> Result<Xml<'a>> {
    // A tag has no "<" inside it, so this counts at least its attributes. Comments and the like start with "!".
    let equal_signs = |piece: &str| piece.bytes().filter(|&byte| byte == b'=').count();
    if text.split('<').any(|piece| !piece.starts_with('!') && equal_signs(piece) > MAX_ATTRIBUTES) {
        return Err(Error::limit(path, format!("an element with more than {MAX_ATTRIBUTES} attributes")));
    }
    if text.matches("xmlns").count() > MAX_NAMESPACES {
        return Err(Error::limit(path, format!("more than {MAX_NAMESPACES} declarations of namespaces")));
    }
    let options = ParsingOptions { nodes_limit: MAX_NODES, ..ParsingOptions::default() };
    Xml::parse_with_options(text, options).map_err(|e| match e {
        XmlError::NodesLimitReached => Error::limit(path, format!("more than {MAX_NODES} elements")),
        XmlError::UnclosedRootNode | XmlError::UnexpectedEndOfStream | XmlError::NoRootNode => {
            let at = At::new(path.into(), text.lines().count().max(1), last_line(text).chars().count() + 1);
            at.input("the file ends in the middle of its XML").with_hint("it is cut off: get it whole again")
        }
        _ => {
            let (place, message) = (e.pos(), e.to_string());
            let message = message.split(&format!(" at {place}")).next().unwrap_or_default();
            At::new(path.into(), place.row as usize, place.col as usize).input(format!("broken XML: {message}"))
        }
    })
}

fn last_line(text: &str) -> &str {
    text.lines().last().unwrap_or_default()
}

impl<'a> Document<'a> {
    /// The document at `path`. Of two elements with the same `id` the later one counts.
    pub fn new(xml: &'a Xml<'a>, path: &Path) -> Self {
        let ids = xml.descendants().filter_map(|node| Some((node.attribute("id")?, node))).collect();
        let ends = xml.input_text().bytes().enumerate().filter(|(_, byte)| *byte == b'\n');
        let lines = std::iter::once(0).chain(ends.map(|(i, _)| i + 1)).collect();
        Self {
            xml,
            path: path.into(),
            ids,
            lines,
            linked_bytes: Cell::new(MAX_LINKED_BYTES),
            warnings: RefCell::default(),
        }
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    pub fn root(&self) -> Element<'a> {
        self.xml.root_element()
    }

    pub fn at(&self, node: Element) -> At {
        self.place(node.range().start)
    }

    fn place(&self, offset: usize) -> At {
        let line = self.lines.partition_point(|&start| start <= offset);
        let before = &self.xml.input_text()[self.lines[line - 1]..offset];
        At::new(self.path.clone(), line, before.chars().count() + 1)
    }

    /// Notes what was left out or filled in at an element.
    pub fn warn(&self, node: Element, message: &str) {
        let mut warnings = self.warnings.borrow_mut();
        match warnings.len() {
            0..MAX_WARNINGS => warnings.push(self.at(node).warning(message)),
            MAX_WARNINGS => warnings.push(format!("{}: further warnings are left out", self.path.display())),
            _ => {}
        }
    }

    pub fn into_warnings(self) -> Vec<String> {
        self.warnings.into_inner()
    }

    /// The element at the end of a path of names, `a/b/c`, that `node` must have inside it.
    pub fn require(&self, node: Element<'a>, names: &str) -> Result<Element<'a>> {
        find(node, names).ok_or_else(|| self.at(node).input(format!("<{}> has no {names}", node.tag_name().name())))
    }

    /// The element that an attribute of `node` names, like `url="#id"`; its kind must be `name`.
    pub fn follow(&self, node: Element<'a>, attribute: &str, name: &str) -> Result<Element<'a>> {
        let (at, tag) = (self.at(node), node.tag_name().name());
        let link = node.attribute(attribute).ok_or_else(|| at.input(format!("<{tag}> has no {attribute}")))?;
        let Some(id) = link.strip_prefix('#') else {
            return Err(
                at.unsupported(format!("{} is in another file: only links within one are supported", quote(link)))
            );
        };
        let found = self.ids.get(id).ok_or_else(|| at.input(format!("no element has the id {}", quote(id))))?;
        if found.tag_name().name() != name {
            let kind = found.tag_name().name();
            return Err(at.input(format!("{} must be a <{name}>, not a <{kind}>", quote(id))));
        }
        let left = self.linked_bytes.get().checked_sub(found.range().len());
        self.linked_bytes.set(left.ok_or_else(|| {
            Error::limit(self.path(), format!("its instances are more than {} MiB", MAX_LINKED_BYTES >> 20))
        })?);
        Ok(*found)
    }

    /// The words in an element, each with its offset in the file.
    fn words(&self, node: Element<'a>) -> impl Iterator<Item = (&'a str, usize)> {
        let source = self.xml.input_text();
        // As written in the file: numbers have no entities in them, and comments end a text.
        let texts = node.children().filter(|child| child.node_type() == NodeType::Text).map(|text| text.range());
        texts.flat_map(move |range| {
            let text = &source[range];
            text.split_ascii_whitespace().map(|word| (word, word.as_ptr() as usize - source.as_ptr() as usize))
        })
    }

    /// All finite numbers in an element.
    pub fn numbers(&self, node: Element<'a>) -> Result<Vec<f64>> {
        self.words(node).map(|(word, offset)| finite(word).map_err(|wrong| self.place(offset).input(wrong))).collect()
    }

    /// All whole numbers in an element, from 0 on.
    pub fn indices(&self, node: Element<'a>) -> Result<Vec<u32>> {
        let wrong = |word, offset| self.place(offset).input(format!("{} is not a whole number from 0 on", quote(word)));
        self.words(node).map(|(word, offset)| word.parse().map_err(|_| wrong(word, offset))).collect()
    }

    /// The colour in an element: red, green and blue by the rule, and perhaps an alpha, which is not used.
    pub fn colour(&self, node: Element<'a>, rule: &Rule) -> Result<Rgb> {
        let channels = match self.words(node).count() {
            4 => self.exactly::<4>(node, rule).map(|[r, g, b, _]| [r, g, b])?,
            _ => self.exactly(node, rule)?,
        };
        Ok(Rgb::from_array(channels.map(|channel| channel as f32)))
    }

    /// The `N` numbers of an element, which must keep a rule.
    pub fn exactly<const N: usize>(&self, node: Element<'a>, rule: &Rule) -> Result<[f64; N]> {
        let wrong = |what| self.at(node).input(format!("<{}> {what}", node.tag_name().name()));
        rule.check(&self.numbers(node)?).map_err(wrong)
    }
}

/// The first element at the end of a path of names, `a/b/c`, inside `node`.
pub fn find<'a>(node: Element<'a>, names: &str) -> Option<Element<'a>> {
    names.split('/').try_fold(node, |node, name| elements(node).find(|child| is(*child, name)))
}

/// The elements directly inside `node`.
pub fn elements<'a>(node: Element<'a>) -> impl Iterator<Item = Element<'a>> {
    node.children().filter(Node::is_element)
}

/// The part of an element that is meant for renderers of the course: it overrides what all programs share.
pub fn course_profile<'a>(node: Element<'a>) -> Option<Element<'a>> {
    let extras = elements(node).filter(|child| is(*child, "extra"));
    let mut techniques = extras.flat_map(elements).filter(|child| is(*child, "technique"));
    techniques.find(|technique| technique.attribute("profile") == Some("CGL"))
}

/// Whether an element has this name.
pub fn is(node: Element, name: &str) -> bool {
    node.tag_name().name() == name
}
