"""A reader of MCAP files after the MCAP Format Specification, which checks all that a file says twice: CRCs, indexes, counts."""
import dataclasses
import json
import struct
import zlib

import zstandard

MAGIC = b"\x89MCAP0\r\n"
HEADER, FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, MESSAGE_INDEX, CHUNK_INDEX = range(1, 9)
STATISTICS, METADATA, METADATA_INDEX, SUMMARY_OFFSET, DATA_END = 0x0B, 0x0C, 0x0D, 0x0E, 0x0F


class Malformed(Exception):
    """A file that contradicts the specification or itself."""


def require(is_so: bool, what: str) -> None:
    if not is_so:
        raise Malformed(what)


class Fields:
    """The members of a record, one after the other."""

    def __init__(self, data: bytes):
        self.data, self.place = data, 0

    def take(self, count: int) -> bytes:
        require(self.place + count <= len(self.data), "a member beyond the end of its record")
        self.place += count
        return self.data[self.place - count:self.place]

    def number(self, size: int) -> int:
        return int.from_bytes(self.take(size), "little")

    def block(self, size_of_length: int = 4) -> bytes:
        return self.take(self.number(size_of_length))

    def text(self) -> str:
        return self.block().decode()

    def rest(self) -> bytes:
        return self.take(len(self.data) - self.place)

    def pairs(self, *readers) -> list:
        """The entries of a list of tuples or a map; a reader is a size of a number, or None for a text."""
        entries = Fields(self.block())
        found = []
        while entries.place < len(entries.data):
            found.append(tuple(entries.text() if size is None else entries.number(size) for size in readers))
        return found


def records(data: bytes, start: int, end: int):
    """\\return  opcode, fields, place and length with the head of each record."""
    place = start
    while place < end:
        opcode, length = struct.unpack_from("<BQ", data, place)
        require(place + 9 + length <= end, f"record {opcode} at {place} reaches beyond {end}")
        yield opcode, Fields(data[place + 9:place + 9 + length]), place, 9 + length
        place += 9 + length


@dataclasses.dataclass
class Message:
    topic: str
    time: int  # ns
    value: dict


class Mcap:
    """A whole file, checked. Compression is zstd, messages are JSON."""

    def __init__(self, data: bytes):
        require(data[:8] == MAGIC and data[-8:] == MAGIC, "magic")
        self.data = data
        self.schemas, self.channels, self.messages, self.metadata = {}, {}, [], []
        self.chunks, self._metadata_places = [], []  # what the summary's indexes must say
        self._counts = {}
        self._read_data()
        self._read_summary()

    def on(self, topic: str) -> "list[Message]":
        return [message for message in self.messages if message.topic == topic]

    def _read_data(self) -> None:
        expected_indexes = []
        for opcode, fields, place, length in records(self.data, 8, len(self.data) - 8):
            require((opcode == HEADER) == (place == 8), f"record {opcode} at {place}")
            if opcode == HEADER:
                self.profile, self.library = fields.text(), fields.text()
            elif opcode in (SCHEMA, CHANNEL):
                self._define(opcode, fields)
            elif opcode == METADATA:
                name = fields.text()
                self.metadata.append((name, dict(fields.pairs(None, None))))
                self._metadata_places.append((place, length, name))
            elif opcode == CHUNK:
                require(not expected_indexes, "a chunk without all its message indexes")
                expected_indexes = self._read_chunk(fields, place, length)
            elif opcode == MESSAGE_INDEX:
                channel = fields.number(2)
                require(expected_indexes and expected_indexes.pop(0) == (channel, fields.pairs(8, 8)), f"message index at {place}")
                self.chunks[-1]["indexes"].append((channel, place))
                self.chunks[-1]["index_length"] += length
            elif opcode == DATA_END:
                require(not expected_indexes, "a chunk without all its message indexes")
                require(fields.number(4) == zlib.crc32(self.data[:place]), "CRC of the data section")
                self.summary_start = place + length
                return
            else:
                raise Malformed(f"record {opcode} in the data section")
        raise Malformed("no end of the data section")

    def _define(self, opcode: int, fields: Fields) -> None:
        known = self.schemas if opcode == SCHEMA else self.channels
        number = fields.number(2)
        require(number not in known or known[number] == fields.data, f"two records for {number}")
        known[number] = fields.data

    def schema_of(self, number: int) -> "tuple[str, str, dict]":
        fields = Fields(self.schemas[number][2:])
        return fields.text(), fields.text(), json.loads(fields.block())

    def channel_of(self, number: int) -> "tuple[int, str, str]":
        fields = Fields(self.channels[number][2:])
        return fields.number(2), fields.text(), fields.text()

    def _read_chunk(self, fields: Fields, place: int, length: int) -> list:
        """\\return  the message indexes that must follow."""
        begin, end, size, crc = fields.number(8), fields.number(8), fields.number(8), fields.number(4)
        compression, packed = fields.text(), fields.block(8)
        require(compression == "zstd", f"compression '{compression}'")
        content = zstandard.ZstdDecompressor().decompress(packed, max_output_size=size)
        require(len(content) == size and zlib.crc32(content) == crc, f"content of the chunk at {place}")
        indexes, times = {}, []
        for opcode, message, start, _ in records(content, 0, len(content)):
            require(opcode == MESSAGE, f"record {opcode} in a chunk")
            channel, sequence, time = message.number(2), message.number(4), message.number(8)
            require(message.number(8) == time, "publish time")
            require(sequence == self._counts.get(channel, 0), f"sequence number {sequence}")
            self._counts[channel] = sequence + 1
            indexes.setdefault(channel, []).append((time, start))
            times.append(time)
            _, topic, encoding = self.channel_of(channel)
            require(encoding == "json", f"encoding '{encoding}'")
            self.messages.append(Message(topic, time, json.loads(message.rest())))
        require((begin, end) == (min(times), max(times)), f"times of the chunk at {place}")
        self.chunks.append({"times": (begin, end), "place": (place, length), "indexes": [], "index_length": 0,
                                    "sizes": (len(packed), size)})
        return sorted(indexes.items())

    def _read_summary(self) -> None:
        footer_place = len(self.data) - 8 - 9 - 20
        opcode, footer, _, _ = next(records(self.data, footer_place, len(self.data) - 8))
        require(opcode == FOOTER, "no footer")
        start, offset_start, crc = footer.number(8), footer.number(8), footer.number(4)
        require(start == self.summary_start, "start of the summary")
        require(zlib.crc32(self.data[start:len(self.data) - 12]) == crc, "CRC of the summary")
        groups, again, found = [], {SCHEMA: {}, CHANNEL: {}}, {METADATA_INDEX: [], CHUNK_INDEX: [], STATISTICS: []}
        for opcode, fields, place, length in records(self.data, start, offset_start):
            if not groups or groups[-1][0] != opcode:
                groups.append([opcode, place, 0])
            groups[-1][2] += length
            if opcode in again:
                again[opcode][fields.number(2)] = fields.data
            else:
                found[opcode].append(fields)
        require(len({opcode for opcode, _, _ in groups}) == len(groups), "records of the summary are not grouped")
        offsets = [[f.number(1), f.number(8), f.number(8)] for _, f, _, _ in records(self.data, offset_start, footer_place)]
        require(offsets == groups, f"summary offsets {offsets}, groups {groups}")
        require(again == {SCHEMA: self.schemas, CHANNEL: self.channels}, "schemas and channels of the summary")
        require([(f.number(8), f.number(8), f.text()) for f in found[METADATA_INDEX]] == self._metadata_places, "metadata indexes")
        self._check_chunk_indexes(found[CHUNK_INDEX])
        self._check_statistics(*found[STATISTICS])

    def _check_chunk_indexes(self, indexes: "list[Fields]") -> None:
        require(len(indexes) == len(self.chunks), "number of chunk indexes")
        for fields, chunk in zip(indexes, self.chunks):
            require((fields.number(8), fields.number(8)) == chunk["times"], "times of a chunk index")
            require((fields.number(8), fields.number(8)) == chunk["place"], "place of a chunk index")
            require(fields.pairs(2, 8) == chunk["indexes"] and fields.number(8) == chunk["index_length"], "message indexes of a chunk")
            require(fields.text() == "zstd" and (fields.number(8), fields.number(8)) == chunk["sizes"], "sizes of a chunk index")

    def _check_statistics(self, fields: Fields) -> None:
        times = [message.time for message in self.messages] or [0]
        expected = [len(self.messages), len(self.schemas), len(self.channels), 0, len(self.metadata), len(self.chunks),
                    min(times), max(times)]
        require([fields.number(size) for size in (8, 2, 4, 4, 4, 4, 8, 8)] == expected, f"statistics are not {expected}")
        require(dict(fields.pairs(2, 8)) == {number: self._counts.get(number, 0) for number in self.channels}, "counts of channels")
