//! The text for `;`, `%` and white space in a value.

use std::fmt::Write;

/// Writes what a state string could not hold as `%xx`.
pub fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        if matches!(c, '%' | ';') || c.is_whitespace() || c.is_control() {
            for byte in c.to_string().bytes() {
                // Writing to a string cannot fail.
                let _ = write!(escaped, "%{byte:02x}");
            }
        } else {
            escaped.push(c);
        }
    }
    escaped
}

/// The inverse of `escape`; a `%` that escapes nothing stands for itself.
pub fn unescape(text: &str) -> String {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text;
    while let Some((before, after)) = rest.split_once('%') {
        bytes.extend_from_slice(before.as_bytes());
        let byte = after
            .get(..2)
            .and_then(|hex| u8::from_str_radix(hex, 16).ok());
        bytes.push(byte.unwrap_or(b'%'));
        rest = if byte.is_some() { &after[2..] } else { after };
    }
    bytes.extend_from_slice(rest.as_bytes());
    String::from_utf8_lossy(&bytes).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_escape_cut_short_stands_for_itself() {
        for text in ["%", "%4", "a%zzb", "%é", "100%"] {
            assert_eq!(unescape(text), text);
        }
    }
}
