//! An encoded picture, shown at its own size.

use serde::Serialize;
use serde_bytes::ByteBuf;

use super::envelope::ControlProps;

/// How it looks.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ImageProps {
    /// Place in its container, ascending.
    pub order: f64,
    /// What stands above it.
    pub label: Option<String>,
    /// The file; none shows nothing.
    #[serde(rename = "_data")]
    pub data: Option<ByteBuf>,
    /// `png` or `jpeg`.
    #[serde(rename = "_format")]
    pub format: &'static str,
    /// Whether it is there at all.
    pub visible: bool,
}

impl ControlProps for ImageProps {
    const TYPE: &'static str = "GuiImageMessage";
    type Value = ();
}

#[cfg(test)]
mod tests {
    use super::super::envelope::Control;
    use super::super::golden::{captured, container, holds, uuid};
    use super::*;

    #[test]
    fn is_what_the_reference_sends() {
        let name = "s2c_023_gui_image_png.bin";
        let bytes = captured(name)[0]["props"]["_data"]["bin"].take();
        let data: Vec<u8> = serde_json::from_value(bytes).unwrap_or_default();
        assert!(data.starts_with(b"\x89PNG"));
        let props = ImageProps {
            order: 22.0,
            label: Some("png image".to_owned()),
            data: Some(ByteBuf::from(data)),
            format: "png",
            visible: true,
        };
        let image = Control::new(&uuid(name), &container(name), None, props);
        holds(&image, name, 0);
    }
}
