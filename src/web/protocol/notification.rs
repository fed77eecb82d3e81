//! Something to tell the user, beside the panel, for a while.

use serde::Serialize;

/// Shows it.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "type", rename = "NotificationShowMessage")]
pub struct Notification {
    /// Its name.
    pub uuid: String,
    /// What it says and how.
    pub props: NotificationProps,
}

/// What it says and how.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NotificationProps {
    /// Its heading.
    pub title: String,
    /// Its text.
    pub body: String,
    /// Whether something turns in it.
    pub loading: bool,
    /// Whether the user can close it.
    pub with_close_button: bool,
    /// After so many seconds it goes; none: it stays.
    pub auto_close_seconds: Option<f64>,
    /// A name of the client's palette; none for its own.
    pub color: Option<String>,
}

/// Takes it away.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "type", rename = "RemoveNotificationMessage")]
pub struct RemoveNotification {
    /// Its name.
    pub uuid: String,
}

#[cfg(test)]
mod tests {
    use super::super::golden::{holds, uuid};
    use super::*;

    #[test]
    fn both_are_what_the_reference_sends() {
        let name = "s2c_100_client_notification_show.bin";
        let props = NotificationProps {
            title: "Note".to_owned(),
            body: "body text".to_owned(),
            loading: true,
            with_close_button: true,
            auto_close_seconds: None,
            color: Some("blue".to_owned()),
        };
        holds(
            &Notification {
                uuid: uuid(name),
                props,
            },
            name,
            0,
        );
        let name = "s2c_102_client_notification_remove.bin";
        holds(&RemoveNotification { uuid: uuid(name) }, name, 0);
    }
}
