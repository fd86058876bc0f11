//! A folder as a map from names to bytes: written, read back and compared.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::Path;

/// A map from paths to the bytes of files. Paths are relative to the folder and use `/`. The entry
/// of a subfolder has no bytes; when a folder is read, a link has the bytes of its target's path.
pub(crate) type Folder = BTreeMap<String, Option<Vec<u8>>>;

/// A folder with the given files.
pub(crate) fn of<const N: usize>(files: [(&str, Vec<u8>); N]) -> Folder {
    let files = files.map(|(name, bytes)| (name.to_owned(), Some(bytes)));
    Folder::from(files)
}

/// Writes files, and creates the folders that contain them.
pub(crate) fn write(at: &Path, files: &Folder) -> io::Result<()> {
    fs::create_dir_all(at)?;
    for (name, bytes) in files {
        let path = at.join(name);
        match bytes {
            None => fs::create_dir_all(&path)?,
            Some(bytes) => {
                fs::create_dir_all(path.parent().unwrap_or(at))?;
                fs::write(&path, bytes)?;
            }
        }
    }
    Ok(())
}

/// Reads everything below a folder; the result is empty if the folder does not exist.
pub(crate) fn read(at: &Path) -> io::Result<Folder> {
    let mut found = Folder::new();
    if at.exists() {
        read_into(at, "", &mut found)?;
    }
    Ok(found)
}

fn read_into(at: &Path, before: &str, found: &mut Folder) -> io::Result<()> {
    for entry in fs::read_dir(at)? {
        let entry = entry?;
        let name = format!("{before}{}", entry.file_name().to_string_lossy());
        if entry.file_type()?.is_symlink() {
            let target = fs::read_link(entry.path())?;
            found.insert(name, Some(target.into_os_string().into_encoded_bytes()));
        } else if entry.file_type()?.is_dir() {
            read_into(&entry.path(), &format!("{name}/"), found)?;
            found.insert(name, None);
        } else {
            found.insert(name, Some(fs::read(entry.path())?));
        }
    }
    Ok(())
}

/// The names of entries that only one of two folders has, or that differ.
pub(crate) fn differences<'a>(one: &'a Folder, other: &'a Folder) -> Vec<&'a str> {
    let names = one
        .keys()
        .chain(other.keys().filter(|n| !one.contains_key(*n)));
    let differs = |name: &&String| one.get(*name) != other.get(*name);
    names.filter(differs).map(String::as_str).collect()
}
