//! Text as programs write it: byte order marks, UTF-16, three kinds of line ends.

use std::borrow::Cow;

/// Text in UTF-8 without a byte order mark, its lines ended by LF or CR LF. Bytes that are not UTF-8 stay as they are:
/// comments may be in any encoding.
pub(crate) fn plain(bytes: &[u8]) -> Cow<'_, [u8]> {
    match decoded(bytes) {
        Cow::Borrowed(text) if !has_lone_cr(text) => Cow::Borrowed(text),
        text => Cow::Owned(with_lf(&text)),
    }
}

/// The same with its line ends as they are: the rest of the file may be binary.
pub(crate) fn decoded(bytes: &[u8]) -> Cow<'_, [u8]> {
    if let Some(text) = bytes.strip_prefix(b"\xef\xbb\xbf") {
        return Cow::Borrowed(text);
    }
    match *bytes {
        [0xff, 0xfe, ref text @ ..] => Cow::Owned(of_utf16(text, u16::from_le_bytes)),
        [0xfe, 0xff, ref text @ ..] => Cow::Owned(of_utf16(text, u16::from_be_bytes)),
        // No mark. Every format begins with an ASCII character or a space.
        [1..=255, 0, 1..=255, 0, ..] => Cow::Owned(of_utf16(bytes, u16::from_le_bytes)),
        [0, 1..=255, 0, 1..=255, ..] => Cow::Owned(of_utf16(bytes, u16::from_be_bytes)),
        _ => Cow::Borrowed(bytes),
    }
}

fn of_utf16(bytes: &[u8], unit: fn([u8; 2]) -> u16) -> Vec<u8> {
    let units = bytes.as_chunks::<2>().0.iter().map(|&pair| unit(pair));
    let text = char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER));
    text.collect::<String>().into_bytes()
}

fn has_lone_cr(text: &[u8]) -> bool {
    text.windows(2).any(|w| w[0] == b'\r' && w[1] != b'\n')
}

fn with_lf(text: &[u8]) -> Vec<u8> {
    let mut out = text.to_vec();
    for (i, byte) in out.iter_mut().enumerate() {
        if *byte == b'\r' && text.get(i + 1) != Some(&b'\n') {
            *byte = b'\n';
        }
    }
    out
}

/// A text for a message. What should be a name or a number may be a payload of megabytes.
pub(crate) fn shortened(text: &str) -> Cow<'_, str> {
    const LONGEST: usize = 60;
    match text.char_indices().nth(LONGEST) {
        None => Cow::Borrowed(text),
        Some((end, _)) => Cow::Owned(format!("{}…", &text[..end])),
    }
}

/// A message that quotes a text of the file: its beginning and its end.
pub(crate) fn abridged(message: &str) -> Cow<'_, str> {
    const LONGEST: usize = 200;
    const END: usize = 60;
    let count = message.chars().count();
    if count <= LONGEST {
        return Cow::Borrowed(message);
    }
    let end: String = message.chars().skip(count - END).collect();
    Cow::Owned(format!("{} {end}", shortened(message)))
}
