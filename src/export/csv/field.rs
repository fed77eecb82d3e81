//! One line of a table.

/// A line, field by field.
#[derive(Default)]
pub(in crate::export) struct Fields {
    line: String,
    begun: bool,
}

impl Fields {
    /// Appends a field, in quotes where it needs them.
    pub(in crate::export) fn push(&mut self, text: &str) {
        if self.begun {
            self.line.push(',');
        }
        self.begun = true;
        if text.contains(['"', ',', '\n', '\r']) {
            self.line.push('"');
            self.line.push_str(&text.replace('"', "\"\""));
            self.line.push('"');
        } else {
            self.line.push_str(text);
        }
    }

    /// The line with its end.
    pub(in crate::export) fn into_line(mut self) -> String {
        self.line.push('\n');
        self.line
    }
}

/// The shortest text that reads back as the same `f32`, never without a point or an exponent, so that a column of
/// whole numbers is one of floats all the same. Empty for what is not known or not finite.
pub(super) fn number(value: Option<f32>) -> String {
    let known = value.filter(|value| value.is_finite());
    known.map_or_else(String::new, |value| format!("{value:?}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_needs_quotes_has_them() {
        let mut fields = Fields::default();
        for text in ["", "a,b", "say \"x\"", "two\nlines", "plain"] {
            fields.push(text);
        }
        assert_eq!(
            fields.into_line(),
            ",\"a,b\",\"say \"\"x\"\"\",\"two\nlines\",plain\n"
        );
    }

    #[test]
    fn numbers_read_back_bit_for_bit() {
        for value in [0.1_f32, -0.0, 1.0, 1e-30, 3.402_823_5e38, 16_777_217.0] {
            let text = number(Some(value));
            assert_eq!(text.parse::<f32>().map(f32::to_bits), Ok(value.to_bits()));
            assert!(text.contains(['.', 'e']), "{text}");
        }
        assert_eq!(number(Some(f32::NAN)) + &number(None), "");
    }
}
