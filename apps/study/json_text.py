"""JSON with the line of every value, so that a message can say where; Python's own reader keeps no positions."""

import difflib
import json
import re
from json.decoder import scanstring

from plotting.errors import BadInput

BLANK = re.compile(r"[ \t\r\n]*")


class JsonText:
    """The value of a JSON file and its places: `seeds`, `parameters[0].values[1]`, `settings.Packing/Grains`."""

    def __init__(self, path):
        self.path = path
        try:
            self.text = path.read_text(encoding="utf-8")
        except OSError as error:
            raise BadInput(f"{path}: cannot be read: {error.strerror}") from None
        except UnicodeDecodeError:
            raise BadInput(f"{path}: is not a text file in UTF-8") from None
        self._lines = {}
        try:
            json.loads(self.text, parse_constant=self._refuse_constant)
            self.value = self._read(BLANK.match(self.text).end(), "")[0]
        except json.JSONDecodeError as error:
            raise BadInput(f"{path}, line {error.lineno}: not valid JSON: {error.msg}") from None
        except RecursionError:
            raise BadInput(f"{path}: nested too deeply") from None

    def reject(self, place, why):
        """Raises BadInput with file, line, place and why."""
        while place not in self._lines:  # a key that is missing: where its object begins
            place = place.rpartition(".")[0]
        raise BadInput(f"{self.path}, line {self._lines[place]}{', ' + place if place else ''}: {why}")

    def check_keys(self, place, value, allowed, required=()):
        """@p value must be an object with no keys but the allowed ones and all of the required."""
        if not isinstance(value, dict):
            self.reject(place, f"{show(value)} is not an object {{...}}")
        for key in value:
            if key not in allowed:
                near = difflib.get_close_matches(key, allowed, 1)
                hint = f"did you mean '{near[0]}'? " if near else ""
                self.reject(join(place, key), f"unknown key '{key}'; {hint}allowed: {', '.join(allowed)}")
        for key in required:
            if key not in value:
                self.reject(place, f"key '{key}' is missing")

    def _refuse_constant(self, name):
        line = self.text[:self.text.find(name)].count("\n") + 1
        raise BadInput(f"{self.path}, line {line}: not valid JSON: {name} is not a number")

    def _read(self, begin, place):
        """(value, end) of what begins there; json.loads has found the text sound, so that nothing need be checked."""
        self._lines[place] = self.text.count("\n", 0, begin) + 1
        if self.text[begin] == "{":
            return self._read_object(begin + 1, place)
        if self.text[begin] == "[":
            return self._read_list(begin + 1, place)
        return json.JSONDecoder().raw_decode(self.text, begin)

    def _read_object(self, position, place):
        value, position = {}, self._skip(position)
        while self.text[position] != "}":
            line = self.text.count("\n", 0, position) + 1
            key, position = scanstring(self.text, position + 1)
            if key in value:
                self._lines[join(place, key)] = line
                self.reject(join(place, key), f"key '{key}' is given twice")
            position = self._skip(self._skip(position) + 1)  # behind the colon
            value[key], position = self._read(position, join(place, key))
            position = self._skip_comma(position)
        return value, position + 1

    def _read_list(self, position, place):
        value, position = [], self._skip(position)
        while self.text[position] != "]":
            item, position = self._read(position, f"{place}[{len(value)}]")
            value.append(item)
            position = self._skip_comma(position)
        return value, position + 1

    def _skip(self, position):
        return BLANK.match(self.text, position).end()

    def _skip_comma(self, position):
        position = self._skip(position)
        return self._skip(position + 1) if self.text[position] == "," else position


def join(place, key):
    return f"{place}.{key}" if place else key


def show(value):
    """A value in a message: as the file has it, cut short."""
    text = json.dumps(value, ensure_ascii=False)
    return text if len(text) <= 60 else text[:57] + "..."


def is_number(value):
    return isinstance(value, (int, float)) and not isinstance(value, bool) and abs(value) < float("inf")


def is_integer(value):
    return isinstance(value, int) and not isinstance(value, bool)
