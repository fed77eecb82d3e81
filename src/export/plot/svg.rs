//! A figure as SVG text.

use std::fmt::Write as _;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};

use super::{Anchor, INK, Mark, Plot, Rgb};

/// The whole document.
pub fn text(plot: &Plot) -> String {
    let [width, height] = plot.size;
    // Writing to a string cannot fail, here and below.
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" role=\"img\">\n"
    );
    let title = escaped(&plot.title);
    let _ = writeln!(
        out,
        "<title>{title}</title>\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>"
    );
    for mark in &plot.marks {
        draw(mark, &mut out);
    }
    out.push_str("</svg>\n");
    out
}

fn hex([r, g, b]: Rgb) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

fn points(points: &[[f32; 2]]) -> String {
    let each: Vec<String> = points
        .iter()
        .map(|[x, y]| format!("{x:.2},{y:.2}"))
        .collect();
    each.join(" ")
}

fn draw(mark: &Mark, out: &mut String) {
    let _ = match mark {
        Mark::Area {
            points: corners,
            color,
            opacity,
        } => writeln!(
            out,
            "<polygon points=\"{}\" fill=\"{}\" fill-opacity=\"{opacity}\"/>",
            points(corners),
            hex(*color)
        ),
        Mark::Line {
            points: through,
            color,
            width,
            dash,
        } => {
            let dash: Vec<String> = dash.iter().map(f32::to_string).collect();
            let dash = match dash.as_slice() {
                [] => String::new(),
                dash => format!(" stroke-dasharray=\"{}\"", dash.join(" ")),
            };
            writeln!(
                out,
                "<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{width}\"{dash}/>",
                points(through),
                hex(*color)
            )
        }
        Mark::Text {
            at: [x, y],
            text,
            size,
            anchor,
            upwards,
        } => {
            let anchor = match anchor {
                Anchor::Start => "start",
                Anchor::Middle => "middle",
                Anchor::End => "end",
            };
            let turn = if *upwards {
                format!(" transform=\"rotate(-90 {x} {y})\"")
            } else {
                String::new()
            };
            writeln!(
                out,
                "<text x=\"{x:.2}\" y=\"{y:.2}\" font-family=\"sans-serif\" font-size=\"{size}\" text-anchor=\"{anchor}\" fill=\"{}\"{turn}>{}</text>",
                hex(INK),
                escaped(text)
            )
        }
        Mark::Image {
            at: [x, y],
            size: [width, height],
            columns,
            pixels,
        } => {
            let rows = pixels.len() / (*columns).max(1);
            let mut png = Vec::new();
            let written = PngEncoder::new(&mut png).write_image(
                pixels,
                *columns as u32,
                rows as u32,
                ExtendedColorType::L8,
            );
            if written.is_err() {
                return;
            }
            writeln!(
                out,
                "<image x=\"{x:.2}\" y=\"{y:.2}\" width=\"{width}\" height=\"{height}\" style=\"image-rendering:pixelated\" href=\"data:image/png;base64,{}\"/>",
                STANDARD.encode(&png)
            )
        }
    };
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_cannot_break_out() {
        let mut plot = Plot {
            size: [20.0, 10.0],
            title: "a <b>".to_owned(),
            marks: Vec::new(),
        };
        plot.text([1.0, 2.0], "</text><script>&", Anchor::End);
        let text = text(&plot);
        assert!(text.contains("&lt;/text&gt;&lt;script&gt;&amp;") && !text.contains("<script"));
        assert!(
            text.contains("<title>a &lt;b&gt;</title>") && text.contains("text-anchor=\"end\"")
        );
    }
}
