# %% [markdown]
# # Many machines: Dask from Python
#
# Each task evaluates a part of the points on one core of a worker. `Client()` without arguments makes workers on this machine; with the
# address of a scheduler the same lines run on a cluster whose machines have the package.

# %%
import numpy as np
import videg
from dask.distributed import Client, LocalCluster


def power(points: dict[str, np.ndarray]) -> np.ndarray:
    circuit = {"topology": "isolated", "release": "switch", "zener.voltage": 2450.0}
    return videg.evaluate(points, "fig14", set=circuit, record="net_power", jobs=1)["net_power"]


def main() -> None:
    loads, gaps = (axis.ravel() for axis in np.meshgrid(np.geomspace(1e8, 1e11, 20), np.linspace(0.035, 0.05, 10)))
    parts = [{"load.resistance": load, "cylinder.length": gap} for load, gap in zip(np.split(loads, 8), np.split(gaps, 8))]
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
        found = np.concatenate(client.gather(client.map(power, parts)))
    here = np.concatenate([power(part) for part in parts])
    assert np.array_equal(found, here), "the workers give other bits"
    best = int(np.argmax(found))
    print(f"{len(found)} points; best: {loads[best]:.2g} Ohm, length {1e3 * gaps[best]:.1f} mm, net power {1e6 * found[best]:.1f} uW")


if __name__ == "__main__":
    main()
