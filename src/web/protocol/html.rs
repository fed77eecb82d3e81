//! A piece of HTML. The client puts it into its page as it is.

use serde::Serialize;

use super::about;

/// A piece of HTML. The client puts it into its page as it is.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "type", rename = "GuiHtmlMessage")]
pub struct Html {
    /// Its name, the same on every connection.
    pub uuid: String,
    /// Where it stands.
    pub container_uuid: String,
    /// How it looks.
    pub props: HtmlProps,
}

about!(Html, gui uuid);

/// How it looks.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HtmlProps {
    /// Place in its container, ascending.
    pub order: f64,
    /// The HTML.
    pub content: String,
    /// Whether it is there at all.
    pub visible: bool,
}

#[cfg(test)]
mod tests {
    use super::super::golden::{container, holds, uuid};
    use super::*;

    #[test]
    fn is_what_the_reference_sends() {
        let name = "s2c_020_gui_html.bin";
        let content = "<b style='color:teal'>raw html</b>".to_owned();
        let props = HtmlProps {
            order: 19.0,
            content,
            visible: true,
        };
        let html = Html {
            uuid: uuid(name),
            container_uuid: container(name),
            props,
        };
        holds(&html, name, 0);
    }
}
