//! A bar from 0 to 100.

use serde::Serialize;

use super::envelope::ControlProps;

/// How it looks.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ProgressBarProps {
    /// Place in its container, ascending.
    pub order: f64,
    /// Whether it has moving stripes.
    pub animated: bool,
    /// A name of the client's palette; none for its own.
    pub color: Option<String>,
    /// Whether it is there at all.
    pub visible: bool,
}

impl ControlProps for ProgressBarProps {
    const TYPE: &'static str = "GuiProgressBarMessage";
    type Value = f64;
}

#[cfg(test)]
mod tests {
    use super::super::envelope::Control;
    use super::super::golden::{container, holds, uuid};
    use super::*;

    #[test]
    fn is_what_the_reference_sends() {
        let name = "s2c_022_gui_progress_bar.bin";
        let props = ProgressBarProps {
            order: 21.0,
            animated: true,
            color: Some("cyan".to_owned()),
            visible: true,
        };
        let bar = Control::new(&uuid(name), &container(name), Some(35.0), props);
        holds(&bar, name, 0);
    }
}
