//! The colours of signed errors: blue where too dark, white where right, orange where too bright.

use crate::episode::Frame;
use crate::measure::frame::{self, error_rgb, signed_difference};

/// Grey levels of error, of 255, that have the full colour; beyond them it stays.
pub const ERROR_RANGE: f32 = 255.0 * frame::ERROR_RANGE;

/// The colour of a signed error in grey levels, -255 to 255.
pub fn signed(error: i16) -> [u8; 3] {
    error_rgb(f32::from(error) / ERROR_RANGE)
}

/// `frame` minus `truth` in colours, row major; none where the sizes differ.
pub fn error(frame: &Frame, truth: &Frame) -> Option<Vec<[u8; 3]>> {
    let difference = signed_difference(frame, truth)?;
    Some(difference.into_iter().map(signed).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_of_both_signs_differ_and_saturate() {
        assert_eq!(signed(0), [255; 3]);
        assert_eq!([signed(128), signed(255)], [[230, 97, 1]; 2]);
        assert_eq!([signed(-128), signed(-255)], [[33, 102, 172]; 2]);
        assert!(signed(10)[2] < signed(10)[0] && signed(-10)[0] < signed(-10)[2]);
    }
}
