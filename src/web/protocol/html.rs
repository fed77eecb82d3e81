//! A piece of HTML. The client puts it into its page as it is.

use serde::Serialize;

use super::envelope::ControlProps;

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

impl ControlProps for HtmlProps {
    const TYPE: &'static str = "GuiHtmlMessage";
    type Value = ();
}

#[cfg(test)]
mod tests {
    use super::super::envelope::Control;
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
        let html = Control::new(&uuid(name), &container(name), None, props);
        holds(&html, name, 0);
    }
}
