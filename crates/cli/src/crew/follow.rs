//! A process that does what the one that leads asks for.

use super::message::{Order, Packed, Piece, Said, Task, packed, unpack};
use super::{Crew, key};
use crate::args::{Command, PhotonArgs, SceneArgs, ThreadArgs};
use crate::job::{Job, Options};
use crate::sweep::Points;
use crate::threads::on_threads;
use etendue_field::PhotonSource;
use etendue_spectrum::{PartialBatch, Watch, measure_watched};
use etendue_store::Failure;
use etendue_store::framing::{joined, split};
use std::time::{Duration, Instant};

/// Does whatever the process that leads asks for, until it is dismissed.
pub(super) fn follow(command: &Command, crew: &dyn Crew) {
    let followed = match command {
        Command::Run(args) => with_job(&args.scene, &args.photons, &args.threads, crew),
        Command::Predict(args) => with_job(&args.scene, &args.photons, &args.threads, crew),
        Command::Sweep(args) => on_threads(&args.threads, || {
            let points = Points::read(args)?;
            let mut run = |order: &Order, _: &[u8]| -> Result<_, Failure> {
                let run = |piece: &Piece| Ok(whole(piece.number, points.summary(piece.number)?));
                order.pieces.iter().map(run).collect()
            };
            obey(crew, &key(&points.scenes), &mut run)
        }),
        _ => Ok(()),
    };
    if let Err(Failure { message, .. }) = followed {
        // The one that leads says so and ends the run; it may be gone itself.
        let _ = crew.send(0, &joined(&Said::Failed { message }, &[]));
        let _ = crew.receive();
    }
}

/// Measures batches and predicts planes of a scene.
fn with_job(
    scene: &SceneArgs,
    photons: &PhotonArgs,
    threads: &ThreadArgs,
    crew: &dyn Crew,
) -> Result<(), Failure> {
    let options = Options {
        set: scene.set.clone(),
        photons: photons.photons,
        seed: photons.seed,
        method: photons.method,
    };
    on_threads(threads, || {
        let job = Job::read(&scene.path, &options)?;
        let mut source: Option<Box<dyn PhotonSource>> = None;
        let mut done = |order: &Order, bytes: &[u8]| match order.task {
            Task::Planes => {
                let predicted =
                    |piece: &Piece| Ok(whole(piece.number, job.packed_prediction(piece.number)?));
                order.pieces.iter().map(predicted).collect()
            }
            _ => {
                if source.is_none() {
                    source = Some(job.source()?);
                }
                source.as_deref().map_or(Ok(Vec::new()), |source| {
                    measured(&job, source, order, bytes)
                })
            }
        };
        obey(crew, &key([job.scene()]), &mut done)
    })
}

/// A piece that is done.
fn whole(number: u32, bytes: Vec<u8>) -> Packed {
    let piece = Piece {
        number,
        parts: None,
        length: bytes.len(),
    };
    (piece, bytes)
}

/// Measures batches until it is time to send them back.
fn measured(
    job: &Job,
    source: &dyn PhotonSource,
    order: &Order,
    bytes: &[u8],
) -> Result<Vec<Packed>, Failure> {
    let batches = unpack(&order.pieces, bytes);
    let batches = batches.map(|(piece, own)| job.unpacked_partial(source, piece, own));
    let batches: Vec<PartialBatch> = batches.collect::<Result<_, _>>()?;
    let until = Until(Instant::now() + Duration::from_secs_f64(order.seconds));
    let planes = &job.scene().planes;
    let (found, begun) = measure_watched(source, planes, &mut batches.into_iter(), &until);
    let done = found.batches();
    let done = done.map(|batch| Ok(whole(batch.index, job.packed(batch)?)));
    let begun = begun.iter().map(|batch| job.packed_partial(batch));
    done.chain(begun).collect()
}

/// Goes on until this moment.
struct Until(Instant);

impl Watch for Until {
    fn traced(&self, _photons: u64) {}

    fn goes_on(&self, _batch: u32, _part: u32) -> bool {
        Instant::now() < self.0
    }
}

/// What comes of an order, with the bytes it came with.
type Done = Result<Vec<Packed>, Failure>;

/// Follows orders by `done`, until one is empty.
fn obey(
    crew: &dyn Crew,
    key: &str,
    done: &mut dyn FnMut(&Order, &[u8]) -> Done,
) -> Result<(), Failure> {
    let ready = Said::Ready {
        key: key.to_owned(),
        abreast: rayon::current_num_threads(),
    };
    let mut message = joined(&ready, &[]);
    loop {
        crew.send(0, &message).map_err(Failure::cannot_run)?;
        let (_, answer) = crew.receive().map_err(Failure::cannot_run)?;
        let (order, bytes): (Order, _) = split(&answer).map_err(Failure::cannot_run)?;
        if order.pieces.is_empty() {
            return Ok(());
        }
        let found = done(&order, bytes)?;
        message = packed(|pieces| Said::Done { pieces }, found);
    }
}
