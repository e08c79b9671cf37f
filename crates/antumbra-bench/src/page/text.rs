//! Number formats for people.

/// Cell of an unknown value.
pub const DASH: &str = "–";

/// A text, or a dash.
pub fn or_dash(text: Option<String>) -> String {
    text.unwrap_or_else(|| DASH.to_owned())
}

/// An error metric in [0, 1], four decimals: beyond them is the reference's own noise.
pub fn metric(value: f64) -> String {
    format!("{value:.4}")
}

/// Milliseconds, three significant digits.
pub fn ms(value: f64) -> String {
    if !value.is_finite() {
        return DASH.into();
    }
    let decimals = if value <= 0.0 { 2 } else { (2 - value.log10().floor() as i32).clamp(0, 3) };
    format!("{value:.*}", decimals as usize)
}

/// A ratio, two significant digits.
pub fn ratio(value: f64) -> String {
    if !value.is_finite() {
        return DASH.into();
    }
    format!("{value:.*}", if value < 0.995 { 2 } else { usize::from(value < 9.95) })
}

/// Megabytes (10⁶ bytes).
pub fn megabytes(bytes: u64) -> String {
    let mb = bytes as f64 * 1e-6;
    match mb {
        0.0 => "0".into(),
        _ if mb < 0.05 => "< 0.1".into(),
        _ => format!("{mb:.1}"),
    }
}

/// A whole number with thin spaces between thousands.
pub fn count(value: u64) -> String {
    let digits = value.to_string();
    let groups: Vec<&str> =
        digits.as_bytes().rchunks(3).rev().map(|group| std::str::from_utf8(group).expect("digits")).collect();
    groups.join("\u{202f}")
}

/// Seconds, or minutes and seconds.
pub fn seconds(value: f64) -> String {
    match value {
        v if v < 10.0 => format!("{v:.1} s"),
        v if v < 59.5 => format!("{v:.0} s"),
        v => format!("{} min {:.0} s", (v.round() / 60.0).floor(), v.round() % 60.0),
    }
}

/// A fraction in percent.
pub fn percent(part: u64, whole: u64) -> String {
    format!("{:.1}\u{a0}%", 100.0 * part as f64 / whole.max(1) as f64)
}

/// A fraction of real numbers in percent; a dash where it is not finite.
pub fn percent_of(part: f64, whole: f64) -> String {
    let percent = 100.0 * part / whole;
    if percent.is_finite() { format!("{percent:.1}\u{a0}%") } else { DASH.into() }
}

/// A portable file name.
pub fn slug(text: &str) -> String {
    let safe = |c: char| if c.is_ascii_alphanumeric() || c == '-' || c == '.' { c } else { '-' };
    text.chars().map(safe).collect::<String>().trim_matches(['-', '.']).to_lowercase()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_well() {
        assert_eq!([ms(0.0), ms(0.0421), ms(1.234), ms(12.34), ms(1234.5)], ["0.00", "0.042", "1.23", "12.3", "1234"]);
        assert_eq!([0.656, 0.999, 1.0, 5.52, 9.96, 17.3].map(ratio), ["0.66", "1.0", "1.0", "5.5", "10", "17"]);
        assert_eq!([count(7), count(1234), count(2_000_000)], ["7", "1\u{202f}234", "2\u{202f}000\u{202f}000"]);
        assert_eq!([megabytes(0), megabytes(9_000), megabytes(16_777_216)], ["0", "< 0.1", "16.8"]);
        assert_eq!([seconds(1.24), seconds(42.4), seconds(83.0)], ["1.2 s", "42 s", "1 min 23 s"]);
        assert_eq!([seconds(59.4), seconds(59.7), seconds(119.8)], ["59 s", "1 min 0 s", "2 min 0 s"]);
        assert_eq!([slug("pcf:map=512,format=x/../y"), slug("hard")], ["pcf-map-512-format-x-..-y", "hard"]);
    }
}
