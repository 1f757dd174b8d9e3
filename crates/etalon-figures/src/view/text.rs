//! Numbers as text.

/// A count with its noun: "1 test", "2 tests".
pub fn counted(n: usize, noun: &str) -> String {
    format!("{n} {noun}{}", if n == 1 { "" } else { "s" })
}

/// "0.52 s", "0.095 s", "3.1 ms".
pub fn duration(seconds: f64) -> String {
    if seconds < 0.01 { format!("{:.1}\u{a0}ms", 1e3 * seconds) } else { format!("{}\u{a0}s", rounded(seconds, 2)) }
}

/// A small p-value, with markup: "≈ 10^{−17}", or "< 10^{−300}" for what f64 cannot hold.
pub fn power_of_ten(p: f64) -> String {
    if p >= 1e-300 { format!("≈ 10^{{−{:.0}}}", -p.log10()) } else { "< 10^{−300}".into() }
}

/// An exponent in raised digits, for texts without markup: "⁻¹¹".
pub fn superscript(exponent: i32) -> String {
    let raised = |c: char| match c.to_digit(10) {
        Some(digit) => ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'][digit as usize],
        None => '⁻',
    };
    exponent.to_string().chars().map(raised).collect()
}

/// A p-value, with markup: "/{p} = 0.123", or the power of ten of a small one.
pub fn p_value(p: f64) -> String {
    if p >= 1e-3 { format!("/{{p}} = {p:.3}") } else { format!("/{{p}} {}", power_of_ten(p)) }
}

/// A finding of a test with its p-values ("p < 1e-300"), angles and minus signs in markup.
pub fn finding(text: &str) -> String {
    let words: Vec<&str> = text.split(' ').collect();
    let mut marked: Vec<String> = Vec::new();
    let mut i = 0;
    while i < words.len() {
        let number = words.get(i + 2).map(|word| word.trim_end_matches(')'));
        let p = number.and_then(|number| number.parse::<f64>().ok());
        match (words[i].strip_suffix('p'), words.get(i + 1), p) {
            (Some(before @ ("" | "(")), Some(&("=" | "<")), Some(p)) => {
                let is_limit = words[i + 1] == "<";
                let after = if words[i + 2].ends_with(')') { ")" } else { "" };
                marked.push(format!("{before}{}{after}", p_value(if is_limit { 0.0 } else { p })));
                i += 3;
            }
            _ => {
                marked.push(words[i].to_owned());
                i += 1;
            }
        }
    }
    marked.join(" ").replace("theta", "/{θ}").replace("phi", "/{φ}").replace(" - ", " − ").replace("..", "–")
}

/// The clauses of a finding in few words, for a figure: without asides and the place of an example, which the text beside it has; angles in
/// whole degrees and other numbers of few digits.
pub fn clauses(text: &str) -> Vec<String> {
    let parts = without_asides(text);
    // "weight = f |cos| / pdf fails in 7 of 9 comparisons, as at wo 30°: a probability of 1.01"
    let with_example = |part: &str| match part.split_once(", as at ") {
        Some((law, example)) => {
            let found = example.rsplit(": ").next().unwrap_or_default();
            // Two numbers, which the figure has
            let found = if found.starts_with(|c: char| c.is_ascii_digit()) { None } else { Some(found.to_owned()) };
            found.into_iter().chain([law.to_owned()]).collect::<Vec<_>>()
        }
        None => vec![part.to_owned()],
    };
    let one = |part: String| {
        // "formula: …", "wo: …"
        let is_name = |name: &str| name.chars().all(|c| c.is_ascii_lowercase());
        let told = part.split_once(": ").filter(|(name, _)| is_name(name)).map_or(&*part, |(_, told)| told);
        short_numbers(&whole_degrees(told))
    };
    parts.split("; ").flat_map(with_example).map(one).collect()
}

/// A text without brackets that have numbers with decimals, or much, in them.
fn without_asides(text: &str) -> String {
    let (mut rest, mut kept) = (text, String::new());
    while let Some(start) = rest.find(" (") {
        let mut depth = 0;
        let end = rest[start..].char_indices().find_map(|(at, c)| {
            depth += i32::from(c == '(') - i32::from(c == ')');
            (c == ')' && depth == 0).then_some(start + at + 1)
        });
        let end = end.unwrap_or(rest.len());
        let inside = &rest[start..end];
        let decimal = |pair: &[u8]| pair[0] == b'.' && pair[1].is_ascii_digit();
        let is_aside = inside.len() > 40 || inside.as_bytes().windows(2).any(decimal);
        kept += if is_aside { &rest[..start] } else { &rest[..end] };
        rest = &rest[end..];
    }
    kept + rest
}

/// A text with its angles in whole degrees, unless two that differ are one then.
fn whole_degrees(text: &str) -> String {
    fn parted(part: &str) -> (&str, &str) {
        let digits = part.rfind(|c: char| !c.is_ascii_digit() && c != '.').map_or(0, |at| at + 1);
        // "24.41°..37.96°"
        part.split_at(part.len() - part[digits..].trim_start_matches('.').len())
    }
    let Some((angles, rest)) = text.rsplit_once('°') else { return text.to_owned() };
    let parts: Vec<(&str, &str)> = angles.split('°').map(parted).collect();
    let whole = |angle: &str| angle.parse::<f64>().map_or(angle.to_owned(), |angle| format!("{angle:.0}"));
    let is_one = |a: &str, b: &str| a != b && whole(a) == whole(b);
    if parts.iter().any(|(_, a)| parts.iter().any(|(_, b)| is_one(a, b))) {
        return text.to_owned();
    }
    let told: Vec<String> = parts.iter().map(|(before, angle)| format!("{before}{}", whole(angle))).collect();
    format!("{}°{rest}", told.join("°"))
}

/// A text whose numbers have at most four digits, or as many as tell them from a whole one.
fn short_numbers(text: &str) -> String {
    let short = |word: &str| {
        let start = word.find(|c: char| c.is_ascii_digit()).unwrap_or(word.len());
        let end = word.rfind(|c: char| c.is_ascii_digit()).map_or(start, |at| at + 1);
        let number = &word[start..end];
        let Some(value) = number.parse::<f64>().ok().filter(|_| number.contains('.')) else { return word.to_owned() };
        let to = |digits: usize| format!("{value:.digits$e}").parse().unwrap_or(value);
        let is_told = |x: &f64| x.fract() != 0.0 || value.fract() == 0.0;
        let told = (3..12).map(to).find(is_told).unwrap_or(value);
        let told = if number.contains('e') { format!("{told:e}") } else { told.to_string() };
        format!("{}{told}{}", &word[..start], &word[end..])
    };
    let words = text.split(' ').map(|word| word.split("..").map(short).collect::<Vec<_>>().join(".."));
    words.collect::<Vec<_>>().join(" ")
}

/// A p-value of a table: "0.1234", "1.5e-9", or "< 1e-300" for what f64 cannot hold.
pub fn plain_p_value(p: f64) -> String {
    match p {
        p if p < 1e-300 => "< 1e-300".into(),
        p if p < 1e-3 => format!("{p:.1e}"),
        p => format!("{p:.4}"),
    }
}

/// The same in a sentence: "p = 0.1234", "p < 1e-300".
pub fn p_is(p: f64) -> String {
    let value = plain_p_value(p);
    if value.starts_with('<') { format!("p {value}") } else { format!("p = {value}") }
}

/// A number rounded to n significant digits, with an exponent only if it is very small or large.
pub fn rounded(value: f64, digits: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    // The exponent after rounding: 9.99 is 10 in two digits
    let scientific = format!("{value:.*e}", digits - 1);
    let exponent = scientific.split_once('e').and_then(|(_, exponent)| exponent.parse::<i32>().ok()).unwrap_or(0);
    match exponent {
        -4..=4 => format!("{value:.*}", usize::try_from(digits as i32 - 1 - exponent).unwrap_or(0)),
        _ => scientific,
    }
}

/// Characters in a line of a terminal.
pub const LINE: usize = 80;

/// The words of a text in lines of at most `width` characters (a longer word has a line of its own), each after `indent`.
pub fn wrapped(text: &str, indent: &str, width: usize) -> String {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        let line = lines.last().map_or(0, |line| line.chars().count());
        if line > 0 && indent.len() + line + 1 + word.chars().count() > width {
            lines.push(String::new());
        }
        if let Some(line) = lines.last_mut() {
            *line += if line.is_empty() { "" } else { " " };
            *line += word;
        }
    }
    lines.iter().map(|line| format!("{indent}{line}\n")).collect()
}

/// A text with its first letter in upper case, unless that is the name of a function or of a variable.
pub fn capitalized(text: &str) -> String {
    let is_variable = text.get(1..2) == Some(" ") && !text.starts_with("a ");
    if text.get(1..2) == Some("(") || is_variable {
        return text.to_owned();
    }
    let mut chars = text.chars();
    chars.next().map_or_else(String::new, |first| first.to_uppercase().chain(chars).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn findings_are_set_as_formulas() {
        assert_eq!(
            finding("neighbours differ by 42 % (RMS) (p < 1e-300)"),
            "neighbours differ by 42 % (RMS) (/{p} < 10^{−300})"
        );
        assert_eq!(finding("1 - cos θ (p = 3.76e-212)"), "1 − cos θ (/{p} ≈ 10^{−211})");
        assert_eq!(finding("38 % too few for theta 1..2"), "38 % too few for /{θ} 1–2");
    }

    #[test]
    fn figures_have_findings_in_few_words() {
        let found = "formula: weight = f |cos| / pdf fails in 3075 of 3081 comparisons, as at wo (30.0000°, 36.87°), u = (0.9, 0.3) \
                     (weight · pdf, f |cos|): 5.639195 and 5.675405, 0.994 times; ratios are from 0.973 to 1.03";
        let few = ["weight = f |cos| / pdf fails in 3075 of 3081 comparisons", "ratios are from 0.973 to 1.03"];
        assert_eq!(clauses(found), few);
        let found = "the sample (-0.069404, 0.994738) carries the pdf 0.397887, but the density says 0.795775 (sampled from u = (0.44495))";
        assert_eq!(clauses(found), ["the sample carries the pdf 0.3979, but the density says 0.7958"]);
        let kept = "a density in proportion to 1/r (the radius is u, not √u)";
        assert_eq!(clauses(kept), [kept]);
        let kept = "samples have a mean angle of 5.04° with the axis, not 5.05°";
        assert_eq!(clauses(kept), [kept]);
        assert_eq!(clauses("1.0000312, 9.02 % for theta 31.00°..58.49°"), ["1.00003, 9.02 % for theta 31°..58°"]);
    }

    #[test]
    fn p_values_are_as_long_as_they_are_worth() {
        assert_eq!([-11, 20].map(superscript), ["⁻¹¹", "²⁰"]);
        assert_eq!([0.9, 1e-17, 0.0].map(p_value), ["/{p} = 0.900", "/{p} ≈ 10^{−17}", "/{p} < 10^{−300}"]);
    }

    #[test]
    fn plain_p_values_never_are_zero() {
        assert_eq!([0.9, 1.234e-17, 0.0].map(p_is), ["p = 0.9000", "p = 1.2e-17", "p < 1e-300"]);
    }

    #[test]
    fn numbers_have_the_digits_that_are_asked_for() {
        let texts = [0.018_846_67, 9.999, 123_456.0, -0.5, 3.1e-9, 2.04e10, 0.0, f64::NAN].map(|x| rounded(x, 3));
        assert_eq!(texts, ["0.0188", "10.0", "1.23e5", "-0.500", "3.10e-9", "2.04e10", "0", "NaN"]);
    }

    #[test]
    fn long_texts_are_wrapped_between_words() {
        assert_eq!(wrapped("a bc def ghijklm n", "  ", 8), "  a bc\n  def\n  ghijklm\n  n\n");
    }

    #[test]
    fn titles_begin_with_a_capital() {
        assert_eq!(["mirror", "", "/{R}"].map(capitalized), ["Mirror", "", "/{R}"]);
        let views = std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/src/view")).unwrap();
        for path in views.map(|entry| entry.unwrap().path()) {
            let text = std::fs::read_to_string(&path).unwrap();
            for call in [".title(\"", ".title(format!(\""] {
                let small = text.split(call).skip(1).find(|rest| rest.starts_with(|c: char| c.is_ascii_lowercase()));
                assert!(small.is_none(), "{}: {:.30}", path.display(), small.unwrap());
            }
        }
    }

    #[test]
    fn one_has_no_plural() {
        assert_eq!([0, 1, 2].map(|n| counted(n, "check")), ["0 checks", "1 check", "2 checks"]);
    }
}
