//! Single keys of a config changed by name: `training.rollouts=0.5`.

use toml::{Table, Value};

use super::Config;

impl Config {
    /// The same config with one key set, as `--set` says: dots lead into tables, the value is TOML, and what is no TOML is
    /// taken as a string.
    ///
    /// # Errors
    /// Says which key does not exist, or what its value may be.
    pub fn set(&self, assignment: &str) -> Result<Self, String> {
        let Some((path, value)) = assignment.split_once('=') else {
            return Err(format!("`{assignment}`: write key=value"));
        };
        let mut table = Table::try_from(self).map_err(|error| error.to_string())?;
        let mut names: Vec<&str> = path.trim().split('.').collect();
        let last = names.pop().unwrap_or_default();
        let mut inner = &mut table;
        for name in names {
            inner = match inner.get_mut(name) {
                Some(Value::Table(table)) => table,
                _ => return Err(format!("`{path}`: there is no table `{name}`")),
            };
        }
        inner.insert(last.to_owned(), parsed(value.trim()));
        let config: Self = table
            .try_into()
            .map_err(|error: toml::de::Error| format!("`{path}`: {}", error.message()))?;
        config.validate().map_err(|error| error.to_string())?;
        Ok(config)
    }
}

/// The value that is meant.
fn parsed(text: &str) -> Value {
    format!("value = {text}")
        .parse::<Table>()
        .ok()
        .and_then(|mut table| table.remove("value"))
        .unwrap_or_else(|| Value::String(text.to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::config::Preset;
    use crate::model::kernel::pointwise::Activation;

    #[test]
    fn a_key_is_set_and_what_is_wrong_is_named() {
        let config = Config::preset("vhp", Preset::Fast).expect("a known name");
        assert!(
            (config
                .set("training.rollouts=0.25")
                .expect("valid")
                .training
                .rollouts
                - 0.25)
                .abs()
                < 1e-12
        );
        assert_eq!(
            config.set("activation=relu").expect("valid").activation,
            Activation::Relu
        );
        assert!(
            !config
                .set("prior_expert = false")
                .expect("valid")
                .prior_expert
        );
        for (wrong, named) in [
            ("training.nothing=1", "nothing"),
            ("nowhere.rate=1", "nowhere"),
            ("hidden=many", "hidden"),
            ("training.clip=-1", "training.clip"),
            ("training.clip", "key=value"),
        ] {
            let error = config.set(wrong).expect_err(wrong);
            assert!(error.contains(named), "{wrong}: {error}");
        }
    }
}
