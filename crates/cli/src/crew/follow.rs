//! A process that does what the one that leads asks for.

use super::led::Alone;
use super::message::{Order, Said, Task, joined, split};
use super::{Crew, key};
use crate::args::{Command, PhotonArgs, SceneArgs, ThreadArgs};
use crate::failure::Failure;
use crate::job::{Job, Options};
use crate::sweep::Points;
use crate::threads::on_threads;
use etendue_field::PhotonSource;
use etendue_spectrum::{Batch, measure_watched};

/// A piece that is done: its number and its bytes.
type Piece = (u32, Vec<u8>);

/// Does whatever the process that leads asks for, until it is dismissed.
pub(super) fn follow(command: &Command, crew: &dyn Crew) {
    let followed = match command {
        Command::Run(args) => with_job(&args.scene, &args.photons, &args.threads, crew),
        Command::Predict(args) => with_job(&args.scene, &args.photons, &args.threads, crew),
        Command::Sweep(args) => on_threads(&args.threads, || {
            let points = Points::read(args)?;
            let mut run = |order: &Order| -> Result<_, Failure> {
                let run = |point: &u32| Ok((*point, points.summary(*point)?));
                order.numbers.iter().map(run).collect()
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
        let mut done = |order: &Order| match order.task {
            Task::Planes => {
                let predicted = |plane: &u32| Ok((*plane, job.packed_prediction(*plane)?));
                order.numbers.iter().map(predicted).collect()
            }
            _ => {
                if source.is_none() {
                    source = Some(job.source()?);
                }
                source.as_deref().map_or(Ok(Vec::new()), |source| {
                    measured(&job, source, &order.numbers)
                })
            }
        };
        obey(crew, &key([job.scene()]), &mut done)
    })
}

fn measured(job: &Job, source: &dyn PhotonSource, batches: &[u32]) -> Result<Vec<Piece>, Failure> {
    let found = measure_watched(source, &job.scene().planes, batches, &Alone);
    let packed = |batch: &Batch| Ok((batch.index, job.packed(batch)?));
    found.batches().map(packed).collect()
}

/// Follows orders by `done`, until one is empty.
fn obey(
    crew: &dyn Crew,
    key: &str,
    done: &mut dyn FnMut(&Order) -> Result<Vec<Piece>, Failure>,
) -> Result<(), Failure> {
    let mut said = Said::Ready {
        key: key.to_owned(),
        abreast: rayon::current_num_threads(),
    };
    let mut bytes = Vec::new();
    loop {
        let sent = crew.send(0, &joined(&said, &bytes));
        sent.map_err(Failure::cannot_run)?;
        let (_, answer) = crew.receive().map_err(Failure::cannot_run)?;
        let (order, _): (Order, _) = split(&answer).map_err(Failure::cannot_run)?;
        if order.numbers.is_empty() {
            return Ok(());
        }
        let found = done(&order)?;
        let pieces = found.iter().map(|(number, own)| (*number, own.len()));
        said = Said::Done {
            pieces: pieces.collect(),
        };
        bytes = found.into_iter().flat_map(|(_, own)| own).collect();
    }
}
