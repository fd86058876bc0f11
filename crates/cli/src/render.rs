//! Implements `etendue render`: renders what a camera of a scene sees.

use crate::args::RenderArgs;
use crate::print::say;
use crate::progress::Terminal;
use crate::threads::on_threads;
use etendue_store::Failure;
use etendue_view::{RenderedPicture, render as render_picture};

/// Runs `etendue render`; returns the exit code.
pub(crate) fn render(args: &RenderArgs) -> Result<u8, Failure> {
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
