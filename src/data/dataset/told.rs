//! What a dataset says of itself that nobody should miss.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use super::Dataset;
use crate::data::folder::split_bags;
use crate::data::topics::Role;

impl Dataset {
    /// Of the topics that `named` gives a role, those that no file can be read from: `ROLE=TOPIC`, why, and which topics
    /// there are of its types.
    pub fn unread(&self, named: &[(Role, String)]) -> Vec<String> {
        let mut unread = Vec::new();
        for (role, topic) in named {
            let streams = || self.files.iter().flat_map(|file| file.streams.values());
            if streams().any(|stream| stream.role == *role) {
                continue;
            }
            let mut lefts = self.files.iter().flat_map(|file| &file.left_out);
            let why = lefts
                .find(|left| left.what == *topic)
                .map_or("is no topic here", |left| &left.why);
            let mut what = format!("{}={topic}: {why}", role.name());
            let types: Vec<&str> = role.types().iter().map(|ty| ty.name()).collect();
            let fitting: BTreeSet<&str> = self
                .files
                .iter()
                .flat_map(|file| file.index.channels.values().map(move |it| (file, it)))
                .filter(|(file, channel)| {
                    let schema = file.index.schemas.get(&channel.schema_id);
                    schema.is_some_and(|schema| types.contains(&schema.name.as_str()))
                })
                .map(|(_, channel)| channel.topic.as_str())
                .collect();
            let _ = if fitting.is_empty() {
                write!(what, "; no topic here is {}", types.join(" or "))
            } else {
                let fitting: Vec<&str> = fitting.into_iter().collect();
                write!(what, "; of its type: {}", fitting.join(", "))
            };
            unread.push(what);
        }
        unread
    }

    /// What of the recordings is not there, that nobody should miss without knowing: files of the folder that are none,
    /// files that end in the middle, and bags that were split.
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings: Vec<String> = self
            .left_out
            .iter()
            .map(|left| format!("left out: {}", left.why))
            .collect();
        warnings.extend(self.files.iter().filter_map(|file| {
            let cut = file.index.cut.as_ref()?;
            Some(format!("{}: {cut}", file.path.display()))
        }));
        let whole = self
            .files
            .iter()
            .filter(|file| file.index.episodes.is_empty());
        for bag in split_bags(whole.map(|file| file.path.as_path())) {
            warnings.push(format!(
                "{}: a bag in several files, each of which is an episode of its own here; join them with `ros2 bag convert`",
                bag.display()
            ));
        }
        warnings
    }
}
