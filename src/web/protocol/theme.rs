//! How the client as a whole looks. It is kept over reconnects, so it is sent on each.

use serde::Serialize;

use super::about;

/// How the client as a whole looks.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "type", rename = "ThemeConfigurationMessage")]
pub struct Theme {
    /// Buttons over everything; none here.
    pub titlebar_content: Option<()>,
    /// Where the panel is: `floating`.
    pub control_layout: &'static str,
    /// `small`, `medium` or `large`.
    pub control_width: &'static str,
    /// viser's own mark.
    pub show_logo: bool,
    /// Sharing through a server of viser's; not here.
    pub show_share_button: bool,
    /// Light on dark.
    pub dark_mode: bool,
    /// Ten shades, light to dark; none for the client's own.
    pub colors: Option<[String; 10]>,
}

about!(Theme, "ThemeConfigurationMessage" of client);

impl Default for Theme {
    fn default() -> Self {
        Self {
            titlebar_content: None,
            control_layout: "floating",
            control_width: "medium",
            show_logo: true,
            show_share_button: false,
            dark_mode: false,
            colors: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::golden::holds;
    use super::*;

    #[test]
    fn is_what_the_reference_sends() {
        let colors = [
            "#d6f5eb", "#b7eddb", "#98e5cc", "#7adebc", "#5bd6ad", "#3cce9d", "#2db688", "#269771",
            "#1e785a", "#165742",
        ];
        let theme = Theme {
            control_width: "large",
            colors: Some(colors.map(str::to_owned)),
            ..Theme::default()
        };
        holds(&theme, "s2c_048_theme.bin", 0);
    }
}
