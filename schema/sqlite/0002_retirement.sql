-- 0002: paths may be retired, evicted distributions leave their revision behind, the arms of the
-- attempts are summed up per robot and task, and a path knows when it arrived.

-- The column last added stands behind the waypoints: what is read without them is in the indexes.
ALTER TABLE path ADD COLUMN received_ms INTEGER NOT NULL DEFAULT 0;  -- of the attempt that brought it
ALTER TABLE path ADD COLUMN retired_ms INTEGER CHECK (retired_ms > 0);  -- NULL: in use
UPDATE path SET received_ms =
  coalesce((SELECT received_ms FROM attempt WHERE attempt.report_uuid = path.report_uuid), 0);

-- A retired path, like a damaged one, is kept for the record and stands in nobody's way.
DROP INDEX path_by_content;
DROP INDEX path_by_task_robot;
CREATE UNIQUE INDEX path_by_content ON path (robot_id, task_id, content_sha256)
  WHERE damaged = 0 AND retired_ms IS NULL;
CREATE INDEX path_by_task_robot ON path (task_id, robot_id, id, received_ms)
  WHERE damaged = 0 AND retired_ms IS NULL;
CREATE INDEX path_retired ON path (task_id, robot_id, id)
  WHERE damaged = 0 AND retired_ms IS NOT NULL;

CREATE INDEX attempt_by_task_robot ON attempt (task_id, robot_id, id);

-- The generation that the last retirement made: what was fitted before it is never served again.
ALTER TABLE experience ADD COLUMN retired_generation INTEGER NOT NULL DEFAULT 0
  CHECK (retired_generation BETWEEN 0 AND generation);

-- Sums over the attempts of arm 1 (guided) and 2 (control), kept up by each report: the row is
-- written anyway, and nobody has to read a million attempts for an advice.
ALTER TABLE experience ADD COLUMN guided_attempts INTEGER NOT NULL DEFAULT 0;
ALTER TABLE experience ADD COLUMN guided_solved INTEGER NOT NULL DEFAULT 0;
ALTER TABLE experience ADD COLUMN guided_checks REAL NOT NULL DEFAULT 0;  -- collision checks
ALTER TABLE experience ADD COLUMN guided_checks_squared REAL NOT NULL DEFAULT 0;  -- sum of squares
ALTER TABLE experience ADD COLUMN guided_checks_of_solved REAL NOT NULL DEFAULT 0;
ALTER TABLE experience ADD COLUMN control_attempts INTEGER NOT NULL DEFAULT 0;
ALTER TABLE experience ADD COLUMN control_solved INTEGER NOT NULL DEFAULT 0;
ALTER TABLE experience ADD COLUMN control_checks REAL NOT NULL DEFAULT 0;
ALTER TABLE experience ADD COLUMN control_checks_squared REAL NOT NULL DEFAULT 0;
ALTER TABLE experience ADD COLUMN control_checks_of_solved REAL NOT NULL DEFAULT 0;
UPDATE experience SET
  guided_attempts = sums.guided, guided_solved = sums.guided_solved,
  guided_checks = sums.guided_checks, guided_checks_squared = sums.guided_squared,
  guided_checks_of_solved = sums.guided_of_solved,
  control_attempts = sums.control, control_solved = sums.control_solved,
  control_checks = sums.control_checks, control_checks_squared = sums.control_squared,
  control_checks_of_solved = sums.control_of_solved
FROM (
  SELECT task_id, robot_id,
    count(*) FILTER (WHERE arm = 1) AS guided,
    count(*) FILTER (WHERE arm = 1 AND outcome = 1) AS guided_solved,
    total(collision_checks) FILTER (WHERE arm = 1) AS guided_checks,
    total(1.0 * collision_checks * collision_checks) FILTER (WHERE arm = 1) AS guided_squared,
    total(collision_checks) FILTER (WHERE arm = 1 AND outcome = 1) AS guided_of_solved,
    count(*) FILTER (WHERE arm = 2) AS control,
    count(*) FILTER (WHERE arm = 2 AND outcome = 1) AS control_solved,
    total(collision_checks) FILTER (WHERE arm = 2) AS control_checks,
    total(1.0 * collision_checks * collision_checks) FILTER (WHERE arm = 2) AS control_squared,
    total(collision_checks) FILTER (WHERE arm = 2 AND outcome = 1) AS control_of_solved
  FROM attempt GROUP BY task_id, robot_id
) AS sums
WHERE sums.task_id = experience.task_id AND sums.robot_id = experience.robot_id;

-- A distribution fitted again after it was evicted goes on counting revisions from here.
CREATE TABLE evicted_distribution (
  digest      BLOB PRIMARY KEY CHECK (length(digest) = 32),
  revision    INTEGER NOT NULL CHECK (revision >= 1),
  evicted_ms  INTEGER NOT NULL
) STRICT, WITHOUT ROWID;
