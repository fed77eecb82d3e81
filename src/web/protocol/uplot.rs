//! A chart, drawn by uPlot. Its options are uPlot's own; what is not set is left out.

use std::collections::BTreeMap;

use serde::Serialize;

use super::array::Array;
use super::envelope::ControlProps;

/// What it shows.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct UplotProps {
    /// Place in its container, ascending.
    pub order: f64,
    /// Columns of equal length: x, ascending, then one a series.
    pub data: Vec<Column>,
    /// 1 aligned, 2 faceted; none for aligned.
    pub mode: Option<u8>,
    /// What stands above it.
    pub title: Option<String>,
    /// One a column.
    pub series: Vec<Series>,
    /// Filled areas between two series.
    pub bands: Option<Vec<Band>>,
    /// Axes' ranges by name.
    pub scales: Option<BTreeMap<String, Scale>>,
    /// Axes; none for two in the theme's colours.
    pub axes: Option<Vec<Axis>>,
    /// The legend.
    pub legend: Option<Legend>,
    /// The cross hair.
    pub cursor: Option<Cursor>,
    /// What a series that the pointer is not at looks like.
    pub focus: Option<Focus>,
    /// Width by height, where there is no height.
    pub aspect: f64,
    /// In pixels.
    pub height: Option<u32>,
    /// Top, right, bottom, left in pixels.
    pub padding: Option<[i32; 4]>,
    /// Whether it is there at all.
    pub visible: bool,
}

impl ControlProps for UplotProps {
    const TYPE: &'static str = "GuiUplotMessage";
    type Value = ();
}

/// A column. One with gaps cannot be a buffer: the client draws a line over what is not a number.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Column {
    /// Without gaps.
    Whole(Array),
    /// With gaps.
    Gaps(Vec<Option<f64>>),
}

impl Column {
    /// Of these; what is not finite is a gap.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Self {
        let values: Vec<f64> = values.into_iter().collect();
        if values.iter().all(|value| value.is_finite()) {
            Self::Whole(Array::f64(values))
        } else {
            let gap = |value: f64| value.is_finite().then_some(value);
            Self::Gaps(values.into_iter().map(gap).collect())
        }
    }
}

/// How a column is drawn; the first one only has a label.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Series {
    /// Its name in the legend.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub label: Option<String>,
    /// Colour of the line.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stroke: Option<String>,
    /// Its width in pixels.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub width: Option<f64>,
    /// Lengths of dashes and gaps.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dash: Option<Vec<u32>>,
    /// Colour of the area under it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fill: Option<String>,
    /// Marks at its points.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub points: Option<Points>,
}

/// Marks at the points of a series.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Points {
    /// Whether there are any.
    pub show: bool,
    /// Their size in pixels.
    pub size: f64,
    /// Their colour.
    pub fill: String,
}

/// An area between two series.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Band {
    /// The upper and the lower one, by column.
    pub series: [usize; 2],
    /// Its colour.
    pub fill: String,
    /// -1: downwards from the first.
    pub dir: i8,
}

/// The range of an axis.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Scale {
    /// Whether its numbers are times.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time: Option<bool>,
    /// Its ends.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub range: Option<[Option<f64>; 2]>,
}

/// An axis.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Axis {
    /// What it measures.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub label: Option<String>,
    /// 0 top, 1 right, 2 bottom, 3 left.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub side: Option<u8>,
    /// Its breadth in pixels.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub size: Option<u32>,
}

/// The legend.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Legend {
    /// Whether there is one.
    pub show: bool,
}

/// The cross hair.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Cursor {
    /// Whether there is one.
    pub show: bool,
    /// What dragging does.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub drag: Option<Drag>,
}

/// Along which axes dragging zooms.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Drag {
    /// x.
    pub x: bool,
    /// y.
    pub y: bool,
}

/// What a series that the pointer is not at looks like.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Focus {
    /// Its opacity.
    pub alpha: f64,
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "a test may stop here")]

    use super::super::envelope::Control;
    use super::super::golden::{captured, container, holds, sent, uuid};
    use super::*;

    fn line(label: &str, stroke: &str) -> Series {
        Series {
            label: Some(label.to_owned()),
            stroke: Some(stroke.to_owned()),
            ..Series::default()
        }
    }

    #[test]
    fn is_what_the_reference_sends() {
        let name = "s2c_026_gui_uplot_rich.bin";
        let fill = "rgba(31,119,180,0.2)".to_owned();
        let columns = captured(name)[0]["props"]["data"].take();
        let numbers = |column: &serde_json::Value| -> Vec<f64> {
            serde_json::from_value(column["values"].clone()).unwrap()
        };
        let columns = columns.as_array().unwrap().iter();
        let time = Scale {
            time: Some(false),
            ..Scale::default()
        };
        let props = UplotProps {
            order: 25.0,
            data: columns.map(|column| Column::of(numbers(column))).collect(),
            series: vec![
                Series {
                    label: Some("t".to_owned()),
                    ..Series::default()
                },
                Series {
                    width: Some(2.0),
                    ..line("mean", "#1f77b4")
                },
                Series {
                    fill: Some(fill.clone()),
                    ..line("hi", "transparent")
                },
                line("lo", "transparent"),
            ],
            bands: Some(vec![Band {
                series: [2, 3],
                fill,
                dir: -1,
            }]),
            scales: Some(BTreeMap::from([("x".to_owned(), time)])),
            axes: Some(vec![
                Axis {
                    label: Some("step".to_owned()),
                    ..Axis::default()
                },
                Axis {
                    label: Some("value".to_owned()),
                    side: Some(3),
                    size: Some(60),
                },
            ]),
            cursor: Some(Cursor {
                show: true,
                drag: Some(Drag { x: true, y: false }),
            }),
            focus: Some(Focus { alpha: 0.3 }),
            aspect: 1.0,
            height: Some(180),
            padding: Some([4, 24, 0, 0]),
            visible: true,
            ..UplotProps::default()
        };
        let chart = Control::new(&uuid(name), &container(name), None, props);
        holds(&chart, name, 0);
    }

    #[test]
    fn what_is_not_finite_is_a_gap() {
        let columns = [
            Column::of([1.0, f64::NAN, f64::INFINITY]),
            Column::of([1.0, 2.0]),
        ];
        let array = serde_json::json!({"dtype": "<f8", "values": [1.0, 2.0]});
        assert_eq!(
            sent(&columns),
            serde_json::json!([[1.0, null, null], array])
        );
    }
}
