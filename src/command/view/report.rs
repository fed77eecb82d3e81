//! What is written instead of a face: a drawn frame, the same as lines of text, or all of it as JSON.

use std::sync::Arc;

use anyhow::Context;

use super::failures;
use crate::cli::ViewArgs;
use crate::session::Session;
use crate::session::snapshot::Snapshot;
use crate::tui::face::Face;
use crate::tui::{plain, print};

/// A form of one report.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Report {
    /// As the terminal would show it.
    Frame,
    /// A labelled fact a line.
    Plain,
    /// Every field of the snapshot.
    Json,
    /// The queue of failures, a line each.
    Failures,
}

impl Report {
    /// The one that the arguments ask for.
    pub fn asked(args: &ViewArgs) -> Option<Self> {
        if args.failures {
            Some(Self::Failures)
        } else if args.json {
            Some(Self::Json)
        } else if args.plain {
            Some(Self::Plain)
        } else {
            args.print.then_some(Self::Frame)
        }
    }

    /// Writes it.
    pub fn of(self, session: &Session, face: &Face, size: (u16, u16)) -> anyhow::Result<String> {
        let snapshot = session.snapshot();
        match self {
            Self::Frame => Ok(print(&snapshot, face, size)),
            Self::Plain => Ok(plain(&snapshot)),
            Self::Json => json(snapshot),
            Self::Failures => Ok(failures::list(session)),
        }
    }
}

/// The frames of every decoded step, some 16 kB each as numbers, would be nearly all of it; those at the cursor stay.
fn json(mut snapshot: Snapshot) -> anyhow::Result<String> {
    snapshot.strip = Arc::default();
    if let Some(other) = &mut snapshot.other {
        Arc::make_mut(other).strip = Arc::default();
    }
    let mut text = serde_json::to_string(&snapshot).context("writing the state as JSON")?;
    text.push('\n');
    Ok(text)
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "a test fails by panicking")]

    use std::time::Duration;

    use serde_json::Value;

    use super::*;
    use crate::session::fake::{FakePredictor, FakeSource};

    #[test]
    fn json_has_every_field_small_and_with_null_for_what_is_no_number() {
        let source = Arc::new(FakeSource::new(1));
        let mut session = Session::new(source, vec![Arc::new(FakePredictor::three())]);
        assert!(session.wait_idle(Duration::from_mins(1)));
        let report = Report::Json;
        let text = report.of(&session, &Face::default(), (80, 24));
        let text = text.unwrap();
        assert!(text.len() < 1_000_000 && text.ends_with("}\n"));
        let value: Value = serde_json::from_str(&text).unwrap();
        assert_eq!(value["strip"], Value::Array(Vec::new()));
        assert_eq!(value["experts"][0]["expert"], "vision");
        // There is no belief before the second frame, so no share either.
        assert_eq!(value["experts"][0]["share_over_time"][0], Value::Null);
    }
}
