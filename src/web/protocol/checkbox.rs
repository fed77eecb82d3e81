//! A switch.

use serde::Serialize;

use super::envelope::ControlProps;
use super::props::Base;

/// How it looks.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CheckboxProps {
    /// What every control has.
    #[serde(flatten)]
    pub base: Base,
}

impl ControlProps for CheckboxProps {
    const TYPE: &'static str = "GuiCheckboxMessage";
    type Value = bool;
}

#[cfg(test)]
mod tests {
    use super::super::envelope::Control;
    use super::super::golden::{container, holds, uuid};
    use super::*;

    #[test]
    fn is_what_the_reference_sends() {
        let name = "s2c_006_gui_checkbox.bin";
        let props = CheckboxProps {
            base: Base::new(5.0, "checkbox"),
        };
        let checkbox = Control::new(&uuid(name), &container(name), Some(true), props);
        holds(&checkbox, name, 0);
    }
}
