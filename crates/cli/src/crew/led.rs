//! The processes that this one leads: it hands out what they ask for, and takes what they have done.

use super::message::{Order, Said, Task, joined, split};
use super::{Crew, key};
use crate::failure::Failure;
use crate::job::Job;
use etendue_compare::Prediction;
use etendue_field::PhotonSource;
use etendue_scene::Scene;
use etendue_spectrum::{Batch, Measurement, Watch, measure_watched};
use std::collections::{BTreeMap, VecDeque};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;

/// What the bytes of the piece of that number say.
type Unpacked<'a, T> = dyn Fn(u32, &[u8]) -> Result<T, Failure> + Sync + 'a;

/// Takes the bytes of the piece of that number.
type Taken<'a> = dyn FnMut(u32, &[u8]) -> Result<(), Failure> + Send + 'a;

/// The processes that this one leads.
pub(crate) struct Led<'a> {
    crew: &'a dyn Crew,
    others: Mutex<Vec<Other>>,
}

/// One of them.
#[derive(Clone, Copy, Debug)]
struct Other {
    /// Batches that it measures at a time.
    abreast: usize,
    /// Pieces that it has now.
    has: usize,
    /// Whether it waits for an answer.
    waits: bool,
}

fn held<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl<'a> Led<'a> {
    pub(super) fn new(crew: &'a dyn Crew) -> Self {
        let other = Other {
            abreast: 1,
            has: 0,
            waits: false,
        };
        Self {
            crew,
            others: Mutex::new(vec![other; crew.count()]),
        }
    }

    /// Measures batches of a scene.
    pub(crate) fn measure(
        &self,
        job: &Job,
        source: &dyn PhotonSource,
        batches: &[u32],
        watch: &dyn Watch,
    ) -> Result<Measurement, Failure> {
        let left = Left::new(batches.iter().copied(), watch);
        let mut others = Vec::new();
        let own = || Ok(measure_watched(source, &job.scene().planes, batches, &left));
        let mut take = |number, bytes: &[u8]| {
            let batch = job.unpacked(source, number, bytes)?;
            watch.traced(batch.emitted);
            watch.done(&batch);
            others.push(batch);
            Ok(())
        };
        let key = key([job.scene()]);
        let mut all = self.share(&key, Task::Batches, &left, own, &mut take)?;
        for batch in others {
            all.insert(batch).map_err(Failure::cannot_run)?;
        }
        Ok(all)
    }

    /// Predicts planes of a scene: `own` does it here, and `unpacked` has what another process has sent.
    pub(crate) fn predict(
        &self,
        scene: &Scene,
        planes: &[u32],
        own: &dyn Fn(u32) -> Result<Prediction, Failure>,
        unpacked: &Unpacked<'_, Prediction>,
    ) -> Result<BTreeMap<u32, Prediction>, Failure> {
        self.pieces(&key([scene]), Task::Planes, planes, own, unpacked)
    }

    /// Runs points of a sweep, whose scenes these are: `own` does it here, and `unpacked` keeps what another process has sent.
    pub(crate) fn run<T: Send>(
        &self,
        scenes: &[Scene],
        points: &[u32],
        own: &dyn Fn(u32) -> Result<T, Failure>,
        unpacked: &Unpacked<'_, T>,
    ) -> Result<BTreeMap<u32, T>, Failure> {
        self.pieces(&key(scenes), Task::Points, points, own, unpacked)
    }

    /// Pieces that are done one by one.
    fn pieces<T: Send>(
        &self,
        key: &str,
        task: Task,
        numbers: &[u32],
        own: &dyn Fn(u32) -> Result<T, Failure>,
        unpacked: &Unpacked<'_, T>,
    ) -> Result<BTreeMap<u32, T>, Failure> {
        let left = Left::new(numbers.iter().copied(), &Alone);
        let mut others = BTreeMap::new();
        let all_own = || {
            let taken = std::iter::from_fn(|| left.next());
            taken.map(|number| Ok((number, own(number)?))).collect()
        };
        let mut take = |number, bytes: &[u8]| {
            others.insert(number, unpacked(number, bytes)?);
            Ok(())
        };
        let mut all: BTreeMap<u32, T> = self.share(key, task, &left, all_own, &mut take)?;
        all.append(&mut others);
        Ok(all)
    }

    /// Does what is left, here by `own` and wherever somebody asks for some, whose pieces go to `take`.
    fn share<T>(
        &self,
        key: &str,
        task: Task,
        left: &Left<'_>,
        own: impl FnOnce() -> Result<T, Failure>,
        take: &mut Taken<'_>,
    ) -> Result<T, Failure> {
        let (own, others) = thread::scope(|scope| {
            let others = scope.spawn(|| {
                let served = self.serve(key, task, left, take);
                // Where others have failed, this process need not go on.
                served.inspect_err(|_| left.drop_all())
            });
            let own = own().inspect_err(|_| left.drop_all());
            (own, others.join())
        });
        others.map_err(|_| Failure::cannot_run("the process that leads has failed"))??;
        own
    }

    /// Answers whoever asks, until nothing is left and nobody has any more of it.
    fn serve(
        &self,
        key: &str,
        task: Task,
        left: &Left<'_>,
        take: &mut Taken<'_>,
    ) -> Result<(), Failure> {
        for who in 1..self.crew.count() {
            if held(&self.others)[who].waits {
                self.hand(who, task, left)?;
            }
        }
        while !left.is_empty() || held(&self.others).iter().any(|other| other.has > 0) {
            let (who, said, bytes) = self.heard()?;
            match said {
                Said::Ready { key: theirs, .. } if theirs != key => {
                    return Err(Failure::cannot_run(format!(
                        "process {who} has another scene, or another version of Étendue"
                    )));
                }
                Said::Ready { abreast, .. } => {
                    held(&self.others)[who].abreast = abreast;
                    self.hand(who, task, left)?;
                }
                Said::Failed { message } => {
                    return Err(Failure::cannot_run(format!("process {who}: {message}")));
                }
                Said::Done { pieces } => {
                    // It goes on while its pieces are unpacked and kept.
                    self.hand(who, task, left)?;
                    let mut bytes = bytes.as_slice();
                    for (number, length) in pieces {
                        let (own, rest) = bytes.split_at_checked(length).unwrap_or_default();
                        take(number, own)?;
                        bytes = rest;
                    }
                }
            }
        }
        Ok(())
    }

    /// Waits for what another process says. It waits for the answer.
    fn heard(&self) -> Result<(usize, Said, Vec<u8>), Failure> {
        let (who, bytes) = self.crew.receive().map_err(Failure::cannot_run)?;
        let mut others = held(&self.others);
        others[who].waits = true;
        others[who].has = 0;
        drop(others);
        let (said, bytes) = split(&bytes).map_err(Failure::cannot_run)?;
        Ok((who, said, bytes.to_vec()))
    }

    /// Gives pieces to a process that waits, if any are left.
    fn hand(&self, who: usize, task: Task, left: &Left<'_>) -> Result<(), Failure> {
        let most = match task {
            Task::Batches => held(&self.others)[who].abreast,
            Task::Planes | Task::Points => 1,
        };
        let numbers = left.last(most);
        if numbers.is_empty() {
            return Ok(());
        }
        let mut others = held(&self.others);
        others[who].has = numbers.len();
        others[who].waits = false;
        drop(others);
        self.order(who, &Order { task, numbers })
    }

    fn order(&self, who: usize, order: &Order) -> Result<(), Failure> {
        let sent = self.crew.send(who, &joined(order, &[]));
        sent.map_err(Failure::cannot_run)
    }

    /// Ends the work of all others, as soon as each asks for more.
    pub(super) fn dismiss_all(&self) -> Result<(), Failure> {
        let end = Order {
            task: Task::Batches,
            numbers: Vec::new(),
        };
        for who in 1..self.crew.count() {
            while !held(&self.others)[who].waits {
                self.heard()?;
            }
            self.order(who, &end)?;
        }
        Ok(())
    }
}

/// The pieces that nobody has begun.
struct Left<'a> {
    numbers: Mutex<VecDeque<u32>>,
    watch: &'a dyn Watch,
}

impl<'a> Left<'a> {
    fn new(numbers: impl Iterator<Item = u32>, watch: &'a dyn Watch) -> Self {
        Self {
            numbers: Mutex::new(numbers.collect()),
            watch,
        }
    }

    fn is_empty(&self) -> bool {
        held(&self.numbers).is_empty()
    }

    fn drop_all(&self) {
        held(&self.numbers).clear();
    }

    /// Takes the first one.
    fn next(&self) -> Option<u32> {
        held(&self.numbers).pop_front()
    }

    /// Takes the last ones, as many as that: this process goes through them from the first.
    fn last(&self, most: usize) -> Vec<u32> {
        let mut numbers = held(&self.numbers);
        let mut taken = Vec::new();
        while taken.len() < most.max(1)
            && let Some(number) = numbers.pop_back()
        {
            if self.watch.wants(number) {
                taken.push(number);
            }
        }
        taken
    }
}

impl Watch for Left<'_> {
    fn traced(&self, photons: u64) {
        self.watch.traced(photons);
    }

    fn wants(&self, batch: u32) -> bool {
        let mut numbers = held(&self.numbers);
        let Some(at) = numbers.iter().position(|other| *other == batch) else {
            return false;
        };
        numbers.remove(at);
        self.watch.wants(batch)
    }

    fn done(&self, batch: &Batch) {
        self.watch.done(batch);
    }
}

/// Nobody looks on, and everything is wanted.
pub(super) struct Alone;

impl Watch for Alone {
    fn traced(&self, _photons: u64) {}
}
