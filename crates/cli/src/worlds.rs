//! Implements `etendue import`, `render` and `probe`, for scenes of other programs.

use crate::args::{ImportArgs, ProbeArgs, RenderArgs, WorldCommand};
use crate::conclude::code_of;
use crate::print::{deliver, deliver_json_file, say};
use crate::progress::Terminal;
use crate::threads::on_threads;
use etendue_store::{Failure, PROBE};
use etendue_view::{
    Contents, RenderedPicture, map_bandwidths, probe_pixel, render as render_picture,
};

/// Runs a command; returns the exit code.
pub(crate) fn run(command: &WorldCommand) -> Result<u8, Failure> {
    match command {
        WorldCommand::Import(args) => import(args),
        WorldCommand::Render(args) => render(args),
        WorldCommand::Probe(args) => probe(args),
    }
}

/// Runs `etendue import`; returns the exit code.
fn import(args: &ImportArgs) -> Result<u8, Failure> {
    let contents = Contents::read(&args.scene.source())?;
    deliver(&contents.lines().join("\n"))?;
    Ok(0)
}

/// Runs `etendue render`; returns the exit code.
fn render(args: &RenderArgs) -> Result<u8, Failure> {
    let name = args.scene.path.file_stem().unwrap_or_default();
    let folder = args.out.or_named(name);
    let terminal = Terminal::new(args.work.quiet);
    let RenderedPicture {
        size: [w, h],
        notes,
        effort,
    } = on_threads(&args.work.threads, || {
        render_picture(&args.request(), &folder, &terminal)
    })?;
    if !args.work.quiet {
        notes.iter().for_each(|note| say(&format!("note: {note}")));
        let folder = folder.display();
        say(&format!("{w} × {h} pixels{effort} in {folder}"));
    }
    Ok(0)
}

/// Runs `etendue probe`; returns the exit code.
fn probe(args: &ProbeArgs) -> Result<u8, Failure> {
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
