//! A button; a press sends the value true.

use serde::Serialize;

use super::envelope::ControlProps;
use super::props::Base;

/// How it looks.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ButtonProps {
    /// What every control has.
    #[serde(flatten)]
    pub base: Base,
    /// A name of the client's palette; none for its own.
    pub color: Option<String>,
    /// An inline picture.
    #[serde(rename = "_icon_html")]
    pub icon_html: Option<String>,
    /// How often it repeats while held, in hertz; empty for never.
    #[serde(rename = "_hold_callback_freqs")]
    pub hold_callback_freqs: Vec<f64>,
}

impl ControlProps for ButtonProps {
    const TYPE: &'static str = "GuiButtonMessage";
    type Value = bool;
}

#[cfg(test)]
mod tests {
    use super::super::envelope::Control;
    use super::super::golden::{captured, container, holds, uuid};
    use super::*;

    #[test]
    fn is_what_the_reference_sends() {
        let name = "s2c_016_gui_button.bin";
        let icon = captured(name)[0]["props"]["_icon_html"]
            .as_str()
            .map(str::to_owned);
        let props = ButtonProps {
            base: Base {
                hint: Some("button hint".to_owned()),
                ..Base::new(15.0, "Press me")
            },
            color: Some("green".to_owned()),
            icon_html: icon,
            hold_callback_freqs: Vec::new(),
        };
        let button = Control::new(&uuid(name), &container(name), Some(false), props);
        holds(&button, name, 0);
    }
}
