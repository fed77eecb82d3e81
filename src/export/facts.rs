//! Where an export comes from, as strings under keys: what files without a better place for it carry.

use std::collections::BTreeMap;

use super::Provenance;

impl Provenance {
    /// What a model's topics and keys are named after: its name in lower case with an underscore for what ROS does not
    /// allow, each another one.
    pub fn topic_names(&self) -> Vec<String> {
        let mut names: Vec<String> = Vec::new();
        for model in &self.models {
            let parts = model.name.split(|c: char| !c.is_ascii_alphanumeric());
            let parts: Vec<&str> = parts.filter(|part| !part.is_empty()).collect();
            let mut name = parts.join("_").to_lowercase();
            if !name.starts_with(|c: char| c.is_ascii_lowercase()) {
                name.insert(0, 'm');
            }
            while names.contains(&name) {
                name.push('x');
            }
            names.push(name);
        }
        names
    }

    /// Everything but the probes.
    pub fn facts(&self) -> BTreeMap<String, String> {
        let mut facts = BTreeMap::from([
            ("version".to_owned(), self.poescope.clone()),
            ("data".to_owned(), self.data.name.clone()),
            ("data_hash".to_owned(), self.data.hash.clone()),
            ("state".to_owned(), self.state.clone()),
            ("seed".to_owned(), self.seed.to_string()),
        ]);
        if let Some(split) = self.split {
            facts.insert("split".to_owned(), split.name().to_owned());
        }
        for (model, topic) in self.models.iter().zip(self.topic_names()) {
            let update = model.update.map(|update| update.to_string());
            for (key, value) in [
                ("name", Some(model.name.clone())),
                ("hash", Some(model.hash.clone())),
                ("source", Some(model.source.clone())),
                ("update", update),
                ("config", Some(model.config.clone())),
            ] {
                facts.extend(value.map(|value| (format!("model.{topic}.{key}"), value)));
            }
        }
        facts
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::export::{DataOrigin, ModelOrigin};

    #[test]
    fn names_of_models_become_names_that_ros_allows_and_stay_apart() {
        let names = ["v-h-p", "v-h-p#2", "V_H__P", "2x", "", "über"];
        let model = |name: &str| ModelOrigin {
            name: name.to_owned(),
            hash: "00".to_owned(),
            source: "runs/a".to_owned(),
            update: Some(7),
            config: "latent = 16".to_owned(),
            probe: None,
        };
        let provenance = Provenance {
            poescope: "0".to_owned(),
            data: DataOrigin {
                name: "a.mcap".to_owned(),
                hash: "1".to_owned(),
            },
            models: names.map(model).to_vec(),
            state: "v=1".to_owned(),
            seed: 3,
            split: None,
        };
        assert_eq!(
            provenance.topic_names(),
            ["v_h_p", "v_h_p_2", "v_h_px", "m2x", "m", "ber"]
        );
        let facts = provenance.facts();
        assert_eq!(facts["model.v_h_p_2.name"], "v-h-p#2");
        assert_eq!(facts["model.m2x.update"], "7");
        assert_eq!(facts["model.v_h_p.config"], "latent = 16");
        assert_eq!(facts["seed"], "3");
        assert!(!facts.contains_key("split"));
    }
}
