//! A folder: a container with a heading.

use serde::Serialize;

use super::envelope::ControlProps;

/// How it looks.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FolderProps {
    /// Place in its container, ascending.
    pub order: f64,
    /// Its heading; none for no border either.
    pub label: Option<String>,
    /// Whether it is there at all.
    pub visible: bool,
    /// Whether it is open at first.
    pub expand_by_default: bool,
}

impl ControlProps for FolderProps {
    const TYPE: &'static str = "GuiFolderMessage";
    type Value = ();
}

#[cfg(test)]
mod tests {
    use super::super::envelope::Control;
    use super::super::golden::{container, holds, uuid};
    use super::*;

    #[test]
    fn is_what_the_reference_sends() {
        let name = "s2c_002_gui_folder.bin";
        let props = FolderProps {
            order: 1.0,
            label: Some("Folder A".to_owned()),
            visible: true,
            expand_by_default: true,
        };
        let folder = Control::new(&uuid(name), &container(name), None, props);
        holds(&folder, name, 0);
    }
}
