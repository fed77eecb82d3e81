//! Text with Markdown. What is in it is not made safe by the client.

use serde::Serialize;

use super::envelope::ControlProps;

/// How it looks.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MarkdownProps {
    /// Place in its container, ascending.
    pub order: f64,
    /// The text.
    #[serde(rename = "_markdown")]
    pub markdown: String,
    /// Whether it is there at all.
    pub visible: bool,
}

impl ControlProps for MarkdownProps {
    const TYPE: &'static str = "GuiMarkdownMessage";
    type Value = ();
}

#[cfg(test)]
mod tests {
    use super::super::envelope::Control;
    use super::super::golden::{container, holds, uuid};
    use super::*;

    #[test]
    fn is_what_the_reference_sends() {
        let name = "s2c_019_gui_markdown.bin";
        let text = "**bold** _italic_ `code`\n\n| a | b |\n|---|---|\n| 1 | 2 |";
        let props = MarkdownProps {
            order: 18.0,
            markdown: text.to_owned(),
            visible: true,
        };
        let markdown = Control::new(&uuid(name), &container(name), None, props);
        holds(&markdown, name, 0);
    }
}
