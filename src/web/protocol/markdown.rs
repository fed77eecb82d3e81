//! Text with Markdown. What is in it is not made safe by the client.

use serde::Serialize;

use super::about;

/// Text with Markdown. What is in it is not made safe by the client.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "type", rename = "GuiMarkdownMessage")]
pub struct Markdown {
    /// Its name, the same on every connection.
    pub uuid: String,
    /// Where it stands.
    pub container_uuid: String,
    /// How it looks.
    pub props: MarkdownProps,
}

about!(Markdown, gui uuid);

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

#[cfg(test)]
mod tests {
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
        let markdown = Markdown {
            uuid: uuid(name),
            container_uuid: container(name),
            props,
        };
        holds(&markdown, name, 0);
    }
}
