//! A switch.

use serde::Serialize;

use super::about;
use super::props::Base;

/// A switch.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "type", rename = "GuiCheckboxMessage")]
pub struct Checkbox {
    /// Its name, the same on every connection.
    pub uuid: String,
    /// Where it stands.
    pub container_uuid: String,
    /// Whether it is on.
    pub value: bool,
    /// How it looks.
    pub props: CheckboxProps,
}

about!(Checkbox, gui uuid);

/// How it looks.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CheckboxProps {
    /// What every control has.
    #[serde(flatten)]
    pub base: Base,
}

#[cfg(test)]
mod tests {
    use super::super::golden::{container, holds, uuid};
    use super::*;

    #[test]
    fn is_what_the_reference_sends() {
        let name = "s2c_006_gui_checkbox.bin";
        let props = CheckboxProps {
            base: Base::new(5.0, "checkbox"),
        };
        let checkbox = Checkbox {
            uuid: uuid(name),
            container_uuid: container(name),
            value: true,
            props,
        };
        holds(&checkbox, name, 0);
    }
}
