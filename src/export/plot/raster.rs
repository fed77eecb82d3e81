//! A figure as pixels, at twice its size.

use epaint_default_fonts::UBUNTU_LIGHT;
use tiny_skia::{
    Color, FillRule, FilterQuality, Paint, PathBuilder, Pixmap, PixmapPaint, Stroke, StrokeDash,
    Transform,
};
use ttf_parser::{Face, OutlineBuilder};

use super::{Anchor, INK, Mark, Plot, Rgb};

/// Pixels of the PNG for one of the SVG.
const ZOOM: f32 = 2.0;

/// Columns and rows, and the pixels row major; none where the size is none that can be drawn.
pub fn pixels(plot: &Plot) -> Option<([usize; 2], Vec<Rgb>)> {
    let [width, height] = plot.size.map(|side| (side * ZOOM).ceil() as u32);
    let mut map = Pixmap::new(width, height)?;
    map.fill(Color::WHITE);
    let face = Face::parse(UBUNTU_LIGHT, 0).ok();
    for mark in &plot.marks {
        draw(mark, face.as_ref(), &mut map);
    }
    let pixels = map.pixels().iter().map(|p| [p.red(), p.green(), p.blue()]);
    Some(([width as usize, height as usize], pixels.collect()))
}

fn paint([r, g, b]: Rgb, opacity: f32) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color_rgba8(r, g, b, (255.0 * opacity).round() as u8);
    paint
}

fn path(points: &[[f32; 2]], closed: bool) -> Option<tiny_skia::Path> {
    let mut builder = PathBuilder::new();
    for (i, [x, y]) in points.iter().enumerate() {
        if i == 0 {
            builder.move_to(*x, *y);
        } else {
            builder.line_to(*x, *y);
        }
    }
    if closed {
        builder.close();
    }
    builder.finish()
}

fn draw(mark: &Mark, face: Option<&Face<'_>>, map: &mut Pixmap) {
    let zoom = Transform::from_scale(ZOOM, ZOOM);
    match mark {
        Mark::Area {
            points,
            color,
            opacity,
        } => {
            if let Some(path) = path(points, true) {
                map.fill_path(
                    &path,
                    &paint(*color, *opacity),
                    FillRule::Winding,
                    zoom,
                    None,
                );
            }
        }
        Mark::Line {
            points,
            color,
            width,
            dash,
        } => {
            let stroke = Stroke {
                width: *width,
                dash: StrokeDash::new(dash.clone(), 0.0),
                ..Stroke::default()
            };
            if let Some(path) = path(points, false) {
                map.stroke_path(&path, &paint(*color, 1.0), &stroke, zoom, None);
            }
        }
        Mark::Text {
            at,
            text,
            size,
            anchor,
            upwards,
        } => {
            let Some(face) = face else { return };
            let (letters, width) = outline(face, text);
            let scale = size / f32::from(face.units_per_em());
            let back = match anchor {
                Anchor::Start => 0.0,
                Anchor::Middle => -0.5 * width,
                Anchor::End => -width,
            };
            // The font's y runs up.
            let place = zoom
                .pre_translate(at[0], at[1])
                .pre_rotate(if *upwards { -90.0 } else { 0.0 })
                .pre_scale(scale, -scale)
                .pre_translate(back, 0.0);
            if let Some(letters) = letters {
                map.fill_path(&letters, &paint(INK, 1.0), FillRule::Winding, place, None);
            }
        }
        Mark::Image {
            at,
            size,
            columns,
            pixels,
        } => {
            let rows = pixels.len() / (*columns).max(1);
            let Some(mut image) = Pixmap::new(*columns as u32, rows as u32) else {
                return;
            };
            for (pixel, grey) in image.data_mut().chunks_exact_mut(4).zip(pixels) {
                pixel.copy_from_slice(&[*grey, *grey, *grey, 255]);
            }
            let place = zoom
                .pre_translate(at[0], at[1])
                .pre_scale(size[0] / *columns as f32, size[1] / rows.max(1) as f32);
            let paint = PixmapPaint {
                quality: FilterQuality::Nearest,
                ..PixmapPaint::default()
            };
            map.draw_pixmap(0, 0, image.as_ref(), &paint, place, None);
        }
    }
}

/// The outlines of a line of letters in the font's units, and how far it runs.
fn outline(face: &Face<'_>, text: &str) -> (Option<tiny_skia::Path>, f32) {
    let mut pen = Pen {
        path: PathBuilder::new(),
        x: 0.0,
    };
    for letter in text.chars() {
        let glyph = face.glyph_index(letter).or_else(|| face.glyph_index('?'));
        if let Some(glyph) = glyph {
            // A letter without an outline, a blank, only takes its room.
            let _ = face.outline_glyph(glyph, &mut pen);
            pen.x += f32::from(face.glyph_hor_advance(glyph).unwrap_or_default());
        }
    }
    (pen.path.finish(), pen.x)
}

struct Pen {
    path: PathBuilder,
    x: f32,
}

impl OutlineBuilder for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        self.path.move_to(self.x + x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.path.line_to(self.x + x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.path.quad_to(self.x + x1, y1, self.x + x, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.path
            .cubic_to(self.x + x1, y1, self.x + x2, y2, self.x + x, y);
    }

    fn close(&mut self) {
        self.path.close();
    }
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may stop here")]
mod tests {
    use super::*;

    #[test]
    fn marks_are_where_they_were_put() {
        let mut plot = Plot {
            size: [40.0, 20.0],
            ..Plot::default()
        };
        plot.marks.push(Mark::Area {
            points: vec![[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]],
            color: [10, 20, 30],
            opacity: 1.0,
        });
        plot.marks.push(Mark::Image {
            at: [20.0, 0.0],
            size: [8.0, 8.0],
            columns: 2,
            pixels: vec![0, 50, 100, 150],
        });
        plot.text([39.0, 18.0], "HH", Anchor::End);
        let ([width, height], pixels) = raster(&plot);
        assert_eq!((width, height), (80, 40));
        let at = |x: usize, y: usize| pixels[y * width + x];
        assert_eq!(at(5, 5), [10, 20, 30]);
        assert_eq!(
            [at(42, 2)[0], at(54, 2)[0], at(42, 14)[0], at(54, 14)[0]],
            [0, 50, 100, 150]
        );
        let dark = |xs: std::ops::Range<usize>| {
            xs.flat_map(|x| (18..36).map(move |y| (x, y)))
                .filter(|&(x, y)| at(x, y)[0] < 128)
                .count()
        };
        assert!(
            dark(44..80) > 20 && dark(20..40) == 0,
            "letters end at their point"
        );
        assert!(pixels_of_nothing().is_none());
    }

    fn raster(plot: &Plot) -> ([usize; 2], Vec<Rgb>) {
        pixels(plot).unwrap()
    }

    fn pixels_of_nothing() -> Option<([usize; 2], Vec<Rgb>)> {
        pixels(&Plot::default())
    }
}
