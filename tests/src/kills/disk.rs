//! Simulates a full disk by a small tmpfs, or by a limit on the size of files.

use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The way to simulate a full disk.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum FullDisk {
    /// Mount a tmpfs, which requires root.
    Tmpfs,
    /// Use the shell's `ulimit -f`.
    Limit,
}

impl FullDisk {
    /// The way that works on this machine. It is a small tmpfs if this process may mount
    /// one, and a limit on the size of files otherwise.
    pub(super) fn best() -> io::Result<Self> {
        let place = tempfile::tempdir()?;
        let mounted = Mount::new(place.path(), 1 << 20);
        Ok(if mounted.is_ok() {
            Self::Tmpfs
        } else {
            Self::Limit
        })
    }
}

/// A mounted small tmpfs, which is unmounted when the value is dropped.
#[derive(Debug)]
pub(super) struct Mount(PathBuf);

impl Mount {
    /// Mounts a tmpfs with the given number of bytes.
    pub(super) fn new(at: &Path, size: u64) -> io::Result<Self> {
        let options = format!("size={size}");
        let mut command = Command::new("mount");
        command
            .args(["-t", "tmpfs", "-o", &options, "tmpfs"])
            .arg(at);
        succeeds(&mut command)?;
        Ok(Self(at.to_owned()))
    }

    /// Enlarges the disk.
    pub(super) fn widen(&self) -> io::Result<()> {
        let mut command = Command::new("mount");
        succeeds(command.args(["-o", "remount,size=1g"]).arg(&self.0))
    }
}

impl Drop for Mount {
    fn drop(&mut self) {
        // The function `drop` cannot report an error, so a failure to unmount is ignored.
        let _ = succeeds(Command::new("umount").arg("-l").arg(&self.0));
    }
}

fn succeeds(command: &mut Command) -> io::Result<()> {
    let output = command.output()?;
    if output.status.success() {
        Ok(())
    } else {
        let message = String::from_utf8_lossy(&output.stderr);
        Err(io::Error::other(format!("{command:?}: {message}")))
    }
}

/// Returns a command whose files may have at most this number of blocks; a longer write returns an
/// error and sends no signal.
pub(super) fn limited(program: &Path, blocks: usize) -> Command {
    let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$@\"");
    let mut command = Command::new("sh");
    command.args(["-c", &script, "sh"]).arg(program);
    command
}
