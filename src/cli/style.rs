//! `--style`, `--theme`, `--title`, `--width` and `--panels`: how the figures of a command look.

use super::values::choice;
use clap::{ArgAction, Args};
use etalon_core::error::Result;
use etalon_figures::figure::style::{Medium, Style, Theme, WIDTHS};

/// The options, of subcommands that write figures of one panel.
#[derive(Args)]
#[command(next_help_heading = "Figures")]
pub struct FigureArgs {
    /// Where the figures will be seen
    ///
    /// It sets the size of type and lines, and how many panels stand side by side.
    #[arg(long, default_value = "screen", value_parser = choice(Medium::ALL))]
    style: Medium,
    /// Colours of paper and ink; maps of values keep theirs
    #[arg(long, default_value = "light", value_parser = choice(Theme::ALL))]
    theme: Theme,
    /// The title above the figure
    #[arg(long, value_name = "TEXT")]
    title: Option<String>,
    /// Width of the figure in mm [default: 84 for column, 339 for slide]
    #[arg(id = "page_width", long = "width", value_name = "MM", value_parser = width, allow_negative_numbers = true)]
    width: Option<f64>,
}

/// The options, of subcommands that write plots.
#[derive(Args)]
#[command(next_help_heading = "Figures")]
pub struct StyleArgs {
    #[command(flatten)]
    figure: FigureArgs,
    /// Show only panels with these words in their title
    ///
    /// Or in that of their group, or in the caption of an image. Of several figures, those that have no such panel are drawn in full.
    #[arg(long, value_name = "WORDS,...", value_delimiter = ',', action = ArgAction::Set)]
    panels: Vec<String>,
}

impl FigureArgs {
    pub fn style(&self) -> Result<Style> {
        let mut style = Style::new(self.style, self.width)?;
        style.title = self.title.clone().unwrap_or_default();
        style.theme = self.theme;
        Ok(style)
    }
}

impl StyleArgs {
    pub fn style(&self) -> Result<Style> {
        let mut style = self.figure.style()?;
        style.panels.clone_from(&self.panels);
        Ok(style)
    }

    /// The flags that give this style.
    pub fn flags(&self) -> Vec<(&'static str, String)> {
        let FigureArgs { style, theme, title, width } = &self.figure;
        let medium = Medium::ALL.into_iter().find(|(.., medium)| medium == style && *medium != Medium::default());
        let theme = Theme::ALL.into_iter().find(|(.., known)| known == theme && *known != Theme::default());
        let given = [
            ("--style", medium.map(|(name, ..)| name.to_owned())),
            ("--theme", theme.map(|(name, ..)| name.to_owned())),
            ("--title", title.clone()),
            ("--width", width.map(|mm| mm.to_string())),
            ("--panels", (!self.panels.is_empty()).then(|| self.panels.join(","))),
        ];
        given.into_iter().filter_map(|(flag, value)| Some((flag, value?))).collect()
    }
}

fn width(text: &str) -> std::result::Result<f64, String> {
    let [least, most] = WIDTHS;
    let mm = text.strip_suffix("mm").unwrap_or(text).trim().parse().ok();
    mm.filter(|mm| (least..=most).contains(mm)).ok_or(format!("not a number of millimetres from {least} to {most}"))
}
