//! The XML of a COLLADA file: elements by name, by `id` and by link, their numbers, and the place of each.

use super::super::{MAX_WARNINGS, further_warnings};
use crate::error::{Error, Result};
use crate::import::place::{At, Rule, finite, quote};
use crate::math::Rgb;
use crate::memory;
use roxmltree::{Document as Xml, Error as XmlError, Node, NodeType, ParsingOptions};
use std::cell::{Cell, RefCell};
use std::collections::HashMap;
use std::path::Path;
use std::rc::Rc;

/// Most elements and texts in a file, and the memory of each and of an attribute in bytes.
const MAX_NODES: u32 = 1 << 22;
const NODE_BYTES: usize = 80;
const ATTRIBUTE_BYTES: usize = 64;
/// Most attributes of an element, and most declarations of namespaces in a file: the parser's time grows with their
/// squares.
const MAX_ATTRIBUTES: usize = 64;
const MAX_NAMESPACES: usize = 64;
/// Most bytes of elements that links lead to, each counted as often as it is reached: what an instance costs in time.
const MAX_LINKED_BYTES: usize = 1 << 30;

pub type Element<'a> = Node<'a, 'a>;
/// A value, or what is wrong with the word for it.
type Read<T> = std::result::Result<T, String>;

pub struct Document<'a> {
    xml: &'a Xml<'a>,
    path: Rc<Path>,
    ids: HashMap<&'a str, Element<'a>>,
    /// How many more bytes of elements links may lead to.
    linked_bytes: Cell<usize>,
    warnings: RefCell<Vec<String>>,
}

pub fn parse<'a>(text: &'a str, path: &Path) -> Result<Xml<'a>> {
    // A tag has no "<" inside it, so this counts at least its attributes. Comments and the like start with "!".
    let equal_signs = |piece: &str| piece.bytes().filter(|&byte| byte == b'=').count();
    if text.split('<').any(|piece| !piece.starts_with('!') && equal_signs(piece) > MAX_ATTRIBUTES) {
        return Err(Error::limit(path, format!("an element with more than {MAX_ATTRIBUTES} attributes")));
    }
    if text.matches("xmlns").count() > MAX_NAMESPACES {
        return Err(Error::limit(path, format!("more than {MAX_NAMESPACES} declarations of namespaces")));
    }
    // A tag that opens is a node, and so is a text behind one. The parser also takes a node for each tag that closes, at first,
    // and copies texts whose characters it replaces.
    let (mut tags, mut nodes) = (0, 0);
    for piece in text.split('<') {
        tags += 1;
        nodes += usize::from(!piece.starts_with('/')) + usize::from(!piece.ends_with('>'));
    }
    let copied = if text.contains(['\r', '&']) { text.len() } else { 0 };
    let bytes = tags.max(nodes) * NODE_BYTES + equal_signs(text) * ATTRIBUTE_BYTES + copied;
    memory::request(bytes, || path.display().to_string())?;
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
    pub fn new(xml: &'a Xml<'a>, path: &Path) -> Result<Self> {
        let mut ids = HashMap::new();
        for node in xml.descendants() {
            if let Some(id) = node.attribute("id") {
                memory::insert(&mut ids, id, node, || path.display().to_string())?;
            }
        }
        let (linked_bytes, warnings) = (Cell::new(MAX_LINKED_BYTES), RefCell::default());
        Ok(Self { xml, path: path.into(), ids, linked_bytes, warnings })
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    pub fn root(&self) -> Element<'a> {
        self.xml.root_element()
    }

    /// The place of an element, for a message: to find it takes as long as the text before it.
    pub fn at(&self, node: Element) -> At {
        self.place(node.range().start)
    }

    fn place(&self, offset: usize) -> At {
        let before = &self.xml.input_text()[..offset];
        let line = before.bytes().filter(|&byte| byte == b'\n').count() + 1;
        let column = before.rsplit('\n').next().unwrap_or_default().chars().count() + 1;
        At::new(self.path.clone(), line, column)
    }

    /// Notes what was left out or filled in at an element.
    pub fn warn(&self, node: Element, message: &str) {
        let mut warnings = self.warnings.borrow_mut();
        match warnings.len() {
            0..MAX_WARNINGS => warnings.push(self.at(node).warning(message)),
            MAX_WARNINGS => warnings.push(further_warnings(&self.path)),
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
        let (at, tag) = (|| self.at(node), node.tag_name().name());
        let link = node.attribute(attribute).ok_or_else(|| at().input(format!("<{tag}> has no {attribute}")))?;
        let Some(id) = link.strip_prefix('#') else {
            return Err(
                at().unsupported(format!("{} is in another file: only links within one are supported", quote(link)))
            );
        };
        let found = self.ids.get(id).ok_or_else(|| at().input(format!("no element has the id {}", quote(id))))?;
        if found.tag_name().name() != name {
            let kind = found.tag_name().name();
            return Err(at().input(format!("{} must be a <{name}>, not a <{kind}>", quote(id))));
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
        self.values(node, finite)
    }

    /// All whole numbers in an element, from 0 on.
    pub fn indices(&self, node: Element<'a>) -> Result<Vec<u32>> {
        self.values(node, |word| word.parse().map_err(|_| format!("{} is not a whole number from 0 on", quote(word))))
    }

    /// The values of an element's words.
    fn values<T>(&self, node: Element<'a>, read: impl Fn(&str) -> Read<T>) -> Result<Vec<T>> {
        let mut values = Vec::new();
        for (word, offset) in self.words(node) {
            let value = read(word).map_err(|wrong| self.place(offset).input(wrong))?;
            memory::push(&mut values, value, || self.place(offset).to_string())?;
        }
        Ok(values)
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

pub fn is(node: Element, name: &str) -> bool {
    node.tag_name().name() == name
}
