use crate::failure::Failure;
use atomic_write_file::AtomicWriteFile;
use ndarray::{ArrayBase, Data, Dimension};
use ndarray_npy::{NpzWriter, WritableElement};
use std::collections::BTreeMap;
use std::fs;
use std::io::{self, BufWriter, Cursor, Write};
use std::path::{Component, Path, PathBuf};

/// A results folder being written: every file to a temporary name first, then renamed, and hashed.
///
/// `summary.json` comes last and lists the hashes: a folder without a matching summary is no result.
#[derive(Debug)]
pub(crate) struct Results {
    folder: PathBuf,
    hashes: BTreeMap<String, String>,
}

/// The file that makes a folder a result.
const SUMMARY: &str = "summary.json";

impl Results {
    /// Makes the folder and proves that files can be written to it, so that a long run does not end in vain.
    pub(crate) fn create(folder: &Path) -> Result<Self, Failure> {
        let failure = |e| Failure::write(folder, e);
        fs::create_dir_all(folder).map_err(failure)?;
        AtomicWriteFile::open(folder.join(SUMMARY))
            .and_then(AtomicWriteFile::discard)
            .map_err(failure)?;
        Ok(Self {
            folder: folder.to_owned(),
            hashes: BTreeMap::new(),
        })
    }

    /// Takes away an earlier result in this folder: first its summary, then the files that lists, so that none
    /// of them stays beside those to come.
    pub(crate) fn begin(&self) -> Result<(), Failure> {
        let summary = self.folder.join(SUMMARY);
        let Ok(text) = fs::read(&summary) else {
            return Ok(());
        };
        let earlier: serde_json::Value = serde_json::from_slice(&text).unwrap_or_default();
        if earlier.get("scene_hash").is_none() {
            return Err(Failure::write(
                &summary,
                "the file there is not of this program",
            ));
        }
        fs::remove_file(&summary).map_err(|e| Failure::write(&summary, e))?;
        for (name, hash) in earlier["files"].as_object().into_iter().flatten() {
            let path = self.folder.join(name);
            let inside = Path::new(name)
                .components()
                .all(|c| matches!(c, Component::Normal(_)));
            // What someone has changed since is theirs.
            let unchanged =
                || fs::read(&path).is_ok_and(|b| *hash == blake3::hash(&b).to_hex().as_str());
            if inside && unchanged() {
                fs::remove_file(&path).map_err(|e| Failure::write(&path, e))?;
            }
        }
        Ok(())
    }

    /// Writes a file that the summary lists; `name` is relative to the folder, with `/`.
    pub(crate) fn write(&mut self, name: &str, bytes: &[u8]) -> Result<(), Failure> {
        self.stream(name, &mut |file| file.write_all(bytes))
    }

    /// The same for a file too large for memory, which `content` writes.
    pub(crate) fn stream(
        &mut self,
        name: &str,
        content: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>,
    ) -> Result<(), Failure> {
        let hash = self.atomically(name, content)?;
        self.hashes.insert(name.to_owned(), hash);
        Ok(())
    }

    /// Writes a file that is not part of the promise of same bytes.
    pub(crate) fn write_unlisted(&self, name: &str, bytes: &[u8]) -> Result<(), Failure> {
        self.atomically(name, &mut |file| file.write_all(bytes))
            .map(drop)
    }

    /// Writes a file under a temporary name and renames it; returns its hash.
    fn atomically(
        &self,
        name: &str,
        content: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>,
    ) -> Result<String, Failure> {
        let path = self.folder.join(name);
        let folder = path.parent().unwrap_or(&self.folder);
        let mut write = || {
            fs::create_dir_all(folder)?;
            let mut file = Hashed {
                file: BufWriter::new(AtomicWriteFile::open(&path)?),
                hasher: blake3::Hasher::new(),
            };
            content(&mut file)?;
            file.file.into_inner()?.commit()?;
            Ok(file.hasher.finalize().to_hex().to_string())
        };
        write().map_err(|e: io::Error| Failure::write(&path, e))
    }

    /// Writes the summary, which `with_files` makes of the hashes of all files so far.
    pub(crate) fn finish(
        self,
        with_files: impl FnOnce(&BTreeMap<String, String>) -> Vec<u8>,
    ) -> Result<PathBuf, Failure> {
        self.write_unlisted(SUMMARY, &with_files(&self.hashes))?;
        Ok(self.folder)
    }
}

/// A file that is hashed as it is written.
struct Hashed {
    file: BufWriter<AtomicWriteFile>,
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

/// Named arrays in the making of an NPZ file.
pub(crate) struct Npz(NpzWriter<Cursor<Vec<u8>>>);

impl Npz {
    pub(crate) fn new() -> Self {
        Self(NpzWriter::new(Cursor::new(Vec::new())))
    }

    pub(crate) fn add<A, S, D>(
        mut self,
        name: &str,
        array: &ArrayBase<S, D>,
    ) -> Result<Self, Failure>
    where
        A: WritableElement,
        S: Data<Elem = A>,
        D: Dimension,
    {
        self.0
            .add_array(name, array)
            .map_err(|e| Failure::cannot_run(format!("array {name}: {e}")))?;
        Ok(self)
    }

    pub(crate) fn bytes(self) -> Result<Vec<u8>, Failure> {
        let finished = self.0.finish().map_err(Failure::cannot_run)?;
        Ok(finished.into_inner())
    }
}
