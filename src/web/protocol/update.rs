//! Changes of elements that are there, and their end.

use std::collections::BTreeMap;

use serde::Serialize;

use super::array::Written;

/// Another value or other props of an element.
#[derive(Clone, Debug, Serialize)]
#[serde(tag = "type", rename = "GuiUpdateMessage")]
pub struct Update<'a> {
    /// Whose.
    pub uuid: &'a str,
    /// What, by name.
    pub updates: BTreeMap<&'a str, Written<'a>>,
}

/// The end of an element; a container's elements go each for itself.
#[derive(Clone, Debug, Serialize)]
#[serde(tag = "type", rename = "GuiRemoveMessage")]
pub struct Remove<'a> {
    /// Whose.
    pub uuid: &'a str,
}

#[cfg(test)]
mod tests {
    use super::super::array::Array;
    use super::super::golden::{captured, holds, sent, uuid};
    use super::super::write;
    use super::*;

    #[test]
    fn both_are_what_the_reference_sends() {
        let name = "s2c_032_gui_update_value.bin";
        let value = write(&43);
        let updates = BTreeMap::from([("value", Written(&value))]);
        holds(
            &Update {
                uuid: &uuid(name),
                updates,
            },
            name,
            0,
        );
        let name = "s2c_041_gui_remove.bin";
        holds(&Remove { uuid: &uuid(name) }, name, 0);
    }

    #[test]
    fn arrays_may_stand_in_what_was_written() {
        let name = "s2c_036_gui_update_uplot.bin";
        let theirs = captured(name).remove(0);
        let columns = theirs["updates"]["data"].as_array().into_iter().flatten();
        let columns: Vec<Array> = columns
            .map(|column| {
                let values = column["values"].as_array().into_iter().flatten();
                Array::f64(values.filter_map(serde_json::Value::as_f64))
            })
            .collect();
        let data = write(&columns);
        let updates = BTreeMap::from([("data", Written(&data))]);
        assert_eq!(
            sent(&Update {
                uuid: &uuid(name),
                updates
            }),
            theirs
        );
    }
}
