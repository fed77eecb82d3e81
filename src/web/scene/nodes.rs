//! Puts nodes of the scene together: each with its place, and unseen where there is nothing to see.

use crate::web::piece::Piece;
use crate::web::protocol::Message;
use crate::web::protocol::array::Array;
use crate::web::protocol::arrow::ArrowProps;
use crate::web::protocol::envelope::{Node, NodeProps};
use crate::web::protocol::label::LabelProps;
use crate::web::protocol::lines::LinesProps;
use crate::web::protocol::pose::{Orientation, Position, Visibility};
use crate::web::protocol::props::Rgb;

/// A point, in metres.
pub type Point = [f32; 3];

/// Pieces, nodes among them.
pub struct Nodes {
    /// So far.
    pub pieces: Vec<Piece>,
}

impl Nodes {
    /// After these.
    pub fn new(pieces: Vec<Piece>) -> Self {
        Self { pieces }
    }

    /// Adds a piece.
    pub fn add(&mut self, message: &impl Message) {
        self.pieces.push(Piece::of(message));
    }

    /// Adds a node at a place, turned around z by so many radians; unseen without a place.
    pub fn put(&mut self, name: &str, props: impl NodeProps, place: Option<(Point, f32)>) {
        self.add(&Node::new(name, props));
        let (name, owner) = (name.to_owned(), String::new());
        if let Some((position, yaw)) = place {
            self.add(&Position {
                name: name.clone(),
                position,
                owner: owner.clone(),
            });
            let (sin, cos) = (0.5 * yaw).sin_cos();
            let wxyz = [cos, 0.0, 0.0, sin];
            self.add(&Orientation {
                name: name.clone(),
                wxyz,
                owner: owner.clone(),
            });
        }
        self.add(&Visibility {
            name,
            visible: place.is_some(),
            owner,
        });
    }

    /// Adds straight lines of so many pixels, each from one point to another; unseen without any.
    pub fn lines(&mut self, name: &str, ends: &[[Point; 2]], color: Rgb, pixels: f32) {
        let props = LinesProps {
            points: points(ends),
            thickness: pixels,
            colors: Array::u8(color),
            scale: 1.0,
            thickness_units: "screen",
        };
        let here = (!ends.is_empty()).then_some(([0.0; 3], 0.0));
        self.put(name, props, here);
    }

    /// Adds an arrow; unseen without one.
    pub fn arrow(&mut self, name: &str, ends: Option<[Point; 2]>, color: Rgb) {
        let props = ArrowProps {
            points: points(ends.as_slice()),
            colors: Array::u8(color),
            shaft_radius: 0.001_5,
            head_radius: 0.004,
            head_length: 0.008,
            scale: 1.0,
        };
        self.put(name, props, ends.map(|_| ([0.0; 3], 0.0)));
    }

    /// Adds text at a place; unseen without one.
    pub fn label(&mut self, name: &str, text: String, place: Option<Point>) {
        let props = LabelProps {
            text,
            font_size_mode: "screen",
            font_screen_scale: 0.8,
            font_scene_height: 0.01,
            depth_test: false,
            anchor: "bottom-center",
        };
        self.put(name, props, place.map(|place| (place, 0.0)));
    }
}

/// Both ends of each; a line of no length where there is none, since a client needs at least one.
fn points(ends: &[[Point; 2]]) -> Array {
    if ends.is_empty() {
        Array::f32([0.0; 6])
    } else {
        Array::f32(ends.iter().flatten().flatten().copied())
    }
}
