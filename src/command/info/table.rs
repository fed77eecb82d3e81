//! The table for people: it stays on a screen, however many episodes and files there are.

use std::collections::BTreeMap;
use std::fmt::Write;

use super::{EpisodeInfo, Info};
use crate::data::{FileReport, TopicReport};
use crate::episode::Split;

/// Longer lists are shortened to their first and last lines.
const SHOWN: usize = 6;

/// Everything, in lines.
pub(super) fn render(info: &Info) -> String {
    let mut lines = Lines::default();
    let bytes: u64 = info.files.iter().map(|file| file.bytes).sum();
    lines.add(format!(
        "{}  {}, {}, {} of episodes, data {}",
        info.dataset,
        count(info.episodes.len() as u64, "episode"),
        size(bytes),
        duration(info.duration_secs),
        info.data_hash
    ));
    lines.episodes(&info.episodes);
    lines.files(&info.files);
    lines.topics(&info.files);
    lines.left_out(info);
    lines.0
}

#[derive(Default)]
struct Lines(String);

impl Lines {
    /// Names come from recordings, and a terminal would obey what is not to be read in them.
    fn add(&mut self, line: impl AsRef<str>) {
        let line = line.as_ref().replace(char::is_control, " ");
        self.0.push_str(line.trim_end());
        self.0.push('\n');
    }

    fn title(&mut self, title: &str) {
        self.add("");
        self.add(title);
    }

    /// Adds `items`, only the ends of a long list.
    fn ends(&mut self, items: &[String]) {
        let hidden = if items.len() <= SHOWN {
            0..0
        } else {
            SHOWN / 2..items.len() - 1
        };
        for (i, item) in items.iter().enumerate() {
            if i == hidden.start && !hidden.is_empty() {
                let more = hidden.len();
                self.add(format!("  … {more} more (--json lists all)"));
            }
            if !hidden.contains(&i) {
                self.add(item);
            }
        }
    }

    fn episodes(&mut self, episodes: &[EpisodeInfo]) {
        if episodes.is_empty() {
            return;
        }
        let mut by_split: BTreeMap<Option<Split>, (u64, f64, u64)> = BTreeMap::new();
        for episode in episodes {
            let (number, secs, images) = by_split.entry(episode.meta.split).or_default();
            *number += 1;
            *secs += episode.duration_secs;
            *images += episode.images.unwrap_or(0);
        }
        self.title("Splits");
        for (split, (number, secs, images)) in by_split {
            let name = split.map_or("(none)", Split::name);
            self.add(format!(
                "  {name:<8}{:>16}{:>12}{:>16}",
                count(number, "episode"),
                duration(secs),
                count(images, "image")
            ));
        }
        self.title("Episodes");
        let width = episodes.iter().map(|e| e.meta.id.chars().count()).max();
        let width = width.unwrap_or(0).clamp(8, 40);
        let line = |episode: &EpisodeInfo| {
            format!(
                "  {:<width$}  {:<7}{:>10}{:>14}",
                episode.meta.id,
                episode.meta.split.map_or("-", Split::name),
                duration(episode.duration_secs),
                episode
                    .images
                    .map_or("? images".to_owned(), |n| count(n, "image"))
            )
        };
        self.ends(&episodes.iter().map(line).collect::<Vec<_>>());
    }

    fn files(&mut self, files: &[FileReport]) {
        self.title("Files");
        let line = |file: &FileReport| {
            let name = file.path.file_name().unwrap_or(file.path.as_os_str());
            let compression = match file.compression.as_slice() {
                [] => "not chunked".to_owned(),
                kinds => format!(
                    "{} ({})",
                    count(file.chunks as u64, "chunk"),
                    kinds.join(", ")
                ),
            };
            format!(
                "  {}  {}, {}, {compression}, profile {:?}, by {}",
                name.to_string_lossy(),
                size(file.bytes),
                count(file.messages, "message"),
                file.profile,
                file.library
            )
        };
        self.ends(&files.iter().map(line).collect::<Vec<_>>());
    }

    fn topics(&mut self, files: &[FileReport]) {
        let topics = merged(files);
        if topics.is_empty() {
            return;
        }
        let width = |text: fn(&TopicReport) -> usize| topics.iter().map(text).max().unwrap_or(0);
        let names = width(|topic| topic.topic.chars().count()).max(5);
        let types = width(|topic| type_of(topic).chars().count());
        self.title("Topics");
        for topic in &topics {
            let rate = topic
                .rate_hz
                .map_or("-".to_owned(), |rate| format!("{rate:.2} Hz"));
            let role = topic.role.map_or("left out", crate::data::Role::name);
            self.add(format!(
                "  {:<names$}  {:<types$}  {role:<9}{:>10}{rate:>12}",
                topic.topic,
                type_of(topic),
                topic.messages
            ));
        }
    }

    fn left_out(&mut self, info: &Info) {
        let mut reasons: Vec<_> = info
            .left_out
            .iter()
            .map(|left| format!("  {}: {}", left.what, left.why))
            .collect();
        let mut notes = Vec::new();
        for file in &info.files {
            let name = file.path.file_name().unwrap_or(file.path.as_os_str());
            let prefix = if info.files.len() > 1 {
                format!("{}: ", name.to_string_lossy())
            } else {
                String::new()
            };
            let lefts = file.left_out.iter();
            reasons.extend(lefts.map(|left| format!("  {prefix}{}: {}", left.what, left.why)));
            notes.extend(file.notes.iter().map(|note| format!("  {prefix}{note}")));
        }
        for (title, list) in [("Left out", reasons), ("Notes", notes)] {
            if !list.is_empty() {
                self.title(title);
                self.ends(&list);
            }
        }
    }
}

/// The topics of all files, those of one name and type added up.
fn merged(files: &[FileReport]) -> Vec<TopicReport> {
    let mut topics: BTreeMap<(String, Option<String>), TopicReport> = BTreeMap::new();
    let mut secs: BTreeMap<(String, Option<String>), f64> = BTreeMap::new();
    for topic in files.iter().flat_map(|file| &file.topics) {
        let key = (topic.topic.clone(), topic.message_type.clone());
        let rate = topic.rate_hz.filter(|&rate| rate > 0.0);
        *secs.entry(key.clone()).or_default() += rate.map_or(0.0, |r| topic.messages as f64 / r);
        topics
            .entry(key)
            .and_modify(|sum| sum.messages += topic.messages)
            .or_insert_with(|| topic.clone());
    }
    for (key, topic) in &mut topics {
        let secs = secs.get(key).copied().unwrap_or(0.0);
        topic.rate_hz = (secs > 0.0).then(|| topic.messages as f64 / secs);
    }
    topics.into_values().collect()
}

fn type_of(topic: &TopicReport) -> &str {
    topic.message_type.as_deref().unwrap_or("(no schema)")
}

fn count(number: u64, word: &str) -> String {
    format!("{number} {word}{}", if number == 1 { "" } else { "s" })
}

fn size(bytes: u64) -> String {
    let mut text = String::new();
    let bytes = bytes as f64;
    // A String takes everything that is written to it.
    let _ = match bytes {
        b if b >= 1e9 => write!(text, "{:.1} GB", b * 1e-9),
        b if b >= 1e6 => write!(text, "{:.1} MB", b * 1e-6),
        b => write!(text, "{:.1} kB", b * 1e-3),
    };
    text
}

fn duration(secs: f64) -> String {
    if secs >= 3600.0 {
        format!("{:.1} h", secs / 3600.0)
    } else if secs >= 120.0 {
        format!("{:.1} min", secs / 60.0)
    } else {
        format!("{secs:.2} s")
    }
}
