use crate::failure::Failure;
use atomic_write_file::AtomicWriteFile;
use std::collections::BTreeMap;
use std::fs;
use std::io::{self, BufWriter, Write};
use std::path::{Component, Path, PathBuf};

/// A results folder being written: every file to a temporary name first, then renamed, and hashed.
///
/// Its index, such as `summary.json`, comes last and lists the hashes: a folder without a matching index is no
/// result.
#[derive(Debug)]
pub(crate) struct Results {
    folder: PathBuf,
    index: &'static str,
    hashes: BTreeMap<String, String>,
}

/// The index of a comparison.
pub(crate) const SUMMARY: &str = "summary.json";

impl Results {
    /// Makes the folder and proves that files can be written to it, so that a long run does not end in vain.
    pub(crate) fn create(folder: &Path, index: &'static str) -> Result<Self, Failure> {
        let failure = |e| Failure::write(folder, e);
        fs::create_dir_all(folder).map_err(failure)?;
        AtomicWriteFile::open(folder.join(index))
            .and_then(AtomicWriteFile::discard)
            .map_err(failure)?;
        Ok(Self {
            folder: folder.to_owned(),
            index,
            hashes: BTreeMap::new(),
        })
    }

    /// Takes away an earlier result in this folder: first its index, then the files that lists, so that none
    /// of them stays beside those to come. Returns the names of those files.
    pub(crate) fn begin(&self) -> Result<Vec<String>, Failure> {
        let index = self.folder.join(self.index);
        let Ok(text) = fs::read(&index) else {
            return Ok(Vec::new());
        };
        let earlier: serde_json::Value = serde_json::from_slice(&text).unwrap_or_default();
        if earlier.get("scene_hash").is_none() {
            return Err(Failure::write(
                &index,
                "the file there is not of this program",
            ));
        }
        fs::remove_file(&index).map_err(|e| Failure::write(&index, e))?;
        let mut removed = Vec::new();
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
                removed.push(name.clone());
            }
        }
        Ok(removed)
    }

    /// Writes a file that the index lists; `name` is relative to the folder, with `/`.
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

    /// Writes the index, which `with_files` makes of the hashes of all files so far.
    pub(crate) fn finish(
        self,
        with_files: impl FnOnce(&BTreeMap<String, String>) -> Vec<u8>,
    ) -> Result<PathBuf, Failure> {
        self.write_unlisted(self.index, &with_files(&self.hashes))?;
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
