//! Numbers as programs write them: decimal, or hexadecimal as C's `%a` and Python's `float.hex` do.

/// The number that `word` stands for, infinite ones included; `None` for NaN and for what is no number.
pub fn number(word: &str) -> Option<f64> {
    let number = match word.parse::<f64>() {
        Ok(number) => number,
        Err(_) => hexadecimal(word)?,
    };
    (!number.is_nan()).then_some(number)
}

/// `[-+]0x1.8p-3`, exact for up to 13 digits after the point.
fn hexadecimal(word: &str) -> Option<f64> {
    let (sign, digits) = match word.strip_prefix('-') {
        Some(rest) => (-1.0, rest),
        None => (1.0, word.strip_prefix('+').unwrap_or(word)),
    };
    let digits = digits.strip_prefix("0x").or_else(|| digits.strip_prefix("0X"))?;
    let (digits, exponent) = digits.split_once(['p', 'P']).unwrap_or((digits, "0"));
    let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
    let all = [whole, fraction].concat();
    // 16 digits fit u64. The check also refuses the sign that from_str_radix would take.
    if all.is_empty() || all.len() > 16 || !all.bytes().all(|byte| byte.is_ascii_hexdigit()) {
        return None;
    }
    let mantissa = u64::from_str_radix(&all, 16).ok()?;
    let exponent: i32 = exponent.parse().ok()?;
    Some(sign * libm::scalbn(mantissa as f64, exponent.checked_sub(4 * fraction.len() as i32)?))
}

#[cfg(test)]
mod tests {
    use super::number;

    #[test]
    fn decimal_and_hexadecimal() {
        assert_eq!(number("-2.5e-1"), Some(-0.25));
        assert_eq!(number("inf"), Some(f64::INFINITY));
        assert_eq!(number("0x1.8p+1"), Some(3.0));
        assert_eq!(number("-0x1.999999999999ap-4"), Some(-0.1));
        assert_eq!(number("0x0.0000000000001p-1022"), Some(f64::from_bits(1)));
        assert_eq!(number("0X10"), Some(16.0));
        for bad in
            ["", "nan", "-NaN", "1,5", "0x", "0x.p1", "0x+1", "0x1p", "0x1p9999999999", "0x12345678901234567", "x1"]
        {
            assert_eq!(number(bad), None, "{bad}");
        }
    }
}
