//! Implements `etendue probe`: measures the light field behind a pixel.

use crate::args::ProbeArgs;
use crate::conclude::code_of;
use crate::print::{deliver, deliver_json_file};
use crate::progress::Terminal;
use crate::threads::on_threads;
use etendue_store::{Failure, PROBE};
use etendue_view::{map_bandwidths, probe_pixel};

/// Runs `etendue probe`; returns the exit code.
pub(crate) fn probe(args: &ProbeArgs) -> Result<u8, Failure> {
    let request = args.request()?;
    let terminal = Terminal::new(args.work.quiet);
    let (code, words, folder) = on_threads(&args.work.threads, || {
        Ok(match (args.pixel, args.map) {
            (Some(pixel), _) => {
                let found = probe_pixel(&request, pixel, &terminal)?;
                (code_of(found.verdict), found.lines.join("\n"), found.folder)
            }
            (None, Some(size)) => {
                let found = map_bandwidths(&request, size, &terminal)?;
                (0, found.words, found.folder)
            }
            (None, None) => unreachable!("clap requires one of --pixel and --map"),
        })
    })?;
    if args.json {
        deliver_json_file(&folder.join(PROBE))?;
    } else if !args.work.quiet {
        deliver(&words)?;
        deliver(&format!("results: {}", folder.display()))?;
    }
    Ok(code)
}
