"""XML without what only attackers write: entities that grow."""

import xml.etree.ElementTree as ET
from pathlib import Path

from physgnn.errors import InputError
from physgnn.io.untrusted.input_errors import reading
from physgnn.io.untrusted.text import read_bytes

ENCODINGS = ("utf-8", "utf-16-le", "utf-16-be")


def read_xml(path: str | Path, what: str = "XML") -> ET.Element:
    """Return the root of an XML file, in whatever encoding it declares.

    Raises
    ------
    InputError
        If it is no XML, or defines entities.
    """
    data = read_bytes(path)
    with reading(path, what):
        return parsed(data)


def parsed(data: bytes) -> ET.Element:
    """Return the root of the XML that bytes hold; see `read_xml`."""
    if any("<!ENTITY".encode(encoding) in data for encoding in ENCODINGS):
        raise InputError("XML must not define entities: write their text instead")
    return ET.fromstring(data)
