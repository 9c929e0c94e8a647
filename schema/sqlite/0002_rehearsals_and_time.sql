-- 0002: what rehearsals found, and what queries cost.

-- Rehearsals with their libraries of paths to recall, the newest of each distribution: they
-- are made anew where one is missing or damaged, and refer to no row.
CREATE TABLE rehearsal (
  id          INTEGER PRIMARY KEY,  -- grows
  digest      BLOB NOT NULL CHECK (length(digest) = 32),  -- of the distribution
  robot       BLOB NOT NULL CHECK (length(robot) = 32),
  task        TEXT NOT NULL CHECK (length(task) BETWEEN 1 AND 128),
  made_ms     INTEGER NOT NULL,  -- Unix time, UTC
  crc32c      INTEGER NOT NULL CHECK (crc32c BETWEEN 0 AND 4294967295),  -- of the payload
  row_crc32c  INTEGER NOT NULL DEFAULT 0,
  payload     BLOB NOT NULL  -- server/store/values/rehearsal_blob.cpp
) STRICT;
CREATE INDEX rehearsal_by_digest ON rehearsal (digest);

-- What a query cost in processor time, with everything that guidance costs; 0: unknown, as in all
-- attempts from before.
ALTER TABLE attempt ADD COLUMN processor_time_s REAL NOT NULL DEFAULT 0 CHECK (processor_time_s >= 0);
-- To the reference machine, as its client measured it (proto/evidence/machine_speed); 0: unknown.
ALTER TABLE attempt ADD COLUMN machine_speed REAL NOT NULL DEFAULT 0 CHECK (machine_speed >= 0);
