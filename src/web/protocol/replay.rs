//! The end of what a client is told at first.

use serde::Serialize;

/// All that was there when the client came has been sent.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "type", rename = "ReplayDoneMessage")]
pub struct ReplayDone {}

#[cfg(test)]
mod tests {
    use super::super::golden::holds;
    use super::*;

    #[test]
    fn is_what_the_reference_sends() {
        holds(&ReplayDone {}, "s2c_000_connect.bin", 9);
    }
}
