//! Runs a follower process, which does the work that the leading process requests.

use crate::method;
use crate::run::Run;
use crate::workers::{
    Order, Packed, Piece, Task, WorkerMessage, Workers, key, packed, unpack, whole,
};
use etendue_field::PhotonSource;
use etendue_scene::Scene;
use etendue_spectrum::{PartialBatch, Watch, measure_watched};
use etendue_store::Failure;
use etendue_store::framing::{joined, split};
use std::time::{Duration, Instant};

/// Measures batches and predicts planes of a scene when the leading process requests them. Returns
/// when the leading process dismisses this process.
pub fn follow_run(workers: &dyn Workers, run: &Run) -> Result<(), Failure> {
    let mut source: Option<Box<dyn PhotonSource>> = None;
    let mut done = |order: &Order, bytes: &[u8]| match order.task {
        Task::Planes => {
            let predicted =
                |piece: &Piece| Ok(whole(piece.number, run.packed_prediction(piece.number)?));
            order.pieces.iter().map(predicted).collect()
        }
        _ => {
            let source = match &mut source {
                Some(source) => source,
                none => none.insert(method::source(&run.scene, run.method)?),
            };
            measured(run, &**source, order, bytes)
        }
    };
    serve(workers, &key([&run.scene]), &mut done)
}

/// Computes points of a sweep when the leading process requests them. `scenes` has the scene of
/// each point, and `run` returns the bytes of a point.
pub fn follow_points(
    workers: &dyn Workers,
    scenes: &[Scene],
    run: &dyn Fn(u32) -> Result<Vec<u8>, Failure>,
) -> Result<(), Failure> {
    let mut done = |order: &Order, _: &[u8]| -> Result<_, Failure> {
        let run = |piece: &Piece| Ok(whole(piece.number, run(piece.number)?));
        order.pieces.iter().map(run).collect()
    };
    serve(workers, &key(scenes), &mut done)
}

/// Tells the leading process why this process cannot continue; the leading process reports the
/// reason and ends the run.
pub fn report_failure(workers: &dyn Workers, Failure { message, .. }: Failure) {
    // The leading process may have ended before it receives the message.
    let _ = workers.send(0, &joined(&WorkerMessage::Failed { message }, &[]));
    let _ = workers.receive();
}

/// Measures batches until the time when they must be sent back.
fn measured(
    run: &Run,
    source: &dyn PhotonSource,
    order: &Order,
    bytes: &[u8],
) -> Result<Vec<Packed>, Failure> {
    let packing = run.packing();
    let batches = unpack(&order.pieces, bytes)
        .map(|(piece, own)| packing.unpacked_partial(source, piece, own))
        .collect::<Result<Vec<PartialBatch>, _>>()?;
    let until = Until(Instant::now() + Duration::from_secs_f64(order.seconds));
    let (found, begun) =
        measure_watched(source, &packing.planes(), &mut batches.into_iter(), &until);
    let done = found
        .batches()
        .map(|batch| Ok(whole(batch.index, packing.packed(batch)?)));
    let begun = begun.iter().map(|batch| packing.packed_partial(batch));
    done.chain(begun).collect()
}

/// A [`Watch`] that lets a measurement continue until this time.
struct Until(Instant);

impl Watch for Until {
    fn traced(&self, _photons: u64) {}

    fn should_continue(&self, _batch: u32, _part: u32) -> bool {
        Instant::now() < self.0
    }
}

/// The results of an order, with their bytes.
type Done = Result<Vec<Packed>, Failure>;

/// Carries out each order by calling `done`, until an empty order arrives.
fn serve(
    workers: &dyn Workers,
    key: &str,
    done: &mut dyn FnMut(&Order, &[u8]) -> Done,
) -> Result<(), Failure> {
    let ready = WorkerMessage::Ready {
        key: key.to_owned(),
        abreast: rayon::current_num_threads(),
    };
    let mut message = joined(&ready, &[]);
    loop {
        workers.send(0, &message).map_err(Failure::cannot_run)?;
        let (_, answer) = workers.receive().map_err(Failure::cannot_run)?;
        let (order, bytes): (Order, _) = split(&answer).map_err(Failure::cannot_run)?;
        if order.pieces.is_empty() {
            return Ok(());
        }
        let found = done(&order, bytes)?;
        message = packed(|pieces| WorkerMessage::Done { pieces }, found);
    }
}
