"""Errors and warnings of stackmesh."""


class Error(Exception):
    """What stackmesh could not do.

    Attributes
    ----------
    kind : str
        "usage" (the call is wrong), "input" (the labels are unreadable or invalid), "no_result" (no valid mesh was found),
        "output" (a file cannot be written), "outside_limits", "cancelled" or "internal" (a bug of stackmesh).
    problem : str
        What is wrong.
    where : str
        The file, array, section, label or option that it is wrong with.
    mend : str
        What to do about it. Options are named as on the command line: --edge-length is edge_length here.
    """

    def __init__(self, kind, problem, where="", mend=""):
        self.kind, self.problem, self.where, self.mend = kind, problem, where, mend
        super().__init__(kind, problem, where, mend)

    def __str__(self):
        text = self.problem
        if self.where:
            text += ", " + self.where
        if self.mend:
            text += "; " + self.mend
        return text


class MeshWarning(UserWarning):
    """What stackmesh warns of: the mesh is valid, but not in every respect what may have been meant."""
