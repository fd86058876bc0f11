use etendue_field::random::{Stream, unit, words};

/// The random numbers of one path, in (0, 1), drawn one after another.
#[derive(Debug)]
pub(crate) struct Numbers {
    seed: u64,
    path: u64,
    block: u32,
    left: [u32; 4],
    used: usize,
}

impl Numbers {
    pub(crate) fn new(seed: u64, path: u64) -> Self {
        Self {
            seed,
            path,
            block: 0,
            left: [0; 4],
            used: 4,
        }
    }

    fn next(&mut self) -> f64 {
        if self.used == 4 {
            self.left = words(self.seed, Stream::Backward, self.path, self.block);
            self.block += 1;
            self.used = 0;
        }
        self.used += 1;
        unit(self.left[self.used - 1])
    }

    /// The next `N` numbers.
    pub(crate) fn draw<const N: usize>(&mut self) -> [f64; N] {
        [(); N].map(|()| self.next())
    }
}
