//! The colours of signed errors: blue where too dark, white where right, orange where too bright.

use crate::episode::Frame;
use crate::measure::frame::signed_difference;

/// Grey levels of error, of 255, that have the full colour; beyond them it stays.
pub const ERROR_RANGE: f32 = 127.5;

const BLUE: [u8; 3] = [33, 102, 172];
const ORANGE: [u8; 3] = [230, 97, 1];

/// The colour of a signed error in grey levels, -255 to 255.
pub fn signed(error: i16) -> [u8; 3] {
    let part = (f32::from(error) / ERROR_RANGE).clamp(-1.0, 1.0);
    let end = if part < 0.0 { BLUE } else { ORANGE };
    end.map(|channel| (255.0 + (f32::from(channel) - 255.0) * part.abs()).round() as u8)
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
        assert_eq!([signed(128), signed(255)], [ORANGE; 2]);
        assert_eq!([signed(-128), signed(-255)], [BLUE; 2]);
        assert!(signed(10)[2] < signed(10)[0] && signed(-10)[0] < signed(-10)[2]);
    }
}
