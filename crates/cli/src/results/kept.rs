//! Batches of a run that are kept as they are done, so that a run that ends early goes on from them.
//!
//! Each is a file below `batches/` and the key of the run, in the folder of its results. It comes there whole, by one move, and its name has
//! the hash of its content. A batch has the same bytes whoever measures it: processes need no lock to share the work, and one that
//! dies holds nothing up.

use crate::failure::Failure;
use crate::machine::available_memory;
use crate::method::Method;
use crate::results::batches::{Held, files, read_files};
use crate::results::npz::NpzFile;
use crate::results::stored::VERSION;
use etendue_field::VirtualPlane;
use etendue_scene::{Scene, read_file};
use etendue_spectrum::{Batch, Measurement};
use std::collections::BTreeMap;
use std::fs;
use std::io::{Cursor, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipArchive, ZipWriter};

/// Where the runs of a folder keep their batches.
const FOLDER: &str = "batches";

/// The batches of one run.
#[derive(Debug)]
pub(crate) struct Kept {
    folder: PathBuf,
    planes: Vec<VirtualPlane>,
    seed: u64,
    method: Method,
}

impl Kept {
    /// Those of a run into `out`: of this scene, measured in this way by this version.
    pub(crate) fn of(out: &Path, scene: &Scene, method: Method) -> Self {
        let what = format!("{VERSION} {} {}", scene.hash(), method.words());
        let key = &blake3::hash(what.as_bytes()).to_hex()[..16];
        Self {
            folder: out.join(FOLDER).join(key),
            planes: scene.planes.clone(),
            seed: scene.run.seed,
            method,
        }
    }

    /// Where they are, for messages.
    pub(crate) fn folder(&self) -> &Path {
        &self.folder
    }

    /// Whether a batch is there.
    pub(crate) fn has(&self, batch: u32) -> bool {
        self.paths().contains_key(&batch)
    }

    /// How many batches are there.
    pub(crate) fn count(&self) -> usize {
        self.paths().len()
    }

    /// The file of each batch that is there.
    fn paths(&self) -> BTreeMap<u32, PathBuf> {
        let entries = fs::read_dir(&self.folder).into_iter().flatten().flatten();
        let paths = entries.map(|entry| entry.path());
        paths
            .filter_map(|path| Some((named(&path)?.0, path)))
            .collect()
    }

    /// Keeps a batch.
    pub(crate) fn write(&self, batch: &Batch) -> Result<(), Failure> {
        let bytes = packed(&self.planes, batch)?;
        let put = || {
            fs::create_dir_all(&self.folder)?;
            let mut file = tempfile::NamedTempFile::new_in(&self.folder)?;
            file.write_all(&bytes)?;
            file.as_file().sync_all()?;
            let path = self.folder.join(name_of(batch.index, &bytes));
            file.persist(path).map_err(|error| error.error)
        };
        put().map(drop).map_err(|e| Failure::write(&self.folder, e))
    }

    /// Adds those that are there and not yet in a measurement. Returns the paths of damaged ones, which were removed and are to be measured
    /// again. `emitted` says how many photons a batch has.
    pub(crate) fn read(
        &self,
        all: &mut Measurement,
        emitted: &dyn Fn(u32) -> u64,
    ) -> Result<Vec<PathBuf>, Failure> {
        let mut damaged = Vec::new();
        for (index, path) in self.paths() {
            if all.contains(index) {
                continue;
            }
            match self.batch(index, emitted(index), &path) {
                Ok(batch) => all.insert(batch).map_err(Failure::cannot_run)?,
                Err(_) => match fs::remove_file(&path) {
                    Ok(()) => damaged.push(path),
                    // Another process has removed it.
                    Err(e) if e.kind() == ErrorKind::NotFound => {}
                    Err(e) => return Err(Failure::write(&path, e)),
                },
            }
        }
        Ok(damaged)
    }

    fn batch(&self, index: u32, photons: u64, path: &Path) -> Result<Batch, Failure> {
        let bytes = read_file(path, available_memory()).map_err(Failure::bad_input)?;
        if named(path).is_none_or(|(_, hash)| hash != hash_of(&bytes)) {
            return Err(Failure::bad_input("its name has another hash"));
        }
        let held = Held {
            seed: self.seed,
            method: self.method,
            photons,
            batches: index..index.saturating_add(1),
        };
        unpacked(&bytes, &held, &self.planes)
    }

    /// Removes them, and what a process that died has left unfinished.
    pub(crate) fn remove(&self) {
        // What stays is harmless.
        let _ = fs::remove_dir_all(&self.folder);
        if let Some(above) = self.folder.parent() {
            let _ = fs::remove_dir(above);
        }
    }
}

/// A batch as the bytes of its file.
pub(crate) fn packed(planes: &[VirtualPlane], batch: &Batch) -> Result<Vec<u8>, Failure> {
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

/// The batch that `held` names, from the bytes of its file.
pub(crate) fn unpacked(
    bytes: &[u8],
    held: &Held,
    planes: &[VirtualPlane],
) -> Result<Batch, Failure> {
    let open = |name: &str| {
        let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(Failure::bad_input)?;
        let mut content = Vec::new();
        let file = archive.by_name(name).map_err(Failure::bad_input)?;
        // What is inside is stored as it is.
        let most = bytes.len() as u64;
        file.take(most)
            .read_to_end(&mut content)
            .map_err(Failure::bad_input)?;
        NpzFile::new(PathBuf::from(name), content)
    };
    let found = read_files(&open, held, planes)?;
    let batch = found.batches().next().cloned();
    batch.ok_or_else(|| Failure::bad_input("no batch is in it"))
}

fn hash_of(bytes: &[u8]) -> String {
    blake3::hash(bytes).to_hex()[..32].to_owned()
}

fn name_of(batch: u32, bytes: &[u8]) -> String {
    format!("{batch:08}-{}.batch", hash_of(bytes))
}

/// The number and the hash that the name of a file has; `None` if it is not one of a batch.
fn named(path: &Path) -> Option<(u32, String)> {
    let name = path.file_name()?.to_str()?.strip_suffix(".batch")?;
    let (batch, hash) = name.split_once('-')?;
    Some((batch.parse().ok()?, hash.to_owned()))
}
