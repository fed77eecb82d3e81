//! Moments that an analysis is lined up with (D25): where the tip meets the object.

/// Contact ends where the force falls below this part of the threshold, so that a force trembling around the
/// threshold is one contact, not many.
const RELEASE: f32 = 0.5;

/// The steps at which contact begins: the force rises above `threshold` (newtons) from rest. It is at rest after it
/// fell below half the threshold, or at a first known step that is not above it.
///
/// A recording that starts in contact has no onset there: its rise was not seen. A force that is not a number
/// changes nothing.
pub fn onsets(force_newtons: &[f32], threshold: f32) -> Vec<usize> {
    let mut onsets = Vec::new();
    let mut in_contact = None;
    for (step, &force) in force_newtons.iter().enumerate() {
        if force > threshold {
            if in_contact == Some(false) {
                onsets.push(step);
            }
            in_contact = Some(true);
        } else if force < RELEASE * threshold || (in_contact.is_none() && force <= threshold) {
            in_contact = Some(false);
        }
    }
    onsets
}

/// The force that counts as contact in a set of episodes: a quarter of the median of their peaks. Zero for none.
pub fn contact_newtons(mut peaks: Vec<f32>) -> f32 {
    peaks.sort_by(f32::total_cmp);
    0.25 * peaks.get(peaks.len() / 2).copied().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_trembling_force_is_one_contact() {
        let force = [0.0, 0.2, 1.1, 0.9, 1.2, 0.6, 1.3, 0.4, 0.9, 2.0];
        assert_eq!(onsets(&force, 1.0), [2, 9]);
    }

    #[test]
    fn a_recording_that_starts_in_contact_has_no_onset_there() {
        assert_eq!(onsets(&[3.0, 3.0, 0.1, 3.0], 1.0), [3]);
        assert_eq!(onsets(&[0.8, 3.0], 1.0), [1]);
    }

    #[test]
    fn one_hard_hit_does_not_move_the_threshold() {
        assert!((contact_newtons(vec![4.0, 900.0, 8.0, 6.0, 2.0]) - 1.5).abs() < 1e-6);
        assert!(contact_newtons(Vec::new()).abs() < 1e-12);
    }

    #[test]
    fn what_is_not_a_number_changes_nothing() {
        assert_eq!(onsets(&[0.0, f32::NAN, 2.0, f32::NAN, 2.0], 1.0), [2]);
        assert_eq!(onsets(&[f32::NAN, 2.0], 1.0), [0; 0]);
        assert_eq!(onsets(&[0.0, 2.0], f32::NAN), [0; 0]);
        assert_eq!(onsets(&[], 1.0), [0; 0]);
    }
}
