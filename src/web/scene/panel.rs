//! Puts elements of the panel together: each control in its place, named, and dead where nobody may touch it.

use super::names::uuid;
use crate::web::piece::Piece;
use crate::web::protocol::ROOT;
use crate::web::protocol::button::ButtonProps;
use crate::web::protocol::checkbox::CheckboxProps;
use crate::web::protocol::dropdown::DropdownProps;
use crate::web::protocol::envelope::{Control, ControlProps};
use crate::web::protocol::folder::FolderProps;
use crate::web::protocol::html::HtmlProps;
use crate::web::protocol::image::ImageProps;
use crate::web::protocol::markdown::MarkdownProps;
use crate::web::protocol::progress::ProgressBarProps;
use crate::web::protocol::props::Base;
use crate::web::protocol::slider::SliderProps;
use crate::web::protocol::text::TextProps;
use crate::web::protocol::uplot::UplotProps;

/// Elements, one after the other.
pub struct Panel {
    /// So far.
    pub pieces: Vec<Piece>,
    read_only: bool,
    container: String,
    order: f64,
}

/// A slider's ends and steps.
#[derive(Clone, Copy, Debug)]
pub struct Range {
    /// Left end.
    pub min: f64,
    /// Right end.
    pub max: f64,
    /// From one value to the next.
    pub step: f64,
}

impl Range {
    /// Whole numbers.
    pub fn whole(min: usize, max: usize) -> Self {
        Self {
            min: min as f64,
            max: max.max(min) as f64,
            step: 1.0,
        }
    }
}

impl Panel {
    /// Without any.
    pub fn new(read_only: bool) -> Self {
        Self {
            pieces: Vec::new(),
            read_only,
            container: ROOT.to_owned(),
            order: 0.0,
        }
    }

    fn next(&mut self) -> f64 {
        self.order += 1.0;
        self.order
    }

    fn put<P: ControlProps>(&mut self, name: &str, value: Option<P::Value>, props: P) {
        let control = Control::new(&uuid(name), &self.container, value, props);
        self.pieces.push(Piece::of(&control));
    }

    fn base(&mut self, label: &str, hint: &str) -> Base {
        Base {
            hint: (!hint.is_empty()).then(|| hint.to_owned()),
            disabled: self.read_only,
            ..Base::new(self.next(), label)
        }
    }

    /// Opens a folder of the root; what follows is in it.
    pub fn folder(&mut self, name: &str, label: &str, open: bool) {
        let order = self.next();
        let props = FolderProps {
            order,
            label: Some(label.to_owned()),
            visible: true,
            expand_by_default: open,
        };
        self.root();
        self.put(name, None, props);
        self.container = uuid(name);
    }

    /// What follows is in the root again.
    pub fn root(&mut self) {
        ROOT.clone_into(&mut self.container);
    }

    /// A choice.
    pub fn dropdown(
        &mut self,
        name: &str,
        (label, hint): (&str, &str),
        value: &str,
        options: Vec<String>,
    ) {
        let props = DropdownProps {
            base: self.base(label, hint),
            options,
        };
        self.put(name, Some(value.to_owned()), props);
    }

    /// A slider, dead where `enabled` is false.
    pub fn slider(
        &mut self,
        name: &str,
        (label, hint): (&str, &str),
        value: f64,
        range: Range,
        enabled: bool,
    ) {
        let mut base = self.base(label, hint);
        base.disabled |= !enabled;
        let props = SliderProps {
            base,
            min: range.min,
            max: range.max,
            step: range.step,
            precision: u8::from(range.step < 1.0),
            marks: Some(Vec::new()),
        };
        self.put(name, Some(value), props);
    }

    /// A switch, dead where `enabled` is false.
    pub fn checkbox(
        &mut self,
        name: &str,
        (label, hint): (&str, &str),
        value: bool,
        enabled: bool,
    ) {
        let mut base = self.base(label, hint);
        base.disabled |= !enabled;
        let props = CheckboxProps { base };
        self.put(name, Some(value), props);
    }

    /// A button.
    pub fn button(&mut self, name: &str, label: &str, hint: &str) {
        let base = self.base(label, hint);
        let hold_callback_freqs = Vec::new();
        let props = ButtonProps {
            base,
            color: None,
            icon_html: None,
            hold_callback_freqs,
        };
        self.put(name, Some(false), props);
    }

    /// Markdown; the text is safe already.
    pub fn markdown(&mut self, name: &str, markdown: String) {
        let props = MarkdownProps {
            order: self.next(),
            markdown,
            visible: true,
        };
        self.put(name, None, props);
    }

    /// HTML; the text is safe already.
    pub fn html(&mut self, name: &str, content: String) {
        let props = HtmlProps {
            order: self.next(),
            content,
            visible: true,
        };
        self.put(name, None, props);
    }

    /// A picture; none shows nothing.
    pub fn image(&mut self, name: &str, label: &str, png: Option<Vec<u8>>) {
        let props = ImageProps {
            order: self.next(),
            label: Some(label.to_owned()),
            visible: png.is_some(),
            data: png.map(Into::into),
            format: "png",
        };
        self.put(name, None, props);
    }

    /// A bar, seen while there is something to wait for.
    pub fn progress(&mut self, name: &str, percent: f64, visible: bool) {
        let props = ProgressBarProps {
            order: self.next(),
            animated: true,
            color: None,
            visible,
        };
        self.put(name, Some(percent), props);
    }

    /// A chart.
    pub fn chart(&mut self, name: &str, props: UplotProps) {
        let props = UplotProps {
            order: self.next(),
            ..props
        };
        self.put(name, None, props);
    }

    /// Text that only our own client looks at.
    pub fn hidden(&mut self, name: &str, value: String) {
        let base = Base {
            visible: false,
            ..Base::new(self.next(), name)
        };
        let props = TextProps {
            base,
            multiline: false,
        };
        self.put(name, Some(value), props);
    }
}
