//! Runs the leading process, which gives pieces of work to other processes on request, and
//! receives their results.

use super::link::{Workers, key};
use super::message::{Order, Packed, Piece, Task, WorkerMessage, packed, unpack, whole};
use super::packing::Packing;
use etendue_field::PhotonSource;
use etendue_scene::Scene;
use etendue_spectrum::{Measurement, PartialBatch, Watch, measure_watched};
use etendue_store::Failure;
use etendue_store::framing::split;
use std::collections::{BTreeMap, VecDeque};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::{fmt, thread};

/// Decodes the bytes of the piece with a given number.
type Unpacked<'a, T> = dyn Fn(u32, &[u8]) -> Result<T, Failure> + Sync + 'a;

/// A function that receives a finished piece and its bytes.
type Taken<'a> = dyn FnMut(&Piece, &[u8]) -> Result<(), Failure> + Send + 'a;

/// A function that returns the piece with a given number, for another process.
type Given<'a> = dyn Fn(u32) -> Result<Packed, Failure> + Sync + 'a;

/// The number of seconds after which other processes return unfinished batches: a minimum, and an
/// addition for each process. The addition gives the leading process enough time to handle the
/// returned batches.
const RETURN_SECONDS: [f64; 2] = [5.0, 0.05];

/// The leading process, with the processes that it leads.
pub struct Leader<'a> {
    workers: &'a dyn Workers,
    others: Mutex<Vec<Other>>,
}

/// The state of one of the other processes.
#[derive(Clone, Copy, Debug)]
struct Other {
    /// Number of parts of batches that the process measures in parallel.
    abreast: usize,
    /// Number of pieces on which the process is currently working.
    has: usize,
    /// Whether the process is waiting for an answer from the leading process.
    waits: bool,
}

fn held<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl fmt::Debug for Leader<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Leader")
            .field("others", &self.others)
            .finish_non_exhaustive()
    }
}

impl<'a> Leader<'a> {
    /// The leader of `workers`; this process is number 0.
    #[must_use]
    pub fn new(workers: &'a dyn Workers) -> Self {
        let other = Other {
            abreast: 1,
            has: 0,
            waits: false,
        };
        Self {
            workers,
            others: Mutex::new(vec![other; workers.count()]),
        }
    }

    /// Measures batches of a scene, and continues each batch after its finished parts. Returns
    /// the finished batches, and the unfinished batches that `watch` has stopped.
    pub(crate) fn measure(
        &self,
        packing: Packing<'_>,
        source: &dyn PhotonSource,
        batches: Vec<PartialBatch>,
        watch: &dyn Watch,
    ) -> Result<(Measurement, Vec<PartialBatch>), Failure> {
        let parts = batches.first().map_or(1, |batch| source.parts(batch.index));
        let left = Left::new(batches.iter().map(|batch| batch.index), parts as usize);
        let begun: BTreeMap<u32, PartialBatch> =
            batches.into_iter().map(|b| (b.index, b)).collect();
        let begun = Mutex::new(begun);
        let taken = |number| {
            let partial = held(&begun).remove(&number);
            partial.unwrap_or_else(|| PartialBatch::new(number))
        };
        let own = || {
            let mut batches = std::iter::from_fn(|| left.next().map(taken));
            Ok(measure_watched(
                source,
                &packing.planes(),
                &mut batches,
                watch,
            ))
        };
        let give = |number| packing.packed_partial(&taken(number));
        let mut others = Vec::new();
        let mut take = |piece: &Piece, bytes: &[u8]| {
            // A process that ends returns its finished parts, and another one continues.
            if piece.parts.is_some() {
                let partial = packing.unpacked_partial(source, piece, bytes)?;
                watch.begun(&partial);
                let goes_on = watch.should_continue(partial.index, partial.parts);
                held(&begun).insert(piece.number, partial);
                if goes_on {
                    left.put_back(piece.number);
                }
                return Ok(());
            }
            let batch = packing.unpacked(source, piece.number, bytes)?;
            watch.traced(batch.emitted);
            watch.done(&batch);
            others.push(batch);
            Ok(())
        };
        let key = key([packing.scene]);
        let (mut all, stopped) = self.share(&key, Task::Batches, &left, own, (&give, &mut take))?;
        for batch in others {
            all.insert(batch).map_err(Failure::cannot_run)?;
        }
        let begun = begun.into_inner().unwrap_or_else(PoisonError::into_inner);
        Ok((all, begun.into_values().chain(stopped).collect()))
    }

    /// Processes pieces of work on `scenes` that are handled one by one. Each piece is a plane to
    /// predict or a point of a sweep. `own` processes a piece in this process, and `unpacked`
    /// decodes or stores a piece that another process has sent.
    pub fn pieces<T: Send>(
        &self,
        task: Task,
        scenes: &[Scene],
        numbers: &[u32],
        own: &dyn Fn(u32) -> Result<T, Failure>,
        unpacked: &Unpacked<'_, T>,
    ) -> Result<BTreeMap<u32, T>, Failure> {
        let left = Left::new(numbers.iter().copied(), usize::MAX);
        let mut others = BTreeMap::new();
        let all_own = || {
            let taken = std::iter::from_fn(|| left.next());
            taken.map(|number| Ok((number, own(number)?))).collect()
        };
        let give = |number| Ok(whole(number, Vec::new()));
        let mut take = |piece: &Piece, bytes: &[u8]| {
            others.insert(piece.number, unpacked(piece.number, bytes)?);
            Ok(())
        };
        let exchange = (&give as &Given<'_>, &mut take as &mut Taken<'_>);
        let mut all: BTreeMap<u32, T> = self.share(&key(scenes), task, &left, all_own, exchange)?;
        all.append(&mut others);
        Ok(all)
    }

    /// Processes the remaining pieces: `own` processes pieces in this process, and other
    /// processes receive pieces on request. `give` returns the pieces to send to other processes,
    /// and `take` receives their results.
    fn share<T>(
        &self,
        key: &str,
        task: Task,
        left: &Left,
        own: impl FnOnce() -> Result<T, Failure>,
        (give, take): (&Given<'_>, &mut Taken<'_>),
    ) -> Result<T, Failure> {
        let (own, others) = thread::scope(|scope| {
            let others = scope.spawn(|| {
                let served = self.serve(key, task, left, (give, take));
                // If the other processes have failed, the leading process does not continue its
                // own work.
                served.inspect_err(|_| left.drop_all())
            });
            let own = own().inspect_err(|_| left.drop_all());
            (own, others.join())
        });
        others.map_err(|_| Failure::cannot_run("the leading process has failed"))??;
        own
    }

    /// Answers requests until no pieces remain and no other process is working on a piece.
    fn serve(
        &self,
        key: &str,
        task: Task,
        left: &Left,
        (give, take): (&Given<'_>, &mut Taken<'_>),
    ) -> Result<(), Failure> {
        let hand_all = || {
            let waits = |who: &usize| held(&self.others)[*who].waits;
            let mut waiting = (1..self.workers.count()).filter(waits);
            waiting.try_for_each(|who| self.hand(who, task, left, give))
        };
        hand_all()?;
        while !left.is_empty() || held(&self.others).iter().any(|other| other.has > 0) {
            let (who, said, bytes) = self.heard()?;
            match said {
                WorkerMessage::Ready { key: theirs, .. } if theirs != key => {
                    return Err(Failure::cannot_run(format!(
                        "process {who} has another scene or another version of Étendue"
                    )));
                }
                WorkerMessage::Ready { abreast, .. } => {
                    held(&self.others)[who].abreast = abreast;
                    self.hand(who, task, left, give)?;
                }
                WorkerMessage::Failed { message } => {
                    return Err(Failure::cannot_run(format!("process {who}: {message}")));
                }
                WorkerMessage::Done { pieces } => {
                    // The other process first receives new pieces, and works on them while this
                    // process decodes and stores its results.
                    self.hand(who, task, left, give)?;
                    let mut pieces = unpack(&pieces, &bytes);
                    pieces.try_for_each(|(piece, own)| take(piece, own))?;
                    // Unfinished batches that a process has returned are given to processes that
                    // are waiting.
                    hand_all()?;
                }
            }
        }
        Ok(())
    }

    /// Waits for a message from another process; the other process then waits for an answer.
    fn heard(&self) -> Result<(usize, WorkerMessage, Vec<u8>), Failure> {
        let (who, bytes) = self.workers.receive().map_err(Failure::cannot_run)?;
        let mut others = held(&self.others);
        others[who].waits = true;
        others[who].has = 0;
        drop(others);
        let (said, bytes) = split(&bytes).map_err(Failure::cannot_run)?;
        Ok((who, said, bytes.to_vec()))
    }

    /// Gives pieces to a process that is waiting, if any pieces remain.
    fn hand(&self, who: usize, task: Task, left: &Left, give: &Given<'_>) -> Result<(), Failure> {
        let numbers = left.last(held(&self.others)[who].abreast);
        if numbers.is_empty() {
            return Ok(());
        }
        let mut others = held(&self.others);
        others[who].has = numbers.len();
        others[who].waits = false;
        drop(others);
        let pieces = numbers.into_iter().map(give);
        self.order(who, task, pieces.collect::<Result<_, _>>()?)
    }

    fn order(&self, who: usize, task: Task, pieces: Vec<Packed>) -> Result<(), Failure> {
        let [least, each] = RETURN_SECONDS;
        let order = |pieces| Order {
            task,
            pieces,
            seconds: least.max(each * self.workers.count() as f64),
        };
        let sent = self.workers.send(who, &packed(order, pieces));
        sent.map_err(Failure::cannot_run)
    }

    /// Ends the work of all other processes; each process is dismissed when it next asks for
    /// work.
    pub fn dismiss_all(&self) -> Result<(), Failure> {
        for who in 1..self.workers.count() {
            while !held(&self.others)[who].waits {
                self.heard()?;
            }
            self.order(who, Task::Batches, Vec::new())?;
        }
        Ok(())
    }
}

/// The pieces that no process is working on.
struct Left {
    numbers: Mutex<VecDeque<u32>>,
    /// The number of parts of one piece that a process measures in parallel.
    parts: usize,
}

impl Left {
    fn new(numbers: impl Iterator<Item = u32>, parts: usize) -> Self {
        Self {
            numbers: Mutex::new(numbers.collect()),
            parts,
        }
    }

    fn is_empty(&self) -> bool {
        held(&self.numbers).is_empty()
    }

    fn drop_all(&self) {
        held(&self.numbers).clear();
    }

    /// Takes the first of the remaining pieces.
    fn next(&self) -> Option<u32> {
        held(&self.numbers).pop_front()
    }

    /// Takes pieces with `parts` parts in total. They come from the end of the list, because the
    /// leading process takes pieces from the front.
    fn last(&self, parts: usize) -> Vec<u32> {
        let mut numbers = held(&self.numbers);
        let most = parts.div_ceil(self.parts).clamp(1, numbers.len().max(1));
        std::iter::from_fn(|| numbers.pop_back())
            .take(most)
            .collect()
    }

    /// Puts back a piece that was taken and is not finished.
    fn put_back(&self, number: u32) {
        held(&self.numbers).push_back(number);
    }
}
