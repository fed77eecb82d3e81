//! Numbers of the paper, for standing beside ours: always marked as quoted, never computed here.

use super::protocol::Protocol;

/// A row of the paper's Tables 1 and 2: model, RMSE, SSIM and its deviation, PSNR in dB and its deviation.
pub type Row = (&'static str, f64, [f64; 2], [f64; 2]);

/// Table 1, the paper's synthetic set.
pub const SYNTHETIC: [Row; 5] = [
    ("v", 3.243, [0.955, 0.04], [28.639, 5.84]),
    ("vp", 1.758, [0.982, 0.02], [33.935, 5.93]),
    ("vh", 2.956, [0.961, 0.04], [29.684, 5.70]),
    ("vhp-c", 2.911, [0.962, 0.04], [29.700, 5.39]),
    ("vhp", 1.749, [0.983, 0.02], [34.202, 6.19]),
];

/// Table 2, the MIT pushing set.
pub const MIT: [Row; 5] = [
    ("v", 1.917, [0.907, 0.02], [30.806, 1.66]),
    ("vp", 1.850, [0.923, 0.03], [31.395, 2.28]),
    ("vh", 1.839, [0.922, 0.03], [31.298, 2.03]),
    ("vhp-c", 1.846, [0.923, 0.03], [31.333, 2.12]),
    ("vhp", 1.734, [0.927, 0.02], [31.741, 1.84]),
];

/// Table 3, RMSE in cm of the object's position on the MIT set.
pub const POSITION_MIT: [(&str, f64); 5] = [
    ("EKF, supervised, filtered", 1.33),
    ("PF, supervised, filtered", 1.14),
    ("LSTM, supervised, filtered", 2.32),
    ("vhp, filtered", 1.80),
    ("vhp, predicted", 1.96),
];

/// The table that was scored under a protocol.
pub fn quality(protocol: Protocol) -> Option<(&'static str, [Row; 5])> {
    match protocol {
        Protocol::SYNTHETIC => Some(("Table 1, the paper's synthetic set", SYNTHETIC)),
        Protocol::MIT => Some(("Table 2, the MIT pushing set", MIT)),
        _ => None,
    }
}
