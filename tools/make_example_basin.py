#!/usr/bin/python3
"""Writes the heights of the basins in examples/rain/: a level floor, black, with a rim of one pixel, white.

    tools/make_example_basin.py [FOLDER]

The same file every time; FOLDER is examples/rain/ unless said otherwise. With one pixel a cell the rim is one cell
wide, and water that is shallower than the rim is high stands level on the floor.
"""

import pathlib
import sys

from make_example_street import write_grey

FOLDER = pathlib.Path(__file__).resolve().parent.parent / "examples" / "rain"
CELLS = 80  # along each side, with the rim
FLOOR, RIM = 0, 255


def main():
    folder = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else FOLDER
    ends = (0, CELLS - 1)
    write_grey(folder / "basin_heights.png", [[RIM if i in ends or j in ends else FLOOR for i in range(CELLS)] for j in range(CELLS)])


if __name__ == "__main__":
    main()
