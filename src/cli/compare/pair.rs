//! `etalon compare A B`: how far two images are apart.

use super::{Compare, left_out, measure, read, why};
use crate::cli::console::Console;
use crate::cli::global::{Global, Verdict};
use etalon_bench::compare::Measured;
use etalon_bench::table::Table;
use etalon_core::error::Result;
use etalon_core::interrupt;
use etalon_figures::output::{self, Saving, name_of_pair};
use etalon_figures::view::checks::Checks;
use etalon_figures::view::compare as view;
use etalon_figures::view::text::{LINE, rounded, wrapped};
use std::path::Path;
use std::time::Instant;

impl Compare {
    pub(super) fn measure(&self, a_path: &Path, b_path: &Path, global: &Global, console: &Console) -> Result<Verdict> {
        let start = Instant::now();
        self.reports.check()?;
        let name = name_of_pair(&[a_path.into()], "vs", &[b_path.into()]);
        let (target, style) = (global.target(), self.style.style()?);
        let stem = target.stem(&name, "", &output::DRAWING)?;
        let bar = console.busy("compare");
        let (a, b) = (read(a_path)?, read(b_path)?);
        a.notes.iter().chain(&b.notes).for_each(|note| console.warn(note));
        let measured = measure(a_path, &a, b_path, &b)?.map_err(|other| other.error(a_path, b_path))?;
        interrupt::check()?;
        bar.finish_and_clear();
        let mut saving = Saving::default();
        let shown = [a_path, b_path].map(|path| path.display().to_string());
        let drawing = view::pair([&a.image, &b.image], &shown, &measured, self.relative);
        saving.add(drawing.write(&stem, &style));
        let title = format!("{} against {}", shown[0], shown[1]);
        let list = self.checks(&title, &measured);
        let checks = Checks { title: format!("etalon compare {title}"), list, seconds: start.elapsed().as_secs_f64() };
        saving.add(self.reports.write(&checks));
        let (files, saved) = saving.end();
        left_out(&measured).iter().for_each(|lost| console.warn(lost));
        let clipped = match [a.is_clipped, b.is_clipped] {
            [false, false] => None,
            [true, true] => Some("both images have integer values: rounded, clipped at 1, decoded by the sRGB curve"),
            _ => Some(
                "one image has integer values, the other linear light: the first is rounded, clipped at 1 and decoded by the sRGB \
                 curve; its exposure or tone map is not undone",
            ),
        };
        clipped.iter().for_each(|text| console.warn(text));
        let rejected: String = checks
            .list
            .iter()
            .filter(|check| check.verdict == Some(etalon_stats::Verdict::Reject))
            .map(|check| wrapped(&format!("rejected: {}", check.message), "", LINE))
            .collect();
        console.saved(&measured, &target.written(files), || rejected + &text(&measured));
        saved?;
        Ok(Verdict::of(self.is_within(&measured), false))
    }
}

/// That both images are the same, or what would explain their difference.
fn in_words(measured: &Measured) -> Option<String> {
    match measured.identical {
        true => Some("A and B are the same values".into()),
        false => why(measured),
    }
}

fn text(measured: &Measured) -> String {
    let Measured { numbers, shown, .. } = measured;
    let trimmed = |value: f64| format!("{} without the worst 0.1 %", rounded(value, 4));
    let metrics = [
        ("mse", numbers.mse, trimmed(numbers.mse_trimmed)),
        ("rmse", numbers.rmse, String::new()),
        ("rel_mse", numbers.rel_mse, trimmed(numbers.rel_mse_trimmed)),
        ("mape", numbers.mape, trimmed(numbers.mape_trimmed)),
        ("smape", numbers.smape, trimmed(numbers.smape_trimmed)),
        ("hdr_flip", shown.hdr_flip.unwrap_or(f64::NAN), String::new()),
        ("psnr", shown.psnr, "dB".to_owned()),
        ("ssim", shown.ssim.unwrap_or(f64::NAN), String::new()),
        ("max_abs", numbers.max_abs, String::new()),
        ("mean_a", numbers.mean_a, String::new()),
        ("mean_b", numbers.mean_b, String::new()),
    ];
    let metrics = Table::of(&metrics)
        .words("", |(name, ..)| name)
        .numbers("", |(_, value, _)| rounded(*value, 4))
        .words("", |(.., more)| more);
    in_words(measured).map_or(String::new(), |words| wrapped(&words, "", LINE)) + &metrics.text()
}
