"""Reads a world of Webots, as far as ours go: nodes, fields, numbers, strings, lists, DEF.

A node is a dict of its fields with its type as "node"; a field with several numbers is a list.
"""

import re

TOKEN = re.compile(r'"(?P<text>[^"]*)"|(?P<mark>[{}\[\]])|(?P<word>[^\s{}\[\]"]+)')


def _is_number(word):
    return re.fullmatch(r"[-+]?[0-9.]+(e[-+]?[0-9]+)?", word) is not None


class _Reader:
    def __init__(self, text):
        self.tokens = [(match.lastgroup, match[match.lastgroup]) for line in text.splitlines()
                       for match in TOKEN.finditer(line.split("#")[0])]
        self.at = 0

    def next(self):
        self.at += 1
        return self.tokens[self.at - 1]

    def ahead(self):
        return self.tokens[self.at] if self.at < len(self.tokens) else ("end", "")

    def expect(self, mark):
        kind, token = self.next()
        if (kind, token) != ("mark", mark):
            raise ValueError(f"'{token}' where '{mark}' was expected")

    def node(self, node_type):
        if node_type == "DEF":
            self.next()  # the name
            node_type = self.next()[1]
        fields = {"node": node_type}
        self.expect("{")
        while self.ahead() != ("mark", "}"):
            name = self.next()[1]
            if name in fields:
                raise ValueError(f"{node_type} has two fields '{name}'")
            fields[name] = self.value()
        self.expect("}")
        return fields

    def list(self):
        values = []
        while self.ahead() != ("mark", "]"):
            values.append(self.value(alone=True))
        self.expect("]")
        return values

    def value(self, alone=False):
        kind, token = self.next()
        if kind == "text":
            return token
        if (kind, token) == ("mark", "["):
            return self.list()
        if _is_number(token):
            numbers = [float(token)]
            while not alone and self.ahead()[0] == "word" and _is_number(self.ahead()[1]):
                numbers.append(float(self.next()[1]))
            return numbers if len(numbers) > 1 else numbers[0]
        if token in ("TRUE", "FALSE"):
            return token == "TRUE"
        return self.node(token)


def read(text):
    """The nodes of a world, in their order."""
    if not text.startswith("#VRML_SIM R"):
        raise ValueError("no world of Webots: its first line begins with '#VRML_SIM R'")
    reader, nodes = _Reader(text), []
    while reader.ahead()[0] != "end":
        nodes.append(reader.node(reader.next()[1]))
    return nodes


def below(nodes):
    """These nodes and all nodes in their fields."""
    for node in nodes:
        yield node
        for value in node.values():
            if isinstance(value, dict):
                yield from below([value])
            elif isinstance(value, list):
                yield from below([entry for entry in value if isinstance(entry, dict)])
