//! A line of text to type.

use serde::Serialize;

use super::envelope::ControlProps;
use super::props::Base;

/// How it looks.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TextProps {
    /// What every control has.
    #[serde(flatten)]
    pub base: Base,
    /// Whether it has several lines.
    pub multiline: bool,
}

impl ControlProps for TextProps {
    const TYPE: &'static str = "GuiTextMessage";
    type Value = String;
}

#[cfg(test)]
mod tests {
    use super::super::envelope::Control;
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
        let text = Control::new(&uuid(name), &container(name), Some(value), props);
        holds(&text, name, 0);
    }
}
