-- 0001: robots, tasks, attempts, paths, distributions. Applied once, in one transaction, by
-- server/store/sqlite/migrations.cpp, which then records it in schema_migration and sets
-- PRAGMA user_version = 1. Once released, never edited: write the next number.
--
-- Times are Unix time in ms, UTC. A pose is a BLOB of 7 float64 little-endian: x y z (m), then the
-- quaternion x y z w. Digests are SHA-256, checksums CRC-32C.

PRAGMA application_id = 0x4B494E53;  -- 'KINS': files without it are refused

CREATE TABLE schema_migration (
  version         INTEGER PRIMARY KEY CHECK (version >= 1),
  name            TEXT NOT NULL,
  sha256          BLOB NOT NULL CHECK (length(sha256) = 32),  -- of the text: an edited history is refused
  applied_ms      INTEGER NOT NULL,
  sqlite_version  TEXT NOT NULL
) STRICT;

CREATE TABLE setting (
  key    TEXT PRIMARY KEY,
  value  TEXT NOT NULL
) STRICT, WITHOUT ROWID;

CREATE TABLE robot (
  id              INTEGER PRIMARY KEY,
  digest          BLOB NOT NULL UNIQUE CHECK (length(digest) = 32),
  label           TEXT NOT NULL UNIQUE CHECK (length(label) BETWEEN 1 AND 64),
  dof             INTEGER NOT NULL CHECK (dof BETWEEN 1 AND 32),
  base_link       TEXT NOT NULL,
  tip_link        TEXT NOT NULL,
  T_tip_transfer  BLOB NOT NULL CHECK (length(T_tip_transfer) = 56),
  task_axes       INTEGER NOT NULL CHECK (task_axes BETWEEN 0 AND 63),  -- bit 0 x, y, z, roll, pitch, 5 yaw
  registered_ms   INTEGER NOT NULL,
  crc32c          INTEGER NOT NULL CHECK (crc32c BETWEEN 0 AND 4294967295),  -- of the whole description
  urdf            TEXT NOT NULL
) STRICT;

CREATE TABLE robot_held_joint (
  robot_id  INTEGER NOT NULL REFERENCES robot (id) ON DELETE CASCADE,
  joint     TEXT NOT NULL,
  position  REAL NOT NULL,  -- joint units
  PRIMARY KEY (robot_id, joint)
) STRICT, WITHOUT ROWID;

CREATE TABLE robot_never_colliding (
  robot_id  INTEGER NOT NULL REFERENCES robot (id) ON DELETE CASCADE,
  ordinal   INTEGER NOT NULL CHECK (ordinal >= 0),
  link_a    TEXT NOT NULL,
  link_b    TEXT NOT NULL,
  PRIMARY KEY (robot_id, ordinal)
) STRICT, WITHOUT ROWID;

CREATE TABLE task (
  id    INTEGER PRIMARY KEY,
  name  TEXT NOT NULL UNIQUE CHECK (length(name) BETWEEN 1 AND 128)
) STRICT;

-- One row per robot and task that somebody reported. The generation says whether a fit is fresh.
CREATE TABLE experience (
  task_id     INTEGER NOT NULL REFERENCES task (id),
  robot_id    INTEGER NOT NULL REFERENCES robot (id),
  generation  INTEGER NOT NULL DEFAULT 0 CHECK (generation >= 0),
  paths       INTEGER NOT NULL DEFAULT 0 CHECK (paths >= 0),  -- without damaged ones
  attempts    INTEGER NOT NULL DEFAULT 0 CHECK (attempts >= 0),
  PRIMARY KEY (task_id, robot_id)
) STRICT, WITHOUT ROWID;
CREATE INDEX experience_by_robot ON experience (robot_id);

CREATE TABLE path (
  id              INTEGER PRIMARY KEY,
  task_id         INTEGER NOT NULL,
  robot_id        INTEGER NOT NULL,
  report_uuid     BLOB NOT NULL CHECK (length(report_uuid) = 16),  -- of the attempt that brought it
  content_sha256  BLOB NOT NULL CHECK (length(content_sha256) = 32),  -- of dof, n and the waypoints
  waypoint_count  INTEGER NOT NULL CHECK (waypoint_count BETWEEN 2 AND 16384),
  dof             INTEGER NOT NULL CHECK (dof BETWEEN 1 AND 32),
  length          REAL NOT NULL CHECK (length >= 0),  -- joint units
  damaged         INTEGER NOT NULL DEFAULT 0 CHECK (damaged IN (0, 1)),  -- 1: set aside
  T_task_base     BLOB CHECK (length(T_task_base) = 56),
  encoding        INTEGER NOT NULL CHECK (encoding IN (1, 2)),
  crc32c          INTEGER NOT NULL CHECK (crc32c BETWEEN 0 AND 4294967295),
  -- dof x n, column-major, joint units. Encoding 1: float64 little-endian. Encoding 2: the same
  -- without loss, as differences of bit patterns between waypoints, bytes shuffled, zstd.
  waypoints       BLOB NOT NULL,
  FOREIGN KEY (task_id, robot_id) REFERENCES experience (task_id, robot_id),
  CHECK (encoding <> 1 OR length(waypoints) = 8 * dof * waypoint_count),
  CHECK (length(waypoints) BETWEEN 1 AND 8 * dof * waypoint_count)
) STRICT;
-- A damaged path stands in nobody's way: the same content may come again.
CREATE UNIQUE INDEX path_by_content ON path (robot_id, task_id, content_sha256) WHERE damaged = 0;
CREATE INDEX path_by_task_robot ON path (task_id, robot_id, id) WHERE damaged = 0;
CREATE INDEX path_damaged ON path (id) WHERE damaged = 1;

-- Every planning query that a client reported, solved or not; also the ledger that makes a repeated
-- report harmless, so a row outlives its path.
CREATE TABLE attempt (
  id                     INTEGER PRIMARY KEY,
  report_uuid            BLOB NOT NULL UNIQUE CHECK (length(report_uuid) = 16),
  body_sha256            BLOB NOT NULL CHECK (length(body_sha256) = 32),
  task_id                INTEGER NOT NULL,
  robot_id               INTEGER NOT NULL,
  path_id                INTEGER REFERENCES path (id) ON DELETE SET NULL,
  status                 INTEGER NOT NULL CHECK (status IN (1, 2, 3)),  -- 1 stored, 2 duplicate content, 3 unsolved
  machine                TEXT NOT NULL,
  T_task_base            BLOB CHECK (length(T_task_base) = 56),
  outcome                INTEGER NOT NULL CHECK (outcome IN (1, 2, 3)),  -- 1 solved, 2 timeout, 3 failed
  planner                TEXT NOT NULL,
  planner_options        TEXT NOT NULL,
  planning_time_s        REAL NOT NULL CHECK (planning_time_s BETWEEN 0 AND 1e12),
  collision_checks       INTEGER NOT NULL CHECK (collision_checks >= 0),
  projections            INTEGER NOT NULL CHECK (projections >= 0),
  time_limit_s           REAL NOT NULL CHECK (time_limit_s BETWEEN 0 AND 1e12),
  arm                    INTEGER NOT NULL CHECK (arm IN (1, 2, 3)),  -- 1 guided, 2 control, 3 uniform
  share                  REAL NOT NULL CHECK (share BETWEEN 0 AND 1),
  distribution_digest    BLOB CHECK (length(distribution_digest) = 32),
  distribution_revision  INTEGER NOT NULL CHECK (distribution_revision >= 0),
  received_ms            INTEGER NOT NULL,
  FOREIGN KEY (task_id, robot_id) REFERENCES experience (task_id, robot_id),
  CHECK ((outcome = 1) = (status IN (1, 2)))
) STRICT;

-- The newest revision of each distribution. Everything but the payload is there to be listed.
CREATE TABLE distribution (
  id              INTEGER PRIMARY KEY,
  digest          BLOB NOT NULL UNIQUE CHECK (length(digest) = 32),
  revision        INTEGER NOT NULL CHECK (revision >= 1),
  task_id         INTEGER NOT NULL REFERENCES task (id),
  robot_id        INTEGER NOT NULL REFERENCES robot (id),
  profile         TEXT NOT NULL,
  state           INTEGER NOT NULL CHECK (state IN (1, 2)),  -- 1 ready, 2 failed
  reason          TEXT NOT NULL,
  components      INTEGER NOT NULL CHECK (components >= 0),
  configurations  INTEGER NOT NULL CHECK (configurations >= 0),
  paths           INTEGER NOT NULL CHECK (paths >= 0),
  fitted_ms       INTEGER NOT NULL,
  crc32c          INTEGER NOT NULL CHECK (crc32c BETWEEN 0 AND 4294967295),
  payload         BLOB NOT NULL,  -- server/store/sqlite/distribution_blob.cpp
  CHECK ((state = 1) = (components > 0))
) STRICT;
CREATE INDEX distribution_by_task ON distribution (task_id);
CREATE INDEX distribution_by_robot ON distribution (robot_id);
