//! Text from files made safe for elements whose text the client takes as markup.

use std::fmt::Write;

/// Text as it is shown in HTML and in Markdown alike: everything that could mean something there is written as a
/// numeric reference, which neither takes for markup; control characters become blanks.
pub fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        if c.is_control() {
            out.push(' ');
        } else if c.is_ascii_punctuation() && !matches!(c, '.' | ',' | '%') {
            // Writing to a string cannot fail.
            let _ = write!(out, "&#{};", c as u32);
        } else {
            out.push(c);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_of_it_is_markup() {
        let hostile = "<img src=x onerror=alert(1)>\n# [a](javascript:b) `c` *d* &lt;";
        let safe = escaped(hostile);
        assert!(
            !safe.contains(['<', '>', '[', ']', '(', '`', '*', '"', '\'', '\n']),
            "{safe}"
        );
        assert!(safe.starts_with("&#60;img src&#61;x"));
        assert_eq!(escaped("push 7, 3.5 %"), "push 7, 3.5 %");
    }
}
