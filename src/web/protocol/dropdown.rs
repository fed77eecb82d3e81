//! A choice of one of many.

use serde::Serialize;

use super::about;
use super::props::Base;

/// A choice of one of many.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "type", rename = "GuiDropdownMessage")]
pub struct Dropdown {
    /// Its name, the same on every connection.
    pub uuid: String,
    /// Where it stands.
    pub container_uuid: String,
    /// The one that is chosen.
    pub value: String,
    /// How it looks.
    pub props: DropdownProps,
}

about!(Dropdown, gui uuid);

/// How it looks.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DropdownProps {
    /// What every control has.
    #[serde(flatten)]
    pub base: Base,
    /// The choices, each once.
    pub options: Vec<String>,
}

#[cfg(test)]
mod tests {
    use super::super::golden::{container, holds, uuid};
    use super::*;

    #[test]
    fn is_what_the_reference_sends() {
        let name = "s2c_007_gui_dropdown.bin";
        let options = ["alpha", "beta", "gamma"].map(str::to_owned).to_vec();
        let props = DropdownProps {
            base: Base::new(6.0, "dropdown"),
            options,
        };
        let value = "beta".to_owned();
        let dropdown = Dropdown {
            uuid: uuid(name),
            container_uuid: container(name),
            value,
            props,
        };
        holds(&dropdown, name, 0);
    }
}
