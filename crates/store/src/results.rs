//! Writes a folder of results. Only files that Étendue wrote to the folder are replaced or removed.
//!
//! New files wait in a subfolder until all new files are complete, so an earlier result stays in
//! place until then. An index, such as `summary.json`, lists the files with their hashes and is
//! moved last. A file of an earlier result is removed if the index of that result lists the file,
//! and the file still has the listed hash. All other files in the folder belong to the user and are
//! kept (docs/files.md).

mod claim;
mod commit;

use crate::file_seal::SealKind;
use crate::lock::Lock;
use crate::{ArgumentStyle, Failure, lock, sealed, unfinished};
use etendue_scene::read_file;
use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Component, Path, PathBuf};
use std::time::{Duration, Instant};

/// The index of a comparison.
pub const SUMMARY: &str = "summary.json";
/// The index of `etendue measure`.
pub const MEASUREMENT: &str = "measurement.json";
/// The index of `etendue predict`.
pub const PREDICTION: &str = "prediction.json";
/// The index of `etendue export`.
pub const EXPORT: &str = "export.json";
/// The index of a figure.
pub const FIGURE: &str = "figure.json";
/// The index of `etendue sweep`.
pub const SWEEP: &str = "sweep.json";
/// The index of a folder written by `etendue render`.
pub const PICTURE: &str = "picture.json";
/// The index of `etendue probe`.
pub const PROBE: &str = "probe.json";
/// The index of `etendue covariance`.
pub const COVARIANCE: &str = "covariance.json";
/// The index of `etendue variance`.
pub const VARIANCE: &str = "variance.json";
/// The index of `etendue fit`.
pub const FIT: &str = "fit.json";
/// The file with the seconds of a comparison. The index does not list this file, because the
/// seconds differ in every run.
pub const TIMING: &str = "timing.json";

/// The largest number of bytes of an index.
pub const MAX_INDEX_BYTES: u64 = 1 << 26;

/// The folder in which new files wait.
const UNFINISHED: &str = ".etendue-unfinished";
const LOCK: &str = ".etendue.lock";

/// The message if nothing can be written below a folder.
pub(crate) const LINKED: &str = "a link or a file is in the place of a folder";

/// The time for which another process may hold a folder before a message is given.
const MAX_WAIT: Duration = Duration::from_secs(3);

/// The files that a command will write, and the files that it reads.
#[derive(Clone, Debug)]
pub struct Plan {
    /// Name of the index.
    pub index: &'static str,
    /// Files beside the index, relative to the folder, with `/`.
    pub files: Vec<String>,
    /// Inputs, which must not be among the files written.
    pub inputs: Vec<PathBuf>,
    /// Whether files that etendue did not write may be replaced.
    pub force: bool,
    /// The style in which messages name the argument of `force`.
    pub arguments: ArgumentStyle,
}

/// A results folder that only this process writes to.
#[derive(Debug)]
pub struct Results {
    folder: PathBuf,
    /// The path as the user wrote it, for messages.
    shown: PathBuf,
    plan: Plan,
    hashes: BTreeMap<String, String>,
    /// Suffixes of planned files that are not written.
    left_out: &'static [&'static str],
    /// The folders that were created for the results, and that are removed if they stay empty.
    made: Vec<PathBuf>,
    /// Files that etendue did not write. They were replaced when the moves of a dead process were
    /// completed.
    replaced: Vec<String>,
    /// The lock, which is released before the folder is removed; `None` after its release.
    lock: Option<Lock>,
}

/// The outcome of writing a results folder.
#[derive(Debug)]
pub struct Finished {
    /// The path as the user wrote it.
    pub folder: PathBuf,
    /// Files of the earlier result that no longer exist.
    pub gone: Vec<String>,
    /// Files that etendue did not write and that were replaced.
    pub replaced: Vec<String>,
}

impl Finished {
    /// A message that lists the replaced files that etendue did not write, if there are
    /// any.
    #[must_use]
    pub fn replaced_message(&self) -> Option<String> {
        let names = self.replaced.join(", ");
        let folder = self.folder.display();
        (!self.replaced.is_empty()).then(|| format!("replaced in {folder}: {names}"))
    }
}

impl Results {
    /// Claims a folder, before any work is done. Creates and locks the folder, and removes the
    /// remains of a dead process. Fails if an input, or a file that etendue did not write, is in
    /// the place of a file to be written.
    pub fn claim(folder: &Path, plan: Plan) -> Result<Self, Failure> {
        let failure = |e| Failure::write(folder, e);
        if folder.symlink_metadata().is_ok() && !folder.is_dir() {
            return Err(Failure::write(folder, "it exists and is not a folder"));
        }
        let made = make_folders(folder).map_err(failure)?;
        let locked = || {
            let canonical = folder.canonicalize().map_err(failure)?;
            let path = canonical.join(LOCK);
            let lock = unfinished::begin(vec![path.clone()], || Lock::take(&path, folder))?;
            Ok((canonical, lock))
        };
        let (canonical, lock) = locked().inspect_err(|_| remove_folders(&made))?;
        let mut results = Self {
            folder: canonical,
            shown: folder.to_owned(),
            plan,
            hashes: BTreeMap::new(),
            left_out: &[],
            made,
            replaced: Vec::new(),
            lock: Some(lock),
        };
        results.refuse_inputs()?;
        results.replaced = results.recover()?.replaced;
        results.refuse_foreign()?;
        let staged = results.staged("");
        let unfinished = [UNFINISHED, LOCK].map(|name| results.folder.join(name));
        unfinished::begin(unfinished.to_vec(), || fs::create_dir_all(&staged))
            .map_err(|e| Failure::write(&staged, e))?;
        Ok(results)
    }

    /// Claims a folder `name` inside `out`. The user chooses `out`; below `out`, nothing is
    /// written through a link.
    pub fn claim_below(out: &Path, name: &str, plan: Plan) -> Result<Self, Failure> {
        Self::claim(&below(out, name)?, plan)
    }

    /// Claims a folder, but waits while another process writes there, and warns if the wait is
    /// long.
    pub fn claim_in_turn(folder: &Path, plan: Plan, warn: &dyn Fn(&str)) -> Result<Self, Failure> {
        let mut begun = Some(Instant::now());
        loop {
            match Self::claim(folder, plan.clone()) {
                Err(failure) if failure.message.ends_with(lock::BUSY) => {
                    // Processes that share a run briefly wait for each other without a message.
                    if begun.take_if(|begun| begun.elapsed() > MAX_WAIT).is_some() {
                        warn(&format!(
                            "{}: waiting for that process to end",
                            failure.message
                        ));
                    }
                    std::thread::sleep(Duration::from_millis(100));
                }
                ended => return ended,
            }
        }
    }

    /// Omits planned files whose names have one of these suffixes.
    pub fn leave_out(&mut self, ends: &'static [&'static str]) {
        self.left_out = ends;
    }

    /// Writes a file that the index lists.
    pub fn write(&mut self, name: &str, bytes: &[u8]) -> Result<(), Failure> {
        self.stream(name, &mut |file| file.write_all(bytes))
    }

    /// Writes a file that the index lists and that is too large for memory; `content` writes its
    /// bytes.
    pub fn stream(
        &mut self,
        name: &str,
        content: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>,
    ) -> Result<(), Failure> {
        if self.left_out.iter().any(|end| name.ends_with(end)) {
            return Ok(());
        }
        let hash = self.put(name, content)?;
        self.hashes.insert(name.to_owned(), hash);
        Ok(())
    }

    /// Writes a JSON file whose bytes may differ from run to run. The index does not list this
    /// file, which ends with its own hash.
    pub fn write_unlisted(&self, name: &str, json: &[u8]) -> Result<(), Failure> {
        let bytes = sealed::sealed(json);
        self.put(name, &mut |file| file.write_all(&bytes)).map(drop)
    }

    /// Writes and syncs a file in the folder of new files; returns its hash.
    fn put(
        &self,
        name: &str,
        content: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>,
    ) -> Result<String, Failure> {
        let shown = self.shown.join(name);
        if !self.planned().any(|planned| planned == name) {
            return Err(Failure::write(
                &shown,
                "etendue did not plan to write this file; this is a bug in etendue",
            ));
        }
        let path = self.staged(name);
        let mut write = || {
            // If this process is being interrupted, the folder has been removed and must not be
            // created again.
            let file = unfinished::undisturbed(|| {
                if let Some(folder) = path.parent() {
                    fs::create_dir_all(folder)?;
                }
                File::create_new(&path)
            })?;
            let mut file = Hashed {
                file: BufWriter::new(file),
                hasher: blake3::Hasher::new(),
            };
            content(&mut file)?;
            file.file.into_inner()?.sync_all()?;
            Ok(file.hasher.finalize().to_hex().to_string())
        };
        write().map_err(|e: io::Error| Failure::write(&shown, e))
    }

    /// Writes the index with the hashes of all files so far, and puts everything in place.
    pub fn finish(
        mut self,
        index: impl FnOnce(&BTreeMap<String, String>) -> Vec<u8>,
    ) -> Result<Finished, Failure> {
        let bytes = sealed::sealed(&index(&self.hashes));
        self.put(self.plan.index, &mut |file| file.write_all(&bytes))?;
        // The folder is checked again, because files may have appeared there since it was claimed.
        self.refuse_inputs()?;
        self.refuse_foreign()?;
        let moved = unfinished::undisturbed(|| self.commit())?;
        self.made.clear();
        let mut replaced = std::mem::take(&mut self.replaced);
        replaced.extend(moved.replaced);
        Ok(Finished {
            folder: self.shown.clone(),
            gone: moved.gone,
            replaced,
        })
    }

    /// The names of all files to be written.
    fn planned(&self) -> impl Iterator<Item = &str> {
        let files = self.plan.files.iter().map(String::as_str);
        files.chain([self.plan.index])
    }

    /// The temporary path of a new file.
    fn staged(&self, name: &str) -> PathBuf {
        self.folder.join(UNFINISHED).join("new").join(name)
    }

    /// The temporary path that a new index has after all files are complete. From then on,
    /// the files begin to move.
    fn ready(&self, index: &str) -> PathBuf {
        self.folder.join(UNFINISHED).join(index)
    }

    /// The index of the files that have begun to move, if there are any.
    fn ready_index(&self) -> Option<&'static str> {
        let mut indices = [
            SUMMARY,
            MEASUREMENT,
            PREDICTION,
            EXPORT,
            SWEEP,
            FIGURE,
            PICTURE,
            PROBE,
            COVARIANCE,
            VARIANCE,
            FIT,
        ]
        .into_iter();
        indices.find(|index| listed(&self.ready(index)).is_some())
    }
}

impl Drop for Results {
    fn drop(&mut self) {
        // The files are kept if they have begun to move, because the next process completes the
        // moves.
        if self.ready_index().is_none() {
            let _ = fs::remove_dir_all(self.folder.join(UNFINISHED));
        }
        unfinished::ended(|| drop(self.lock.take()));
        remove_folders(&self.made);
    }
}

/// Creates a folder and the folders above it. Returns those that were not there, the innermost
/// first.
pub(crate) fn make_folders(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let missing = folder
        .ancestors()
        .take_while(|path| *path != Path::new("") && !path.exists())
        .map(Path::to_owned)
        .collect();
    fs::create_dir_all(folder).inspect_err(|_| remove_folders(&missing))?;
    Ok(missing)
}

/// Removes those of the folders that are empty.
pub(crate) fn remove_folders(folders: &Vec<PathBuf>) {
    for folder in folders {
        let _ = fs::remove_dir(folder);
    }
}

/// The path of the folder `name` inside `out`. Fails if this path leads out of `out`,
/// through `..` or through a link.
pub fn below(out: &Path, name: &str) -> Result<PathBuf, Failure> {
    let folder = out.join(name);
    match inside(out, &format!("{name}/file")) {
        Some(_) => Ok(folder),
        None => Err(Failure::write(&folder, LINKED)),
    }
}

/// The path of a file of a folder. Returns `None` if the path leads out of the folder,
/// through `..` or through a link.
pub(crate) fn inside(folder: &Path, name: &str) -> Option<PathBuf> {
    let mut path = folder.to_owned();
    let mut components = Path::new(name).components().peekable();
    while let Some(component) = components.next() {
        let Component::Normal(part) = component else {
            return None;
        };
        path.push(part);
        let is_folder = || match fs::symlink_metadata(&path) {
            Ok(found) => found.is_dir(),
            Err(_) => true,
        };
        if components.peek().is_some() && !is_folder() {
            return None;
        }
    }
    Some(path)
}

/// The files that an index lists, with their hashes. Returns `None` if the index was
/// changed after Étendue wrote it.
fn listed(index: &Path) -> Option<BTreeMap<String, String>> {
    let bytes = sealed_bytes(index)?;
    let tree: serde_json::Value = serde_json::from_slice(&bytes).ok()?;
    tree["files"]
        .as_object()?
        .iter()
        .map(|(name, hash)| Some((name.clone(), hash.as_str()?.to_owned())))
        .collect()
}

/// The hash of a file, as listed in the index of a complete result.
pub fn hash_of(folder: &Path, index: &str, name: &str) -> Option<String> {
    listed(&folder.join(index))?.remove(name)
}

/// Checks whether a path is itself a regular file, and not a link to one.
fn is_regular(path: &Path) -> bool {
    fs::symlink_metadata(path).is_ok_and(|found| found.is_file())
}

/// Checks whether a path is a regular file with this hash.
fn has_hash(path: &Path, hash: &str) -> bool {
    let hashed = || {
        let mut hasher = blake3::Hasher::new();
        hasher.update_reader(File::open(path).ok()?).ok()?;
        Some(hasher.finalize().to_hex())
    };
    is_regular(path) && hashed().is_some_and(|found| found.as_str() == hash)
}

/// The content of a regular file that ends with its own hash.
fn sealed_bytes(path: &Path) -> Option<Vec<u8>> {
    regular_bytes(path).filter(|bytes| sealed::is_sealed(bytes))
}

/// Checks whether etendue wrote a file that no index lists: the seconds of a comparison, or a page
/// or a picture that bears its own mark.
fn bears_mark(name: &str, path: &Path) -> bool {
    if name == TIMING {
        return sealed_bytes(path).is_some();
    }
    let kind = SealKind::of(Path::new(name));
    kind.is_some_and(|kind| regular_bytes(path).is_some_and(|bytes| kind.is_sealed(&bytes)))
}

fn regular_bytes(path: &Path) -> Option<Vec<u8>> {
    let bytes = || read_file(path, MAX_INDEX_BYTES).ok();
    is_regular(path).then(bytes).flatten()
}

/// The folders, below the results folder, that hold these files.
fn parents<'a>(names: impl Iterator<Item = &'a String>) -> BTreeSet<&'a Path> {
    let ancestors = names.flat_map(|name| Path::new(name).ancestors().skip(1));
    ancestors
        .filter(|path| !path.as_os_str().is_empty())
        .collect()
}

/// A file that is hashed as it is written.
struct Hashed {
    file: BufWriter<File>,
    hasher: blake3::Hasher,
}

impl Write for Hashed {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.file.write(bytes)?;
        self.hasher.update(&bytes[..written]);
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}
