//! Stores batches of a run as they are measured, so that a run that ends early can be continued.
//!
//! The folder of the results has a folder `batches/KEY`, where KEY is the key of the run. Each
//! batch is a file in this folder. A file is moved there when it is complete, and its name holds
//! the hash of its content. Every process produces the same bytes for a batch, except that rounding
//! errors differ between kinds of processors. Processes can therefore share the work without a
//! lock, and a process that dies does not delay the others. The sum of the first parts of an
//! unfinished batch is also stored as a file, which a later sum replaces.

use crate::batches::{Held, files, read_files};
use crate::machine::available_memory;
use crate::npz::NpzFile;
use crate::results::{LINKED, inside, make_folders, remove_folders};
use crate::version::VERSION;
use crate::{Failure, Method};
use etendue_field::VirtualPlane;
use etendue_scene::{Scene, read_file};
use etendue_spectrum::{Batch, Measurement, PartialBatch};
use std::collections::BTreeMap;
use std::io::{Cursor, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};
use std::{fmt, fs};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipArchive, ZipWriter};

/// The folder in which runs store their batches.
const FOLDER: &str = "batches";

/// The batches of one run.
#[derive(Debug)]
pub struct CheckpointStore {
    /// The folder of the results.
    out: PathBuf,
    folder: PathBuf,
    planes: Vec<VirtualPlane>,
    seed: u64,
    method: Method,
}

impl CheckpointStore {
    /// The batches of a run with results in `out`. The batches belong to this scene,
    /// method and version.
    pub fn of(out: &Path, scene: &Scene, method: Method) -> Self {
        let other = scene.hash_of_other().unwrap_or_default();
        let what = format!("{VERSION} {} {}{other}", scene.hash(), method.words());
        let key = &blake3::hash(what.as_bytes()).to_hex()[..16];
        Self {
            out: out.to_owned(),
            folder: out.join(FOLDER).join(key),
            planes: method.recorded_planes(scene).into_owned(),
            seed: scene.run.seed,
            method,
        }
    }

    /// The folder of the batches, for messages.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// The number of finished batches, and the number of batches that are begun.
    pub fn count(&self) -> [usize; 2] {
        let found = self.furthest();
        let done = found.values().filter(|name| name.parts.is_none()).count();
        [done, found.len() - done]
    }

    /// The progress of a batch; `None` if it is not begun.
    pub fn progress(&self, batch: u32) -> Option<BatchProgress> {
        let parts = self.furthest().remove(&batch)?.parts;
        Some(parts.map_or(BatchProgress::Done, BatchProgress::Parts))
    }

    /// The file with the most parts for each batch.
    fn furthest(&self) -> BTreeMap<u32, CheckpointName> {
        let mut furthest = BTreeMap::new();
        for name in self.names() {
            let of_batch = furthest.entry(name.batch).or_insert_with(|| name.clone());
            if name.is_beyond(of_batch) {
                *of_batch = name;
            }
        }
        furthest
    }

    /// Checks whether no link leads out of the results folder.
    fn is_inside(&self) -> bool {
        let below = self.folder.strip_prefix(&self.out).ok();
        let name = below.and_then(|below| below.join("batch").to_str().map(str::to_owned));
        name.is_some_and(|name| inside(&self.out, &name).is_some())
    }

    fn names(&self) -> impl Iterator<Item = CheckpointName> {
        let entries = self.is_inside().then(|| fs::read_dir(&self.folder).ok());
        let entries = entries.flatten().into_iter().flatten().flatten();
        entries.filter_map(|entry| CheckpointName::parse(entry.file_name().to_str()?))
    }

    /// Stores a batch.
    pub fn write(&self, batch: &Batch) -> Result<(), Failure> {
        self.put(batch, None)
    }

    /// Stores the first parts of a batch, unless more parts of this batch are stored.
    pub fn write_partial(&self, batch: &PartialBatch) -> Result<(), Failure> {
        let is_new = match self.progress(batch.index) {
            None => true,
            Some(BatchProgress::Parts(parts)) => parts < batch.parts,
            Some(BatchProgress::Done) => false,
        };
        match batch.sum.as_ref().filter(|_| is_new) {
            Some(sum) => self.put(sum, Some(batch.parts)),
            None => Ok(()),
        }
    }

    /// Writes a file, and removes the files of the same batch that hold fewer parts.
    fn put(&self, batch: &Batch, parts: Option<u32>) -> Result<(), Failure> {
        if !self.is_inside() {
            return Err(Failure::write(&self.folder, LINKED));
        }
        let bytes = packed(&self.planes, batch)?;
        let name = CheckpointName::new(batch.index, parts, &bytes);
        let made = make_folders(&self.folder).map_err(|e| Failure::write(&self.folder, e))?;
        let put = || {
            let mut file = tempfile::NamedTempFile::new_in(&self.folder)?;
            file.write_all(&bytes)?;
            file.as_file().sync_all()?;
            let path = self.folder.join(name.to_string());
            file.persist(path).map_err(|error| error.error)
        };
        put().map_err(|e| {
            remove_folders(&made);
            Failure::write(&self.folder, e)
        })?;
        for other in self.names() {
            if other.batch == name.batch && name.is_beyond(&other) {
                // Failure is ignored: a file that remains is harmless, and another process may
                // have removed it.
                let _ = fs::remove_file(self.folder.join(other.to_string()));
            }
        }
        Ok(())
    }

    /// Adds the finished batches that a measurement does not have yet. Returns the batches that
    /// are begun, and the paths of damaged files. Damaged files are removed, and their batches are
    /// measured again. `emitted` returns the number of photons of a batch.
    pub fn read(
        &self,
        all: &mut Measurement,
        emitted: &dyn Fn(u32) -> u64,
    ) -> Result<(BTreeMap<u32, PartialBatch>, Vec<PathBuf>), Failure> {
        let mut begun = BTreeMap::new();
        let mut damaged = Vec::new();
        for (index, name) in self.furthest() {
            if all.contains(index) {
                continue;
            }
            let path = self.folder.join(name.to_string());
            match (self.batch(&name, emitted(index), &path), name.parts) {
                (Ok(batch), None) => all.insert(batch).map_err(Failure::cannot_run)?,
                (Ok(batch), Some(parts)) => {
                    let sum = Some(batch);
                    begun.insert(index, PartialBatch { index, parts, sum });
                }
                (Err(_), _) => match fs::remove_file(&path) {
                    Ok(()) => damaged.push(path),
                    // Another process has already removed the file.
                    Err(e) if e.kind() == ErrorKind::NotFound => {}
                    Err(e) => return Err(Failure::write(&path, e)),
                },
            }
        }
        Ok((begun, damaged))
    }

    fn batch(&self, name: &CheckpointName, photons: u64, path: &Path) -> Result<Batch, Failure> {
        let bytes = read_file(path, available_memory()).map_err(Failure::bad_input)?;
        if *name != CheckpointName::new(name.batch, name.parts, &bytes) {
            return Err(Failure::bad_input(
                "the hash in the name of the file does not match",
            ));
        }
        let held = Held {
            seed: self.seed,
            method: self.method,
            photons,
            batches: name.batch..name.batch.saturating_add(1),
        };
        unpacked(&bytes, &held, &self.planes)
    }

    /// Removes the batches, and unfinished files of processes that died.
    pub fn remove(&self) {
        if !self.is_inside() {
            return;
        }
        // Failure is ignored, because a file that remains is harmless.
        let _ = fs::remove_dir_all(&self.folder);
        if let Some(above) = self.folder.parent() {
            let _ = fs::remove_dir(above);
        }
    }
}

/// A batch as the bytes of its file.
pub fn packed(planes: &[VirtualPlane], batch: &Batch) -> Result<Vec<u8>, Failure> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    let stored = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
    for (name, bytes) in files(planes, &[batch])? {
        archive
            .start_file(name, stored)
            .map_err(Failure::cannot_run)?;
        archive.write_all(&bytes).map_err(Failure::cannot_run)?;
    }
    Ok(archive.finish().map_err(Failure::cannot_run)?.into_inner())
}

/// The batch described by `held`, from the bytes of its file.
pub fn unpacked(bytes: &[u8], held: &Held, planes: &[VirtualPlane]) -> Result<Batch, Failure> {
    let open = |name: &str| {
        let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(Failure::bad_input)?;
        let mut content = Vec::new();
        let file = archive.by_name(name).map_err(Failure::bad_input)?;
        // The content is stored uncompressed.
        let most = bytes.len() as u64;
        file.take(most)
            .read_to_end(&mut content)
            .map_err(Failure::bad_input)?;
        NpzFile::new(PathBuf::from(name), content)
    };
    let found = read_files(&open, held, planes)?;
    let batch = found.batches().next().cloned();
    batch.ok_or_else(|| Failure::bad_input("the file contains no batch"))
}

/// The progress of a batch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BatchProgress {
    /// The number of the batch's first parts that the stored sum contains.
    Parts(u32),
    /// The batch is complete.
    Done,
}

/// The name of a file: `NUMBER-HASH.batch` for a complete batch, or `NUMBER-PARTS-HASH.begun` for
/// the first parts of a batch.
#[derive(Clone, Debug, PartialEq, Eq)]
struct CheckpointName {
    batch: u32,
    /// The number of parts that the file holds; `None` for a complete batch.
    parts: Option<u32>,
    /// Hash of the parts and the bytes.
    hash: String,
}

impl CheckpointName {
    fn new(batch: u32, parts: Option<u32>, bytes: &[u8]) -> Self {
        let mut hasher = blake3::Hasher::new();
        if let Some(parts) = parts {
            hasher.update(&parts.to_le_bytes());
        }
        let hash = hasher.update(bytes).finalize().to_hex()[..32].to_owned();
        Self { batch, parts, hash }
    }

    fn parse(name: &str) -> Option<Self> {
        let (stem, is_whole) = match name.strip_suffix(".batch") {
            Some(stem) => (stem, true),
            None => (name.strip_suffix(".begun")?, false),
        };
        let (batch, mut hash) = stem.split_once('-')?;
        let mut parts = None;
        if !is_whole {
            let (number, rest) = hash.split_once('-')?;
            parts = Some(number.parse().ok()?);
            hash = rest;
        }
        let (batch, hash) = (batch.parse().ok()?, hash.to_owned());
        Some(Self { batch, parts, hash })
    }

    /// Checks whether this file holds more of a batch than another file of the same batch.
    fn is_beyond(&self, other: &Self) -> bool {
        let rank = |name: &Self| name.parts.map_or(u64::MAX, u64::from);
        rank(self) > rank(other)
    }
}

impl fmt::Display for CheckpointName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { batch, parts, hash } = self;
        match parts {
            None => write!(f, "{batch:08}-{hash}.batch"),
            Some(parts) => write!(f, "{batch:08}-{parts:08}-{hash}.begun"),
        }
    }
}
