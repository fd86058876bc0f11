//! `etendue-mpi run`, `predict` and `sweep`: batches, planes and points shared by all processes of
//! an MPI job.
//!
//! `mpirun -n 32 etendue-mpi run scenes/fig9b.ron --photons 2^36 --threads 4 --resume`
//!
//! Rank 0 runs the command as `etendue` does. Rank 0 also hands out pieces of work to the other
//! ranks on request, and works on pieces itself. MPI only transfers bytes and does not sum numbers,
//! so the result has the same bytes as the result of `etendue run`. The arguments are the arguments
//! of `etendue`, and the crate of `etendue` parses them.
//!
//! The crate uses `ferrompi` for three reasons: `ferrompi` needs no libclang, its calls return
//! errors instead of aborting, and it is tested with both MPICH and Open MPI. `mpi` (rsmpi)
//! generates its bindings with libclang, which cluster nodes often lack.

use etendue::command_of_workers;
use etendue_pipeline::Workers;
use ferrompi::{Communicator, Mpi, Source, Tag, ThreadLevel};
use std::io::Write;
use std::process::ExitCode;
use std::thread::sleep;
use std::time::Duration;

/// The tag of all messages.
const TAG: i32 = 0;

/// Pause between checks for a message. Waiting inside MPI would occupy a core that could trace
/// photons.
const PAUSE: Duration = Duration::from_micros(200);

/// All ranks of the job.
struct Ranks(Communicator);

impl Workers for Ranks {
    fn number(&self) -> usize {
        usize::try_from(self.0.rank()).unwrap_or(0)
    }

    fn count(&self) -> usize {
        usize::try_from(self.0.size()).unwrap_or(1)
    }

    fn send(&self, to: usize, bytes: &[u8]) -> Result<(), String> {
        let to = i32::try_from(to).map_err(|e| e.to_string())?;
        self.0.send(bytes, to, TAG).map_err(|e| e.to_string())
    }

    fn receive(&self) -> Result<(usize, Vec<u8>), String> {
        let said = |error: ferrompi::Error| error.to_string();
        let status = loop {
            match self.0.iprobe::<u8>(Source::Any, TAG).map_err(said)? {
                Some(status) => break status,
                None => sleep(PAUSE),
            }
        };
        let Source::Rank(from) = status.source else {
            return Err("a message without a sender".to_owned());
        };
        let mut bytes = vec![0; status.count.unwrap_or(0)];
        let received = self.0.recv(&mut bytes, from, Tag::Value(TAG));
        received.map_err(said)?;
        let from = usize::try_from(from).map_err(|e| e.to_string())?;
        Ok((from, bytes))
    }
}

fn main() -> ExitCode {
    // Rank 0 sends and receives from a separate thread, one call at a time.
    let mpi = match Mpi::init_thread(ThreadLevel::Serialized) {
        Ok(mpi) => mpi,
        Err(error) => {
            let _ = writeln!(std::io::stderr(), "error: MPI does not start: {error}");
            return ExitCode::from(3);
        }
    };
    let ranks = Ranks(mpi.world());
    ExitCode::from(command_of_workers(std::env::args_os(), &ranks))
}
