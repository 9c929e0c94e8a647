-- 0001: the whole store. Applied once, in one transaction, by server/store/sqlite/opening, which
-- then records it in schema_migration and sets PRAGMA user_version = 1. Once released, never
-- edited: write the next number.
--
-- Times are Unix time in ms, UTC. A pose is a BLOB of 7 float64 little-endian: x y z (m), then the
-- quaternion x y z w. Digests are SHA-256, checksums CRC-32C.
--
-- row_crc32c is the checksum of the other columns of its row; a large one has a checksum of its own
-- (server/store/sqlite/database/row_checksums). A row whose checksum is wrong
-- is not read. What is damaged is quarantined by its id, in a table of its own: the row itself may
-- not be writable. For the same reason nothing is UNIQUE that a report may bring again. The one
-- writer sees to it that there is one row which is not quarantined.

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
  value  TEXT NOT NULL,
  row_crc32c  INTEGER NOT NULL DEFAULT 0
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
  row_crc32c  INTEGER NOT NULL DEFAULT 0,
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

-- A robot without a row: no solids around meshes, and its geometry is that of its registration.
CREATE TABLE robot_geometry (
  robot_id     INTEGER PRIMARY KEY REFERENCES robot (id) ON DELETE CASCADE,
  revision     INTEGER NOT NULL CHECK (revision >= 0),  -- how often better geometry was taken over
  taken_ms     INTEGER NOT NULL,  -- when last; 0: never
  row_crc32c  INTEGER NOT NULL DEFAULT 0,
  mesh_solids  BLOB NOT NULL  -- server/store/values/mesh_solids_blob.cpp; under the robot's checksum
) STRICT;

CREATE TABLE task (
  id    INTEGER PRIMARY KEY,
  name  TEXT NOT NULL UNIQUE CHECK (length(name) BETWEEN 1 AND 128),
  row_crc32c  INTEGER NOT NULL DEFAULT 0
) STRICT;

-- One row per robot and task that somebody reported. The generation says whether a fit is fresh.
-- Sums are kept up by each report: the row is written anyway, and nobody has to read a million
-- attempts for an advice.
CREATE TABLE experience (
  task_id             INTEGER NOT NULL REFERENCES task (id),
  robot_id            INTEGER NOT NULL REFERENCES robot (id),
  generation          INTEGER NOT NULL DEFAULT 0 CHECK (generation >= 0),
  paths               INTEGER NOT NULL DEFAULT 0 CHECK (paths >= 0),  -- in use
  attempts            INTEGER NOT NULL DEFAULT 0 CHECK (attempts >= 0),
  -- Made by the last retirement: what was fitted before it is never served again.
  retired_generation  INTEGER NOT NULL DEFAULT 0 CHECK (retired_generation BETWEEN 0 AND generation),
  -- Sums over the attempts in sampling_mode 1 (guided) and 2 (control): checks are collision checks.
  guided_attempts           INTEGER NOT NULL DEFAULT 0,
  guided_solved             INTEGER NOT NULL DEFAULT 0,
  guided_checks             REAL NOT NULL DEFAULT 0,
  guided_checks_squared     REAL NOT NULL DEFAULT 0,  -- sum of squares
  guided_checks_of_solved   REAL NOT NULL DEFAULT 0,
  control_attempts          INTEGER NOT NULL DEFAULT 0,
  control_solved            INTEGER NOT NULL DEFAULT 0,
  control_checks            REAL NOT NULL DEFAULT 0,
  control_checks_squared    REAL NOT NULL DEFAULT 0,
  control_checks_of_solved  REAL NOT NULL DEFAULT 0,
  dropped                   INTEGER NOT NULL DEFAULT 0,  -- paths beyond the cap, in all
  row_crc32c  INTEGER NOT NULL DEFAULT 0,
  PRIMARY KEY (task_id, robot_id)
) STRICT, WITHOUT ROWID;
CREATE INDEX experience_by_robot ON experience (robot_id);

-- The scenes that attempts were planned in, one row in use per content.
CREATE TABLE scene (
  id              INTEGER PRIMARY KEY,
  content_sha256  BLOB NOT NULL CHECK (length(content_sha256) = 32),  -- proto/types/recorded_scene
  received_ms     INTEGER NOT NULL,  -- of the attempt that brought it
  size            INTEGER NOT NULL CHECK (size BETWEEN 1 AND 1048576),  -- bytes before compression
  encoding        INTEGER NOT NULL CHECK (encoding IN (1, 2)),  -- 1 plain, 2 zstd
  crc32c          INTEGER NOT NULL CHECK (crc32c BETWEEN 0 AND 4294967295),
  row_crc32c  INTEGER NOT NULL DEFAULT 0,
  scene           BLOB NOT NULL,  -- server/store/values/scene_blob.cpp
  CHECK (encoding <> 1 OR length(scene) = size),
  CHECK (length(scene) BETWEEN 1 AND size)
) STRICT;
CREATE INDEX scene_by_content ON scene (content_sha256);

-- The waypoints come last: columns behind them would cost their overflow pages.
CREATE TABLE path (
  id              INTEGER PRIMARY KEY,
  task_id         INTEGER NOT NULL,
  robot_id        INTEGER NOT NULL,
  report_uuid     BLOB NOT NULL CHECK (length(report_uuid) = 16),  -- of the attempt that brought it
  content_sha256  BLOB NOT NULL CHECK (length(content_sha256) = 32),  -- of waypoints and snapped placement
  waypoint_count  INTEGER NOT NULL CHECK (waypoint_count BETWEEN 2 AND 16384),
  dof             INTEGER NOT NULL CHECK (dof BETWEEN 1 AND 32),
  length          REAL NOT NULL CHECK (length >= 0),  -- joint units
  received_ms     INTEGER NOT NULL,  -- of the attempt that brought it
  retired_ms      INTEGER CHECK (retired_ms > 0),  -- NULL: not retired, not dropped
  scene_id        INTEGER REFERENCES scene (id),  -- of the attempt that brought it
  T_task_base     BLOB CHECK (length(T_task_base) = 56),
  encoding        INTEGER NOT NULL CHECK (encoding IN (1, 2)),
  crc32c          INTEGER NOT NULL CHECK (crc32c BETWEEN 0 AND 4294967295),
  row_crc32c      INTEGER NOT NULL DEFAULT 0,
  -- dof x n, column-major, joint units. Encoding 1: float64 little-endian. Encoding 2: the same
  -- without loss, as differences of bit patterns between waypoints, bytes shuffled, zstd. One zero
  -- byte: the path was dropped, being beyond the cap.
  waypoints       BLOB NOT NULL,
  FOREIGN KEY (task_id, robot_id) REFERENCES experience (task_id, robot_id),
  CHECK (encoding <> 1 OR length(waypoints) = 8 * dof * waypoint_count),
  CHECK (length(waypoints) BETWEEN 1 AND 8 * dof * waypoint_count)
) STRICT;
-- A retired path stands in nobody's way: the same content may come again.
CREATE INDEX path_by_content ON path (robot_id, task_id, content_sha256) WHERE retired_ms IS NULL;
CREATE INDEX path_by_task_robot ON path (task_id, robot_id, id, received_ms)
  WHERE retired_ms IS NULL;
CREATE INDEX path_retired ON path (task_id, robot_id, id) WHERE retired_ms IS NOT NULL;

-- Every planning query that a client reported, solved or not; also the ledger that makes a repeated
-- report harmless, so a row outlives its path. A path that was beyond the cap when it came has no
-- row: its attempt is stored and names no path.
CREATE TABLE attempt (
  id                     INTEGER PRIMARY KEY,
  report_uuid            BLOB NOT NULL CHECK (length(report_uuid) = 16),
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
  sampling_mode          INTEGER NOT NULL CHECK (sampling_mode IN (1, 2, 3)),  -- 1 guided, 2 control, 3 uniform
  share                  REAL NOT NULL CHECK (share BETWEEN 0 AND 1),
  distribution_digest    BLOB CHECK (length(distribution_digest) = 32),
  distribution_revision  INTEGER NOT NULL CHECK (distribution_revision >= 0),
  received_ms            INTEGER NOT NULL,
  scene_id               INTEGER REFERENCES scene (id),
  row_crc32c  INTEGER NOT NULL DEFAULT 0,
  FOREIGN KEY (task_id, robot_id) REFERENCES experience (task_id, robot_id),
  CHECK ((outcome = 1) = (status IN (1, 2)))
) STRICT;
CREATE INDEX attempt_by_uuid ON attempt (report_uuid);
CREATE INDEX attempt_by_task_robot ON attempt (task_id, robot_id, id);

-- The newest revision of each distribution. Everything but the payload is there to be listed.
CREATE TABLE distribution (
  id              INTEGER PRIMARY KEY,
  digest          BLOB NOT NULL CHECK (length(digest) = 32),
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
  row_crc32c  INTEGER NOT NULL DEFAULT 0,
  payload         BLOB NOT NULL,  -- server/store/values/distribution_blob.cpp
  CHECK ((state = 1) = (components > 0))
) STRICT;
-- With the revision: what a damaged row's was is known without it.
CREATE INDEX distribution_by_digest ON distribution (digest, revision);
CREATE INDEX distribution_by_task ON distribution (task_id);
CREATE INDEX distribution_by_robot ON distribution (robot_id);

-- Beside the distributions: to write a column of theirs SQLite would write their payload anew.
CREATE TABLE distribution_use (
  id       INTEGER PRIMARY KEY,  -- of the distribution
  used_ms  INTEGER NOT NULL,     -- to the hour
  bytes    INTEGER NOT NULL CHECK (bytes >= 1)  -- of its row, about
) STRICT;
CREATE INDEX distribution_use_by_time ON distribution_use (used_ms, id, bytes);

-- A distribution fitted again after it was evicted goes on counting revisions from here.
CREATE TABLE evicted_distribution (
  digest      BLOB PRIMARY KEY CHECK (length(digest) = 32),
  revision    INTEGER NOT NULL CHECK (revision >= 1),
  evicted_ms  INTEGER NOT NULL,
  row_crc32c  INTEGER NOT NULL DEFAULT 0
) STRICT, WITHOUT ROWID;

CREATE TABLE quarantine (
  of_table     TEXT NOT NULL CHECK (of_table IN ('path', 'attempt', 'scene', 'distribution')),
  id           INTEGER NOT NULL,
  noticed_ms   INTEGER NOT NULL,
  replaced_by  INTEGER,  -- the row that a report brought in its place
  retired_ms   INTEGER CHECK (retired_ms > 0),  -- of a path that was retired before or after
  row_crc32c   INTEGER NOT NULL DEFAULT 0,
  PRIMARY KEY (of_table, id)
) STRICT, WITHOUT ROWID;

-- Paths, in use or retired, that lost their attempts, in a repair or a move.
CREATE TABLE lost_attempt (
  id          INTEGER PRIMARY KEY,  -- of the path
  row_crc32c  INTEGER NOT NULL DEFAULT 0
) STRICT;

-- Reports whose path somebody retired, here or in another store, in the order in which that became
-- known. Also of reports that are not here: their paths are retired when they come.
CREATE TABLE retired_report (
  id           INTEGER PRIMARY KEY,  -- grows
  report_uuid  BLOB NOT NULL UNIQUE CHECK (length(report_uuid) = 16),
  retired_ms   INTEGER NOT NULL CHECK (retired_ms > 0),
  row_crc32c  INTEGER NOT NULL DEFAULT 0
) STRICT;

-- Attempts whose content another one had brought already, by that one's path: who retires the path
-- names all its reports. Only of these, so that other reports write no page more.
CREATE TABLE same_content (
  path_id      INTEGER NOT NULL,
  report_uuid  BLOB NOT NULL CHECK (length(report_uuid) = 16),
  row_crc32c   INTEGER NOT NULL DEFAULT 0,
  PRIMARY KEY (path_id, report_uuid)
) STRICT, WITHOUT ROWID;

-- Who had what done to the store, and what was refused.
CREATE TABLE audit (
  id         INTEGER PRIMARY KEY,  -- grows
  time_ms    INTEGER NOT NULL,
  name       TEXT NOT NULL CHECK (length(name) <= 64),     -- in the certificate; '': none
  role       TEXT NOT NULL CHECK (length(role) <= 64),     -- of the certificate; '': none
  client     TEXT NOT NULL CHECK (length(client) <= 128),  -- the name, or the participant
  is_local   INTEGER NOT NULL CHECK (is_local IN (0, 1)),
  verb       TEXT NOT NULL CHECK (length(verb) BETWEEN 1 AND 64),
  target     TEXT NOT NULL CHECK (length(target) <= 1024),
  outcome    INTEGER NOT NULL CHECK (outcome BETWEEN 1 AND 4),  -- 1 begun, 2 done, 3 refused, 4 failed
  was        TEXT NOT NULL CHECK (length(was) <= 2048),
  became     TEXT NOT NULL CHECK (length(became) <= 2048),
  message    TEXT NOT NULL CHECK (length(message) <= 2048),
  row_crc32c  INTEGER NOT NULL DEFAULT 0
) STRICT;
CREATE INDEX audit_by_name ON audit (name, id);

-- Entries are added, never changed or removed.
CREATE TRIGGER audit_keeps_its_rows BEFORE UPDATE OF id, time_ms, name, role, client, is_local, verb,
  target, outcome, was, became, message ON audit
BEGIN SELECT RAISE(ABORT, 'the audit log is append-only'); END;
CREATE TRIGGER audit_keeps_all_rows BEFORE DELETE ON audit
BEGIN SELECT RAISE(ABORT, 'the audit log is append-only'); END;
-- REPLACE deletes without the trigger above.
CREATE TRIGGER audit_replaces_no_row BEFORE INSERT ON audit
WHEN EXISTS (SELECT 1 FROM audit WHERE id = NEW.id)
BEGIN SELECT RAISE(ABORT, 'the audit log is append-only'); END;
