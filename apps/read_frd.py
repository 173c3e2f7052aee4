"""Reads a CalculiX result file (.frd, text): nodes, elements, and fields of its last step.

    from read_frd import read_frd
    result = read_frd("model.frd")
    result.points (n, 3), result.numbers (n), result.tets (m, 4 or 10; rows of points), result.fields["DISP"] (n, components)
"""
import numpy as np


class Result:
    def __init__(self):
        self.numbers, self.points = np.empty(0, int), np.empty((0, 3))
        self.tets, self.element_numbers = np.empty((0, 4), int), np.empty(0, int)
        self.fields = {}


def _values(line):
    """Numbers of 12 characters behind the first 13."""
    return [float(line[i:i + 12]) for i in range(13, len(line.rstrip("\n")) - 11, 12)]


def read_frd(path):
    result = Result()
    with open(path, encoding="ascii", errors="replace") as file:
        lines = iter(file)
        for line in lines:
            key = line[:6].strip()
            if key == "2C":
                numbers, points = [], []
                for line in lines:
                    if not line.startswith(" -1"):
                        break
                    numbers.append(int(line[3:13]))
                    points.append(_values(line))
                result.numbers, result.points = np.array(numbers), np.array(points)
            elif key == "3C":
                rows, ids, nodes, wanted = [], [], [], 0
                for line in lines:
                    if line.startswith(" -1"):
                        kind = int(line[13:18])
                        ids.append(int(line[3:13]))
                        nodes, wanted = [], {3: 4, 6: 10}.get(kind, 0)
                    elif line.startswith(" -2"):
                        nodes += [int(line[i:i + 10]) for i in range(3, len(line.rstrip("\n")), 10)]
                        if wanted and len(nodes) == wanted:
                            rows.append(nodes)
                        elif not wanted and ids and len(ids) > len(rows):
                            ids.pop()
                    else:
                        break
                if rows:
                    place = np.full(result.numbers.max() + 1, -1)
                    place[result.numbers] = np.arange(len(result.numbers))
                    result.tets, result.element_numbers = place[np.array(rows)], np.array(ids[:len(rows)])
            elif line.startswith(" -4"):
                name = line[5:13].strip()
                place = {int(n): i for i, n in enumerate(result.numbers)}
                values = None
                for line in lines:
                    if line.startswith(" -1"):
                        row = _values(line)
                        if values is None:
                            values = np.zeros((len(result.numbers), len(row)))
                        values[place[int(line[3:13])]] = row
                    elif line.startswith(" -3"):
                        break
                if values is not None:
                    result.fields[name] = values
    return result
