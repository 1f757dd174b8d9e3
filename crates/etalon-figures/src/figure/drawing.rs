//! A drawing: what a figure shows, before it is laid out for a style; and its pages, written as files.

use super::page::{FORMATS, Page, with_extension};
use super::picture::Picture;
use super::plot::Plot;
use super::shapes::{Anchor, Level, Text};
use super::sheet::Sheet;
use super::style::{Room, Style, Theme};
use super::{Heatmap, text, theme};
use etalon_core::error::{Error, Result};
use etalon_core::files::check_no_input;
use std::path::{Path, PathBuf};

/// Plots, images and texts. A style's room decides how many of them stand side by side, and their size.
#[derive(Debug, Clone, PartialEq)]
#[must_use]
pub enum Drawing {
    Plot(Plot),
    Sheet(Sheet),
    Picture(Picture),
    /// The colour bar of a heat map, of this length where there is room.
    Bar(Heatmap, f64),
    /// A title and lines of text, with a drawing below them.
    Headed {
        title: String,
        lines: Vec<String>,
        below: Box<Drawing>,
    },
    /// Drawings below each other; `align` is 0 for their left edges in line, 0.5 for their middles.
    Stack {
        rows: Vec<Drawing>,
        align: f64,
    },
    /// Drawings side by side, or below each other on a page of limited width.
    Beside(Vec<Drawing>),
}

impl From<Page> for Drawing {
    /// A page that is enlarged or reduced as a whole.
    fn from(page: Page) -> Self {
        Self::Picture(Picture { page, key: Vec::new() })
    }
}

impl Drawing {
    /// Drawings below each other.
    pub fn stacked(rows: Vec<Drawing>, align: f64) -> Self {
        Self::Stack { rows, align }
    }

    /// Drawings side by side, so that a long one is not much higher than wide.
    pub fn beside(columns: Vec<Drawing>) -> Self {
        Self::Beside(columns)
    }

    /// A title and some lines above this drawing.
    pub fn headed(self, title: impl Into<String>, lines: Vec<String>) -> Self {
        Self::Headed { title: title.into(), lines, below: Box::new(self) }
    }

    /// The pages of this drawing in a style: one, except for slides, which have a fixed height, and columns, which have a largest one.
    ///
    /// # Errors
    /// [`Error::Parameter`] if no panel has one of the names of [`Style::panels`], or a part does not fit.
    pub fn pages(&self, style: &Style) -> Result<Vec<Page>> {
        let shown = self.named(style)?.titled(&style.title);
        let finished = |page: Page| {
            let page = Page { unit: style.unit, scale: style.room.pixels.unwrap_or(page.scale), ..page.within(style) };
            if style.theme == Theme::Dark { page.darkened() } else { page }
        };
        Ok(shown.fitted(style)?.into_iter().map(finished).collect())
    }

    /// The page that is as large as its content.
    pub fn natural(&self) -> Page {
        self.laid(Room::UNLIMITED)
    }

    /// That page as an SVG document.
    pub fn svg(&self) -> String {
        self.natural().svg()
    }

    /// Writes `STEM.svg`, `STEM.png` and `STEM.pdf`, of further pages `STEM-2.svg` and so on, and returns their paths.
    ///
    /// # Errors
    /// Those of [`Drawing::pages`] and [`Page::write`].
    pub fn write(&self, stem: &Path, style: &Style) -> Result<Vec<PathBuf>> {
        write_pages(&self.pages(style)?, stem, &FORMATS)
    }

    /// Writes it in the format that the extension of `path` names: svg, png or pdf. Returns the paths of its pages.
    ///
    /// # Errors
    /// As [`Drawing::write`]; [`Error::Parameter`] for another format.
    pub fn save(&self, path: &Path, style: &Style) -> Result<Vec<PathBuf>> {
        let format = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        write_pages(&self.pages(style)?, &path.with_extension(""), &[&format])
    }

    /// As few pages as there must be: what does not fit on one is divided.
    fn fitted(self, style: &Style) -> Result<Vec<Page>> {
        let (page, pieces) = (self.within(style.room), self.pieces());
        match page {
            Some(page) if pieces.len() < 2 || page.height <= style.tallest * style.room.width => return Ok(vec![page]),
            None if pieces.len() < 2 || !style.is_fixed => return Err(self.too_large(style)),
            _ => {}
        }
        let pages = pieces.into_iter().map(|piece| piece.fitted(style)).collect::<Result<Vec<_>>>()?;
        Ok(pages.concat())
    }

    /// What this drawing is divided into where it does not fit on a page: the drawings of a stack, rows of panels under headings, or
    /// half of the panels or images each.
    fn pieces(&self) -> Vec<Self> {
        match self {
            Self::Stack { rows, align } if rows.iter().filter(|row| !row.is_bar()).count() > 1 => {
                // A colour bar stays with what stands above it
                let groups = rows.chunk_by(|_, next| next.is_bar());
                groups.map(|rows| Self::stacked(rows.to_vec(), *align)).collect()
            }
            Self::Beside(columns) if columns.len() > 1 => columns.clone(),
            // Every page has the title
            Self::Headed { title, lines, below } => {
                below.pieces().into_iter().map(|piece| piece.headed(title.clone(), lines.clone())).collect()
            }
            Self::Plot(plot) if plot.has_headings() => plot.rows_apart().into_iter().map(Self::Plot).collect(),
            _ => {
                let parts = self.names().len();
                let half = |from: usize, to: usize| {
                    let mut index = 0;
                    self.select(&[], &mut |_| {
                        index += 1;
                        (from..to).contains(&(index - 1))
                    })
                };
                let middle = parts.div_ceil(2).next_multiple_of(self.unit()).min(parts);
                [half(0, middle), half(middle, parts)].into_iter().flatten().collect()
            }
        }
    }

    /// The images that stay together, also of a sheet above its colour bar.
    fn unit(&self) -> usize {
        match self {
            Self::Sheet(sheet) => sheet.unit(),
            Self::Stack { rows, .. } => rows.iter().map(Self::unit).max().unwrap_or(1),
            _ => 1,
        }
    }

    fn is_bar(&self) -> bool {
        matches!(self, Self::Bar(..))
    }

    fn too_large(&self, style: &Style) -> Error {
        let mm = style.width_mm();
        let wider = |factor: &f64| {
            self.within(Room { width: style.room.width * factor, height: f64::INFINITY, ..style.room }).is_some()
        };
        let enough = (1..60).map(|tenths| 1.0 + 0.1 * f64::from(tenths)).find(wider);
        let error = Error::parameter("page_width", format!("the figure does not fit on a page of {mm:.0} mm"));
        match enough {
            Some(factor) if !style.is_fixed => error.with_hint(format!("{:.0} mm are enough", (mm * factor).ceil())),
            _ => error.with_hint("choose some of its panels with `panels`"),
        }
    }

    /// The page, if the drawing fits into the room.
    fn within(&self, room: Room) -> Option<Page> {
        const ROUNDING: f64 = 1.0;
        let page = self.laid(room);
        (page.width <= room.width + ROUNDING && page.height <= room.height + ROUNDING).then_some(page)
    }

    /// The page for a room. It is larger where the content needs more.
    pub(super) fn laid(&self, room: Room) -> Page {
        match self {
            Self::Plot(plot) => plot.laid(room),
            Self::Sheet(sheet) => sheet.laid(room),
            Self::Picture(picture) => picture.laid(room),
            Self::Bar(map, length) => map.lying_bar(*length, room.width),
            Self::Headed { title, lines, below } => headed(title, lines, below, room),
            Self::Stack { rows, align } => stack(rows, *align, room),
            Self::Beside(columns) if room.width.is_infinite() => {
                Page::beside(columns.iter().map(Self::natural).collect())
            }
            Self::Beside(columns) => stack(columns, 0.0, room),
        }
    }

    /// What this drawing consists of: panels and images by their titles and captions, each behind the titles of the groups that it is in.
    fn names(&self) -> Vec<Vec<String>> {
        let mut names = Vec::new();
        self.select(&[], &mut |name| {
            names.push(name.iter().map(|part| text::plain(part)).collect());
            true
        });
        names
    }

    /// The panels and images whose name, or that of a group that they are in, has one of the style's names in it, in any case.
    fn named(&self, style: &Style) -> Result<Self> {
        if style.panels.is_empty() {
            return Ok(self.clone());
        }
        let mut wanted = Wanted::of(style);
        wanted.style(self);
        wanted.check()?;
        let shown = self.select(&[], &mut |name| style.panels.iter().any(|words| has(name, words)));
        Ok(shown.unwrap_or_else(|| self.clone()))
    }

    /// The parts that `keep` wants, asked in order, inside of these groups; `None` if it wants none.
    fn select(&self, groups: &[&str], keep: &mut Keep) -> Option<Self> {
        match self {
            Self::Plot(plot) => plot.select(groups, keep).map(Self::Plot),
            Self::Sheet(sheet) => sheet.select(groups, keep).map(Self::Sheet),
            Self::Picture(_) => keep(groups).then(|| self.clone()),
            Self::Bar(..) => Some(self.clone()),
            Self::Headed { title, lines, below } => {
                let below = below.select(&[groups, &[title.as_str()]].concat(), keep)?;
                Some(below.headed(title.clone(), lines.clone()))
            }
            Self::Stack { rows, align } => {
                let rows: Vec<Self> = rows.iter().filter_map(|row| row.select(groups, keep)).collect();
                (!rows.iter().all(Self::is_bar)).then_some(Self::Stack { rows, align: *align })
            }
            Self::Beside(columns) => {
                let columns: Vec<Self> = columns.iter().filter_map(|column| column.select(groups, keep)).collect();
                (!columns.is_empty()).then_some(Self::Beside(columns))
            }
        }
    }

    /// The drawing under a title of the user's, if there is one.
    fn titled(self, title: &str) -> Self {
        match self {
            same if title.is_empty() => same,
            Self::Plot(plot) if plot.is_single() => Self::Plot(plot.titled(title)),
            Self::Sheet(sheet) => Self::Sheet(Sheet { title: title.into(), ..sheet }),
            Self::Headed { lines, below, .. } => below.headed(title, lines),
            other => other.headed(title, Vec::new()),
        }
    }
}

/// Whether a part is wanted, by the titles of its groups and its own.
pub(super) type Keep<'a> = dyn FnMut(&[&str]) -> bool + 'a;

/// Whether a name, or that of a group, has these words in it, in any case.
fn has(name: &[impl AsRef<str>], words: &str) -> bool {
    name.iter().any(|part| text::plain(part.as_ref()).to_lowercase().contains(&words.to_lowercase()))
}

/// The wanted panels of several drawings of one command, each of which may have some of them.
pub struct Wanted<'a> {
    style: &'a Style,
    /// The names of all parts that were seen.
    known: Vec<Vec<String>>,
}

impl<'a> Wanted<'a> {
    pub fn of(style: &'a Style) -> Self {
        Self { style, known: Vec::new() }
    }

    /// The style of one of the drawings: with those of the wanted panels that it has, or all where it has none of them.
    pub fn style(&mut self, drawing: &Drawing) -> Style {
        let names = drawing.names();
        let panels = self.style.panels.iter().filter(|words| names.iter().any(|name| has(name, words)));
        let style = Style { panels: panels.cloned().collect(), ..self.style.clone() };
        self.known.extend(names);
        style
    }

    /// Whether every wanted panel is in one of the drawings.
    ///
    /// # Errors
    /// [`Error::Parameter`] with the names of all.
    pub fn check(self) -> Result<()> {
        let is_unknown = |words: &&String| !self.known.iter().any(|name| has(name, words));
        let Some(words) = self.style.panels.iter().find(is_unknown) else { return Ok(()) };
        let mut known: Vec<String> = Vec::new();
        for name in self.known.into_iter().flatten().filter(|name| !name.is_empty()) {
            let name = format!("\"{name}\"");
            if !known.contains(&name) {
                known.push(name);
            }
        }
        let hint = if known.is_empty() { "it has none".into() } else { format!("they are {}", known.join(", ")) };
        Err(Error::parameter("panels", format!("no panel is called \"{words}\"")).with_hint(hint))
    }
}

/// Writes pages under one name, those after the first with their number, in formats of [`FORMATS`].
///
/// # Errors
/// Those of [`Page::write`]; [`Error::Parameter`] if a further page would replace an input.
pub fn write_pages(pages: &[Page], stem: &Path, formats: &[&str]) -> Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for (i, page) in pages.iter().enumerate() {
        let mut name = stem.as_os_str().to_owned();
        if i > 0 {
            name.push(format!("-{}", i + 1));
            let of = |extension: &&str| with_extension(Path::new(&name), extension);
            formats.iter().try_for_each(|extension| check_no_input(&of(extension)))?;
        }
        files.extend(page.write(Path::new(&name), formats)?);
    }
    Ok(files)
}

/// Space at the page's edge, beside a title and lines of text.
const EDGE: f64 = 12.0;

/// The least width, in drawing units, at which texts above a drawing are broken.
const NARROWEST: f64 = 700.0;

fn headed(title: &str, lines: &[String], below: &Drawing, room: Room) -> Page {
    // Texts are as wide as what is below them, or as a column of text
    let natural = room.width.is_infinite().then(|| below.laid(room));
    let limit = natural.as_ref().map_or(room.width, |body| body.width.max(NARROWEST)) - 2.0 * EDGE;
    let broken = |text: &str, size: f64, bold: bool| text::wrapped(text, size, bold, limit);
    let (first, pitch) = (EDGE + theme::TITLE_SIZE, 1.5 * theme::NOTE_SIZE);
    let titles = broken(title, theme::TITLE_SIZE, true);
    let lines: Vec<String> = lines.iter().flat_map(|line| broken(line, theme::NOTE_SIZE, false)).collect();
    let count = titles.len().max(1) + lines.len();
    let top = first + pitch * (count - 1).max(1) as f64;
    let body = natural.unwrap_or_else(|| below.laid(Room { height: room.height - top, ..room }));
    let texts = titles.into_iter().map(|line| (line, theme::TITLE_SIZE, true));
    let texts: Vec<_> = texts.chain(lines.into_iter().map(|line| (line, theme::NOTE_SIZE, false))).collect();
    let widest = texts.iter().map(|(line, size, bold)| text::width(line, *size, *bold)).fold(0.0, f64::max);
    let width = body.width.max(widest + 2.0 * EDGE).ceil();
    let mut page = Page::new(width, (top + body.height.max(EDGE)).ceil(), body.scale);
    let left = 0.5 * (width - body.width);
    page.append(body, left, top);
    for (i, (line, size, bold)) in texts.into_iter().enumerate() {
        let text = Text::new([0.5 * width, first + pitch * i as f64], size, line).held(Anchor::Middle, Level::Baseline);
        page.text(if bold { text.bold() } else { text });
    }
    page
}

/// Drawings below each other. Where they are higher than the room, each is given its share of it.
fn stack(rows: &[Drawing], align: f64, room: Room) -> Page {
    let free = Room { height: f64::INFINITY, ..room };
    let natural: Vec<Page> = rows.iter().map(|row| row.laid(free)).collect();
    let heights = |bars: bool| {
        let of_kind = rows.iter().zip(&natural).filter(|(row, _)| row.is_bar() == bars);
        of_kind.map(|(_, page)| page.height).sum::<f64>()
    };
    let share = (room.height - heights(true)) / heights(false);
    if share >= 1.0 {
        return Page::stacked(natural, align);
    }
    let laid = |(row, page): (&Drawing, Page)| {
        let height = page.height * share;
        if row.is_bar() { page } else { row.laid(Room { height, ..room }) }
    };
    Page::stacked(rows.iter().zip(natural).map(laid).collect(), align)
}

#[cfg(test)]
mod tests {
    use super::super::page::Item;
    use super::super::style::Medium;
    use super::super::{Axis, Panel, Rgb8, contact_sheet};
    use super::*;

    fn panels(count: usize) -> Vec<Panel> {
        let panel = |i: usize| {
            let title = format!("Panel number {i} with a title that is longer than its frame is wide");
            let axes =
                (Axis::linear("angle of incidence /{θ} (degrees)").range(0.0, 90.0).every(15.0), Axis::linear("y"));
            let wave: Vec<_> = (0..91).map(|x| [f64::from(x), (f64::from(x) * 0.3).sin()]).collect();
            let name = "the curve of this panel, with a label that no column has room for in one line";
            Panel::new(axes.0, axes.1).title(title).line(format!("{name} {i}"), theme::series(i), wave)
        };
        (0..count).map(panel).collect()
    }

    fn drawings() -> Vec<Drawing> {
        let images: Vec<_> =
            (0..7).map(|i| (format!("image {i} of a series"), Rgb8::from_fn(96, 64, |_, _| [9; 3]))).collect();
        let map = Page::over(Rgb8::from_fn(1024, 512, |_, _| [0; 3]));
        vec![
            Plot::new(panels(1)).draw(),
            Plot::new(panels(3)).draw(),
            Plot::grid([("Heading".to_owned(), panels(4)), ("Another".to_owned(), panels(2))]).draw(),
            Drawing::stacked(vec![Plot::new(panels(2)).draw(), contact_sheet("Images", 5, &images)], 0.5),
            Drawing::from(map),
            Plot::new(panels(2)).draw().headed("A title", vec!["word ".repeat(60)]),
        ]
    }

    fn smallest_type(page: &Page) -> f64 {
        let size = |item: &Item| if let Item::Text(text) = item { Some(text.size) } else { None };
        page.items.iter().filter_map(size).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn a_column_is_84_mm_wide_with_type_of_7_pt() {
        let style = Style::new(Medium::Column, None).unwrap();
        for drawing in drawings() {
            for page in drawing.pages(&style).unwrap() {
                assert!((page.width * page.unit * 25.4 / 96.0 - 84.0).abs() < 0.3, "{}", page.width);
                assert!(smallest_type(&page) * page.unit * 0.75 >= 7.0);
                assert!(smallest_index(&page) * page.unit * 0.75 >= 5.5);
                assert!(page.height <= 1.5 * page.width, "{} by {}", page.width, page.height);
            }
        }
        assert!(Plot::new(panels(3)).draw().pages(&style).unwrap().len() > 1, "a page of all would be too high");
    }

    /// The smallest index or exponent.
    fn smallest_index(page: &Page) -> f64 {
        let texts = page.items.iter().filter_map(|item| if let Item::Text(text) = item { Some(text) } else { None });
        let sizes = texts.flat_map(|text| text::runs(&text.markup, text.size, text.bold)).map(|run| run.size);
        sizes.fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn slides_are_16_to_9_with_type_of_3_percent_of_their_height() {
        let style = Style::new(Medium::Slide, Some(200.0)).unwrap();
        let all = drawings();
        for drawing in &all {
            for page in drawing.pages(&style).unwrap() {
                assert!((page.width / page.height - 16.0 / 9.0).abs() < 0.01, "{} {}", page.width, page.height);
                assert!(smallest_type(&page) >= 0.03 * page.height);
                let inside =
                    |item: &Item| !matches!(item, Item::Text(t) if t.at[1] > page.height || t.at[0] > page.width);
                assert!(page.items.iter().all(inside));
            }
        }
        assert!(all[2].pages(&style).unwrap().len() > 1, "six panels are too many for a slide");
    }

    #[test]
    fn a_style_has_its_own_width_colours_title_and_panels() {
        let drawing = Plot::new(panels(3)).draw();
        let wide = Style::new(Medium::Screen, Some(200.0)).unwrap();
        assert!((drawing.pages(&wide).unwrap()[0].width - 200.0 * 96.0 / 25.4).abs() < 2.0);
        let style =
            Style { theme: Theme::Dark, title: "Mine".into(), panels: vec!["NUMBER 2".into()], ..Style::default() };
        let page = &drawing.pages(&style).unwrap()[0];
        let texts: Vec<&Text> =
            page.items.iter().filter_map(|i| if let Item::Text(t) = i { Some(t) } else { None }).collect();
        assert!(texts.iter().any(|t| t.markup == "Mine") && !texts.iter().any(|t| t.markup.contains("Panel number")));
        assert!(texts.iter().all(|t| t.colour != theme::INK) && page.paper == theme::DARK_PAPER);
        let unknown = Style { panels: vec!["number 9".into()], ..Style::default() };
        assert!(drawing.pages(&unknown).unwrap_err().to_string().contains("number 9"));
    }

    #[test]
    fn groups_of_panels_have_names_too() {
        let style = |words: &str| Style { panels: vec![words.into()], ..Style::default() };
        let select = |drawing: &Drawing, words: &str| drawing.named(&style(words)).unwrap().names().len();
        let all = drawings();
        assert_eq!([select(&all[2], "heading"), select(&all[3], "IMAGES"), select(&all[5], "a title")], [4, 7, 2]);
        // Among several drawings, those without the panel are whole
        let image = style("image 2");
        let mut wanted = Wanted::of(&image);
        assert_eq!([&all[0], &all[3]].map(|drawing| wanted.style(drawing).panels.len()), [0, 1]);
        assert!(wanted.check().is_ok());
        let mut wanted = Wanted::of(&image);
        wanted.style(&all[1]);
        assert!(wanted.check().unwrap_err().to_string().contains("image 2"));
    }

    #[test]
    fn a_page_too_narrow_for_its_content_is_an_error() {
        let axis = Axis::linear("x").range(0.0, 1.0);
        let names =
            Axis::named("", vec!["a name that is longer than a narrow page has room for beside a frame".to_owned()]);
        let drawing = Plot::new([Panel::new(axis, names)]).draw();
        let error = drawing.pages(&Style::new(Medium::Column, Some(30.0)).unwrap()).unwrap_err();
        assert!(format!("{error:?}").contains("mm are enough"), "{error:?}");
        assert!(Style::new(Medium::Column, Some(3.0)).is_err());
    }

    #[test]
    fn further_slides_have_files_of_their_own() {
        let dir = tempfile::tempdir().unwrap();
        let style = Style::new(Medium::Slide, None).unwrap();
        let files = Plot::new(panels(9)).draw().write(&dir.path().join("v1.5"), &style).unwrap();
        let names: Vec<_> = files.iter().map(|f| f.file_name().unwrap().to_str().unwrap()).collect();
        assert_eq!(names[..4], ["v1.5.svg", "v1.5.png", "v1.5.pdf", "v1.5-2.svg"]);
    }
}
