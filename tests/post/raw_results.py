"""What h5py alone reads from a result."""

import h5py


class RawOutput:
    """One output as it lies in the file, read by h5py alone."""

    def __init__(self, grid, step):
        steps = grid["Steps"]
        part = steps["PartOffsets"][step]
        counts = {
            "PointData": grid["NumberOfPoints"][part],
            "CellData": grid["NumberOfCells"][part],
        }
        first = steps["PointOffsets"][step]
        self.time = steps["Values"][step]
        self.points = grid["Points"][first : first + counts["PointData"]]
        first = steps["ConnectivityIdOffsets"][step, 0]
        n_ids = grid["NumberOfConnectivityIds"][part]
        self.connectivity = grid["Connectivity"][first : first + n_ids]
        self.fields = {}
        for kind, count in counts.items():
            for name, dataset in grid[kind].items():
                first = steps[f"{kind}Offsets"][name][step]
                self.fields[name] = dataset[first : first + count]


def raw_outputs(path):
    """All outputs of a file."""
    with h5py.File(path) as file:
        grid = file["VTKHDF"]
        return [RawOutput(grid, step) for step in range(grid["Steps"].attrs["NSteps"])]
