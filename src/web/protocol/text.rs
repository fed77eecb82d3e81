//! A line of text to type.

use serde::Serialize;

use super::about;
use super::props::Base;

/// A line of text to type.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "type", rename = "GuiTextMessage")]
pub struct Text {
    /// Its name, the same on every connection.
    pub uuid: String,
    /// Where it stands.
    pub container_uuid: String,
    /// What it holds.
    pub value: String,
    /// How it looks.
    pub props: TextProps,
}

about!(Text, gui uuid);

/// How it looks.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TextProps {
    /// What every control has.
    #[serde(flatten)]
    pub base: Base,
    /// Whether it has several lines.
    pub multiline: bool,
}

#[cfg(test)]
mod tests {
    use super::super::golden::{container, holds, uuid};
    use super::*;

    #[test]
    fn is_what_the_reference_sends() {
        let name = "s2c_008_gui_text.bin";
        let props = TextProps {
            base: Base::new(7.0, "text"),
            multiline: false,
        };
        let value = "hello".to_owned();
        let text = Text {
            uuid: uuid(name),
            container_uuid: container(name),
            value,
            props,
        };
        holds(&text, name, 0);
    }
}
