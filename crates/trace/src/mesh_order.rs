//! Tests many photons against a mesh in an order in which successive photons meet nearby triangles,
//! so that the nodes and triangles that a photon needs are often in the processor's cache.

use crate::mesh::BlockerMesh;
use crate::photon_group::{Hits, PhotonGroup};
use etendue_bvh::SearchMemory;
use etendue_field::TwoPlane;

/// The number of cells along each axis of the plane in which photons are sorted.
const CELLS: u16 = 128;

/// A photon to be tested, and its place among the hits.
#[derive(Clone, Copy, Debug)]
struct PhotonTest {
    ray: TwoPlane,
    group: u32,
    lane: u32,
}

/// Memory for the tests of many photons, which later tests use again.
#[derive(Debug, Default)]
pub(crate) struct OrderMemory {
    tests: Vec<PhotonTest>,
    /// The cell of each test.
    cells: Vec<u32>,
    /// The number of tests in earlier cells, for each cell.
    starts: Vec<u32>,
    sorted: Vec<PhotonTest>,
    search: SearchMemory,
}

/// Sets the hits of photons that meet a mesh to its number, unless they meet a nearer obstacle,
/// which has a larger number. The order of the tests does not change the result.
pub(crate) fn meet_mesh(
    mesh: &BlockerMesh,
    number: usize,
    (groups, hits): (&[PhotonGroup], &mut [Hits]),
    memory: &mut OrderMemory,
) {
    let OrderMemory {
        tests,
        cells,
        starts,
        sorted,
        search,
    } = memory;
    let grid = OrderCells::new(mesh);
    tests.clear();
    cells.clear();
    starts.clear();
    starts.resize(usize::from(CELLS) * usize::from(CELLS) + 1, 0);
    for (group, (photons, hits)) in (0..).zip(groups.iter().zip(hits.iter())) {
        let [x, y] = photons.positions(grid.distance);
        for lane in (0..)
            .zip(hits)
            .filter(|(_, hit)| **hit < number)
            .map(|(lane, _)| lane)
        {
            let i = lane as usize;
            let cell = grid.cell([x[i], y[i]]);
            starts[cell as usize + 1] += 1;
            cells.push(cell);
            tests.push(PhotonTest {
                ray: photons.ray(i),
                group,
                lane,
            });
        }
    }
    let Some(any) = tests.first().copied() else {
        return;
    };
    // Photons of one cell meet the same nodes of the hierarchy, so the tests are sorted by cell.
    let mut total = 0;
    for start in &mut *starts {
        total += *start;
        *start = total;
    }
    sorted.clear();
    sorted.resize(tests.len(), any);
    for (test, cell) in tests.iter().zip(&*cells) {
        let place = &mut starts[*cell as usize];
        sorted[*place as usize] = *test;
        *place += 1;
    }
    for PhotonTest { ray, group, lane } in sorted {
        if mesh.is_met(search, ray) {
            hits[*group as usize][*lane as usize] = number;
        }
    }
}

/// A grid of cells in the plane halfway through a mesh.
struct OrderCells {
    distance: f64,
    low: [f64; 2],
    /// Cells per metre.
    density: [f64; 2],
}

impl OrderCells {
    fn new(mesh: &BlockerMesh) -> Self {
        let [low, high] = mesh.bounds();
        Self {
            distance: 0.5 * (low.z + high.z),
            low: [low.x, low.y],
            density: [high.x - low.x, high.y - low.y].map(|width| f64::from(CELLS) / width),
        }
    }

    /// The place of a point's cell on a space-filling curve. A point outside the grid has
    /// the cell that is nearest along each axis.
    fn cell(&self, [x, y]: [f64; 2]) -> u32 {
        let along = |axis: usize, at: f64| {
            let cell = (at - self.low[axis]) * self.density[axis];
            spread(cell.clamp(0.0, f64::from(CELLS - 1)))
        };
        along(0, x) | along(1, y) << 1
    }
}

/// A number below 256 with a zero between each two bits.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the number is at least 0 and below 256"
)]
fn spread(number: f64) -> u32 {
    let bits = number as u32;
    let bits = (bits | bits << 4) & 0x0f0f;
    let bits = (bits | bits << 2) & 0x3333;
    (bits | bits << 1) & 0x5555
}
