-- 0003: an attempt may name the scene that it was planned in; equal scenes are kept once.

CREATE TABLE scene (
  id              INTEGER PRIMARY KEY,
  content_sha256  BLOB NOT NULL UNIQUE CHECK (length(content_sha256) = 32),  -- proto/types/recorded_scene
  damaged         INTEGER NOT NULL DEFAULT 0 CHECK (damaged IN (0, 1)),  -- 1: set aside until it comes again
  received_ms     INTEGER NOT NULL,  -- of the attempt that brought it first, or anew
  size            INTEGER NOT NULL CHECK (size BETWEEN 1 AND 1048576),  -- bytes before compression
  encoding        INTEGER NOT NULL CHECK (encoding IN (1, 2)),  -- 1 plain, 2 zstd
  crc32c          INTEGER NOT NULL CHECK (crc32c BETWEEN 0 AND 4294967295),
  scene           BLOB NOT NULL,  -- server/store/sqlite/scene_blob.cpp
  CHECK (encoding <> 1 OR length(scene) = size),
  CHECK (length(scene) BETWEEN 1 AND size)
) STRICT;
CREATE INDEX scene_damaged ON scene (id) WHERE damaged = 1;

-- A transfer reads paths in bulk, so the scene stands with the path too.
ALTER TABLE attempt ADD COLUMN scene_id INTEGER REFERENCES scene (id);
ALTER TABLE path ADD COLUMN scene_id INTEGER REFERENCES scene (id);  -- of the attempt that brought it
