//! Numeric arrays, and values that were written before: both travel through serde as msgpack extensions, which
//! [`super::batch`] takes out again.

use serde::{Serialize, Serializer};

/// Extension of a value that was written before and stands where the extension does.
pub const WRITTEN: i8 = 16;

/// What an array is made of: its place in here is the extension's tag.
pub const DTYPES: [&str; 4] = ["<f4", "<f8", "<u4", "|u1"];

/// Numbers that go behind the messages as one buffer, little endian, row major. Their shape is known by the field.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Array {
    tag: i8,
    bytes: Vec<u8>,
}

impl Array {
    /// Of `f32`.
    pub fn f32(values: impl IntoIterator<Item = f32>) -> Self {
        Self {
            tag: 0,
            bytes: values.into_iter().flat_map(f32::to_le_bytes).collect(),
        }
    }

    /// Of `f64`.
    pub fn f64(values: impl IntoIterator<Item = f64>) -> Self {
        Self {
            tag: 1,
            bytes: values.into_iter().flat_map(f64::to_le_bytes).collect(),
        }
    }

    /// Of `u32`.
    pub fn u32(values: impl IntoIterator<Item = u32>) -> Self {
        Self {
            tag: 2,
            bytes: values.into_iter().flat_map(u32::to_le_bytes).collect(),
        }
    }

    /// Of bytes: colours.
    pub fn u8(values: impl IntoIterator<Item = u8>) -> Self {
        Self {
            tag: 3,
            bytes: values.into_iter().collect(),
        }
    }
}

impl Serialize for Array {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        extension(serializer, self.tag, &self.bytes)
    }
}

/// A value that is msgpack already.
#[derive(Clone, Copy, Debug)]
pub struct Written<'a>(pub &'a [u8]);

impl Serialize for Written<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        extension(serializer, WRITTEN, self.0)
    }
}

fn extension<S: Serializer>(serializer: S, tag: i8, bytes: &[u8]) -> Result<S::Ok, S::Error> {
    let inside = (tag, serde_bytes::Bytes::new(bytes));
    serializer.serialize_newtype_struct(rmp_serde::MSGPACK_EXT_STRUCT_NAME, &inside)
}
