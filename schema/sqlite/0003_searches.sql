-- 0003: what explains attempts.

-- Search records, beside the attempts that brought them: the oldest go for want of room, the attempts
-- stay. A row refers to no other, and one that is damaged is dropped.
CREATE TABLE search (
  id           INTEGER PRIMARY KEY,  -- grows
  report_uuid  BLOB NOT NULL CHECK (length(report_uuid) = 16),  -- of the attempt
  task_id      INTEGER NOT NULL,
  robot_id     INTEGER NOT NULL,
  received_ms  INTEGER NOT NULL,  -- of the attempt
  bytes        INTEGER NOT NULL CHECK (bytes >= 1),  -- of the row, about
  why          TEXT NOT NULL CHECK (length(why) <= 512),  -- in words, for listings
  crc32c       INTEGER NOT NULL CHECK (crc32c BETWEEN 0 AND 4294967295),  -- of the payload
  row_crc32c   INTEGER NOT NULL DEFAULT 0,
  payload      BLOB NOT NULL  -- server/store/values/search_blob.cpp
) STRICT;
CREATE INDEX search_by_report ON search (report_uuid);
CREATE INDEX search_by_pair ON search (robot_id, task_id, bytes);
