//! A slider with a number box.

use serde::Serialize;

use super::envelope::ControlProps;
use super::props::Base;

/// How it looks.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SliderProps {
    /// What every control has.
    #[serde(flatten)]
    pub base: Base,
    /// Left end.
    pub min: f64,
    /// Right end.
    pub max: f64,
    /// From one value to the next.
    pub step: f64,
    /// Decimals that are shown.
    pub precision: u8,
    /// Labels under it; none for those of its ends.
    #[serde(rename = "_marks")]
    pub marks: Option<Vec<Mark>>,
}

impl ControlProps for SliderProps {
    const TYPE: &'static str = "GuiSliderMessage";
    type Value = f64;
}

/// A label under a slider.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Mark {
    /// Where.
    pub value: f64,
    /// What it says; none for a dot.
    pub label: Option<String>,
}

#[cfg(test)]
mod tests {
    use super::super::envelope::Control;
    use super::super::golden::{container, holds, uuid};
    use super::*;

    #[test]
    fn is_what_the_reference_sends() {
        let name = "s2c_004_gui_slider_float.bin";
        let mark = |value, label: Option<&str>| Mark {
            value,
            label: label.map(str::to_owned),
        };
        let props = SliderProps {
            base: Base {
                hint: Some("a hint".to_owned()),
                ..Base::new(3.0, "float slider")
            },
            min: -1.0,
            max: 1.0,
            step: 0.05,
            precision: 2,
            marks: Some(vec![
                mark(-1.0, Some("lo")),
                mark(0.0, None),
                mark(1.0, Some("hi")),
            ]),
        };
        let slider = Control::new(&uuid(name), &container(name), Some(0.25), props);
        holds(&slider, name, 0);
    }
}
