"""A measurement spread over a cluster of Dask, here four processes of this machine: `python dask_parts.py scenes/fig9b.ron`."""

import sys

import etendue
from dask.distributed import Client

if __name__ == "__main__":
    scene = etendue.Scene(sys.argv[1], photons=2**20)
    with Client(n_workers=4, threads_per_worker=1, dashboard_address=None) as client:
        parts = [range(part, scene.batches, 8) for part in range(8)]
        measured = client.map(lambda batches: etendue.measure(scene, batches=batches, threads=1), parts)
        result = etendue.compare(etendue.merge(client.gather(measured)))
    print(result)
    if len(sys.argv) > 2:
        result.save(sys.argv[2])
