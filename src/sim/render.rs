//! Takes the pictures: draws table, shadows, plate and tool, several samples a pixel, and averages them.
//!
//! The tool never stands over the plate but beside it, so a plane along one of the plate's sides parts the two, and
//! drawing back to front needs no depth buffer.

use nalgebra::Vector3;
use tiny_skia::{
    BlendMode, Color, FillRule, Paint, PathBuilder, Pixmap, PixmapPaint, PremultipliedColorU8,
    Transform,
};

use super::{
    Scene,
    camera::Camera,
    light::Lamp,
    polygon::{Point, clip},
    solid::Prism,
};
use crate::episode::Frame;

/// Samples a pixel, along each axis.
const OVERSAMPLING: usize = 4;
/// Reflectance of the table, as the grey value under full light.
const TABLE_GREY: f64 = 168.0;
/// How much darker the table is in full shadow.
const SHADOW_DEPTH: f64 = 0.52;

/// Camera, lamp and the empty table; takes any number of pictures.
pub(super) struct Studio {
    scene: Scene,
    camera: Camera,
    lamp: Lamp,
    table: Pixmap,
    frame_size: usize,
}

impl Studio {
    /// A studio whose pictures are `frame_size` pixels a side.
    ///
    /// # Panics
    /// On a size of 0, or of more than tiny-skia can draw; [`Params::check`](super::Params::check) refuses both.
    pub fn new(scene: &Scene, frame_size: usize) -> Self {
        let canvas_px = frame_size * OVERSAMPLING;
        let target = Vector3::new(0.585, 0.0, 0.02);
        let (azimuth, elevation) = (-24.0_f64.to_radians(), 46.0_f64.to_radians());
        let direction = Vector3::new(
            elevation.cos() * azimuth.cos(),
            elevation.cos() * azimuth.sin(),
            elevation.sin(),
        );
        let camera = Camera::look_at(target + direction * 1.1, target, 0.50, canvas_px);
        let lamp = Lamp::new(Vector3::new(0.60, -0.55, 1.2), 0.10);
        let table = table(&camera, &lamp, canvas_px);
        Self {
            scene: scene.clone(),
            camera,
            lamp,
            table,
            frame_size,
        }
    }

    /// What the camera sees with the plate at a pose (x, y, yaw) and the rod's axis at `tip_m`.
    pub fn picture(&self, plate_pose: [f64; 3], tip_m: Point) -> Frame {
        let plate = Prism::plate(&self.scene, plate_pose);
        let rod = Prism::rod(&self.scene, tip_m);
        let holder = Prism::holder(tip_m);

        let mut canvas = self.table.clone();
        let tool = || std::iter::once(&rod).chain(&holder);
        let casters: Vec<_> = tool()
            .chain([&plate])
            .map(|solid| solid.corners_above(0.0))
            .collect();
        self.cast_shadows(&mut canvas, &casters, 0.0, None);

        let rod_in_front = self.is_in_front(&plate, tip_m);
        if !rod_in_front {
            self.draw(&mut canvas, &rod);
        }
        self.draw(&mut canvas, &plate);
        self.draw_mark(&mut canvas, &plate);
        let top_m = plate.top_m();
        let casters: Vec<_> = tool().map(|solid| solid.corners_above(top_m)).collect();
        self.cast_shadows(&mut canvas, &casters, top_m, Some(plate.outline()));
        if rod_in_front {
            self.draw(&mut canvas, &rod);
        }
        // Above both rod and plate, and the camera looks down: in front of them wherever they meet in the image.
        for piece in &holder {
            self.draw(&mut canvas, piece);
        }
        average(&canvas, self.frame_size)
    }

    /// Whether a plane along one of the plate's sides has rod and camera on one side and the plate on the other.
    fn is_in_front(&self, plate: &Prism, [x, y]: Point) -> bool {
        let rod = Vector3::new(x, y, 0.0);
        // The side that the rod stands off farthest.
        plate
            .sides()
            .map(|(normal, corners)| {
                let offset = |point: Vector3<f64>| normal.dot(&(point - corners[0]));
                (offset(rod), offset(self.camera.eye()))
            })
            .max_by(|a, b| a.0.total_cmp(&b.0))
            .is_some_and(|(_, camera_offset)| camera_offset > 0.0)
    }

    /// Draws the faces that look at the camera.
    fn draw(&self, canvas: &mut Pixmap, solid: &Prism) {
        let shade = |point, normal| solid.grey * self.lamp.brightness(point, normal);
        for (normal, corners) in solid.sides() {
            if normal.dot(&(self.camera.eye() - corners[0])) > 0.0 {
                self.fill(canvas, &corners, shade(corners[2], normal));
            }
        }
        let top = solid.top();
        self.fill(canvas, &top, shade(top[0], Vector3::z()));
    }

    /// Draws the dark dot near one corner that tells the plate's quarter turns apart.
    fn draw_mark(&self, canvas: &mut Pixmap, plate: &Prism) {
        let [corner, next, _, last] = [0, 1, 2, 3].map(|i| plate.top()[i]);
        let (along, across) = (next - corner, last - corner);
        let dot: Vec<_> = (0..16)
            .map(|i| {
                let (sin, cos) = (f64::from(i) * std::f64::consts::TAU / 16.0).sin_cos();
                corner + along * (0.24 + 0.11 * cos) + across * (0.24 + 0.11 * sin)
            })
            .collect();
        let shade = 0.62 * plate.grey * self.lamp.brightness(corner, Vector3::z());
        self.fill(canvas, &dot, shade);
    }

    fn fill(&self, canvas: &mut Pixmap, polygon: &[Vector3<f64>], grey: f64) {
        let corners = polygon.iter().map(|point| self.camera.project(*point));
        let mut path = PathBuilder::new();
        push_polygon(&mut path, corners);
        fill_path(canvas, path, &grey_paint(grey));
    }

    /// Darkens the plane at `height` where solids, given by their corners, stand in the light; only within `window`.
    fn cast_shadows(
        &self,
        canvas: &mut Pixmap,
        solids: &[Vec<Vector3<f64>>],
        height: f64,
        window: Option<&[Point]>,
    ) {
        let alpha = (255.0 * SHADOW_DEPTH * self.lamp.sample_share()).round() as u8;
        let paint = Paint {
            blend_mode: BlendMode::Plus,
            ..paint(Color::from_rgba8(0, 0, 0, alpha))
        };
        let mut shadow: Option<Pixmap> = None;
        for outlines in self.lamp.shadows(solids, height) {
            // One path a sample of the lamp: where shadows of one sample overlap, it is no darker.
            let mut path = PathBuilder::new();
            for outline in outlines {
                let outline = window.map_or(outline.clone(), |window| clip(&outline, window));
                let lift = |[x, y]: &Point| self.camera.project(Vector3::new(*x, *y, height));
                push_polygon(&mut path, outline.iter().map(lift));
            }
            if !path.is_empty() {
                let shadow = shadow.get_or_insert_with(|| blank(canvas.width()));
                fill_path(shadow, path, &paint);
            }
        }
        if let Some(shadow) = shadow {
            let (paint, still) = (PixmapPaint::default(), Transform::identity());
            canvas.draw_pixmap(0, 0, shadow.as_ref(), &paint, still, None);
        }
    }
}

/// The empty table as the camera sees it.
fn table(camera: &Camera, lamp: &Lamp, canvas_px: usize) -> Pixmap {
    let mut table = blank(canvas_px as u32);
    for (i, pixel) in table.pixels_mut().iter_mut().enumerate() {
        let (column, row) = (i % canvas_px, i / canvas_px);
        let point = camera.on_table(column as f64 + 0.5, row as f64 + 0.5);
        let grey = (TABLE_GREY * lamp.brightness(point, Vector3::z())).round() as u8;
        *pixel = PremultipliedColorU8::from_rgba(grey, grey, grey, 255).unwrap_or(*pixel);
    }
    table
}

/// The mean of each pixel's samples.
fn average(canvas: &Pixmap, frame_size: usize) -> Frame {
    let samples = (OVERSAMPLING * OVERSAMPLING) as u32;
    let mut sums = vec![0_u32; frame_size * frame_size];
    for (row, line) in canvas
        .pixels()
        .chunks_exact(canvas.width() as usize)
        .enumerate()
    {
        let start = row / OVERSAMPLING * frame_size;
        let sums = &mut sums[start..start + frame_size];
        for (sum, block) in sums.iter_mut().zip(line.chunks_exact(OVERSAMPLING)) {
            *sum += block
                .iter()
                .map(|pixel| u32::from(pixel.red()))
                .sum::<u32>();
        }
    }
    Frame {
        width: frame_size,
        height: frame_size,
        pixels: sums
            .into_iter()
            .map(|sum| ((sum + samples / 2) / samples) as u8)
            .collect(),
    }
}

fn blank(canvas_px: u32) -> Pixmap {
    Pixmap::new(canvas_px, canvas_px).expect("Params::check bounds the size of a frame")
}

fn grey_paint(grey: f64) -> Paint<'static> {
    let grey = grey.round().clamp(0.0, 255.0) as u8;
    paint(Color::from_rgba8(grey, grey, grey, 255))
}

/// Without antialiasing: its blending would show seams between faces, and the samples are averaged anyway.
fn paint(color: Color) -> Paint<'static> {
    let mut paint = Paint {
        anti_alias: false,
        ..Paint::default()
    };
    paint.set_color(color);
    paint
}

fn push_polygon(path: &mut PathBuilder, corners: impl Iterator<Item = Point>) {
    let mut is_first = true;
    for [x, y] in corners {
        if is_first {
            path.move_to(x as f32, y as f32);
        } else {
            path.line_to(x as f32, y as f32);
        }
        is_first = false;
    }
    if !is_first {
        path.close();
    }
}

fn fill_path(canvas: &mut Pixmap, path: PathBuilder, paint: &Paint) {
    // A path that is empty or has no area paints nothing.
    if let Some(path) = path.finish() {
        canvas.fill_path(&path, paint, FillRule::Winding, Transform::identity(), None);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FAR_TIP: Point = [0.36, 0.0];

    #[test]
    fn the_plate_at_its_start_is_large_and_bright() {
        let studio = Studio::new(&Scene::default(), 64);
        let frame = studio.picture([0.5, 0.0, 0.0], FAR_TIP);
        let bright = frame.pixels.iter().filter(|grey| **grey > 190).count();
        assert!((150..500).contains(&bright), "{bright} bright pixels");
    }

    #[test]
    fn a_plate_hides_the_rod_behind_it_and_not_the_rod_before_it() {
        let scene = Scene::default();
        let studio = Studio::new(&scene, 64);
        let plate = Prism::plate(&scene, [0.6, 0.0, 0.0]);
        assert!(!studio.is_in_front(&plate, [0.52, 0.0]));
        assert!(studio.is_in_front(&plate, [0.68, 0.0]));
    }

    #[test]
    fn what_does_not_move_looks_the_same_in_every_picture() {
        let studio = Studio::new(&Scene::default(), 64);
        let near = studio.picture([0.5, 0.0, 0.0], FAR_TIP);
        let far = studio.picture([0.6, 0.05, 0.7], [0.40, 0.02]);
        // The lower left of the table, where neither plate nor shadow come.
        let corner = 60 * 64;
        assert_eq!(
            near.pixels[corner..corner + 8],
            far.pixels[corner..corner + 8]
        );
    }

    #[test]
    fn turning_the_plate_by_a_quarter_shows() {
        let studio = Studio::new(&Scene::default(), 64);
        let straight = studio.picture([0.5, 0.0, 0.0], FAR_TIP);
        let turned = studio.picture([0.5, 0.0, std::f64::consts::FRAC_PI_2], FAR_TIP);
        let most = straight
            .pixels
            .iter()
            .zip(&turned.pixels)
            .map(|(a, b)| a.abs_diff(*b))
            .max();
        assert!(most > Some(40));
    }
}
