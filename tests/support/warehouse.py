"""A database as warehouse_ros_sqlite makes it (schema 10), for tests: written by its SCHEMA.md."""
import hashlib
import pathlib
import sqlite3


class Warehouse:
    def __init__(self, file: pathlib.Path, schema: int = 10):
        self._database = sqlite3.connect(file)
        self._database.execute(f"PRAGMA user_version = {schema}")
        self._database.execute("CREATE TABLE WarehouseIndex (MangledTableName TEXT PRIMARY KEY, MessageMD5 BLOB NOT NULL, "
                               "WarehouseCollectionName TEXT NOT NULL, WarehouseDatabaseName TEXT NOT NULL, MessageDataType TEXT NOT NULL)")

    def insert(self, database: str, collection: str, message: str, data: bytes, **metadata) -> None:
        """:param metadata: texts are kept as blobs, as the original does."""
        kind = f"moveit_msgs::msg::{message}"
        table = f"T_{database.replace('@', '@@')}@{collection.replace('@', '@@')}"
        quoted = '"' + table.replace('"', '""') + '"'
        if not self._database.execute("SELECT 1 FROM WarehouseIndex WHERE MangledTableName = ?", [table]).fetchone():
            self._database.execute(f"CREATE TABLE {quoted} (Data BLOB NOT NULL, M_id INTEGER PRIMARY KEY AUTOINCREMENT, "
                                   "M_creation_time INTEGER)")
            self._database.execute("INSERT INTO WarehouseIndex VALUES (?, ?, ?, ?, ?)",
                                   [table, hashlib.md5(kind.encode()).digest(), collection, database, kind])
        known = {row[1] for row in self._database.execute(f"PRAGMA table_info({quoted})")}
        for name, value in metadata.items():
            if f"M_{name}" not in known:
                self._database.execute(f'ALTER TABLE {quoted} ADD "M_{name}" {"BLOB" if isinstance(value, str) else "FLOAT"}')
        values = [value.encode() if isinstance(value, str) else value for value in metadata.values()]
        names = "".join(f', "M_{name}"' for name in metadata)
        self._database.execute(f"INSERT INTO {quoted} (Data, M_creation_time{names}) VALUES (?, 1.5{', ?' * len(values)})", [data, *values])
        self._database.commit()

    def close(self) -> None:
        self._database.close()
