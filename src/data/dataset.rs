//! A dataset: one file or a folder of them, opened by their summaries, read one episode at a time.

mod told;

use std::fs;
use std::path::{Path, PathBuf};

use super::align::align_on;
use super::block_cache::BlockCache;
use super::collect::Stream;
use super::error::DataError;
use super::folder;
use super::hash::Fnv;
use super::mcap_file::{McapFile, Raw};
use super::report::{FileReport, LeftOut, TopicReport};
use super::split::splits;
use super::topics::{Role, Topics};
use crate::episode::{Episode, EpisodeMeta, EpisodeSource, Layout, Recording, SourceError, Split};

/// Recordings on disk.
#[derive(Debug)]
pub struct Dataset {
    path: PathBuf,
    name: String,
    hash: String,
    topics: Topics,
    files: Vec<McapFile>,
    /// Which file each episode is in.
    homes: Vec<usize>,
    metas: Vec<EpisodeMeta>,
    /// Files that are no recordings.
    left_out: Vec<LeftOut>,
    cache: BlockCache,
}

impl Dataset {
    /// Opens an `.mcap` file, or every one in a folder in the order of their names. Reads their summaries and metadata
    /// only, unless a file lacks them: that one is read through once, with a note. A `dataset.toml` beside the files
    /// maps roles to topics. An episode that turns out to have fewer than two images fails when it is read.
    ///
    /// # Errors
    /// If the path cannot be read, is no MCAP, or holds no episode at all. In a folder, what cannot be opened is
    /// reported by [`Dataset::left_out`] as long as one file can.
    pub fn open(path: &Path) -> Result<Self, DataError> {
        Self::open_with(path, &[])
    }

    /// Like [`Dataset::open`], with other topics for some roles than `dataset.toml` or the format say.
    ///
    /// # Errors
    /// Those of [`Dataset::open`], a role that is named twice, a topic with two roles or that no file has as such.
    pub fn open_with(path: &Path, named: &[(Role, String)]) -> Result<Self, DataError> {
        let dataset = Self::inspect(path, named)?;
        if dataset.metas.is_empty() {
            return Err(dataset.why_empty());
        }
        match dataset.unread(named).into_iter().next() {
            Some(what) => Err(DataError::NoSuchTopic {
                path: dataset.path,
                what,
            }),
            None => Ok(dataset),
        }
    }

    /// Like [`Dataset::open_with`], for looking at what is there: no episode at all is no error.
    ///
    /// # Errors
    /// If the path cannot be read or is no MCAP, or `named` cannot be used.
    pub fn inspect(path: &Path, named: &[(Role, String)]) -> Result<Self, DataError> {
        let is_folder = fs::metadata(path).map_err(DataError::io(path))?.is_dir();
        let (folder, paths) = if is_folder {
            (path, folder::recordings(path)?)
        } else {
            (path.parent().unwrap_or(path), vec![path.to_owned()])
        };
        let mut dataset = Self {
            path: path.to_owned(),
            name: path
                .file_name()
                .unwrap_or(path.as_os_str())
                .to_string_lossy()
                .into_owned(),
            hash: String::new(),
            topics: Topics::beside(folder)?.with(named)?,
            files: Vec::new(),
            homes: Vec::new(),
            metas: Vec::new(),
            left_out: Vec::new(),
            cache: BlockCache::default(),
        };
        for path in paths {
            match McapFile::open(&path, &dataset.topics, dataset.files.len()) {
                Ok(file) => dataset.add(file),
                Err(error) if !is_folder => return Err(error),
                Err(error) => dataset.left_out.push(LeftOut {
                    what: path.display().to_string(),
                    why: error.to_string(),
                }),
            }
        }
        dataset.hash = match dataset.files.as_slice() {
            [file] => file.index.hash.clone(),
            files => {
                let mut hash = Fnv::new();
                for file in files {
                    hash.update(file.index.hash.as_bytes());
                }
                hash.hex()
            }
        };
        if dataset.topics != Topics::default() {
            // The same bytes read by other topics are other data.
            let mut hash = Fnv::new();
            hash.update(dataset.hash.as_bytes());
            hash.update(format!("{:?}", dataset.topics).as_bytes());
            dataset.hash = hash.hex();
        }
        Ok(dataset)
    }

    fn add(&mut self, mut file: McapFile) {
        let mut metas = file.episodes();
        if file.images() < 2 {
            let why = format!(
                "{} image(s) on {}, and an episode needs two; name the camera's with --topic vision=TOPIC",
                file.images(),
                self.topics.vision
            );
            let what = file.path.display().to_string();
            file.left_out.push(LeftOut { what, why });
            metas.clear();
        }
        // Exact where the file was read through anyway; else the chunk indexes rule out what they can.
        let counts = if file.index.scanned {
            file.count_images(&metas).unwrap_or_default()
        } else {
            Vec::new()
        };
        let mut counts = counts.into_iter();
        metas.retain(|meta| {
            let images = counts.next().unwrap_or(2);
            let kept = images >= 2 && !file.is_blind(meta);
            if !kept {
                file.left_out.push(LeftOut {
                    what: format!("episode {}", meta.id),
                    why: "has fewer than two images".to_owned(),
                });
            }
            kept
        });
        self.homes
            .resize(self.homes.len() + metas.len(), self.files.len());
        self.metas.extend(metas);
        self.files.push(file);
    }

    fn why_empty(&self) -> DataError {
        let say = |left: &LeftOut| {
            // The message begins with the path of a lone file anyway.
            if left.what == self.path.display().to_string() {
                left.why.clone()
            } else {
                format!("{} {}", left.what, left.why)
            }
        };
        let mut reasons = Vec::new();
        for file in &self.files {
            reasons.extend(file.index.notes.iter().cloned());
            // Without any message, no other topic would help.
            if file.index.counts.values().any(|&messages| messages > 0) {
                reasons.extend(file.left_out.iter().map(say));
            }
        }
        reasons.extend(self.left_out.iter().map(say));
        if reasons.is_empty() {
            reasons.push("no messages".to_owned());
        }
        DataError::NoEpisode {
            path: self.path.clone(),
            why: reasons.join("; "),
        }
    }

    /// Reads episode `index` as it was sensed, each stream on its own clock.
    ///
    /// # Errors
    /// Damage in a chunk it touches, a message that does not decode, an index out of range.
    pub fn recording(&self, index: usize) -> Result<Recording, DataError> {
        let (file, meta) = self.episode(index)?;
        file.recording(meta, None, &self.cache)
    }

    /// The same with frames in the layout's size: those of a camera may be a hundred times larger.
    ///
    /// # Errors
    /// Those of [`Dataset::recording`].
    pub fn recording_as(&self, index: usize, layout: Layout) -> Result<Recording, DataError> {
        let (file, meta) = self.episode(index)?;
        file.recording(meta, Some(layout.frame_size), &self.cache)
    }

    /// Reads episode `index` and lays it out on its steps.
    ///
    /// # Errors
    /// Those of [`Dataset::recording`], and fewer than two images.
    pub fn episode_aligned(&self, index: usize, layout: Layout) -> Result<Episode, DataError> {
        let (file, _) = self.episode(index)?;
        let recording = self.recording_as(index, layout)?;
        align_on(&recording, layout, &self.topics).map_err(|error| match error {
            DataError::TooFewImages { place, images } => DataError::TooFewImages {
                place: format!("{}: {place}", file.path.display()),
                images,
            },
            other => other,
        })
    }

    /// Every message of episode `index` as it was recorded, by log time, with the file that it is from.
    pub(super) fn messages(&self, index: usize) -> Result<(&McapFile, Vec<Raw>), DataError> {
        let (file, meta) = self.episode(index)?;
        Ok((file, file.messages(meta, &self.cache)?))
    }

    /// What the file says of episode `index`.
    pub(super) fn meta(&self, index: usize) -> Result<&EpisodeMeta, DataError> {
        self.episode(index).map(|(_, meta)| meta)
    }

    fn episode(&self, index: usize) -> Result<(&McapFile, &EpisodeMeta), DataError> {
        let home = self.homes.get(index).and_then(|&home| self.files.get(home));
        home.zip(self.metas.get(index))
            .ok_or_else(|| DataError::OutOfRange {
                path: self.path.clone(),
                index,
                count: self.metas.len(),
            })
    }

    /// Where an episode comes from, whichever dataset it is opened as part of: the hash of its file, and its place in
    /// it; none if there is no such episode.
    pub fn origin(&self, index: usize) -> Option<(&str, usize)> {
        let home = *self.homes.get(index)?;
        let before = self.homes[..index].iter();
        let place = before.filter(|&&other| other == home).count();
        Some((&self.files.get(home)?.index.hash, place))
    }

    /// The split of each episode. What names none is `train`; where none is of `val`, a tenth of `train` is, by `seed`.
    pub fn splits(&self, seed: u64) -> Vec<Split> {
        splits(&self.metas, seed)
    }

    /// The topic of each role.
    pub fn topics(&self) -> &Topics {
        &self.topics
    }

    /// Files of a folder that could not be opened, and why.
    pub fn left_out(&self) -> &[LeftOut] {
        &self.left_out
    }

    /// What is known of each file.
    pub fn files(&self) -> Vec<FileReport> {
        (0..self.files.len())
            .map(|home| self.file_report(home))
            .collect()
    }

    /// How many images each episode has, by the files' message indexes; a file without them is read through. None
    /// where the file is damaged.
    pub fn image_counts(&self) -> Vec<Option<u64>> {
        let mut counts = Vec::with_capacity(self.metas.len());
        for (home, file) in self.files.iter().enumerate() {
            let metas = self.metas_of(home);
            match file.count_images(metas) {
                Ok(found) => counts.extend(found.into_iter().map(Some)),
                Err(_) => counts.extend(metas.iter().map(|_| None)),
            }
        }
        counts
    }

    /// The episodes of one file: they stand together.
    fn metas_of(&self, home: usize) -> &[EpisodeMeta] {
        let start = self.homes.partition_point(|&h| h < home);
        let end = self.homes.partition_point(|&h| h <= home);
        &self.metas[start..end]
    }

    fn file_report(&self, home: usize) -> FileReport {
        let file = &self.files[home];
        let index = &file.index;
        let secs = file.recorded_secs();
        let mut topics: Vec<_> = index
            .channels
            .iter()
            .map(|(id, channel)| {
                let messages = index.counts.get(id).copied().unwrap_or(0);
                TopicReport {
                    topic: channel.topic.clone(),
                    message_type: index
                        .schemas
                        .get(&channel.schema_id)
                        .map(|s| s.name.clone()),
                    role: file.streams.get(id).map(|&Stream { role, .. }| role),
                    messages,
                    rate_hz: (secs > 0.0).then(|| messages as f64 / secs),
                }
            })
            .collect();
        topics.sort_by(|a, b| a.topic.cmp(&b.topic));
        FileReport {
            path: file.path.clone(),
            bytes: index.bytes,
            profile: index.profile.clone(),
            library: index.library.clone(),
            compression: index.compression.iter().cloned().collect(),
            chunks: index.chunks,
            messages: index.counts.values().sum(),
            start_nanos: index.log_times.map(|(first, _)| first),
            end_nanos: index.log_times.map(|(_, last)| last),
            data_hash: index.hash.clone(),
            episodes: self.metas_of(home).len(),
            topics,
            left_out: file.left_out.clone(),
            notes: index.notes.clone(),
        }
    }
}

impl EpisodeSource for Dataset {
    fn name(&self) -> &str {
        &self.name
    }

    fn data_hash(&self) -> &str {
        &self.hash
    }

    fn metas(&self) -> &[EpisodeMeta] {
        &self.metas
    }

    fn load(&self, index: usize, layout: Layout) -> Result<Episode, SourceError> {
        self.episode_aligned(index, layout)
            .map_err(|error| SourceError(error.to_string()))
    }
}
