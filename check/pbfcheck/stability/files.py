"""The files of one case on one backend."""
import json
import os

from ..dump import Dump
from ..fault import DumpFault


class CaseFiles:
    def __init__(self, folder):
        self.folder = folder
        self.number = int(os.path.basename(os.path.dirname(folder)).split("-")[0])
        self.facts = self._facts()
        self.backend = str(self.facts.get("backend", os.path.basename(folder)))
        self._trials = {}

    def _facts(self):
        path = os.path.join(self.folder, "facts.json")
        try:
            with open(path, encoding="utf-8") as file:
                facts = json.load(file)
        except OSError as error:
            raise DumpFault(path, f"cannot be read ({error.strerror})") from error
        except (UnicodeDecodeError, json.JSONDecodeError) as error:
            raise DumpFault(path, f"is not JSON: {error}") from error
        if not isinstance(facts, dict):
            raise DumpFault(path, "must hold an object")
        return facts

    def fact(self, key):
        if key not in self.facts:
            raise DumpFault(os.path.join(self.folder, "facts.json"), f'lacks the key "{key}"')
        return self.facts[key]

    @property
    def single(self):
        """Whether the dump is in float32, whose rounding the bounds must leave room for."""
        return self.facts.get("precision") != "f64"

    @property
    def labels(self):
        return self.facts.get("trials", [])

    def trial(self, label):
        if label not in self._trials:
            self._trials[label] = Dump(os.path.join(self.folder, label))
        return self._trials[label]

    def trials(self, prefix=""):
        """(label, dump) in the order of running."""
        return [(label, self.trial(label)) for label in self.labels if label.startswith(prefix)]


def frames(dump):
    return [dump.frame(step) for step in dump.steps]


def last(dump):
    return dump.frame(dump.steps[-1])


def first(dump):
    return dump.frame(dump.steps[0])
