-- 0005: a robot and task keep no more paths than the server was told; distributions that nobody
-- asked for in a long time make room for others; what a server knows of the meshes of a robot, and
-- whether better geometry was taken over since it was registered. Applied once, in one transaction;
-- see 0001. Once released, never edited.

-- A dropped path keeps its row, retired, with one zero byte for its waypoints (no blob is so short);
-- one that was beyond the cap when it came has no row: its attempt is stored and names no path.
-- (Without a CHECK: for one SQLite would read all rows now, and one may be damaged.)
ALTER TABLE experience ADD COLUMN dropped INTEGER NOT NULL DEFAULT 0;  -- paths, in all

-- Beside the distributions: to write a column of theirs SQLite would write their payload anew.
CREATE TABLE distribution_use (
  id       INTEGER PRIMARY KEY,  -- of the distribution
  used_ms  INTEGER NOT NULL,     -- to the hour
  bytes    INTEGER NOT NULL CHECK (bytes >= 1)  -- of its row, about
) STRICT;
CREATE INDEX distribution_use_by_time ON distribution_use (used_ms, id, bytes);
-- From an index, as a row may be damaged: their sizes are not known, and they go first.
INSERT INTO distribution_use
  SELECT id, 0, 32768 FROM distribution INDEXED BY distribution_by_task
  WHERE id NOT IN (SELECT id FROM set_aside WHERE kind = 4);

-- A robot without a row: no solids around meshes, and its geometry is that of its registration.
CREATE TABLE robot_geometry (
  robot_id     INTEGER PRIMARY KEY REFERENCES robot (id) ON DELETE CASCADE,
  revision     INTEGER NOT NULL CHECK (revision >= 0),  -- how often better geometry was taken over
  taken_ms     INTEGER NOT NULL,  -- when last; 0: never
  mesh_solids  BLOB NOT NULL  -- server/store/sqlite/mesh_solids_blob.cpp; under the robot's checksum
) STRICT;
