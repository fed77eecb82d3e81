//! A choice of one of many.

use serde::Serialize;

use super::envelope::ControlProps;
use super::props::Base;

/// How it looks.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DropdownProps {
    /// What every control has.
    #[serde(flatten)]
    pub base: Base,
    /// The choices, each once.
    pub options: Vec<String>,
}

impl ControlProps for DropdownProps {
    const TYPE: &'static str = "GuiDropdownMessage";
    type Value = String;
}

#[cfg(test)]
mod tests {
    use super::super::envelope::Control;
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
        let dropdown = Control::new(&uuid(name), &container(name), Some(value), props);
        holds(&dropdown, name, 0);
    }
}
