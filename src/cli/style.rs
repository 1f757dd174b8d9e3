//! `--style`, `--theme`, `--title`, `--width` and `--panels`: how the figures of a command look.

use super::values::choice;
use clap::{ArgAction, Args};
use etalon_core::error::Result;
use etalon_figures::figure::style::{Medium, Style, Theme, WIDTHS};

/// The options, of subcommands that write plots.
#[derive(Args)]
#[command(next_help_heading = "Figures")]
pub struct StyleArgs {
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
    /// Show only panels with these words in their title
    #[arg(long, value_name = "WORDS,...", value_delimiter = ',', action = ArgAction::Set)]
    panels: Vec<String>,
}

impl StyleArgs {
    pub fn style(&self) -> Result<Style> {
        let mut style = Style::new(self.style, self.width)?;
        style.title = self.title.clone().unwrap_or_default();
        style.panels.clone_from(&self.panels);
        style.theme = self.theme;
        Ok(style)
    }

    /// The flags that give this style.
    pub fn flags(&self) -> Vec<(&'static str, String)> {
        let medium = Medium::ALL.into_iter().find(|(.., medium)| *medium == self.style && *medium != Medium::default());
        let theme = Theme::ALL.into_iter().find(|(.., theme)| *theme == self.theme && *theme != Theme::default());
        let given = [
            ("--style", medium.map(|(name, ..)| name.to_owned())),
            ("--theme", theme.map(|(name, ..)| name.to_owned())),
            ("--title", self.title.clone()),
            ("--width", self.width.map(|mm| mm.to_string())),
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
