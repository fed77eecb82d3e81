//! Names of keys, the same in every face, in scripts and in the README.
//!
//! A plain character names itself; the others have names in angle brackets: `<space>`, `<left>`, `<s-left>`
//! (shift), `<c-r>` (control). In a script blanks between keys are ignored, and `<` itself is `<lt>`.

use std::fmt;

use thiserror::Error;

/// Keys that are not characters; with `s-` before them, with shift.
const NAMED: [&str; 14] = [
    "left",
    "right",
    "up",
    "down",
    "home",
    "end",
    "pageup",
    "pagedown",
    "tab",
    "enter",
    "esc",
    "backspace",
    "delete",
    "space",
];

/// A key as a name.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Key(String);

/// A script names a key that there is not.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum KeyError {
    /// No such name.
    #[error(
        "no key is named {0}; names are like <space>, <left>, <s-left>, <c-r>, <enter>, <esc>, <f1>, and <lt> for <"
    )]
    Unknown(String),
    /// A bracket without its end.
    #[error("{0:?} opens a key name that does not end; the key < itself is <lt>")]
    Open(String),
}

impl Key {
    /// The key of a character.
    pub fn of_char(c: char) -> Self {
        match c {
            ' ' => Self("<space>".to_owned()),
            '\t' => Self("<tab>".to_owned()),
            '\n' | '\r' => Self("<enter>".to_owned()),
            c => Self(c.to_string()),
        }
    }

    /// The key of a name without its brackets, in any case: `left`, `s-left`, `c-r`, `f1`, `lt`.
    pub fn named(name: &str) -> Result<Self, KeyError> {
        let lower = name.to_lowercase();
        if lower == "lt" {
            return Ok(Self("<".to_owned()));
        }
        let base = lower.strip_prefix("s-").unwrap_or(&lower);
        let control = lower
            .strip_prefix("c-")
            .is_some_and(|key| key.chars().count() == 1);
        let function = lower.strip_prefix('f').and_then(|n| n.parse::<u8>().ok());
        if NAMED.contains(&base) || control || function.is_some_and(|n| (1..=12).contains(&n)) {
            Ok(Self(format!("<{lower}>")))
        } else {
            Err(KeyError::Unknown(format!("<{name}>")))
        }
    }

    /// The key of the table's spelling: a character, or a name in brackets.
    pub fn of_spelling(spelling: &str) -> Result<Self, KeyError> {
        let inner = spelling
            .strip_prefix('<')
            .and_then(|rest| rest.strip_suffix('>'));
        let mut chars = spelling.chars();
        match (inner, chars.next(), chars.next()) {
            (Some(name), _, _) => Self::named(name),
            (None, Some(c), None) => Ok(Self::of_char(c)),
            _ => Err(KeyError::Unknown(spelling.to_owned())),
        }
    }

    /// Its name: `a`, `<space>`.
    pub fn name(&self) -> &str {
        &self.0
    }

    /// The character it types, if it types one.
    pub fn as_char(&self) -> Option<char> {
        let mut chars = self.0.chars();
        match (chars.next(), chars.next()) {
            (Some(c), None) => Some(c),
            _ => (self.0 == "<space>").then_some(' '),
        }
    }
}

impl fmt::Display for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// Reads keys one after the other: `ll1<space>`. Blanks are ignored.
pub fn parse_script(script: &str) -> Result<Vec<Key>, KeyError> {
    let mut keys = Vec::new();
    let mut rest = script;
    while let Some(c) = rest.chars().next() {
        rest = &rest[c.len_utf8()..];
        if c == '<' {
            let Some((name, after)) = rest.split_once('>') else {
                return Err(KeyError::Open(format!("<{rest}")));
            };
            keys.push(Key::named(name)?);
            rest = after;
        } else if !c.is_whitespace() {
            keys.push(Key::of_char(c));
        }
    }
    Ok(keys)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn names(script: &str) -> Result<Vec<String>, KeyError> {
        parse_script(script).map(|keys| keys.iter().map(Key::to_string).collect())
    }

    #[test]
    fn reads_characters_and_names() {
        let expected = [
            "l", "l", "1", "<space>", "<s-left>", "<", ">", "<c-r>", "<f1>",
        ];
        let expected = expected.map(str::to_owned).to_vec();
        assert_eq!(names("ll 1 <space>\n<S-Left><lt>> <c-r><F1>"), Ok(expected));
    }

    #[test]
    fn names_what_it_does_not_know() {
        assert_eq!(
            names("l<spce>"),
            Err(KeyError::Unknown("<spce>".to_owned()))
        );
        assert_eq!(names("l<space"), Err(KeyError::Open("<space".to_owned())));
        assert!(names("<f13>").is_err() && names("<>").is_err() && names("<c-left>").is_err());
    }

    proptest! {
        #[test]
        fn any_script_can_be_read(script in "\\PC{0,20}") {
            let _ = parse_script(&script);
        }
    }
}
