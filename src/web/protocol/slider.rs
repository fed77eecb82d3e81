//! A slider with a number box.

use serde::Serialize;

use super::about;
use super::props::Base;

/// A slider with a number box.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "type", rename = "GuiSliderMessage")]
pub struct Slider {
    /// Its name, the same on every connection.
    pub uuid: String,
    /// Where it stands.
    pub container_uuid: String,
    /// What it holds.
    pub value: f64,
    /// How it looks.
    pub props: SliderProps,
}

about!(Slider, gui uuid);

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
        let slider = Slider {
            uuid: uuid(name),
            container_uuid: container(name),
            value: 0.25,
            props,
        };
        holds(&slider, name, 0);
    }
}
