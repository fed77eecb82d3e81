//! The file of several recordings: a sink that all of their streams share, and that keeps the first thing to go wrong.

use std::fmt::Display;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use ::rerun::external::re_build_info::CrateVersion;
use ::rerun::external::re_log_encoding::{Encoder, EncodingOptions};
use ::rerun::log::LogMsg;
use ::rerun::sink::{LogSink, SinkFlushError};

use crate::export::ExportError;
use crate::export::output::Output;
use crate::lock::lock;

/// Cloned for each stream.
#[derive(Clone)]
pub(super) struct Writer {
    path: PathBuf,
    file: Arc<Mutex<File>>,
}

struct File {
    encoder: Encoder<Output>,
    /// What went wrong first; a sink cannot say so itself.
    wrong: Option<String>,
}

impl Writer {
    /// Begins it.
    pub(super) fn new(output: Output) -> Result<Self, ExportError> {
        let path = output.path().to_owned();
        let options = EncodingOptions::PROTOBUF_COMPRESSED;
        let encoder = Encoder::new_eager(CrateVersion::LOCAL, options, output);
        let encoder = encoder.map_err(|error| wrong(&path, error))?;
        let file = File {
            encoder,
            wrong: None,
        };
        Ok(Self {
            path,
            file: Arc::new(Mutex::new(file)),
        })
    }

    /// An error of the SDK as one of ours.
    pub(super) fn failed(&self, error: impl Display) -> ExportError {
        wrong(&self.path, error)
    }

    /// Whether all of it was written so far.
    pub(super) fn check(&self) -> Result<(), ExportError> {
        match &self.lock().wrong {
            Some(what) => Err(wrong(&self.path, what)),
            None => Ok(()),
        }
    }

    /// Ends the file, with the index that lets a viewer load it in parts.
    pub(super) fn finish(self) -> Result<Output, ExportError> {
        self.check()?;
        let Self { path, file } = self;
        let Some(file) = Arc::into_inner(file) else {
            return Err(wrong(&path, "one of its recordings is still open"));
        };
        let file = file.into_inner().unwrap_or_else(PoisonError::into_inner);
        let mut encoder = file.encoder;
        encoder.finish().map_err(|error| wrong(&path, error))?;
        encoder.into_inner().map_err(|error| wrong(&path, error))
    }

    fn lock(&self) -> MutexGuard<'_, File> {
        lock(&self.file)
    }
}

impl LogSink for Writer {
    fn send(&self, message: LogMsg) {
        let mut file = self.lock();
        if file.wrong.is_none()
            && let Err(error) = file.encoder.append(&message)
        {
            file.wrong = Some(error.to_string());
        }
    }

    fn flush_blocking(&self, _: Duration) -> Result<(), SinkFlushError> {
        match &self.lock().wrong {
            Some(what) => Err(SinkFlushError::failed(what.clone())),
            None => Ok(()),
        }
    }
}

fn wrong(path: &std::path::Path, what: impl Display) -> ExportError {
    ExportError::Format {
        path: path.to_owned(),
        what: what.to_string(),
    }
}
