//! What clients say. Only what somebody asks for is taken; all else that a viser client may send is passed over.

use std::io::Cursor;

use serde::Deserialize;
use serde::de::IgnoredAny;
use thiserror::Error;

/// A uuid or a name that is longer is nobody's.
const LONGEST_NAME: usize = 256;
/// A longer text is nobody's: a state string is far shorter.
const LONGEST_TEXT: usize = 8192;
/// A viser client nests three deep.
const DEEPEST: usize = 16;

/// One message.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(tag = "type")]
pub enum Inbound {
    /// A control has another value.
    #[serde(rename = "GuiUpdateMessage")]
    Update {
        /// Which.
        uuid: String,
        /// What.
        updates: Updates,
    },
    /// A node was clicked on.
    #[serde(rename = "SceneNodeClickMessage")]
    Click {
        /// Which.
        name: String,
        /// Which of its places.
        instance_index: Option<u32>,
    },
    /// Something else.
    #[serde(other)]
    Other,
}

/// What a control changes.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Updates {
    /// Its value.
    #[serde(default)]
    pub value: Option<Value>,
}

/// The value of a control.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(untagged)]
pub enum Value {
    /// Of a switch or a button.
    Bool(bool),
    /// Of a slider. A client has one type of number only.
    Number(f64),
    /// Of a choice or a text.
    Text(String),
    /// Of a control that is not used here.
    Other(IgnoredAny),
}

/// Why a message is refused.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum Malformed {
    /// It cannot be read.
    #[error("not a message: {0}")]
    Unreadable(String),
    /// There is more behind it.
    #[error("not one message: more bytes behind it")]
    Trailing,
    /// One of its texts is too long.
    #[error("text too long")]
    Long,
    /// A number that is none.
    #[error("a number that is not finite")]
    NotFinite,
}

/// Reads a message.
pub fn read(bytes: &[u8]) -> Result<Inbound, Malformed> {
    let mut cursor = Cursor::new(bytes);
    let mut deserializer = rmp_serde::Deserializer::new(&mut cursor);
    deserializer.set_max_depth(DEEPEST);
    let message = Inbound::deserialize(&mut deserializer)
        .map_err(|error| Malformed::Unreadable(error.to_string()))?;
    if cursor.position() != bytes.len() as u64 {
        return Err(Malformed::Trailing);
    }
    match &message {
        Inbound::Update { uuid, updates } => {
            if uuid.len() > LONGEST_NAME {
                return Err(Malformed::Long);
            }
            match &updates.value {
                Some(Value::Text(text)) if text.len() > LONGEST_TEXT => Err(Malformed::Long),
                Some(Value::Number(number)) if !number.is_finite() => Err(Malformed::NotFinite),
                _ => Ok(message),
            }
        }
        Inbound::Click { name, .. } if name.len() > LONGEST_NAME => Err(Malformed::Long),
        _ => Ok(message),
    }
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "a test may stop here")]

    use proptest::prelude::*;
    use serde_json::json;

    use super::*;

    fn captured(name: &str) -> Vec<u8> {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/viser");
        std::fs::read(folder.join(name)).unwrap()
    }

    fn value(name: &str) -> Option<Value> {
        match read(&captured(name)).unwrap() {
            Inbound::Update { uuid, updates } if uuid.len() == 36 => updates.value,
            other => panic!("{other:?}"),
        }
    }

    fn update(value: &serde_json::Value) -> Vec<u8> {
        let message = json!({"type": "GuiUpdateMessage", "uuid": "u", "updates": {"value": value}});
        rmp_serde::to_vec_named(&message).unwrap()
    }

    #[test]
    fn what_the_browser_sent_is_understood() {
        let slider = "c2s_001_slider_drag_GuiUpdateMessage.bin";
        assert_eq!(value(slider), Some(Value::Number(0.5)));
        let number = "c2s_006_number_GuiUpdateMessage.bin";
        assert_eq!(
            value(number),
            Some(Value::Number(5.0)),
            "a whole number is a number"
        );
        let checkbox = "c2s_003_checkbox_GuiUpdateMessage.bin";
        assert_eq!(value(checkbox), Some(Value::Bool(true)));
        let dropdown = "c2s_004_dropdown_GuiUpdateMessage.bin";
        assert_eq!(value(dropdown), Some(Value::Text("gamma".to_owned())));
        let vector = "c2s_007_vector3_GuiUpdateMessage.bin";
        assert!(matches!(value(vector), Some(Value::Other(_))));
        let click = read(&captured("c2s_018_node_click_SceneNodeClickMessage.bin")).unwrap();
        let name = "/ball".to_owned();
        assert_eq!(
            click,
            Inbound::Click {
                name,
                instance_index: None
            }
        );
    }

    #[test]
    fn what_nobody_asked_for_is_passed_over() {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/viser");
        let mut others = 0;
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            if name.starts_with("c2s_") {
                let message = read(&std::fs::read(&path).unwrap());
                others += usize::from(message.expect(&name) == Inbound::Other);
            }
        }
        assert!(others >= 4, "{others}");
    }

    #[test]
    fn what_is_no_message_is_refused_with_a_reason() {
        assert!(matches!(read(&[]), Err(Malformed::Unreadable(_))));
        assert!(matches!(read(b"hello"), Err(Malformed::Unreadable(_))));
        // An array that says that it has four thousand million entries, and nesting without end.
        assert!(read(&[0xdd, 0xff, 0xff, 0xff, 0xff]).is_err());
        assert!(read(&vec![0x91; 60_000]).is_err());
        let mut deep = rmp_serde::to_vec_named(&json!({"type": "GuiUpdateMessage"})).unwrap();
        deep[0] = 0x82;
        deep.extend(b"\xa1x");
        deep.extend(vec![0x91; 60_000]);
        assert!(read(&deep).is_err());
        let mut two = update(&json!(1));
        two.extend(update(&json!(1)));
        assert_eq!(read(&two), Err(Malformed::Trailing));
        assert_eq!(
            read(&update(&json!("x".repeat(9000)))),
            Err(Malformed::Long)
        );
        let mut odd = update(&json!(1.5));
        let number = odd.iter().position(|&byte| byte == 0xcb).unwrap();
        odd[number + 1..number + 9].copy_from_slice(&f64::NAN.to_be_bytes());
        assert_eq!(read(&odd), Err(Malformed::NotFinite));
    }

    proptest! {
        #[test]
        fn no_bytes_make_it_panic(bytes in proptest::collection::vec(any::<u8>(), 0..80)) {
            let _ = read(&bytes);
        }

        #[test]
        fn no_change_of_a_real_message_makes_it_panic(at in 0_usize..90, byte: u8) {
            let mut bytes = captured("c2s_001_slider_drag_GuiUpdateMessage.bin");
            if let Some(old) = bytes.get_mut(at) {
                *old = byte;
            }
            let _ = read(&bytes);
            let _ = read(&bytes[..at.min(bytes.len())]);
        }
    }
}
