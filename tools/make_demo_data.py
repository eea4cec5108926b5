#!/usr/bin/python3
"""Makes data/dam_break_3d and data/block_drop from output directories of PySPH.

    make_demo_data.py PYSPH_OUTPUT_DIRECTORY data/dam_break_3d [EVERY]

EVERY keeps the frames whose number of steps is a multiple of it. Each frame keeps /particles/fluid/arrays/{x,y,z,u,v,w} as float32 and the attributes of /solver_data. The first
frame also keeps the positions of the boundary and obstacle particles. Values are rounded to steps of a power of
two near 1e-4 m and 2e-2 m/s, less than a hundredth of the particle spacing and of the largest speeds: the low bits
of the mantissas are then zero and compress away. Needs h5py and numpy.
"""
import pathlib
import sys

import h5py
import numpy as np

POSITION_STEP = 2.0**-13  # m
VELOCITY_STEP = 2.0**-6  # m/s


def stored(group, name, values, step):
    """One array, rounded to multiples of `step`, shuffled and deflated in one chunk."""
    rounded = (np.round(np.asarray(values, np.float64) / step) * step).astype(np.float32) + np.float32(0)
    group.create_dataset(name, data=rounded, chunks=rounded.shape, compression="gzip", compression_opts=9, shuffle=True)


def convert(source, target, first):
    with h5py.File(source) as old, h5py.File(target, "w") as new:
        for name, value in old["solver_data"].attrs.items():
            new.require_group("solver_data").attrs[name] = value
        for group in ("fluid", "boundary", "obstacle") if first and "obstacle" in old["particles"] else ("fluid",):
            arrays = old[f"particles/{group}/arrays"]
            kept = new.create_group(f"particles/{group}/arrays")
            for name in "xyz":
                stored(kept, name, arrays[name][:], POSITION_STEP)
            if group == "fluid":
                for name in "uvw":
                    stored(kept, name, arrays[name][:], VELOCITY_STEP)


def main():
    source, target = map(pathlib.Path, sys.argv[1:3])
    target.mkdir(parents=True, exist_ok=True)
    steps = lambda path: int(path.stem.rsplit("_", 1)[1])
    every = int(sys.argv[3]) if len(sys.argv) > 3 else 1
    frames = sorted((path for path in source.glob("*_*.hdf5") if steps(path) % every == 0), key=steps)
    for index, frame in enumerate(frames):
        convert(frame, target / frame.name, index == 0)
    sizes = [path.stat().st_size for path in target.glob("*.hdf5")]
    print(f"{len(sizes)} frames, {sum(sizes) / 1e6:.1f} MB")


if __name__ == "__main__":
    main()
