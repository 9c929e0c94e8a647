-- 0004: what is damaged is set aside by its id, in a table of its own: to mark a row that lies on a
-- damaged page SQLite would have to read that page. For the same reason nothing is UNIQUE any more
-- that a report may bring again: the old row cannot be removed from its indexes. The one writer
-- sees to it that there is one row which is not set aside. Files of this schema have checksums at
-- the end of their pages (server/store/sqlite/checked_vfs).

CREATE TABLE set_aside (
  kind         INTEGER NOT NULL CHECK (kind BETWEEN 1 AND 5),  -- 1 path, 2 attempt, 3 scene, 4 distribution; 5 path that lost its attempt in a repair
  id           INTEGER NOT NULL,
  noticed_ms   INTEGER NOT NULL,
  replaced_by  INTEGER,  -- the row that a report brought in its place
  retired_ms   INTEGER CHECK (retired_ms > 0),  -- of a path that was retired before or after
  reason       TEXT NOT NULL,
  PRIMARY KEY (kind, id)
) STRICT, WITHOUT ROWID;
INSERT INTO set_aside
  SELECT 1, id, 0, NULL, retired_ms, 'found damaged before schema 4' FROM path WHERE damaged = 1;
INSERT INTO set_aside
  SELECT 3, id, 0, NULL, NULL, 'found damaged before schema 4' FROM scene WHERE damaged = 1;

-- path.damaged is not written any more; to drop the column would write every path anew.
DROP INDEX path_by_content;
DROP INDEX path_by_task_robot;
DROP INDEX path_retired;
DROP INDEX path_damaged;
CREATE INDEX path_by_content ON path (robot_id, task_id, content_sha256) WHERE retired_ms IS NULL;
CREATE INDEX path_by_task_robot ON path (task_id, robot_id, id, received_ms)
  WHERE retired_ms IS NULL;
CREATE INDEX path_retired ON path (task_id, robot_id, id) WHERE retired_ms IS NOT NULL;

CREATE TABLE attempt_4 (
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
  arm                    INTEGER NOT NULL CHECK (arm IN (1, 2, 3)),  -- 1 guided, 2 control, 3 uniform
  share                  REAL NOT NULL CHECK (share BETWEEN 0 AND 1),
  distribution_digest    BLOB CHECK (length(distribution_digest) = 32),
  distribution_revision  INTEGER NOT NULL CHECK (distribution_revision >= 0),
  received_ms            INTEGER NOT NULL,
  scene_id               INTEGER REFERENCES scene (id),
  FOREIGN KEY (task_id, robot_id) REFERENCES experience (task_id, robot_id),
  CHECK ((outcome = 1) = (status IN (1, 2)))
) STRICT;
INSERT INTO attempt_4
  SELECT id, report_uuid, body_sha256, task_id, robot_id, path_id, status, machine, T_task_base,
    outcome, planner, planner_options, planning_time_s, collision_checks, projections, time_limit_s,
    arm, share, distribution_digest, distribution_revision, received_ms, scene_id
  FROM attempt;
DROP TABLE attempt;
ALTER TABLE attempt_4 RENAME TO attempt;
CREATE INDEX attempt_by_uuid ON attempt (report_uuid);
CREATE INDEX attempt_by_task_robot ON attempt (task_id, robot_id, id);

CREATE TABLE scene_4 (
  id              INTEGER PRIMARY KEY,
  content_sha256  BLOB NOT NULL CHECK (length(content_sha256) = 32),  -- proto/types/recorded_scene
  received_ms     INTEGER NOT NULL,  -- of the attempt that brought it
  size            INTEGER NOT NULL CHECK (size BETWEEN 1 AND 1048576),  -- bytes before compression
  encoding        INTEGER NOT NULL CHECK (encoding IN (1, 2)),  -- 1 plain, 2 zstd
  crc32c          INTEGER NOT NULL CHECK (crc32c BETWEEN 0 AND 4294967295),
  scene           BLOB NOT NULL,  -- server/store/sqlite/scene_blob.cpp
  CHECK (encoding <> 1 OR length(scene) = size),
  CHECK (length(scene) BETWEEN 1 AND size)
) STRICT;
INSERT INTO scene_4
  SELECT id, content_sha256, received_ms, size, encoding, crc32c, scene FROM scene;
DROP TABLE scene;
ALTER TABLE scene_4 RENAME TO scene;
CREATE INDEX scene_by_content ON scene (content_sha256);

CREATE TABLE distribution_4 (
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
  payload         BLOB NOT NULL,  -- server/store/sqlite/distribution_blob.cpp
  CHECK ((state = 1) = (components > 0))
) STRICT;
INSERT INTO distribution_4
  SELECT id, digest, revision, task_id, robot_id, profile, state, reason, components,
    configurations, paths, fitted_ms, crc32c, payload
  FROM distribution;
DROP TABLE distribution;
ALTER TABLE distribution_4 RENAME TO distribution;
-- With the revision: what a damaged row's was is known without it.
CREATE INDEX distribution_by_digest ON distribution (digest, revision);
CREATE INDEX distribution_by_task ON distribution (task_id);
CREATE INDEX distribution_by_robot ON distribution (robot_id);
